"""What there is: bodies, joints, loads, supports and choices."""

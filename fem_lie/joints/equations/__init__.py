"""Compiled constraint equations of joints, in the relative motion of two frames."""

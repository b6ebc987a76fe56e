"""Elements of solids."""

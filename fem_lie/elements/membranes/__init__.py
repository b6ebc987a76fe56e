"""Elements of membranes."""

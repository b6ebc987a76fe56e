"""Contact: laws of what bodies do that touch, and the forces of penalties."""

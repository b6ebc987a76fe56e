"""Elements that fill volumes, and materials for them."""

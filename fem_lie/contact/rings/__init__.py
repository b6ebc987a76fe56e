"""Contact of ropes with rings that slide along them."""

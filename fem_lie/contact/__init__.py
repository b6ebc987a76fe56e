"""Contact: surfaces of bodies that touch, laws of what they do then, and who is near whom."""

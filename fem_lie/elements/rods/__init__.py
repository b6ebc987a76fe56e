"""Elements along lines without shear: cables and rods."""

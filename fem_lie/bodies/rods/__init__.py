"""Bodies along lines whose nodes are not frames, and rods without shear."""

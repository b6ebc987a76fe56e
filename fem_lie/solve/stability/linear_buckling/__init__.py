"""Linear buckling: geometric stiffness, its symmetry, load factors."""

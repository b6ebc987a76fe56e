"""Lines and surfaces: from gmsh, DOLFINx and functions."""

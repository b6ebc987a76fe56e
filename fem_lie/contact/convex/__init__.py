"""Convex polyhedra that touch each other and balls: separating axes and contact manifolds."""

"""Contact of convex polyhedra and balls: separating axes and contact manifolds."""

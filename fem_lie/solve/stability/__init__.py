"""Equilibrium paths through critical points, buckling, vibrations, imperfections."""

"""Paths of equilibrium through critical points, buckling, vibrations, imperfections."""

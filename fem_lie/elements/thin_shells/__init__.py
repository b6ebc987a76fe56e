"""Thin shells without shear: a file for each element."""

"""Sections that deform: modes of distortion and warping, and their stiffness."""

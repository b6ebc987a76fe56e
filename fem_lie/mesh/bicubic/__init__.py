"""Meshes of thin shells: bicubic patches, their coupling, and hierarchical refinement."""

"""Outlines of sections of beams, and their meshes."""

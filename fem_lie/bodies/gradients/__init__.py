"""Beams whose sections deform: twelve unknowns at each point."""

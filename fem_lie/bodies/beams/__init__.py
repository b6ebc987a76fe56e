"""Beams: frames along lines, and the assembly of their elements."""

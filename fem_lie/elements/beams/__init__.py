"""Beams: one file for each element, with its strain measures and its energy."""

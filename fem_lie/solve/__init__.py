"""Statics, stability and motion: what solves the equations of a scene."""

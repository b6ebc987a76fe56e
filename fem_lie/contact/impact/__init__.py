"""Impacts and Coulomb's friction of rigid bodies, compiled: what contacts make of a step's end."""

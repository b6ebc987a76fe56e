"""Meshes that follow a state: other meshes of a body, momenta kept, the loop in time."""

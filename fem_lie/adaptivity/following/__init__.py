"""Meshes that change during a motion or along a load: transfer of states, and adaptive loops."""

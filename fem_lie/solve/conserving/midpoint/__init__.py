"""Kinematics and forces at the midpoint of a step.

Cayley rotations, discrete gradients of cells.
"""

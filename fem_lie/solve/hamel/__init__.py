"""Hamel's scheme: rigid bodies by velocities in their own frames, with nonholonomic constraints."""

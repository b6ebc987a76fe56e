"""Rigid bodies by velocities in their own frames, which edges and rolling discs bind there."""

"""Integrators that are derived from a discrete action."""

"""Variational integrators, derived from a discrete action."""

"""Generalised-α."""

"""Loads on solids."""

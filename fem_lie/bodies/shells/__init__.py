"""Shells: frames on surfaces, their supports, and the assembly of their elements."""

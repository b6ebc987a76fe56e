"""Membranes: their nodes, supports, and the assembly of their elements."""

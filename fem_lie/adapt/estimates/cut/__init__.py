"""Shells with cells cut in four, what acts on the nodes that are new, and borders."""

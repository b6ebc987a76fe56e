"""Nodes of a system: numbers, followers, inertia, held axes, and sums over all of them."""

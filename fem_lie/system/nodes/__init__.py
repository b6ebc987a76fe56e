"""Nodes of a system: numbering, attached nodes, inertia, supports, and sums over all nodes."""

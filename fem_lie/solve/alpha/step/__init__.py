"""One step of generalised-α at a node, on all nodes, of free bodies: compiled."""

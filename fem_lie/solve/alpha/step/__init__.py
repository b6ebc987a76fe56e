"""Steps of generalised-α, compiled: at one node, on all nodes, of free bodies."""

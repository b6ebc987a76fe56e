"""Terms of a scene on the nodes that lead, and their sum."""

"""Terms of a scene on its master nodes, and their sum."""

"""Bodies along lines whose nodes are no frames."""

"""Contact pairs: one class for each combination of two kinds of surfaces."""

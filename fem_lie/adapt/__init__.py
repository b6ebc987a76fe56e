"""Error in space: estimates by recovered stress, goals, refinement, and the loop around them."""

"""Bodies of cells of one element of the small-energy kernel."""

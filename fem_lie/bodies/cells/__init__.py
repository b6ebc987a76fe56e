"""Bodies whose cells are those of one element of the small-energy kernel."""

"""One HTML file in which states of a scene move, for any browser and without a network."""

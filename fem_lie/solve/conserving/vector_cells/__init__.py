"""Forces over a step of cells whose nodes have vector coordinates with additive increments."""

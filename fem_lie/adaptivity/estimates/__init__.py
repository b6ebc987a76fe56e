"""Error estimates in space: by recovered stress, by residuals, by hierarchical refinement."""

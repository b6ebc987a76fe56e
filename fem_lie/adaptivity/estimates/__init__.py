"""Ways to estimate the error in space: by recovered stress, by residuals, by more unknowns."""

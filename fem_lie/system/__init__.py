"""The equations of a scene: residual, matrix and invariants."""

"""Time integration: what all schemes share."""

"""Forces over a step that compiled steps ask Python for: joints on attachment frames, viscosity."""

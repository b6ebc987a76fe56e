"""Forces over a step that compiled steps request from Python."""

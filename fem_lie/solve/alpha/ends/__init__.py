"""What changes the end of a step that was made without it: projections, contacts by impacts."""

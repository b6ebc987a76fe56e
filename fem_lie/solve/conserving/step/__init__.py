"""One step of the conserving schemes, compiled."""

"""Statics and time integration: one scheme per file."""

"""Nodes with frames, and the catalogue of who is who."""

"""Meshes that fill volumes."""

"""Subdomains: cells and joints divided among ranks, and the equations of their interface."""

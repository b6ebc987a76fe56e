"""Mortar contact: gaps weighted by shape functions along a line, one pressure per node."""

"""Beam elements: strain measures and energies, one file per element."""

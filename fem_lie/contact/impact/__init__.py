"""Impacts with Coulomb friction, compiled: impulses and positions at the end of a step."""

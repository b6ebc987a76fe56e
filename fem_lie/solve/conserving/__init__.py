"""Schemes that conserve energy and momenta, or dissipate."""

"""Coulomb cones of contacts: Jacobian, sweeps, Newton's methods, compiled."""

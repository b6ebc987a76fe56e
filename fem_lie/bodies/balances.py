"""Conserved quantities of a motion: energy balance, momentum balances, and their scales.

All schemes use the same definitions:

- *energy* is kinetic, elastic (of elements and springs), and potential: of gravity and of forces
  fixed in space without a history;
- all other actions do *work*: loads with a history, moments, follower loads, pressure, prescribed
  strains, drives and prescribed motions; damping dissipates;
- momentum and angular momentum about the origin change by the *impulses* of all external actions:
  loads (gravity, all loads, mass-proportional damping) and reactions (joints, springs and drives on
  the ground, prescribed motions, clamps and rollers).

Errors are relative to the largest exchanged quantity. For energies it is the largest of kinetic
plus elastic energy, the change of the potential, work and dissipation; for momenta the largest of
the impulses, the momentum and ``√(2 m T)``, which bounds the momentum that parts of mass m with
kinetic energy T can exchange (Cauchy-Schwarz), times the reach of the points about their centre for
the angular momentum.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array

WORK, DAMPING, NUMERICAL, COLUMNS = 0, 1, 2, 3
"""Columns: work, dissipation by damping, numerical dissipation; and their number."""
BY_LOADS, BY_REACTIONS, TOTAL = 3, 9, 15
"""First columns of the impulses of loads and of reactions behind those three; number of columns."""

POWER, LOSS, LOADS, REACTIONS, SIZE = 0, 1, 2, 8, 14
"""First index of each external action at one time in a row, and the size of a row."""


def energy_gaps(total: Array, balance: Array) -> Array:
    """Energy less work plus dissipation, relative to the first row, shape (T,).

    Args:
        total: Kinetic, elastic and potential energy, shape (T,).
        balance: Work, dissipation by damping and numerical dissipation, shape (T, 3).
    """
    closed = total - balance[:, 0] + balance[:, 1]
    return np.asarray(closed - closed[0])


def energy_scale(stored: Array, potential: Array, balance: Array) -> float:
    """Largest exchanged energy; ``stored`` is kinetic plus elastic energy, shape (T,)."""
    parts = (stored, potential - potential[0], balance[:, 0], balance[:, 1])
    return float(max(np.abs(part).max() for part in parts))


def momentum_gaps(momentum: Array, impulses: Array) -> Array:
    """Norm of the momentum less impulses since the first row, shape (T,).

    Args:
        momentum: Linear or angular momentum, shape (T, 3).
        impulses: Impulses of loads and of reactions up to each row, shape (T, 2, 3).
    """
    closed = momentum - impulses.sum(axis=1)
    return np.asarray(np.linalg.norm(closed - closed[0], axis=1))


def momentum_scale(momentum: Array, impulses: Array, exchanged: float) -> float:
    """Largest exchanged momentum; ``exchanged`` bounds that between parts of the scene."""
    lengths = np.linalg.norm(momentum, axis=1).max(), np.linalg.norm(impulses, axis=2).max()
    return float(max(*lengths, exchanged))


def reach(positions: Array) -> float:
    """Largest distance of a point from the centre of all, positions (T, N, 3)."""
    offsets = positions - positions.mean(axis=1, keepdims=True)
    return float(np.sqrt(np.einsum("tni,tni->tn", offsets, offsets).max(initial=0.0)))


def relative(value: float, scale: float) -> float:
    """``value`` over ``scale``; 0 if both are 0."""
    return 0.0 if value == 0.0 else float(value / scale) if scale > 0.0 else float("inf")

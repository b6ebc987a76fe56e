"""What of a motion must not change: energy less work, momenta less impulses, and over what scale.

One rule for all schemes:

- *energy* is kinetic, elastic (of elements and springs), and potential: of gravity and of forces
  fixed in space without a history;
- all else that acts does *work*: loads with a history, moments, following loads, pressure, strains
  that change, drives and prescribed motions; and damping takes *loss*;
- momentum and angular momentum about the origin change by the *impulses* of all that acts from
  outside: of loads (gravity, all loads, damping that goes with mass), and of reactions (joints,
  springs and drives on the ground, prescribed motions, clamps and guides).

Errors are gaps of these balances over the largest that is turned over: of energies the kinetic and
elastic one, the change of the potential, work and loss; of momenta the impulses, the momentum and
``√(2 m T)``, which is what the parts of a mass m with the kinetic energy T may exchange (by
Cauchy-Schwarz), times the reach of its points about their middle for angular momentum.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array

WORK, DAMPING, NUMERICAL, COLUMNS = 0, 1, 2, 3
"""Work, loss by damping, numerical loss, and how many these are."""
BY_LOADS, BY_REACTIONS, TOTAL = 3, 9, 15
"""Where impulses begin in rows that have them after those three, and how long such rows are."""


def energy_gaps(total: Array, balance: Array) -> Array:
    """Energy less work plus damping since the first row, shape (T,).

    Args:
        total: Kinetic, elastic and potential energy, shape (T,).
        balance: Work, damping and numerical loss, shape (T, 3).
    """
    closed = total - balance[:, 0] + balance[:, 1]
    return np.asarray(closed - closed[0])


def energy_scale(stored: Array, potential: Array, balance: Array) -> float:
    """The largest energy that is turned over; ``stored``: kinetic and elastic, shape (T,)."""
    parts = (stored, potential - potential[0], balance[:, 0], balance[:, 1])
    return float(max(np.abs(part).max() for part in parts))


def momentum_gaps(momentum: Array, impulses: Array) -> Array:
    """Length of the momentum less impulses since the first row, shape (T,).

    Args:
        momentum: Linear or angular, shape (T, 3).
        impulses: Of loads and of reactions up to then, shape (T, 2, 3).
    """
    closed = momentum - impulses.sum(axis=1)
    return np.asarray(np.linalg.norm(closed - closed[0], axis=1))


def momentum_scale(momentum: Array, impulses: Array, exchanged: float) -> float:
    """The largest momentum that is turned over; ``exchanged``: by the parts of the scene."""
    lengths = np.linalg.norm(momentum, axis=1).max(), np.linalg.norm(impulses, axis=2).max()
    return float(max(*lengths, exchanged))


def reach(positions: Array) -> float:
    """Largest distance of a point from the middle of all, positions (T, N, 3)."""
    apart = positions - positions.mean(axis=1, keepdims=True)
    return float(np.sqrt(np.einsum("tni,tni->tn", apart, apart).max(initial=0.0)))


def relative(value: float, scale: float) -> float:
    """``value`` over ``scale``, 0 where both are."""
    return 0.0 if value == 0.0 else float(value / scale) if scale > 0.0 else float("inf")

"""Whether the loads of a scene have a potential."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.forms.term import Term
from fem_lie.lie.motions import retract
from fem_lie.system.system import System

_SYMMETRIC = 1e-9  # of the largest entry, far above round-off and far below an open edge


def has_potential(system: System) -> bool:
    """Whether all loads have a potential: no moment about a fixed axis, follower load or friction.

    The parts of the matrix of the system are overwritten.
    """
    friction = any(term.has_friction for term in system.terms)
    return not system.load_cases.turning and not friction and _conserve(system)


def _conserve(system: System) -> bool:
    """Whether all load terms have a symmetric stiffness in every state.

    Its entries are polynomials of the state: a stiffness that is symmetric in a random state is so
    in all.
    """
    if not system.terms.loads:
        return True
    H, count, rng = system.frames.copy(), system.count, np.random.default_rng(0)
    h = np.where(system.held, 0.0, 0.1 * rng.normal(size=(count, 6)))
    h *= system.units.reshape(-1, 6)
    system.supports.rotate_back(H, h)
    retract(H[:count], h)
    return all(_symmetric(load, system, H) for load in system.terms.loads)


def _symmetric(load: Term, system: System, H: Array) -> bool:
    """Whether the stiffness of a load is symmetric at ``H`` for nodes that move by ``x + R u``."""
    amplitude, load.amplitude = load.amplitude, 1.0
    A = system.tangent.alone(H, load)
    load.amplitude = amplitude
    moves, free = np.arange(system.held.size) % 6 < 3, np.flatnonzero(~system.held.ravel())
    A = A.multiply(moves).tocsr()[free][:, free]
    return bool(abs(A - A.T).max() <= _SYMMETRIC * abs(A).max())

"""Convergence rate due to old mass and stiffness, measured without a refactorisation.

A Newton correction ``x`` with a frozen matrix leaves the error ``(S_frozen − S) x`` of mass and
stiffness, which the next correction has to remove: ``|J⁻¹ (S_frozen − S) x| / |x|`` is the
convergence rate of the iteration if only ``S`` is old. ``S x`` is a difference of two residuals
with the same multipliers, so that constraints do not contribute and terms nonlinear in ``x``
cancel.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.lie.node_types import all_from_group, twists
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.alpha.step.node import PlainScheme
from fem_lie.solve.alpha.step.nodes import State, correct
from fem_lie.solve.convergence import node_scaling
from fem_lie.system.equations import Equations, TimeState

PROBE = 1e-6
"""Size of the differences, see :func:`~.convergence.size_of`: far above round-off, and small."""

TINY = float(np.finfo(float).tiny)


def staleness(
    equations: Equations,
    solver: DirectSolver,
    scheme: PlainScheme,
    state: State,
    multipliers: Array,
    sizes: tuple[Array, Array, Indices],
    direction: Array,
) -> float:
    """Convergence rate of the iteration if only mass and stiffness are old.

    It costs two residuals and a solution.

    Args:
        equations: Equations of the scene; their matrix is the factorised one, in local components.
        solver: Solver with the frozen factors; its arrays are overwritten.
        scheme: Parameters, as for :func:`~.nodes.correct`.
        state: State within an iteration; not changed.
        multipliers: Lagrange multipliers.
        sizes: Scale of the constraints, norm weights of the multipliers, and which of them belong
            to the same vector as the previous one.
        direction: A correction, twists in the nodes' frames, shape (6 n + m,), overwritten.
    """
    scale, spread, joined = sizes
    nodes, x = 6 * equations.unknowns.moving, direction
    size = _size(equations, x, spread)
    x[nodes:] = 0.0
    probe = PROBE / max(_size(equations, x, spread), TINY)

    def moved(factor: float) -> Array:
        there = state.copy()
        held, r = multipliers.copy(), np.empty_like(x)
        correct(scheme, there.plain, -factor * x, scale, spread, joined, held)
        now = TimeState(there.H1, there.twist1, there.rate1, held)
        equations.residual(now, scale, r)
        return r

    change = (moved(probe) - moved(-probe)) / (2.0 * probe)
    equations.supports.rotate(state.H1, x[:nodes].reshape(-1, 6))
    x[:nodes][equations.matrix.held.ravel()] = 0.0
    solver.right_hand_side[:] = equations.matrix.times(x) - change
    solver.right_hand_side[nodes:] = 0.0
    solver.solve()
    return _size(equations, solver.solution, spread) / max(size, TINY)


def back_to_twists(state: State, d: Array, x: Array) -> None:
    """Transform a correction (6 n + m,) of :func:`~.nodes.correct` back to twists.

    Args:
        state: The state.
        d: Increments that it is a correction of, shape (n, 6).
        x: The correction, overwritten.
    """
    kinds, h = state.kinds, x[: state.d.size].reshape(-1, 6)
    all_from_group(kinds, state.H1, h)
    twists(kinds, d, h.copy(), h)


def _size(equations: Equations, x: Array, spread: Array) -> float:
    """Size of a correction as in :func:`~.nodes.correct`."""
    unknowns = equations.unknowns
    nodes = 6 * unknowns.moving
    halves = np.linalg.norm(x[:nodes].reshape(-1, 2, 3), axis=2) * node_scaling(unknowns)
    group = np.cumsum(~unknowns.joined) - 1
    held = (spread * x[nodes:][unknowns.vectors]).sum(axis=1)
    largest = np.sqrt(np.bincount(group, held**2)).max(initial=0.0)
    return equations.shared.largest(float(max(halves.max(), largest)))

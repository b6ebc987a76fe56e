"""Impulses with the saddle-point mass matrix, and projection of velocities onto constraints.

Some directions have no inertia: the drilling rotation of a shell, the rotation of
a node whose section has no rotary inertia. Only elastic forces within the step balance an
impulse there: the mass matrix is singular, and velocities would be round-off over zero. In these
directions ``h² K/4`` of the step is added, as for accelerations at the start
(:func:`~fem_lie.solve.motion.consistent.accelerations`).

Stabilised index 2: velocities that satisfy the constraints, too. With index 3 the velocities of the
scheme satisfy ``B v = Φ_t`` to second order only. Gear, Gupta & Leimkuhler impose both, with one
more multiplier that moves the positions (C. Lunk & B. Simeon, Z. angew. Math. Mech. 86 (2006) 772,
for generalised-α). Here that multiplier changes the velocities at the end of each step to the
nearest ones that satisfy them, in the norm of the iteration matrix ``S``::

    S δv + Bᵀ μ = 0,    B (v + δv) = Φ_t

so that momenta are conserved (``S`` is mass on rigid motions, and ``Bᵀμ`` is an internal impulse)
and stiff vibrations are not excited. It costs one or two more solutions per step with the frozen
factors.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fem_lie._arrays import Array, Flags
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.linear.direct import DirectSolver
from fem_lie.solve.impacts.step_end import StepEnd
from fem_lie.system.equations import Equations, Plan, TimeState

_TINY = 1e-6
"""Fraction of a step within which stiffness has no effect."""

_MASSLESS = 1e-10
"""Moments of inertia below this fraction of the largest one of a node are zero."""

_SOFTNESS, _REFINED = 1e-9, 2
"""Relative compliance of joints, some of which may be redundant; and number of refinements of
solutions, which remove its effect."""

_DENSE = 150
"""Number of unknowns up to which a dense factorisation is faster."""


def massless(inertia: Inertia, held: Flags) -> sp.csr_matrix:
    """Projector on the free directions in which nodes have no inertia, shape (6 n, 6 n).

    Args:
        inertia: Inertia of the nodes.
        held: Which of their unknowns are zero, shape (n, 6).
    """
    free = (~held).astype(np.float64)
    blocks = np.zeros((len(held), 4, 4))
    rows, columns = inertia.pairs
    blocks[rows[rows == columns]] = inertia.blocks[rows == columns]
    E = blocks[:, 1:, 1:]
    trace = np.trace(E, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(3)
    turns = free[:, 3:, np.newaxis] * free[:, np.newaxis, 3:]
    # a fixed rotation must not count as one without inertia
    moments, axes = np.linalg.eigh(turns * (trace - E) + (1.0 - turns) * trace)
    light = moments <= _MASSLESS * moments[:, 2:]
    N = np.zeros((len(held), 6, 6))
    N[:, :3, :3] = (blocks[:, 0, 0] <= 0.0)[:, np.newaxis, np.newaxis] * np.eye(3)
    N[:, 3:, 3:] = np.einsum("nak,nk,nbk->nab", axes, light, axes)
    N *= free[:, :, np.newaxis] * free[:, np.newaxis]
    n = len(held)
    return sp.bsr_matrix((N, np.arange(n), np.arange(n + 1)), shape=(6 * n, 6 * n)).tocsr()


class Impulses:
    """Solutions of ``M x + Jᵀ λ = f, J x = g``, with a constant mass matrix.

    Attributes:
        mass: The matrix ``M``; ``h² K/4`` in directions without inertia, shape (6 n, 6 n).
    """

    def __init__(self, equations: Equations, step: float) -> None:
        """Assemble the mass matrix.

        Args:
            equations: Equations of the scene; their matrix is overwritten.
            step: Step size.
        """
        unknowns = equations.unknowns
        self._equations, self._n, self._m = equations, 6 * unknowns.moving, unknowns.m
        self._inertia, self._first = _at_rest(equations, _TINY * step), step
        self._elastic: sp.csr_matrix | None = None
        N = massless(equations.arrays.inertia, unknowns.held)
        if N.count_nonzero():
            self._elastic = N @ (_at_rest(equations, step) - self._inertia) @ N
        self.resize(step)

    def resize(self, step: float) -> None:
        """Change the step size."""
        mass = self._inertia
        if self._elastic is not None:
            mass = mass + (step / self._first) ** 2 * self._elastic
        self.mass = mass.tocsc()
        self._weights = 1.0 / self.mass.diagonal()
        self._free = splu(self.mass) if self._m == 0 else None

    def go_to(self, H: Array) -> None:
        """Factorise with the constraint Jacobian at frames ``H``."""
        if self._free is not None:
            return
        J = self._equations.constraints(H).jacobian
        self._scale = 1.0 / np.sqrt(np.maximum(J.multiply(J) @ self._weights, 1e-300))
        J = sp.diags(self._scale) @ J
        soft = -_SOFTNESS * sp.identity(self._m)
        self._matrix = sp.bmat([[self.mass, J.T], [J, soft]], format="csc")
        self._true = sp.bmat([[self.mass, J.T], [J, None]], format="csr")
        self._small = self._n + self._m <= _DENSE
        if self._small:
            self._factors = la.lu_factor(self._matrix.toarray())
        else:
            self._sparse = splu(self._matrix)

    def _solved(self, b: Array) -> Array:
        if self._small:
            return np.asarray(la.lu_solve(self._factors, b))
        return np.asarray(self._sparse.solve(b))

    def solve(self, f: Array, g: Array | None = None) -> tuple[Array, Array]:
        """Solutions ``x`` and ``λ``.

        Args:
            f: Impulses on the nodes, shape (6 n,) or (6 n, k).
            g: Constraint rates, shape (m,) or (m, k); default: zero.
        """
        if self._free is not None:
            return np.asarray(self._free.solve(f)), np.zeros((0, *f.shape[1:]))
        scale = self._scale.reshape(-1, *([1] * (f.ndim - 1)))
        rest = np.zeros((self._m, *f.shape[1:])) if g is None else scale * g
        b = np.concatenate([f, rest])
        x = self._solved(b)
        for _ in range(_REFINED):
            x = x + self._solved(b - self._true @ x)
        return x[: self._n], scale * x[self._n :]


def _at_rest(equations: Equations, step: float) -> sp.csr_matrix:
    """``M + h² K/4`` at the start, for a step of size ``h``, shape (6 n, 6 n)."""
    unknowns = equations.unknowns
    none = np.zeros((unknowns.moving, 6))
    still = TimeState(equations.start.frames, none, none, np.zeros(unknowns.m))
    equations.fill(still, None, Plan(none, at_rest=step))
    n = 6 * unknowns.moving
    return equations.matrix.whole[:n, :n]


_ITERATIONS = 20
_CONTRACTION = 1e-12  # of the violation, or the round-off of velocities


def project(
    equations: Equations,
    solver: DirectSolver,
    end: StepEnd,
    scale: Array,
    step: float,
    subtract: Callable[[Array], object],
) -> None:
    """Project the velocities at the end of a step onto the constraints.

    Args:
        equations: Equations of the scene, at the time of the end of the step.
        solver: Solver with the frozen factors.
        end: End of the converged step; its twists are changed.
        scale: Scale of the constraints in the matrix, shape (m,).
        step: Step of difference quotients of drives and prescribed motions.
        subtract: Subtracts a change in the nodes' axes, shape (6 n + m,), from the twists and from
            all other velocities of the scheme.
    """
    n, velocities = equations.unknowns.moving, np.zeros((len(end.frames), 6))
    drive: Array = np.zeros(1)
    if equations.unknowns.time_dependent:
        driven = equations.prescribed(end.time, step)
        velocities[n + 1 :], drive = driven.velocities, driven.target_rates[0]
    constraints = equations.constraints(end.frames)
    B = constraints.jacobian
    impulse = np.zeros(equations.unknowns.m)
    change, largest = np.zeros(equations.unknowns.size), np.inf
    for _ in range(_ITERATIONS):
        velocities[:n] = end.twists
        first = constraints.rates(velocities)[0] - drive
        violation = float(np.abs(first).max(initial=0.0))
        speed = float(np.abs(velocities).max(initial=0.0))
        # it decreases by the rotation since the factorisation each time, down to round-off
        if violation <= _CONTRACTION * max(speed, 1e-300) or violation > 0.9 * largest:
            return
        largest = violation
        solver.right_hand_side[: 6 * n] = solver.times(change)[: 6 * n]
        solver.right_hand_side[: 6 * n] += B.T @ (scale * impulse)
        solver.right_hand_side[6 * n :] = scale * first
        solver.solve()
        change[: 6 * n] -= solver.solution[: 6 * n]
        impulse -= solver.solution[6 * n :]
        subtract(solver.solution)

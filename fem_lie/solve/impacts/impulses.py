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
from functools import partial

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.lie.node_types import WITH_GRADIENTS, all_axes
from fem_lie.lie.node_types.inertia import Inertia, mass_blocks
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

_SAME, _REPEATED = 1e-11, 12
"""Relative change of the mass matrix, and of solutions, that is neglected; and largest number of
solutions with earlier factors."""

_STALE = 1e-4
"""Relative change of the mass matrix, and so error of momenta, at which factors are stale."""

_DENSE = 150
"""Number of unknowns up to which a dense factorisation is faster."""


def massless(inertia: Inertia, kinds: Indices, held: Flags) -> sp.csr_matrix:
    """Projector on the free directions in which nodes have no inertia, shape (6 n, 6 n).

    All gradients have inertia.

    Args:
        inertia: Inertia of the nodes.
        kinds: Their types, shape (n,).
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
    N[np.isin(kinds, WITH_GRADIENTS)] = 0.0
    n = len(held)
    return sp.bsr_matrix((N, np.arange(n), np.arange(n + 1)), shape=(6 * n, 6 * n)).tocsr()


def _in_fixed_axes(kinds: Indices, H: Array) -> Array:
    """Rotations of unknowns to axes in which ``M`` is constant, shape (n, 6, 6).

    These are global axes for nodes with gradients, whose own axes rotate with them.
    """
    T = np.tile(np.eye(6), (len(kinds), 1, 1))
    nodes = np.flatnonzero(np.isin(kinds, WITH_GRADIENTS))
    R = all_axes(kinds[nodes], H[nodes]).swapaxes(1, 2)
    T[nodes, :3, :3], T[nodes, 3:, 3:] = R, R
    return T


class Impulses:
    """Solutions of ``M x + Jᵀ λ = f, J x = g``.

    ``M`` is constant in fixed axes, but for frames that share cells and turn against each other:
    factors of that of the start then begin an iteration, or give way where it converges slowly.

    Attributes:
        mass: The matrix of the factors; ``h² K/4`` in directions without inertia, (6 n, 6 n).
        turning: Whether axes of nodes rotate relative to those in which it is constant.
    """

    def __init__(self, equations: Equations, step: float) -> None:
        """Assemble the mass matrix.

        Args:
            equations: Equations of the scene; their matrix is overwritten.
            step: Step size.
        """
        unknowns, start = equations.unknowns, equations.start.frames
        self._equations, self._n, self._m = equations, 6 * unknowns.moving, unknowns.m
        self._kinds = unknowns.kinds
        self.turning = bool(np.isin(self._kinds, WITH_GRADIENTS).any())
        self._to_fixed = _in_fixed_axes(self._kinds, start)
        self._inertia, self._first = self._fixed(_at_rest(equations, _TINY * step)), step
        self._coupled = len(equations.arrays.inertia[1]) > unknowns.moving
        self._change: sp.csr_matrix | None = None
        if self._coupled:
            self._assembled, self._at = self._consistent(start), start.copy()
            self._last: tuple[sp.csr_matrix | None, float] = None, 0.0
        self._elastic: sp.csr_matrix | None = None
        N = massless(equations.arrays.inertia, unknowns.kinds, unknowns.held)
        if N.count_nonzero():
            self._elastic = N @ (self._fixed(_at_rest(equations, step)) - self._inertia) @ N
        self.resize(step)

    def _fixed(self, M: sp.csr_matrix) -> sp.csr_matrix:
        """A matrix (6 n, 6 n) in fixed axes."""
        if not self.turning:
            return M
        n = len(self._kinds)
        T = sp.bsr_matrix((self._to_fixed, np.arange(n), np.arange(n + 1)), shape=M.shape)
        return (T @ M @ T.T).tocsr()

    def _consistent(self, H: Array) -> sp.csr_matrix:
        """Mass matrix of the free unknowns at frames ``H``, in fixed axes."""
        unknowns, inertia = self._equations.unknowns, self._equations.arrays.inertia
        indptr, indices, _ = inertia
        blocks = mass_blocks(self._kinds, H, inertia)
        M = sp.bsr_matrix((blocks, indices, indptr), shape=(self._n, self._n)).tocsr()
        free = sp.diags((~unknowns.held.ravel()).astype(np.float64))
        return self._fixed(free @ M @ free)

    def _changed(self, H: Array) -> tuple[sp.csr_matrix | None, float]:
        """Change of the mass matrix since the start, if there is any, and its relative size."""
        if not np.array_equal(H, self._at):
            change = self._consistent(H) - self._assembled
            size = float(abs(change).max() / abs(self._assembled).max())
            self._at, self._last = H.copy(), (change if size > _SAME else None, size)
        return self._last

    def _jacobian(self, H: Array) -> sp.csr_matrix:
        """Constraint Jacobian at ``H`` in fixed axes, with the same pattern for all ``H``."""
        J = self._equations.constraints(H).jacobian
        if not self.turning or not self._m:
            return J
        blocks = J.tobsr(blocksize=(1, 6))
        values = np.einsum("bij,bkj->bki", self._to_fixed[blocks.indices], blocks.data)
        columns = 6 * blocks.indices[:, np.newaxis] + np.arange(6)
        return sp.csr_matrix((values.ravel(), columns.ravel(), 6 * blocks.indptr), shape=J.shape)

    def resize(self, step: float) -> None:
        """Change the step size."""
        self._step, self._replaced = step, False
        self._set_up(self._inertia)
        self._factorise(self._jacobian(self._equations.start.frames).data)

    def _set_up(self, inertia: sp.csr_matrix) -> None:
        mass = inertia
        if self._elastic is not None:
            mass = mass + (self._step / self._first) ** 2 * self._elastic
        self.mass = mass.tocsc()
        J = self._jacobian(self._equations.start.frames)
        self._columns, self._of = J.indices, np.repeat(np.arange(self._m), np.diff(J.indptr))
        self._weights = 1.0 / self.mass.diagonal()[self._columns]
        self._matrix = SaddlePoint(self.mass, J)

    def stale(self, H: Array) -> bool:
        """Whether axes of nodes have turned noticeably since the start.

        A frozen iteration matrix then has a mass that does not conserve momentum.
        """
        if self.turning or not self._coupled:
            return self.turning
        change, turned = self._changed(H)
        return change is not None and turned > _STALE

    def go_to(self, H: Array) -> None:
        """Factorise with the constraint Jacobian at frames ``H``, unless it is the present one."""
        if self.turning:
            self._to_fixed = _in_fixed_axes(self._kinds, H)
        if self._coupled:
            self._change = self._changed(H)[0]
            if self._replaced:  # so that a resumed run has the same factors
                self._replaced = False
                self._set_up(self._inertia)
                self._factorise(self._entries)
        if not self._m:
            return
        entries = self._jacobian(H).data
        if not np.array_equal(entries, self._entries):
            self._factorise(entries)

    def _factorise(self, entries: Array) -> None:
        """Factorise with these entries of the constraint Jacobian."""
        sizes = np.bincount(self._of, entries**2 * self._weights, minlength=self._m)
        self._scale = 1.0 / np.sqrt(np.maximum(sizes, 1e-300))
        self._matrix.factorise(self._scale[self._of] * entries)
        self._entries = entries

    def solve(self, f: Array, g: Array | None = None) -> tuple[Array, Array]:
        """Solutions ``x`` and ``λ``, in the axes of the nodes at the last :meth:`go_to`.

        Args:
            f: Impulses on the nodes, shape (6 n,) or (6 n, k).
            g: Constraint rates, shape (m,) or (m, k); default: zero.
        """
        right = self._turned("nij,njk->nik", f)
        found = self._solved(right, g)
        if found is None:
            self._replace_factors()
            found = self._solved(right, g)
        assert found is not None
        return self._turned("nji,njk->nik", found[0]), found[1]

    def _solved(self, f: Array, g: Array | None) -> tuple[Array, Array] | None:
        """Solutions in fixed axes; ``None`` if the factors are too old."""
        scale = self._scale.reshape(-1, *([1] * (f.ndim - 1)))
        rest = np.zeros((self._m, *f.shape[1:])) if g is None else scale * g
        x, multipliers = self._matrix.solve(f, rest)
        if self._change is not None:
            size = _SAME * np.abs(x).max()
            for _ in range(_REPEATED):
                before = x
                x, multipliers = self._matrix.solve(f - self._change @ before, rest)
                if np.abs(x - before).max() <= size:
                    break
            else:
                return None
        return x, scale * multipliers

    def _replace_factors(self) -> None:
        """Factorise the present mass matrix, until the next :meth:`go_to`."""
        assert self._change is not None
        self._set_up(self._inertia + self._change)
        self._replaced, self._change = True, None
        self._factorise(self._entries)

    def _turned(self, product: str, f: Array) -> Array:
        """Unknowns or forces (6 n,) or (6 n, k) in other axes."""
        if not self.turning:
            return f
        by_node = f.reshape(len(self._kinds), 6, -1)
        return np.einsum(product, self._to_fixed, by_node).reshape(f.shape)


class SaddlePoint:
    """``[[M, Jᵀ], [J, 0]]`` with a constant ``M``, whose pattern is found once.

    Nodes that neither constraints nor ``M`` couple to others are solved for by the inverses of
    their blocks. Redundant constraints make the rest singular: the factors are those with a small
    compliance, whose effect refinements of the solutions remove.
    """

    def __init__(self, mass: sp.csc_matrix, jacobian: sp.csr_matrix) -> None:
        """Find the pattern.

        Args:
            mass: ``M``, shape (6 n, 6 n).
            jacobian: A matrix with the pattern of ``J``, shape (m, 6 n).
        """
        m, size = jacobian.shape
        blocks = mass.tobsr(blocksize=(6, 6))
        used = np.diff(blocks.indptr) + np.bincount(blocks.indices, minlength=size // 6)
        coupled = (used > 2) | (np.bincount(jacobian.indices // 6, minlength=size // 6) > 0)
        self._free, kept = np.flatnonzero(~coupled), np.flatnonzero(np.repeat(coupled, 6))
        self._inverses = np.linalg.inv(blocks.data[blocks.indptr[self._free]])
        self._kept, self._n = kept, len(kept)
        mass, jacobian = mass[kept][:, kept], jacobian[:, kept]
        parts = mass, jacobian, sp.identity(m, format="csr")
        ends = np.cumsum([0, *(each.nnz for each in parts)])
        # the entry of a part that each entry of the matrix is, counted from 1
        M, J, C = (
            type(each)((np.arange(a, b) + 1.0, each.indices, each.indptr), shape=each.shape)
            for each, a, b in zip(parts, ends, ends[1:], strict=False)
        )
        self._matrix = sp.bmat([[M, J.T], [J, C]], format="csc")
        self._order = self._matrix.data.astype(np.int64) - 1
        self._values = np.concatenate([mass.data, jacobian.data, np.full(m, -_SOFTNESS)])
        self._own = slice(ends[1], ends[2])
        self._refined = _REFINED if m else 0
        self._dense = 0 < m <= _DENSE - self._n
        if self._dense:
            columns = np.repeat(np.arange(self._n + m), np.diff(self._matrix.indptr))
            self._where, self._matrix = (self._matrix.indices, columns), self._matrix.toarray()

    def factorise(self, entries: Array) -> None:
        """Factorise with these entries of ``J``."""
        self._values[self._own] = entries
        if self._dense:
            self._matrix[self._where] = self._values[self._order]
            factors = la.lu_factor(self._matrix, check_finite=False)
            self._solved = partial(la.lu_solve, factors, check_finite=False)
        else:
            self._matrix.data[:] = self._values[self._order]
            self._solved = splu(self._matrix).solve

    def solve(self, f: Array, g: Array) -> tuple[Array, Array]:
        """Solutions of right-hand sides (6 n,) or (6 n, k), and (m,) or (m, k)."""
        found = np.empty(f.shape)  # rows follow each other, whatever the order of f
        by_node, of_node = (each.reshape(len(f) // 6, 6, -1) for each in (found, f))
        by_node[self._free] = self._inverses @ of_node[self._free]
        if not self._n:
            return found, g
        b = np.concatenate([f[self._kept], g])
        x = np.asarray(self._solved(b))
        for _ in range(self._refined):
            left = b - self._matrix @ x
            left[self._n :] -= _SOFTNESS * x[self._n :]
            x = x + self._solved(left)
        found[self._kept] = x[: self._n]
        return found, x[self._n :]


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
) -> Array:
    """Project the velocities at the end of a step onto the constraints.

    Args:
        equations: Equations of the scene, at the time of the end of the step.
        solver: Solver with the frozen factors.
        end: End of the converged step; its twists are changed.
        scale: Scale of the constraints in the matrix, shape (m,).
        step: Step of difference quotients of drives and prescribed motions.
        subtract: Subtracts a change in the nodes' axes, shape (6 n + m,), from the twists and from
            all other velocities of the scheme.

    Returns:
        Multipliers ``μ`` without the scale, shape (m,).
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
            break
        largest = violation
        solver.right_hand_side[: 6 * n] = solver.times(change)[: 6 * n]
        solver.right_hand_side[: 6 * n] += B.T @ (scale * impulse)
        solver.right_hand_side[6 * n :] = scale * first
        solver.solve()
        change[: 6 * n] -= solver.solution[: 6 * n]
        impulse -= solver.solution[6 * n :]
        subtract(solver.solution)
    return scale * impulse

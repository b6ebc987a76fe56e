"""Whether an equilibrium is stable: free rigid motions, negative pivots, and the warning.

Rigid motions of bodies that nothing resists, which factors of round-off do not show.

Nodes without rotations store a rigid rotation with round-off, and so do the stiffness matrix and
its pivots: what is singular is factorised all the same, and moves by round-off over round-off. The
rigid motions ``z`` of all pieces that constraints allow are known, though, and ``zᵀ K z`` says
whether stress, loads, springs or contacts resist.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.linear.direct import ConvergenceError, DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.pivots import inertia, negative_determinant
from fem_lie.linear.spectra.pencil import RigidParts

if TYPE_CHECKING:
    from fem_lie.results.equilibrium import StaticResult
    from fem_lie.system.equations import Equations

_SOFT = 1e-6  # give of constraints, over that of the stiffest spring

UNKNOWN = -1
"""Number of negative pivots of a matrix that cannot be factorised."""


def negative_pivots(equations: Equations, solver: DirectSolver) -> int:
    """Negative eigenvalues of the tangent that was factorised last, of what constraints leave free.

    For loads without potential: 1 if their number is odd, 0 if it is even. It is −1 if the matrix
    cannot be factorised.
    """
    unknowns = equations.unknowns
    m, n, redundant = unknowns.m, 6 * unknowns.moving, unknowns.m > 0 and unknowns.may_be_redundant
    try:
        found = None if redundant else solver.negative_pivots()
        if found is None or not unknowns.has_potential:
            A = tangent(equations)
            if redundant:
                A = _softened(A, n)
            if not unknowns.has_potential:
                return int(negative_determinant(A) != bool(m % 2))
            found = inertia((0.5 * (A + A.T)).tocsr())[0]
    except SingularMatrixError:
        return UNKNOWN
    return max(0, found - m)


def tangent(equations: Equations) -> sp.csr_matrix:
    """The matrix as it is now, in rows and columns of one dimension."""
    units = sp.diags(equations.matrix.units)
    return (units @ tangent_csr(equations) @ units).tocsr()


def tangent_csr(equations: Equations) -> sp.csr_matrix:
    """A copy of the matrix as it is now, in the unknowns' own units."""
    return equations.matrix.whole


def _softened(A: sp.csr_matrix, n: int) -> sp.csr_matrix:
    """With constraints after row ``n`` that give way a little, so that redundant ones count, too.

    The rows have the inertia of springs beside ``K``: as many negative pivots as rows.
    """
    stiffest = float(abs(A[:n, :n]).max()) or 1.0
    rows = A[n:, :n]
    give = _SOFT / stiffest * rows.multiply(rows).sum(axis=1).A1
    return sp.bmat([[A[:n, :n], A[:n, n:]], [rows, -sp.diags(give)]], format="csr")


class UnstableEquilibriumWarning(UserWarning):
    """An equilibrium is unstable, or was reached past a limit load: the structure snaps before."""


def warn_if_unstable(result: StaticResult) -> None:
    """One warning for all states of a result.

    In a frame that turns, where an equilibrium with negative pivots may be stable all the same, and
    of states that could not be tested, nothing is said.
    """
    if result.steady_rotation:
        return
    unstable = result.negative_pivots > 0
    sentences = []
    if unstable.any():
        factors = ", ".join(f"{factor:g}" for factor in result.factors[unstable][:4])
        more = ", …" if unstable.sum() > 4 else ""
        sentences.append(
            f"the equilibrium is unstable at load factor {factors}{more} (negative pivots "
            f"{', '.join(map(str, result.negative_pivots[unstable][:4]))}{more})"
        )
    if result.load_maxima:
        factors = ", ".join(f"{factor:.3g}" for factor in result.load_maxima)
        sentences.append(
            f"the load had a maximum near {factors} on the way, where the structure snaps"
        )
    if sentences:
        text = "; ".join(sentences)
        warnings.warn(
            f"{text}. fl.follow_path shows the whole path and its critical points",
            UnstableEquilibriumWarning,
            stacklevel=3,
        )


def maxima(factors: list[float]) -> tuple[float, ...]:
    """Load factors from which those of successive states go down."""
    rise = np.diff([0.0, *factors]) > 0
    return tuple(factors[k] for k in np.flatnonzero(rise[:-1] & ~rise[1:]))


_ULPS = 1e-14  # of the sum without signs: less is round-off
POLISHED = 3
"""Iterations more than an equilibrium needs, before what resists is asked."""

_RESIDUAL = 10.0  # times the work of forces that are not in balance: less is the iteration's


class SingularStartError(ConvergenceError):
    """A step began with a singular matrix, or a motion is free: no other way of loading helps."""


class FreeMotions:
    """Looks for rigid motions that nothing resists, in scenes with nodes that are no frames."""

    def __init__(self, equations: Equations) -> None:
        """Of equations."""
        self._equations, unknowns = equations, equations.unknowns
        self.possible: bool = bool((unknowns.kinds >= POSITION_GRADIENT).any())
        self._weight = unknowns.units
        self._free = np.flatnonzero(~unknowns.held.ravel())

    def allowed(self, H: Array) -> Array:
        """Basis (z, free unknowns) of rigid motions that constraints allow at frames ``H``."""
        constraints = self._equations.constraints(H)
        pieces = constraints.rigid_motions(self._weight)
        none = sp.csr_matrix((len(self._free),) * 2)
        parts = RigidParts(none, none, none, [(p.unknowns, p.basis) for p in pieces])
        B = (constraints.jacobian @ sp.diags(self._weight)).tocsr()[:, self._free]
        return parts.mechanisms(B)

    def unresisted(self, Z: Array, r: Array) -> Array:
        """Those of the motions ``Z`` that the tangent, as it was filled last, does not resist.

        Args:
            Z: See :meth:`allowed`.
            r: Residual of the same state.
        """
        free, weight = self._free, self._weight[self._free]
        W = sp.diags(weight)
        K = (W @ tangent_csr(self._equations)[free][:, free] @ W).tocsr()
        product = Z @ (K @ Z.T)
        stiffness, vectors = np.linalg.eigh(0.5 * (product + product.T))
        motions = vectors.T @ Z
        sizes = np.abs(motions)
        small = _ULPS * (sizes * (abs(K) @ sizes.T).T).sum(axis=1)
        small += _RESIDUAL * sizes @ np.abs(weight * r[free])
        return np.asarray(motions[np.abs(stiffness) <= small])

    def message(self, motions: Array, factor: float) -> str:
        """What to say of motions that are free at a load factor."""
        unknowns, count = self._equations.unknowns, len(motions)
        moves = np.zeros(6 * unknowns.moving)
        moves[self._free] = np.abs(motions).max(axis=0)
        nodes = unknowns.masters[moves.reshape(-1, 6).max(axis=1) > 1e-6 * moves.max()]
        bodies = unknowns.bodies.items()
        names = ", ".join(body.label for body, own in bodies if np.isin(own, nodes).any())
        return (
            f"the equilibrium at load factor {factor:g} is one of many: {count} rigid "
            f"motion{'s' * (count > 1)} of {names} left free. Is every body held by clamps or "
            "joints, with no motion left free?"
        )

"""Rigid motions of bodies that nothing resists, which factors of round-off do not show.

Nodes without rotations store a rigid rotation with round-off, and so do the stiffness matrix and
its pivots: what is singular is factorised all the same, and moves by round-off over round-off. The
rigid motions ``z`` of all pieces that constraints allow are known, though, and ``zᵀ K z`` says
whether stress, loads, springs or contacts resist.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.lie.kinds import SLOPE
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.rigid_parts import RigidParts
from fem_lie.solve.statics.pivots import tangent_csr

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations

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
        self.possible: bool = bool((unknowns.kinds >= SLOPE).any())
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
        nodes = unknowns.leaders[moves.reshape(-1, 6).max(axis=1) > 1e-6 * moves.max()]
        bodies = unknowns.bodies.items()
        names = ", ".join(body.label for body, own in bodies if np.isin(own, nodes).any())
        return (
            f"the equilibrium at load factor {factor:g} is one of many: {count} rigid "
            f"motion{'s' * (count > 1)} of {names} left free. Is every body held by clamps or "
            "joints, with no motion left free?"
        )

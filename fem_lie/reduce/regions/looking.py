r"""What regions with one frame each would miss of the next moments of a motion.

Within a time ``τ`` from twists ``v`` and forces ``r`` nodes move by ``d``, with matrices of small
motions beside the state, as if accelerations were constant::

    A d = b,     A = 2 M / τ² + C / τ + K,     b = −r + (2 M / τ + C) v

and with frames merged, so that twists are ``E w``, by ``E d_E`` with ``Eᵀ A E d_E = Eᵀ b``. What
is missed is the difference: large where a wave comes, or where forces find no balance.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adapt.following.momenta import mass_matrix
from fem_lie.system.equations import Equations, Instant
from fem_lie.system.small_motions.steady import linearised

_ROUNDS = 20


class Looking:
    """A state of a scene without merged frames.

    Attributes:
        H: Frames of all rows.
        v: Twists of the nodes that lead, shape (n, 6).
        mass: Matrix of these twists, (6 n, 6 n).
        kinetic: Energy.
    """

    def __init__(
        self, equations: Equations, frames: Array, twists: Array, times: Array, ahead: float
    ) -> None:
        """Find what moves, and how far.

        Args:
            equations: Of the scene.
            frames: Of all nodes, shape (N, 4, 3).
            twists: Likewise, shape (N, 6).
            times: At which loads are asked for, the present one first.
            ahead: τ.
        """
        unknowns, system = equations.unknowns, equations.system
        self._held: Flags = np.asarray(unknowns.held.any(axis=1))
        self.H = equations.start.frames.copy()
        self.H[: unknowns.moving] = frames[unknowns.leaders]
        self.v = np.ascontiguousarray(twists[unknowns.leaders])
        equations.prescribed(times[0]).act()
        system.terms.reset_stress(self.H)
        r = np.empty(unknowns.size)
        state = Instant(self.H, self.v, np.zeros_like(self.v), np.zeros(0))
        equations.residual(state, np.zeros(0), r)
        M, C, K = (self._matrix(equations, b) for b in linearised(system, *state[:2], state[3]))
        self._free = ~unknowns.held.ravel()
        v = self.v.ravel()
        self._A = (2.0 / ahead**2 * M + C / ahead + K).tocsr()
        steady = np.where(self._free, -r + 2.0 / ahead * (M @ v) + C @ v, 0.0)
        loads = [equations.prescribed(each).loads(self.H) for each in times]
        self._b = steady[:, np.newaxis] + (np.array(loads) - loads[0]).T
        some = self._A[self._free][:, self._free].tocsc()
        self._d = np.zeros_like(self._b)
        self._d[self._free] = splu(some).solve(self._b[self._free])
        self.mass: sp.csr_matrix = mass_matrix(equations, self.H)
        self.kinetic = float(0.5 * v @ (self.mass @ v))
        matrix = equations.matrix
        count = unknowns.moving
        ones = np.ones(len(matrix.indices))
        self._graph = sp.csr_matrix((ones, matrix.indices, matrix.indptr), shape=(count, count))

    @staticmethod
    def _matrix(equations: Equations, blocks: Array) -> sp.csr_matrix:
        size = 6 * equations.unknowns.moving
        kkt = equations.matrix
        return sp.bsr_matrix((blocks, kkt.indices, kkt.indptr), shape=(size, size)).tocsr()

    def merged(self, active: Flags) -> Indices:
        """The node whose frame each follows, itself if it is active, shape (n,).

        What hangs together of the others is a region; one node alone is none, and what is held
        follows nobody.
        """
        root = np.arange(len(active))
        quiet = np.flatnonzero(~active & ~self._held)
        count, region = connected_components(self._graph[quiet][:, quiet], directed=False)
        first = np.full(count, len(active))
        np.minimum.at(first, region, quiet)
        root[quiet] = first[region]
        return root

    def beside(self, nodes: Flags) -> Flags:
        """These nodes and those that share a cell with them, (n,)."""
        return np.asarray(self._graph @ nodes > 0.0)

    def spread(self, root: Indices) -> sp.csr_matrix:
        """``E``: twists of all nodes from those of the nodes that others follow, (6 n, 6 l)."""
        leads, number = np.unique(root, return_inverse=True)
        offset = lie.se3_compose(lie.se3_inverse(self.H[root]), self.H[: len(root)])
        blocks = lie.se3_adjoint(lie.se3_inverse(offset))
        shape = (6 * len(root), 6 * len(leads))
        return sp.bsr_matrix((blocks, number, np.arange(len(root) + 1)), shape=shape).tocsr()

    def missed(self, root: Indices) -> Array:
        """How far each node goes elsewhere within τ under the worst of the loads, shape (n,)."""
        if (root == np.arange(len(root))).all():
            return np.zeros(len(root))
        E = self.spread(root)
        free = np.asarray(abs(E[self._free]).sum(axis=0)).ravel() > 0.0
        E = E[:, free]
        own = splu((E.T @ self._A @ E).tocsc()).solve(E.T @ self._b)
        away = (self._d - E @ own).reshape(-1, 6, self._d.shape[1])
        return np.asarray(np.linalg.norm(away[:, :3], axis=1).max(axis=1))

    def active(self, tolerance: float) -> Flags:
        """Nodes that need frames of their own, so that no other one goes elsewhere by more."""
        found: Flags = self._held.copy()
        for _ in range(_ROUNDS):
            away = self.missed(self.merged(found))
            more = ~found & (away > tolerance)
            if not more.any():
                break
            found[more] = True
        return found

    def projected(self, root: Indices) -> tuple[Array, float]:
        """Twists with merged frames that are nearest by mass, and the kinetic energy lost.

        Both momenta stay as they are, for rigid motions are among those of merged frames.
        """
        E, v = self.spread(root), self.v.ravel()
        own = splu((E.T @ self.mass @ E).tocsc()).solve(E.T @ (self.mass @ v))
        kept = E @ own
        lost = v - kept
        return kept.reshape(-1, 6), float(0.5 * lost @ (self.mass @ lost))

"""Stiffness of motions in which elements hardly strain, without the round-off of those that do.

Elements do not feel rigid motion: ``K_e R = 0`` for the twists ``R`` that move all nodes of a
connected piece together, whatever its stress, since forces in local frames are invariant. Nodes
store such a motion with round-off, of which the elements make far more than a soft spring has. So
``φ = R y + ψ`` is split first, and with ``K_s`` what is not of elements::

    φᵀ K φ' = φᵀ K_s φ' + ψᵀ K_e ψ' + (R y)ᵀ P ψ'

The last is of stress alone: the internal forces ``f`` of a piece have no resultant in any state,
``Rᵀ f = 0``, so that ``(R y)ᵀ K_e ψ = −(δR y)ᵀ f``, with ``δR = −ad(ψ) R``.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie import lie
from fem_lie._jit import Array, Indices
from fem_lie.system import System

_KNOWN = 1e-7  # part of its size to which an eigenvector is known
_ULPS = 1e-14
_MOST = 1200  # rigid motions of all pieces, of which those that joints allow are looked for
_FREE = 1e-9  # rigid motions of a piece of size one that move what is held by less


class RigidParts:
    """Splits vectors of free unknowns.

    Attributes:
        rest: Stiffness without elements, shape (n, n); likewise ``elements`` and ``stress``, ``P``.
    """

    def __init__(
        self,
        rest: sp.csr_matrix,
        elements: sp.csr_matrix,
        stress: sp.csr_matrix,
        motions: list[tuple[Indices, Array]],
    ) -> None:
        """Keep the matrices.

        Args:
            rest: See above.
            elements: See above.
            stress: See above.
            motions: Of each piece its unknowns, shape (k,), and an orthonormal basis of its rigid
                motions that what is held allows, shape (k, ≤ 6).
        """
        self.rest, self.elements, self.stress = rest, elements, stress
        self._motions = motions

    def mechanisms(self, B: sp.csr_matrix) -> Array:
        """Basis (z, n) of motions without strain of elements that the constraints ``B`` allow."""
        n, columns = B.shape[1], [basis.shape[1] for _, basis in self._motions]
        if sum(columns) > _MOST:
            return np.empty((0, n))
        R = np.zeros((n, sum(columns)))
        for (unknowns, basis), last in zip(self._motions, np.cumsum(columns), strict=True):
            R[unknowns, last - basis.shape[1] : last] = basis
        size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        allowed = (sp.diags(1.0 / np.where(size > 0.0, size, 1.0)) @ B) @ R
        return np.asarray(
            (R @ scipy.linalg.null_space(allowed, rcond=_FREE)).T if len(size) else R.T
        )

    def strained(self, vectors: Array) -> Array:
        """``ψ`` of each row."""
        out = vectors.copy()
        for unknowns, basis in self._motions:
            part = out[:, unknowns]
            # once more: what the first leaves is round-off of all of it
            for _ in range(2):
                part = part - (part @ basis) @ basis.T
            out[:, unknowns] = part
        return out

    def stiffness(self, vectors: Array) -> Array:
        """``Φ K Φᵀ`` of rows, shape (k, k)."""
        strained = self.strained(vectors)
        product = vectors @ (self.rest @ vectors.T) + strained @ (self.elements @ strained.T)
        product += (vectors - strained) @ (self.stress @ strained.T)
        return np.asarray(product)

    def round_off(self, vectors: Array) -> Array:
        """What of ``φᵀ K φ`` of each row can be round-off.

        Strains below those of a vector that is known to a part of its size are all round-off.
        """
        strained = self.strained(vectors)
        size, small = np.abs(vectors), np.abs(strained)
        cancels = (size * (abs(self.rest) @ size.T).T).sum(axis=1)
        cancels += (size * (abs(self.stress) @ small.T).T).sum(axis=1)
        strains = (small * (abs(self.elements) @ small.T).T).sum(axis=1)
        rigid = np.linalg.norm(strained, axis=1) <= _KNOWN * np.linalg.norm(vectors, axis=1)
        return np.asarray(_ULPS * cancels + np.where(rigid, strains, _ULPS * strains))


def rigid_motions(system: System, H: Array, weight: Array) -> list[tuple[Indices, Array]]:
    """See :class:`RigidParts`; unknowns are free ones, and twists those times ``weight``."""
    count = system.count
    pairs = system.elastic.pairs
    rows, columns = (np.concatenate([p[k] for p in pairs]) for k in (0, 1))
    graph = sp.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count))
    pieces, label = connected_components(graph, directed=False)
    number = np.cumsum(~system.held.ravel()) - 1
    held = system.held.copy()
    # shells of five parameters do not feel what is held of them
    drills = held & system.numbering.held & system.uncoupled[:, np.newaxis]
    drills[:, :5] = False
    found = []
    for piece in range(pieces):
        nodes = np.flatnonzero(label == piece)
        frames = H[nodes].copy()
        frames[:, 0] -= frames[:, 0].mean(axis=0)
        R = lie.se3_adjoint(lie.se3_inverse(frames)) * np.repeat([system.length, 1.0], 3)
        for k in range(6):
            every = np.zeros((count, 6))
            every[nodes] = R[:, :, k]
            system.supports.turn(H, every)
            R[:, :, k] = every[nodes]
        R = R.reshape(-1, 6) / weight.reshape(-1, 6)[nodes].reshape(-1, 1)
        stuck = (held & ~drills)[nodes].ravel()
        allowed = scipy.linalg.null_space(R[stuck], rcond=_FREE) if stuck.any() else np.eye(6)
        free = ~held[nodes].ravel()
        unknowns = (6 * nodes[:, np.newaxis] + np.arange(6)).ravel()[free]
        if allowed.shape[1]:
            found.append((number[unknowns], np.linalg.qr(R[free] @ allowed)[0]))
    return found


def stress_terms(forces: Array) -> Array:
    """Blocks of ``P``, shape (n, 6, 6), for internal forces (n, 6): ``P ψ = ad(ψ)ᵀ f``."""
    ad = lie.se3_ad(np.eye(6))
    return np.asarray(np.einsum("kji,nj->nik", ad, forces))

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

from typing import TypeVar

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse as sp

from fem_lie._arrays import Array, Indices
from fem_lie.linear.spectra.extended import Extended, product

Real = TypeVar("Real", np.float64, np.longdouble)

_KNOWN = 1e-7  # part of its size to which an eigenvector is known
_ULPS = 1e-14
_VANISHES = 1e-2  # of the largest stiffness, to a last bit
_MOST = 1200  # rigid motions of all pieces, of which those that joints allow are looked for
FREE = 1e-9  # rigid motions of a piece of size one that move what is held by less


def kernel(A: Array) -> Array:
    """Orthonormal basis (z, k) of what a matrix (m, z) of one dimension takes to zero.

    Of a tall one the triangle has it: the SVD of all of it would have m² numbers.
    """
    if not A.size:
        return np.eye(A.shape[1])
    return np.asarray(scipy.linalg.null_space(np.linalg.qr(A, mode="r"), rcond=FREE))


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
        return np.asarray((R @ kernel(allowed)).T)

    def strained(self, vectors: npt.NDArray[Real]) -> npt.NDArray[Real]:
        """``ψ`` of each row."""
        out = vectors.copy()
        for unknowns, basis in self._motions:
            part = out[:, unknowns]
            # once more: what the first leaves is round-off of all of it
            for _ in range(2):
                part = part - (part @ basis) @ basis.T
            out[:, unknowns] = part
        return out

    def product(self, vectors: Array) -> Extended:
        """``K φ`` of rows, shape (k, n), in extended precision."""
        strained = self.strained(vectors)
        elastic, stressed = product(self.elements, strained), product(self.stress, strained)
        resultant = stressed - self.strained(stressed)
        return product(self.rest, vectors) + self.strained(elastic) + resultant

    def product_with_pressure(self, vectors: Array) -> Extended:
        """The same where forces of elements have a resultant, as those of pressure do."""
        return product(self.rest, vectors) + product(self.elements, self.strained(vectors))

    def round_off(self, vectors: Array) -> Array:
        """What of ``φᵀ K φ`` of each row can be round-off.

        Strains below those of a vector that is known to a part of its size are all round-off.
        """
        strained = self.strained(vectors)
        size, small = np.abs(vectors), np.abs(strained)
        cancels = (size * (abs(self.rest) @ size.T).T).sum(axis=1)
        cancels += (size * (abs(self.stress) @ small.T).T).sum(axis=1)
        # forces that vanish, such as those of springs at rest, are round-off of stiffness
        cancels += _VANISHES * abs(self.rest).max() * (size * size).sum(axis=1)
        strains = (small * (abs(self.elements) @ small.T).T).sum(axis=1)
        rigid = np.linalg.norm(strained, axis=1) <= _KNOWN * np.linalg.norm(vectors, axis=1)
        return np.asarray(_ULPS * cancels + np.where(rigid, strains, _ULPS * strains))

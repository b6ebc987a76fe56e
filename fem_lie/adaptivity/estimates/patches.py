"""Polynomials fitted to the best stress of the elements around each element.

The stress of an element is more accurate by one order at some of its points (J. Barlow, IJNME 10
(1976) 243). To its values there, in an element and in those that share a node with it, a polynomial
is fitted by least squares, the nearer the closer: else errors seem much too large where stress
changes within few elements (O. C. Zienkiewicz & J. Z. Zhu, IJNME 33 (1992) 1331). How much nearer
was chosen by one problem of thin shells, see docs/measured/adaptivity.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.sparse import csr_matrix, diags

from fem_lie._arrays import Array, Indices

_NEAR = 4.0
"""Weights decrease with the distance d, in sizes of elements, as ``(1 + 4 d²)⁻⁴``."""
_DETERMINED = 1e-10
"""Relative eigenvalue of the normal equations that counts as zero."""


def shared_nodes(nodes: Indices, sections: Array) -> Indices:
    """Numbers of nodes of elements (m, k), others for each of the unequal sections (m, any)."""
    _, section = np.unique(sections.reshape(len(nodes), -1), axis=0, return_inverse=True)
    both = nodes + (int(nodes.max()) + 1) * section.reshape(-1, 1)
    _, found = np.unique(both, return_inverse=True)
    return np.asarray(found.reshape(nodes.shape), dtype=np.int64)


class Pairs:
    """Pairs of a patch and an element of it.

    Attributes:
        first: Index of the first pair of each patch, shape (a,).
        patches: The patch of each pair, ascending, shape (p,).
        elements: The element of each pair, shape (p,).
    """

    def __init__(self, inside: csr_matrix, neighbours: csr_matrix, least: int) -> None:
        """Find the pairs.

        Args:
            inside: Elements of each patch, shape (a, m).
            neighbours: Elements around each element, itself included, shape (m, m).
            least: Least number of elements of a patch; if there are fewer, those around them are
                added.
        """
        few = (np.diff(inside.indptr) < least).astype(np.float64)
        found = (inside + diags(few) @ inside @ neighbours).tocsr() if few.any() else inside
        self.first = found.indptr[:-1].astype(np.int64)
        self.patches: Indices = np.repeat(np.arange(inside.shape[0]), np.diff(found.indptr))
        self.elements: Indices = found.indices.astype(np.int64)

    @classmethod
    def around_elements(cls, nodes: Indices, least: int) -> Pairs:
        """Patches of the elements that share a node with each, by their numbered nodes (m, k)."""
        has = _incidence(nodes)
        return cls((has @ has.T).tocsr(), (has @ has.T).tocsr(), least)

    @classmethod
    def around_nodes(cls, nodes: Indices, least: int) -> Pairs:
        """Patches of the elements at each node."""
        has = _incidence(nodes)
        return cls(has.T.tocsr(), (has @ has.T).tocsr(), least)


def _incidence(nodes: Indices) -> csr_matrix:
    m, k = nodes.shape
    row = np.repeat(np.arange(m), k)
    return csr_matrix((np.ones(m * k), (row, nodes.ravel())), (m, int(nodes.max()) + 1))


@dataclass(frozen=True, eq=False)
class Patches:
    """Least-squares fits, which do not depend on the state.

    Attributes:
        pairs: Pairs of patches and elements.
        weighted: Weighted monomials at the samples of each pair, shape (p, t, g).
        inverse: Inverse of the normal equations, shape (a, t, t).
        means: Mean coordinates of the samples of each patch, about which monomials are: so those
            that samples in one line or plane do not determine vanish, shape (a, d).
        powers: Powers of the monomials, shape (t, d).
    """

    pairs: Pairs
    weighted: Array
    inverse: Array
    means: Array
    powers: Indices

    @classmethod
    def of(cls, pairs: Pairs, samples: Array, powers: Indices) -> Patches:
        """Fits of polynomials; if few elements do not determine one, that of least norm.

        Args:
            pairs: Pairs of patches and elements.
            samples: Coordinates of the samples of each pair, with the origin in the middle of the
                patch and the size of its elements as the unit, shape (p, g, d).
            powers: Powers of the monomials, shape (t, d).
        """
        counts = np.diff([*pairs.first, len(pairs.patches)])[:, np.newaxis]
        means = np.add.reduceat(samples.mean(axis=1), pairs.first, axis=0) / counts
        basis = _monomials(samples - means[pairs.patches, np.newaxis], powers)
        distance = (samples**2).sum(axis=-1, keepdims=True)
        weighted = (basis / (1.0 + _NEAR * distance) ** 4).swapaxes(1, 2)
        normal = np.add.reduceat(weighted @ basis, pairs.first, axis=0)
        inverse = np.linalg.pinv(normal, _DETERMINED, hermitian=True)
        return cls(pairs, weighted, inverse, means, powers)

    def at(self, patches: Indices, x: Array) -> Array:
        """Monomials of patches (c,) at coordinates (c, q, d) in them, shape (c, q, t)."""
        return _monomials(x - self.means[patches, np.newaxis], self.powers)

    def coefficients(self, values: Array) -> Array:
        """Coefficients of the fits, shape (a, t, b), to samples of each pair (p, g, b)."""
        right = np.add.reduceat(self.weighted @ values, self.pairs.first, axis=0)
        return np.asarray(self.inverse @ right)


def _monomials(x: Array, powers: Indices) -> Array:
    """Monomials with powers (t, d) at points (…, d), shape (…, t)."""
    return np.asarray(np.prod(x[..., np.newaxis, :] ** powers, axis=-1))


def tensor_powers(dimension: int, degree: int) -> Indices:
    """Powers of polynomials of a degree in each coordinate, shape (t, d).

    Args:
        dimension: Number of coordinates d.
        degree: The degree.
    """
    return np.array(list(product(range(degree + 1), repeat=dimension)), dtype=np.int64)


def complete_powers(dimension: int, degree: int) -> Indices:
    """Powers of all polynomials up to a degree, shape (t, d).

    Args:
        dimension: Number of coordinates d.
        degree: The degree.
    """
    powers = tensor_powers(dimension, degree)
    return powers[powers.sum(axis=1) <= degree]

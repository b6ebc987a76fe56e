"""Values at the edge of a surface, from the means of the cells nearby.

Inside, the mean over the cells around a node is of second order. At an edge it is one-sided: what
is constant along a cell is half a cell behind. There the value is that of the plane through the
means of the cells around the node and of their neighbours. (Zienkiewicz & Zhu, IJNME 33 (1992)
1331.)
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from fem_lie._lines import Array, Indices
from fem_lie.shared_values import SharedValues


def nearby(patches: SharedValues) -> tuple[Indices, Indices]:
    """Values at an edge, and the cells that share a value with their cells, as pairs."""
    m, k = patches.number.shape
    rows, columns = patches.number.ravel(), np.repeat(np.arange(m), k)
    around = csr_matrix((np.ones(m * k), (rows, columns)), shape=(len(patches.node), m))
    edge = np.flatnonzero(patches.edge)
    pairs = (around[edge] @ (around.T @ around)).tocoo()
    return edge[pairs.row], pairs.col.astype(np.int64)


def planes(which: Indices, places: Array, values: Array, count: int) -> Array:
    """Value at the origin of the plane nearest to points of each of ``count`` sets, (count, b).

    Where the points are on a line, or there is one alone, the plane does not rise across.

    Args:
        which: Set of each point, shape (r,).
        places: Its place in the plane, shape (r, 2).
        values: Shape (r, b).
        count: Number of sets, each with a point.
    """
    number = np.bincount(which, minlength=count)[:, np.newaxis]

    def total(parts: Array) -> Array:
        sums = np.zeros((count, *parts.shape[1:]))
        np.add.at(sums, which, parts)
        return sums

    middle, mean = total(places) / number, total(values) / number
    d, change = places - middle[which], values - mean[which]
    matrix = total(np.einsum("ri,rj->rij", d, d))
    slope = np.linalg.pinv(matrix, rcond=1e-6, hermitian=True) @ total(
        np.einsum("ri,rb->rib", d, change)
    )
    return np.asarray(mean - np.einsum("ni,nib->nb", middle, slope))

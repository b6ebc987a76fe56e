"""What eliminating a matrix costs, from its graph alone: fill and operations of a Cholesky factor.

Vertices are nodes, each with as many unknowns as it has free ones, and constraints. The columns of
the factor are counted along the row subtrees of the elimination tree (J. W. H. Liu, SIAM J. Matrix
Anal. Appl. 11 (1990) 134), for an ordering of minimum degree and one of nested dissection.
"""

from __future__ import annotations

from typing import NamedTuple

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.linear.bordered import Border

MINIMUM_DEGREE, DISSECTION = "amd", PETSc.Mat.OrderingType.ND
_WITHOUT_AMD = PETSc.Mat.OrderingType.QMD  # where PETSc was built without SuiteSparse


class Cost(NamedTuple):
    """Of an elimination.

    Attributes:
        fill: Entries of the factor.
        operations: Multiplications.
    """

    fill: float
    operations: float


class Graph(NamedTuple):
    """Of a matrix.

    Attributes:
        adjacency: Of vertices with unknowns, symmetric, with its diagonal.
        sizes: Unknowns of each vertex, shape (v,).
        constraints: How many of the last of them are constraints.
    """

    adjacency: sp.csr_matrix
    sizes: Indices
    constraints: int

    @classmethod
    def of(cls, indptr: Indices, indices: Indices, border: Border, held: Flags) -> Graph:
        """From pairs of nodes, from constraints and their nodes, and from what is held (n, 6)."""
        n, m = len(held), len(border.ptr) - 1
        nodes = sp.csr_matrix((np.ones(len(indices)), indices, indptr), shape=(n, n))
        legs = sp.csr_matrix((np.ones(len(border.nodes)), border.nodes, border.ptr), shape=(m, n))
        whole = sp.bmat([[nodes + nodes.T + sp.eye(n), legs.T], [legs, sp.eye(m)]], format="csr")
        sizes = np.append((~held).sum(axis=1), np.ones(m, dtype=np.int64))
        moves = sizes > 0
        adjacency = whole[moves][:, moves].tocsr()
        adjacency.sort_indices()
        return cls(adjacency, sizes[moves], m)

    @property
    def unknowns(self) -> int:
        """Number of free unknowns and constraints."""
        return int(self.sizes.sum())

    def cost(self, ordering: str) -> Cost:
        """With one of PETSc's orderings."""
        order = _ordering(self.adjacency, ordering)
        columns = _columns(self.adjacency, order, self.sizes)
        return _cost(columns, self.sizes[order])

    @property
    def width(self) -> int:
        """Neighbours that a node has at most when it is eliminated, constraints left out.

        One in trees and two in rings, by minimum degree.
        """
        n = len(self.sizes) - self.constraints
        nodes = self.adjacency[:n, :n].tocsr()
        columns = _columns(nodes, _ordering(nodes, MINIMUM_DEGREE), np.ones(n, dtype=np.int64))
        return int(columns.max(initial=1.0)) - 1


def _columns(adjacency: sp.csr_matrix, order: Indices, sizes: Indices) -> Array:
    """Length of the first column of each vertex in the factor, in the order of elimination, (v,).

    Args:
        adjacency: Of the vertices.
        order: Of elimination, shape (v,).
        sizes: Unknowns of each vertex, shape (v,).
    """
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    columns: Array = sizes[order].astype(np.float64)
    _count(adjacency.indptr, adjacency.indices, order, place, sizes, columns)
    return columns


def _ordering(adjacency: sp.csr_matrix, name: str) -> Indices:
    """New order of the vertices, shape (v,)."""
    if not adjacency.shape[0]:
        return np.empty(0, dtype=np.int64)
    csr = (
        adjacency.indptr.astype(PETSc.IntType),
        adjacency.indices.astype(PETSc.IntType),
        adjacency.data,
    )
    matrix = PETSc.Mat().createAIJ(adjacency.shape, csr=csr, comm=PETSc.COMM_SELF)
    try:
        rows, _ = matrix.getOrdering(name)
    except PETSc.Error:
        if name != MINIMUM_DEGREE:
            raise
        rows, _ = matrix.getOrdering(_WITHOUT_AMD)
    return np.asarray(rows.getIndices(), dtype=np.int64)


@compiled
def _count(
    pointers: Indices,
    neighbours: Indices,
    order: Indices,
    place: Indices,
    sizes: Indices,
    columns: Array,
) -> None:
    """Add to each vertex' own unknowns those of all that feel its elimination.

    Args:
        pointers: Of the graph, with ``neighbours``.
        neighbours: See there.
        order: Of elimination, shape (v,).
        place: Of each vertex in it.
        sizes: Unknowns of each vertex.
        columns: In the order of elimination, shape (v,).
    """
    n = len(order)
    parent, seen = np.full(n, -1), np.full(n, -1)
    for k in range(n):
        seen[k] = k
        for p in range(pointers[order[k]], pointers[order[k] + 1]):
            j = place[neighbours[p]]
            while j < k and seen[j] != k:
                if parent[j] < 0:
                    parent[j] = k
                columns[j] += sizes[order[k]]
                seen[j] = k
                j = parent[j]


def _cost(columns: Array, sizes: Indices) -> Cost:
    """Sums over all unknowns of vertices, the columns of which are one shorter after the other.

    Args:
        columns: Length of the first column of each vertex, shape (v,).
        sizes: Unknowns of each.
    """
    first, s = columns, sizes
    below = s * (s - 1) / 2.0  # 0 + 1 + … + (s − 1)
    squares = (s - 1) * s * (2 * s - 1) / 6.0
    fill = (s * first - below).sum()
    operations = (s * first**2 - 2.0 * first * below + squares).sum()
    return Cost(float(fill), float(operations))

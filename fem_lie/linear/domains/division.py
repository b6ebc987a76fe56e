"""Which rank has which cells, nodes and constraints.

What is joined stays together: cells at the nodes of a constraint, or of a pair that no cell has,
are one vertex of the graph that is divided. So all nodes of a constraint are within one domain,
whose own business its multiplier is, and domains meet within bodies. Vertices weigh what unknowns
they have, edges between them what they share.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Flags, Indices
from fem_lie.linear.domains.scotch import parts_of


class Links(NamedTuple):
    """Which of one sort has which nodes.

    Attributes:
        which: Number of the cell, of the constraint, shape (k,).
        nodes: A node of it, shape (k,).
        size: How many there are.
    """

    which: Indices
    nodes: Indices
    size: int

    def matrix(self, nodes: int) -> sp.csr_matrix:
        """Ones where the row has the node."""
        ones = np.ones(len(self.which), dtype=np.int64)
        found = sp.csr_matrix((ones, (self.which, self.nodes)), shape=(self.size, nodes))
        found.data[:] = 1
        return found


class Division(NamedTuple):
    """All domains, the same on all ranks.

    Attributes:
        cells: Domain of each cell, (c,).
        constraints: Of each constraint, (m,).
        nodes: Whether a domain has a node, (n, domains).
    """

    cells: Indices
    constraints: Indices
    nodes: Flags

    @property
    def shared(self) -> Flags:
        """Which nodes several domains have, shape (n,)."""
        return np.asarray(self.nodes.sum(axis=1) > 1)


def divided(cells: Links, constraints: Links, others: Links, free: Indices, count: int) -> Division:
    """Cells and constraints in so many domains.

    Args:
        cells: Nodes of all cells; each node has at least one.
        constraints: Nodes of all constraints.
        others: Of what else couples nodes.
        free: Unknowns of each node, shape (n,).
        count: Of domains.

    Raises:
        ValueError: What is joined cannot be divided so often.
    """
    n = len(free)
    C = cells.matrix(n)
    held = sp.vstack([constraints.matrix(n), others.matrix(n)], format="csr") @ C.T
    graph = sp.bmat([[None, held.T], [held, None]], format="csr")
    if held.shape[0] == 0:
        graph = sp.csr_matrix((cells.size,) * 2)
    groups, group = connected_components(graph, directed=False)
    group = group[: cells.size]
    used, group = np.unique(group, return_inverse=True)
    groups = len(used)
    if groups < count:
        raise ValueError(
            f"{count} subdomains need {count} parts between which there are no joints, got "
            f"{groups}: divide bodies between joints into more elements, or take fewer ranks"
        )
    P = sp.csr_matrix((np.ones(cells.size), (group, np.arange(cells.size)))) @ C
    P.data[:] = 1.0
    sharing = np.asarray(P.sum(axis=0)).ravel()
    weights = np.maximum(np.rint(12 * (P @ (free / sharing))), 1).astype(np.int64)
    edges = (P @ sp.diags(free.astype(float)) @ P.T).tocsr()
    edges.setdiag(0)
    edges.eliminate_zeros()
    edges.data = np.maximum(edges.data, 1.0)
    part = parts_of(edges, weights, count)
    return _of_parts(part[group], C, constraints, count)


def _of_parts(part: Indices, C: sp.csr_matrix, constraints: Links, count: int) -> Division:
    """From the domains of cells.

    Raises:
        ValueError: A domain has no cells.
    """
    empty = np.flatnonzero(np.bincount(part, minlength=count) == 0)
    if len(empty):
        raise ValueError(f"{len(empty)} of {count} subdomains would be empty: take fewer ranks")
    at = part[C.tocsc().indices[C.tocsc().indptr[:-1]]]  # domain of the first cell of each node
    domain = np.zeros(constraints.size, dtype=np.int64)
    domain[constraints.which] = at[constraints.nodes]
    D = C.T @ sp.csr_matrix((np.ones(len(part)), (np.arange(len(part)), part)))
    return Division(part, domain, D.toarray() > 0)

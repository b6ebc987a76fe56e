"""Subdomains of a scene: cells and joints distributed among ranks, and the subdomain matrix.

Every rank has the whole scene. It fills the matrix of its own cells in addition to that of all
cells. Contributions that are not sums over cells (inertia, mass-proportional damping, rotating
loads) are distributed among the subdomains in proportion to the number of cells at a pair of nodes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.node_types import POSITION
from fem_lie.linear.domains.division import Division, Links, Part, divided
from fem_lie.linear.saddle_point import KKT
from fem_lie.system.terms.all_terms import Terms
from fem_lie.system.terms.attached import AttachedTerm


def division_of(kkt: KKT, terms: Terms, coupled: Sequence[Pairs], count: int) -> Division:
    """Divide cells and joints into subdomains.

    Args:
        kkt: The saddle-point matrix.
        terms: Terms of the scene.
        coupled: Further coupled pairs of nodes.
        count: Number of subdomains.

    Raises:
        ValueError: The scene cannot be divided into so many.
    """
    n, incidences = len(kkt.held), kkt.incidences
    cells = all_cells(sums_of(terms), n)
    constraints = Links(incidences.rows, incidences.nodes, len(incidences.ptr) - 1)
    rest = [term.pairs for term in terms if not _is_sum(term)]
    pairs = _apart([*rest, *coupled], cells, n)
    return divided(cells, constraints, pairs, (~kkt.held).sum(axis=1), count)


class Domain:
    """Subdomain of one rank.

    Attributes:
        part: Its part of the matrix.
        share: Fraction of contributions without cells for each pair of the matrix, (nnz, 1, 1).
    """

    def __init__(self, kkt: KKT, terms: Terms, division: Division, rank: int) -> None:
        """Select the cells, nodes and constraints of the subdomain.

        Args:
            kkt: The saddle-point matrix.
            terms: Terms of the scene.
            division: Division, the same on all ranks.
            rank: Number of the subdomain.
        """
        self._kkt, self._summed = kkt, sums_of(terms)
        cells, first = all_cells(self._summed, len(kkt.held)), 0
        for term in self._summed:
            of_term = division.cells[first : first + len(term.cells)] == rank
            first += len(of_term)
            for each in term.matrices:
                each.choose(of_term)
        own = division.nodes[:, rank]
        self.part = Part(own, division.shared, division.constraints == rank, kkt.held)
        self.share = self._share(cells, division.cells == rank)

    def _share(self, cells: Links, own: Flags) -> Array:
        """Fraction of the cells with both nodes of a pair that are in this subdomain."""
        kkt, n = self._kkt, len(self._kkt.held)
        C = cells.matrix(n)
        rows = np.repeat(np.arange(n), np.diff(kkt.indptr))
        mine, every = (
            np.asarray((M.T @ M).tocsr()[rows, kkt.indices]).ravel() for M in (C[own], C)
        )
        return np.where(every > 0, mine / np.maximum(every, 1), 1.0)[:, np.newaxis, np.newaxis]

    def only_own(self, own: bool) -> None:
        """Restrict sums over cells to the subdomain, or undo this."""
        for term in self._summed:
            for each in term.matrices:
                each.own_only = own

    def has_cells(self, term: Term) -> bool:
        """Whether the term is a sum over cells."""
        return term in self._summed

    def see(self, H: Array, kinds: Indices, *, inertial: bool) -> None:
        """Evaluate rigid motions of the interface at frames ``H``, along axes of the unknowns."""
        x, R = H[: len(kinds), 0], H[: len(kinds), 1:]
        axes = np.broadcast_to(np.eye(3), R.shape) if inertial else R
        found = []
        for twist in np.eye(6):
            v = twist[:3] + np.cross(twist[3:], x)
            h = np.hstack([np.einsum("nij,nj->ni", axes, v), axes @ twist[3:]])
            h[:, 3:][kinds == POSITION] = 0.0
            found.append(h.ravel()[self.part.interfaces])
        self.part.motions = found


def _is_sum(term: Term) -> bool:
    return isinstance(term, AttachedTerm) and bool(term.matrices)


def sums_of(terms: Terms) -> list[AttachedTerm]:
    """Terms that are sums over cells."""
    return [term for term in terms if isinstance(term, AttachedTerm) and term.matrices]


def all_cells(terms: Sequence[AttachedTerm], n: int) -> Links:
    """Cells of all terms, and each node without a cell as a cell of its own."""
    which, nodes, count = [np.empty(0, np.int64)], [np.empty(0, np.int64)], 0
    for cells in (term.cells for term in terms):
        which.append(count + np.repeat(np.arange(len(cells)), cells.shape[1]))
        nodes.append(cells.ravel())
        count += len(cells)
    of_nodes = np.concatenate(nodes)
    moves = of_nodes < n
    alone = np.setdiff1d(np.arange(n), of_nodes)
    numbers = np.concatenate([np.concatenate(which)[moves], count + np.arange(len(alone))])
    return Links(numbers, np.concatenate([of_nodes[moves], alone]), count + len(alone))


def _apart(pairs: Sequence[Pairs], cells: Links, n: int) -> Links:
    """Pairs of nodes that are in no cell."""
    rows, columns = (np.concatenate([p[k].ravel() for p in pairs]) for k in range(2))
    moves = (rows < n) & (columns < n) & (rows != columns)
    rows, columns = rows[moves], columns[moves]
    C = cells.matrix(n)
    known = np.asarray((C.T @ C).tocsr()[rows, columns]).ravel() > 0 if len(rows) else moves[:0]
    both = np.stack([rows[~known], columns[~known]], axis=1)
    return Links(np.repeat(np.arange(len(both)), 2), both.ravel(), len(both))

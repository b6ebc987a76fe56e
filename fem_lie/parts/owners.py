"""Which rank has each of the cells that are drawn of a divided scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Flags, Indices
from fem_lie.bodies.body import Body
from fem_lie.linear.domains.division import Links
from fem_lie.parts.partition import Partition


def owners(bodies: Sequence[Body], found: Partition) -> dict[Body, Indices]:
    """Rank of each line, then of each face of each body, or of its nodes if there are neither.

    Args:
        bodies: Bodies of the scene.
        found: Its parts.
    """
    return {body: _of_body(body, found) for body in bodies}


def _of_body(body: Body, found: Partition) -> Indices:
    model = body.model
    drawn = [cells for cells in (model.cells, model.faces) if len(cells)]
    drawn = drawn or [np.arange(len(model.frames))[:, np.newaxis]]
    if body in found.pieces:
        return np.full(sum(map(len, drawn)), found.pieces[body])
    cells, first = model.divisible_cells, found.first[body]
    assert cells is not None
    has = found.division.nodes[first : first + len(model.frames)]
    return np.concatenate([owners_of(own, cells, found.cells[body], has) for own in drawn])


def owners_of(drawn: Indices, cells: Indices, ranks: Indices, has: Flags) -> Indices:
    """Rank of the cell to which each drawn cell belongs, shape (d,).

    It is the rank that has one of its nodes for itself. Otherwise it is that of the cell with most
    of its nodes, the first of several.

    Args:
        drawn: Nodes of each drawn cell, shape (d, k).
        cells: Nodes of each cell, shape (m, l).
        ranks: Rank that has each cell, shape (m,).
        has: Whether a rank has a node, shape (n, ranks).
    """
    shared = has.sum(axis=1) > 1
    alone = ~shared[drawn]
    found: Indices = has.argmax(axis=1)[drawn[np.arange(len(drawn)), alone.argmax(axis=1)]]
    between = np.flatnonzero(~alone.any(axis=1))
    near = np.flatnonzero(shared[cells].any(axis=1))
    common = (_links(drawn[between], len(has)) @ _links(cells[near], len(has)).T).tocoo()
    order = np.lexsort((common.col, -common.data, common.row))
    rows, first = np.unique(common.row[order], return_index=True)
    found[between[rows]] = ranks[near[common.col[order[first]]]]
    return found


def _links(cells: Indices, nodes: int) -> sp.csr_matrix:
    """Matrix with ones where the cell of a row has the node of a column."""
    which = np.repeat(np.arange(len(cells)), cells.shape[1])
    return Links(which, cells.ravel(), len(cells)).matrix(nodes)

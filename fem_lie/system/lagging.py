"""Derivatives in translations along axes that are behind those of the frames."""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.series import exponential
from fem_lie.lie.tuples import load, rotate, store


@compiled
def let_lag(K: Array, rows: Array, lag: Array, bind: Indices, nodes: Indices) -> None:
    """Make derivatives in twists those in translations along other axes, and rotations.

    Args:
        K: Blocks of the matrix, (nnz, 6, 6), updated.
        rows: Of constraints, (legs, 6), updated.
        lag: Rotation vectors from the other axes to those of the frames, (n, 3).
        bind: Node of the columns of each block.
        nodes: Node of each leg.
    """
    for b in range(bind.shape[0]):
        for k in range(6):
            _lagging(lag[bind[b]], K[b, k])
    for leg in range(rows.shape[0]):
        _lagging(lag[nodes[leg]], rows[leg])


@inlined
def _lagging(φ: Array, row: Array) -> None:
    _, e1, e2, e3 = exponential((0.0, 0.0, 0.0), load(φ, 0))
    store(row, 0, rotate(e1, e2, e3, load(row, 0)))

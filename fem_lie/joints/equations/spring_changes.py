"""Changes of the coordinates of springs along small motions of nodes; compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.joints.equations.one_pair import locate, rate_of_term
from fem_lie.joints.equations.table import JointTable


@compiled
def spring_changes(H: Array, h: Array, table: JointTable, out: Array) -> None:
    """Change of the coordinate of each spring along ``h``, to first order.

    Args:
        H: Frames of all nodes, shape (≥ n, 4, 3).
        h: Local increments of the nodes that move, shape (n, 6).
        table: The joints, with k springs.
        out: Shape (k,), overwritten.
    """
    A, B, z, f = np.empty((4, 3)), np.empty((4, 3)), np.empty(12), np.zeros(3)
    m = len(table.targets)
    for j in range(table.nodes.shape[0]):
        for t in range(table.first[j], table.first[j + 1]):
            if table.rows[t] >= m:
                locate(H, table, j, A, B, z, f)
                out[table.rows[t] - m] = rate_of_term(h, table, j, t, z)

"""A place that is fixed to the frame of one node: the constant grip.

Joints there hold on to the node, and forces fixed in space are forces on its place and directors.
Nodes of elements follow so in :mod:`fem_lie.system.nodes.numbering`.
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind


@compiled
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    offset, back = data.reshape(4, 3), np.empty((4, 3))
    lie.compose(X[0], offset, H)
    lie.inverse(offset, back)
    lie.adjoint(back, J[0])


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    K[:] = 0.0


FOLLOWER = GripKind(_locate, _bend, rigid=True)


def following(node: int, offset: Array) -> Grip:
    """The frame ``offset`` (4, 3) in that of a node."""
    return Grip(FOLLOWER, (node,), tuple(map(float, np.ravel(offset))))

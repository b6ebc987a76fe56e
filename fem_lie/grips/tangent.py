"""A node of position and slope, as joints see it: a frame whose first axis is the tangent.

Of rows ``(x, x′)`` and two more that are carried along with the tangent ``x′/|x′|`` the axes are
the tangent and these two, which is also in which components the node moves,
``h = (Rᵀδx, Rᵀδx′)``. Its twist is ``u = h₁₋₃`` and ``ω = e₁ × h₄₋₆/|x′|``: there is no spin about
the tangent, so that a moment about it has nothing to act on.

A :class:`~fem_lie.Spherical` joint holds the place, a :class:`~fem_lie.Revolute` one about the
tangent clamps the direction, too. A :class:`~fem_lie.Fixed` joint asks for a third rotation that
such a node does not have: its constraint is refused as a redundant one.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind


@compiled
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    size = np.sqrt(np.dot(X[0, 1], X[0, 1]))
    H[:] = X[0]
    H[1] /= size
    J[0] = 0.0
    for k in range(3):
        J[0, k, k] = 1.0
    J[0, 4, 5], J[0, 5, 4] = -1.0 / size, 1.0 / size


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    """The axes turn with the force, so that only ``1/|x′|`` changes, by the slope along them."""
    square = np.dot(X[0, 1], X[0, 1])
    K[:] = 0.0
    K[0, 4, 0, 3], K[0, 5, 0, 3] = -f[5] / square, f[4] / square


TANGENT = GripKind(_locate, _bend, summed=True)


def along_tangent(node: int) -> Grip:
    """At a node of position and slope."""
    return Grip(TANGENT, (node,), ())

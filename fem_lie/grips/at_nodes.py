"""Attachment frames at one node: fixed to its frame, to its tangent, to its section.

A place that is fixed to the frame of one node: the constant grip.

Joints there hold on to the node, and forces fixed in space are forces on its place and directors.
Nodes of elements follow so in :mod:`fem_lie.system.nodes.numbering`.

A node of position and slope, as joints see it: a frame whose first axis is the tangent.

Of rows ``(x, x′)`` and two more that are carried along with the tangent ``x′/|x′|`` the axes are
the tangent and these two, which is also in which components the node moves,
``h = (Rᵀδx, Rᵀδx′)``. Its twist is ``u = h₁₋₃`` and ``ω = e₁ × h₄₋₆/|x′|``: there is no spin about
the tangent, so that a moment about it has nothing to act on.

A :class:`~fem_lie.Spherical` joint holds the place, a :class:`~fem_lie.Revolute` one about the
tangent clamps the direction, too. A :class:`~fem_lie.Fixed` joint asks for a third rotation that
such a node does not have: its constraint is refused as a redundant one.

A place on the axis of a beam of places and three slopes, with the frame of its section.

As :mod:`.surface`, where ``r_y`` and ``r_z`` are the derivatives along the surface: the frame's
second axis is along ``r_y``, the first is normal to the section, which is the normal there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.grips.grip import Grip, GripKind
from fem_lie.grips.surface import bend_surface, locate_surface


@compiled
def _locate_on_node(X: Array, data: Array, H: Array, J: Array) -> None:
    offset, back = data.reshape(4, 3), np.empty((4, 3))
    lie.compose(X[0], offset, H)
    lie.inverse(offset, back)
    lie.adjoint(back, J[0])


@compiled
def _bend_on_node(X: Array, data: Array, f: Array, K: Array) -> None:
    K[:] = 0.0


FOLLOWER = GripKind(_locate_on_node, _bend_on_node, rigid=True)


def following(node: int, offset: Array) -> Grip:
    """The frame ``offset`` (4, 3) in that of a node."""
    return Grip(FOLLOWER, (node,), tuple(map(float, np.ravel(offset))))


@compiled
def _locate_on_tangent(X: Array, data: Array, H: Array, J: Array) -> None:
    size = np.sqrt(np.dot(X[0, 1], X[0, 1]))
    H[:] = X[0]
    H[1] /= size
    J[0] = 0.0
    for k in range(3):
        J[0, k, k] = 1.0
    J[0, 4, 5], J[0, 5, 4] = -1.0 / size, 1.0 / size


@compiled
def _bend_on_tangent(X: Array, data: Array, f: Array, K: Array) -> None:
    """The axes turn with the force, so that only ``1/|x′|`` changes, by the slope along them."""
    square = np.dot(X[0, 1], X[0, 1])
    K[:] = 0.0
    K[0, 4, 0, 3], K[0, 5, 0, 3] = -f[5] / square, f[4] / square


TANGENT = GripKind(_locate_on_tangent, _bend_on_tangent, summed=True)


def along_tangent(node: int) -> Grip:
    """At a node of position and slope."""
    return Grip(TANGENT, (node,), ())


@compiled
def _locate_on_cross_section(X: Array, data: Array, H: Array, J: Array) -> None:
    locate_surface(X, data, H, J)
    normal = H[3].copy()
    H[3] = H[2]
    H[2] = H[1]
    H[1] = normal
    for i in range(X.shape[0]):
        for part in range(0, 6, 3):
            normal_rows = J[i, part + 2].copy()
            J[i, part + 2] = J[i, part + 1]
            J[i, part + 1] = J[i, part]
            J[i, part] = normal_rows


@compiled
def _bend_on_cross_section(X: Array, data: Array, f: Array, K: Array) -> None:
    given = np.empty(6)
    for part in range(0, 6, 3):
        given[part], given[part + 1], given[part + 2] = f[part + 1], f[part + 2], f[part]
    bend_surface(X, data, given, K)


ON_SECTION = GripKind(_locate_on_cross_section, _bend_on_cross_section, summed=True, turns=True)


def on_section(nodes: Sequence[int], shares: Array) -> Grip:
    """A place between nodes, those with places first.

    Args:
        nodes: SURFACE nodes, then as many CROSSING ones.
        shares: Of their two straight rows in the place, ``r_y`` and ``r_z``, shape (k, 2, 3).
    """
    return Grip(ON_SECTION, tuple(map(int, nodes)), tuple(map(float, shares.ravel())))

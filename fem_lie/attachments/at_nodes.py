"""Attachment frames at one node or in one cross-section.

*Fixed to the frame of a node.* The offset in that frame is constant. Joints act on the node
directly, and forces that are fixed in space are forces on its position and directors. Nodes of
elements that are rigidly attached to another node are in :mod:`fem_lie.system.nodes.numbering`
instead.

*At a node with a position and a position gradient.* The first axis of the frame is the tangent
``x′/|x′|``. The other two are convected with the tangent. The node has the variations
``h = (Rᵀδx, Rᵀδx′)`` along these axes, and the twist of the frame is ``u = h₁₋₃`` and
``ω = e₁ × h₄₋₆/|x′|``. There is no spin about the tangent, so a moment about the tangent does no
work. A :class:`~fem_lie.joints.Spherical` joint holds the position; a
:class:`~fem_lie.joints.Revolute` joint about the tangent clamps the direction, too. A
:class:`~fem_lie.joints.Fixed` joint constrains a third rotation that the node does not have: its
constraint is rejected as redundant.

*In the cross-section of a beam with position and three position gradients.* As in :mod:`.surface`,
where ``r_y`` and ``r_z`` are the derivatives along the surface. The second axis of the frame is
along ``r_y``; the first is the normal of the cross-section, which is the normal of the surface in
:mod:`.surface`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.attachments.attachment import AttachmentFrame, AttachmentKind
from fem_lie.attachments.surface import bend_surface, locate_surface


@compiled
def _locate_on_node(X: Array, data: Array, H: Array, J: Array) -> None:
    offset, back = data.reshape(4, 3), np.empty((4, 3))
    lie.compose(X[0], offset, H)
    lie.inverse(offset, back)
    lie.adjoint(back, J[0])


@compiled
def _bend_on_node(X: Array, data: Array, f: Array, K: Array) -> None:
    K[:] = 0.0


ON_NODE = AttachmentKind(_locate_on_node, _bend_on_node, rigid=True)


def at_node(node: int, offset: Array) -> AttachmentFrame:
    """Frame with a constant offset (4, 3) in the frame of a node."""
    return AttachmentFrame(ON_NODE, (node,), tuple(map(float, np.ravel(offset))))


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
    """Geometric stiffness; ``f`` rotates with the axes, so only ``1/|x′|`` changes."""
    square = np.dot(X[0, 1], X[0, 1])
    K[:] = 0.0
    K[0, 4, 0, 3], K[0, 5, 0, 3] = -f[5] / square, f[4] / square


TANGENT = AttachmentKind(_locate_on_tangent, _bend_on_tangent, summed=True)


def along_tangent(node: int) -> AttachmentFrame:
    """Frame at a node with a position and a position gradient."""
    return AttachmentFrame(TANGENT, (node,), ())


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


ON_SECTION = AttachmentKind(
    _locate_on_cross_section, _bend_on_cross_section, summed=True, turns=True
)


def on_section(nodes: Sequence[int], coefficients: Array) -> AttachmentFrame:
    """Frame of a cross-section between nodes.

    Args:
        nodes: Surface-gradient nodes, then as many mixed-derivative nodes.
        coefficients: Coefficients of the two coordinate vectors of each node in the position,
            ``r_y`` and ``r_z``, shape (k, 2, 3).
    """
    return AttachmentFrame(
        ON_SECTION, tuple(map(int, nodes)), tuple(map(float, coefficients.ravel()))
    )

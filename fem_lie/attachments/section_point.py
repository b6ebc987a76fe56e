"""Attachment frames at points of a section that distorts.

With a node whose frame is that of the section, and modal nodes with amplitudes ``a``, the frame is
at ``x + R c``, ``c = r + Σ φ_k a_k``, with the axes ``R`` of the section. Its twist is
``(u + ω × c + Σ φ_k ȧ_k, ω)``.
"""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.attachments.attachment import AttachmentFrame, AttachmentKind


@compiled
def _locate(X: Array, data: Array, H: Array, J: Array) -> None:
    c = data[:3].copy()
    J[:] = 0.0
    for node in range(1, X.shape[0]):
        for k in range(6):
            at = 3 + 3 * (6 * (node - 1) + k)
            for i in range(3):
                J[node, i, k] = data[at + i]
                c[i] += data[at + i] * X[node, 1 + k // 3, k % 3]
    H[:] = X[0]
    for i in range(3):
        for j in range(3):
            H[0, j] += c[i] * X[0, 1 + i, j]
        J[0, i, i] = J[0, 3 + i, 3 + i] = 1.0
    # ω × c
    J[0, 0, 4], J[0, 0, 5] = c[2], -c[1]
    J[0, 1, 3], J[0, 1, 5] = -c[2], c[0]
    J[0, 2, 3], J[0, 2, 4] = c[1], -c[0]


@compiled
def _bend(X: Array, data: Array, f: Array, K: Array) -> None:
    """Geometric stiffness: the moment ``c × f`` changes with the amplitudes."""
    K[:] = 0.0
    for node in range(1, X.shape[0]):
        for k in range(6):
            at = 3 + 3 * (6 * (node - 1) + k)
            K[0, 3, node, k] = data[at + 1] * f[2] - data[at + 2] * f[1]
            K[0, 4, node, k] = data[at + 2] * f[0] - data[at] * f[2]
            K[0, 5, node, k] = data[at] * f[1] - data[at + 1] * f[0]


SECTION_POINT = AttachmentKind(_locate, _bend)


def on_distorting_section(
    node: int, modal: Indices, position: Array, displacements: Array
) -> AttachmentFrame:
    """Frame at a point of a section.

    Args:
        node: Node with the frame of the section.
        modal: Modal nodes with the amplitudes.
        position: Position in the frame of the section without distortion, shape (3,).
        displacements: Displacement for each of the six amplitudes of each modal node, (6 m, 3).
    """
    data = (*map(float, position), *map(float, displacements.ravel()))
    return AttachmentFrame(SECTION_POINT, (node, *map(int, modal)), data)

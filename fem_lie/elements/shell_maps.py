"""How positions and directors of a shell move with its nodes: five and six parameters per node.

Nodes store frames ``(x, d₁, d₂, d₃)`` with the director ``t = d₃``.

*Five parameters.* ``h = (u, η₁, η₂)``: ``δx = R u``, ``δt = R (η × e₃) = η₂ d₁ − η₁ d₂``, and the
frame turns by the exact rotation ``exp(η₁, η₂, 0)``, the smallest that takes the director to its new
place. So the director moves along a geodesic of the sphere, and the frame does not drill.

*Six parameters.* All of the frame counts: :data:`fem_lie.frames.DIRECTORS` with the coordinates of
each cell in one array.
"""

from __future__ import annotations

import numba

from fem_lie._jit import compiled
from fem_lie.frames import _director_geometric, _director_pull, _director_push
from fem_lie.kernel import FrameMap, frame_function


@compiled
def _along(H, a, f):  # type: ignore[no-untyped-def]
    return H[1 + a, 0] * f[0] + H[1 + a, 1] * f[1] + H[1 + a, 2] * f[2]


@frame_function
def _five_coordinates(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    H, q = numba.carray(state, (nodes, 4, 3)), numba.carray(y, (nodes, 2, 3))
    for i in range(nodes):
        for j in range(3):
            q[i, 0, j] = H[i, 0, j]
            q[i, 1, j] = H[i, 3, j]


@frame_function
def _five_pull(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    """Force ``Rᵀ f_x``, moments ``−d₂·f_t`` and ``d₁·f_t``."""
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 2, 3))
    r = numba.carray(out, (nodes, 5))
    for i in range(nodes):
        for a in range(3):
            r[i, a] += _along(H[i], a, f[i, 0])
        r[i, 3] -= _along(H[i], 1, f[i, 1])
        r[i, 4] += _along(H[i], 0, f[i, 1])


@frame_function
def _five_push(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 5))
    dy = numba.carray(out, (nodes, 2, 3))
    for i in range(nodes):
        for j in range(3):
            d1, d2, d3 = H[i, 1, j], H[i, 2, j], H[i, 3, j]
            dy[i, 0, j] = d1 * h[i, 0] + d2 * h[i, 1] + d3 * h[i, 2]
            dy[i, 1, j] = d1 * h[i, 4] - d2 * h[i, 3]


@frame_function
def _five_geometric(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    """``(Rᵀf_x)^`` in (force, rotation), ``−(d₃·f_t) I`` in (moment, rotation)."""
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 2, 3))
    A = numba.carray(out, (nodes, 5, nodes, 5))
    for i in range(nodes):
        n0, n1, n2 = _along(H[i], 0, f[i, 0]), _along(H[i], 1, f[i, 0]), _along(H[i], 2, f[i, 0])
        m = _along(H[i], 2, f[i, 1])
        block = A[i, :, i]
        block[0, 4] -= n2
        block[1, 3] += n2
        block[2, 3] -= n1
        block[2, 4] += n0
        block[3, 3] -= m
        block[4, 4] -= m


@frame_function
def _six_coordinates(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    H, q = numba.carray(state, (12 * nodes,)), numba.carray(y, (12 * nodes,))
    for i in range(12 * nodes):
        q[i] = H[i]


FIVE = FrameMap(
    coordinates=_five_coordinates,
    pull=_five_pull,
    push=_five_push,
    geometric=_five_geometric,
    values=12,
    unknowns=5,
)
"""Position and director; the rotation about the director is no unknown."""

SIX = FrameMap(
    coordinates=_six_coordinates,
    pull=_director_pull,
    push=_director_push,
    geometric=_director_geometric,
    values=12,
    unknowns=6,
)
"""Position and all three directors."""

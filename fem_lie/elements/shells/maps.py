"""Maps of shells: positions and directors as functions of nodes with or without drilling rotations.

Nodes store frames ``(x, d₁, d₂, d₃)``; the director is ``t = d₃``. Unknowns are ``(u, η)``, and the
state is updated by :func:`retract`, ``x ← x + R u``, ``R ← R exp(η₁, η₂, 0) exp(0, 0, η₃)``.

*Five parameters.* Without ``η₃``, ``δt = R (η × e₃) = η₂ d₁ − η₁ d₂``. The frame rotates by the
smallest rotation that moves the director to its new direction, along a geodesic of the sphere; the
frame has no drilling rotation.

*Six parameters.* The drilling rotation ``η₃`` comes last, so that it does not move the director
even to second order.

**The tangent of an element is the second derivative of the energy along that motion.** It is
symmetric in every state, in equilibrium or not. It is not ``∂(Lᵀf)/∂h``, which also contains
``(Rᵀf_x)^``, the rotation of the axes in which an unbalanced force is written, and similar terms,
see :func:`add_turning`. At equilibrium these terms cancel for the sum of all forces on a node; off
equilibrium they slow down convergence: they couple the translation of a node to the rotation of its
frame by forces that are an artefact of the iteration.
"""

from __future__ import annotations

import numba

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.forms.frames import pull_back, push_forward
from fem_lie.forms.kernels.addresses import FrameMap, Pointer, frame_function


@compiled
def _along(H: Array, a: int, f: Array) -> float:
    return H[1 + a, 0] * f[0] + H[1 + a, 1] * f[1] + H[1 + a, 2] * f[2]


@frame_function
def _five_coordinates(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, q = numba.carray(state, (nodes, 4, 3)), numba.carray(y, (nodes, 2, 3))
    for i in range(nodes):
        for j in range(3):
            q[i, 0, j] = H[i, 0, j]
            q[i, 1, j] = H[i, 3, j]


@frame_function
def _five_pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    """Force ``Rᵀ f_x``, moments ``−d₂·f_t`` and ``d₁·f_t``."""
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 2, 3))
    r = numba.carray(out, (nodes, 5))
    for i in range(nodes):
        for a in range(3):
            r[i, a] += _along(H[i], a, f[i, 0])
        r[i, 3] -= _along(H[i], 1, f[i, 1])
        r[i, 4] += _along(H[i], 0, f[i, 1])


@frame_function
def _five_push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 5))
    dy = numba.carray(out, (nodes, 2, 3))
    for i in range(nodes):
        for j in range(3):
            d1, d2, d3 = H[i, 1, j], H[i, 2, j], H[i, 3, j]
            dy[i, 0, j] = d1 * h[i, 0] + d2 * h[i, 1] + d3 * h[i, 2]
            dy[i, 1, j] = d1 * h[i, 4] - d2 * h[i, 3]


@frame_function
def _five_geometric(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    """``−(d₃·f_t) I`` in (moment, rotation)."""
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 2, 3))
    A = numba.carray(out, (nodes, 5, nodes, 5))
    for i in range(nodes):
        m = _along(H[i], 2, f[i, 1])
        A[i, 3, i, 3] -= m
        A[i, 4, i, 4] -= m


@frame_function
def _six_coordinates(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, q = numba.carray(state, (12 * nodes,)), numba.carray(y, (12 * nodes,))
    for i in range(12 * nodes):
        q[i] = H[i]


@frame_function
def _six_pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    shape = (nodes, 4, 3)
    pull_back(
        numba.carray(state, shape), numba.carray(given, shape), 1.0, numba.carray(out, (nodes, 6))
    )


@frame_function
def _six_push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    shape = (nodes, 4, 3)
    push_forward(
        numba.carray(state, shape), numba.carray(given, (nodes, 6)), numba.carray(out, shape)
    )


@frame_function
def _six_geometric(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    """Second derivative of ``Σ f_k·d_k``; with ``m_k = Rᵀf_k`` and ⊥ for (η₁, η₂).

    Symmetric part of ``Σ m_k e_kᵀ − (e_k·m_k) I`` in (⊥, ⊥), ``m_k·e₃`` in (η_k, η₃), and
    ``−Σ_⊥ e_k·m_k`` in (η₃, η₃).
    """
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 4, 3))
    A = numba.carray(out, (nodes, 6, nodes, 6))
    for i in range(nodes):
        for k in range(3):
            along = _along(H[i], k, f[i, 1 + k])
            A[i, 3, i, 3] -= along
            A[i, 4, i, 4] -= along
        for k in range(2):
            A[i, 5, i, 5] -= _along(H[i], k, f[i, 1 + k])
            lift = _along(H[i], 2, f[i, 1 + k])
            A[i, 3 + k, i, 5] += lift
            A[i, 5, i, 3 + k] += lift
            for a in range(2):
                m = 0.5 * _along(H[i], a, f[i, 1 + k])
                A[i, 3 + a, i, 3 + k] += m
                A[i, 3 + k, i, 3 + a] += m


FIVE = FrameMap(
    coordinates=_five_coordinates,
    pull_back=_five_pull,
    push_forward=_five_push,
    geometric=_five_geometric,
    values=12,
    unknowns=5,
)
"""Map with position and director; the rotation about the director is not an unknown."""

SIX = FrameMap(
    coordinates=_six_coordinates,
    pull_back=_six_pull,
    push_forward=_six_push,
    geometric=_six_geometric,
    values=12,
    unknowns=6,
)
"""Map with position and all three directors."""

"""Modal coordinates within the frame of a reduced-order body: compiled.

The nodes of such a body are its reference frame, the frames of its other interfaces, and modal
nodes (see :mod:`fem_lie.lie.node_types`), in this order. For each other interface ``(x_i, d_in)``,
with position ``X`` and directors ``D_n`` at the start in components along the frame ``(x, d_k)``,
the coordinates ``z`` are::

    z_u = d_k·(x_i − x) − X_k,    z_θ = ½ Σ_n D_n × (d_k·d_in)

followed by the modal amplitudes. They are bilinear in nodal coordinates, so that their rates and
forces are products. Strains are ``e_a = z_a + ½ Q_abc z_b z_c``.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, uncounted
from fem_lie.lie.node_types.forces import push_forward

Rows: TypeAlias = npt.NDArray[Any]
"""Nodal coordinates or their rates; complex for derivatives by a complex step."""


@uncounted
def add_products(d: Rows, q: Rows, interfaces: Array, factor: float, out: Rows) -> None:
    """Add ``factor`` times the bilinear part of ``z`` (m,) in directors and coordinates.

    ``d`` are coordinates (4, 3) of the reference frame, ``q`` those (k, 4, 3) of all nodes.
    """
    for i in range(interfaces.shape[0]):
        for k in range(3):
            for j in range(3):
                out[6 * i + k] += factor * d[1 + k, j] * (q[1 + i, 0, j] - q[0, 0, j])
        for n in range(3):
            D, row = interfaces[i, 1 + n], q[1 + i, 1 + n]
            c0 = d[1, 0] * row[0] + d[1, 1] * row[1] + d[1, 2] * row[2]
            c1 = d[2, 0] * row[0] + d[2, 1] * row[1] + d[2, 2] * row[2]
            c2 = d[3, 0] * row[0] + d[3, 1] * row[1] + d[3, 2] * row[2]
            out[6 * i + 3] += 0.5 * factor * (D[1] * c2 - D[2] * c1)
            out[6 * i + 4] += 0.5 * factor * (D[2] * c0 - D[0] * c2)
            out[6 * i + 5] += 0.5 * factor * (D[0] * c1 - D[1] * c0)


@uncounted
def add_amplitudes(q: Rows, others: int, out: Rows) -> None:
    """Add the modal amplitudes of a body with ``others`` other interfaces to ``out`` (m,)."""
    first = 6 * others
    for a in range(out.shape[0] - first):
        out[first + a] += q[1 + others + a // 6, 1 + (a % 6) // 3, a % 3]


@uncounted
def coordinates(q: Rows, interfaces: Array, z: Rows) -> None:
    """Set ``z`` (m,) from the coordinates ``q`` (k, 4, 3) of a body's nodes."""
    z[:] = 0.0
    add_products(q[0], q, interfaces, 1.0, z)
    for i in range(interfaces.shape[0]):
        for k in range(3):
            z[6 * i + k] -= interfaces[i, 0, k]
    add_amplitudes(q, interfaces.shape[0], z)


@uncounted
def spread(g: Rows, q: Rows, interfaces: Array, f: Rows) -> None:
    """Add the forces on nodal coordinates of forces ``g`` (m,) on ``z`` to ``f``.

    ``f`` and ``q`` have shape (k, 4, 3).
    """
    others = interfaces.shape[0]
    for i in range(others):
        for j in range(3):
            for k in range(3):
                part = g[6 * i + k] * q[0, 1 + k, j]
                f[1 + i, 0, j] += part
                f[0, 0, j] -= part
                f[0, 1 + k, j] += g[6 * i + k] * (q[1 + i, 0, j] - q[0, 0, j])
        m0, m1, m2 = 0.5 * g[6 * i + 3], 0.5 * g[6 * i + 4], 0.5 * g[6 * i + 5]
        for n in range(3):
            D = interfaces[i, 1 + n]
            w = m1 * D[2] - m2 * D[1], m2 * D[0] - m0 * D[2], m0 * D[1] - m1 * D[0]
            for k in range(3):
                for j in range(3):
                    f[1 + i, 1 + n, j] += w[k] * q[0, 1 + k, j]
                    f[0, 1 + k, j] += w[k] * q[1 + i, 1 + n, j]
    for a in range(g.shape[0] - 6 * others):
        f[1 + others + a // 6, 1 + (a % 6) // 3, a % 3] += g[6 * others + a]


@uncounted
def strains(Q: Array, z: Array, J: Array, e: Array) -> None:
    """Set strains ``e`` (m,) and their derivative ``J`` (m, m) in ``z``.

    ``Q_abc`` is at ``[c, a, b]``.
    """
    m = z.shape[0]
    J[:] = 0.0
    for c in range(m):
        of_one, amplitude = Q[c], z[c]
        for a in range(m):
            for b in range(m):
                J[a, b] += of_one[a, b] * amplitude
    for a in range(m):
        e[a] = z[a]
        for b in range(m):
            e[a] += 0.5 * J[a, b] * z[b]
        J[a, a] += 1.0


@uncounted
def add_times(A: Array, x: Array, out: Array) -> None:
    """Add ``x A`` to ``out``; sums along rows are vectorised."""
    for a in range(A.shape[0]):
        row, amplitude = A[a], x[a]
        for b in range(A.shape[1]):
            out[b] += row[b] * amplitude


@compiled
def all_coordinates(H: Array, interfaces: Array, size: int) -> Array:
    """Coordinates ``z`` (s, m) of a body in s states of its nodes, ``H`` (s, k, 4, 3)."""
    z = np.zeros((H.shape[0], size))
    for s in range(H.shape[0]):
        coordinates(H[s], interfaces, z[s])
    return z


@compiled
def all_rates(node_types: Indices, H: Array, v: Array, interfaces: Array, size: int) -> Array:
    """Rates of ``z`` (s, m) for twists ``v`` (s, k, 6) of the body's nodes."""
    dz, rate = np.zeros((H.shape[0], size)), np.empty(H.shape[1:])
    for s in range(H.shape[0]):
        for i in range(node_types.shape[0]):
            push_forward(node_types[i], H[s, i], v[s, i], rate[i])
        add_products(rate[0], H[s], interfaces, 1.0, dz[s])
        add_products(H[s, 0], rate, interfaces, 1.0, dz[s])
        add_amplitudes(rate, interfaces.shape[0], dz[s])
    return dz

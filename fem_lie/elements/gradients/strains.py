r"""Strains of the beam of places and three slopes, and their first derivatives: compiled.

A point of the section is ``r + y r_y + z r_z``, with ``r`` a cubic of places and slopes ``r_x`` of
both ends and ``r_y``, ``r_z`` linear. All strains are products of vectors at three places, the two
ends and the middle:

- ``(E₁₁, 2 E₁₂, 2 E₁₃) = (½ r_x·r_x − ½, r_x·r_y, r_x·r_z)`` at all three,
- ``κ = (½ (r_y'·r_z − r_z'·r_y), r_x·r_z', −r_x·r_y')``, the twist in the middle, of the others
  four thirds of the middle less a third of the mean of both ends: on an arc of the angle α within
  the cell they are ``2 sin ½α/ℓ`` and ``sin α/ℓ``, and together ``α/ℓ`` but for ``α⁵/480ℓ``,
- ``(E₂₂, E₃₃, 2 E₂₃)`` of the section at both ends.

They are eighteen, as many as a cell has motions that are not rigid: none of them has to be where
another is wanted. Where a thin beam bends far within a cell the cubics and lines cannot be without
stretch, shear and deformation of the section everywhere, but they can be so at the nodes and in the
middle. Integrated at Gauss points they lock.

Less those of the unloaded cell they are what the energy is of. As they are quadratic in the
vectors, the geometric matrix is constant for constant stress.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.lie.kinds.kind import CROSSING, SURFACE, axes
from fem_lie.lie.tuples import load, load_row, rotate, rotate_back, store

ENDS, VECTORS, NODES, UNKNOWNS = 2, 8, 4, 24
"""A cell has the SURFACE nodes of its ends, with place and ``r_x``, then their CROSSING ones, with
``r_y`` and ``r_z``; its vectors are those four of one end, then of the other."""

STRAINS, LEVERS, TERMS = 18, 11, 23
BEAM, CURVATURE, SECTION = 0, 9, 12
"""Where strains of the axis, curvatures, and those of the sections begin."""

_X, _Y, _Z, _DY, _DZ = 0, 3, 6, 9, 10
"""Levers: ``r_x``, ``r_y``, ``r_z`` at one end, in the middle, at the other; ``r_y'``, ``r_z'``."""


def _terms() -> Array:
    """Strains, and both levers and the factor of each product in them, shape (terms, 4)."""
    found: list[tuple[float, ...]] = []
    for p in range(3):
        x, y, z = _X + p, _Y + p, _Z + p
        found += [(3 * p, x, x, 0.5), (3 * p + 1, x, y, 1.0), (3 * p + 2, x, z, 1.0)]
    y, z = _Y + 1, _Z + 1
    found += [(CURVATURE, _DY, z, 0.5), (CURVATURE, _DZ, y, -0.5)]
    for x, share in ((_X, -1 / 6), (_X + 1, 4 / 3), (_X + 2, -1 / 6)):
        found += [(CURVATURE + 1, x, _DZ, share), (CURVATURE + 2, x, _DY, -share)]
    for end, p in enumerate((0, 2)):
        k, y, z = SECTION + 3 * end, _Y + p, _Z + p
        found += [(k, y, y, 0.5), (k + 1, z, z, 0.5), (k + 2, y, z, 1.0)]
    return np.array(found)


_TABLE = _terms()
_STRAIN, _FIRST, _SECOND = (_TABLE[:, k].astype(np.int64) for k in range(3))
_FACTOR = np.ascontiguousarray(_TABLE[:, 3])


class Data(NamedTuple):
    """What the kernels read of one cell.

    Attributes:
        rows: Of its nodes, shape (4, 4, 3).
        length: Unloaded.
        unloaded: Strains then, shape (18,).
        stiffness: Of the whole cell, shape (18, 18).
        stress: What is carried, shape (18,).
    """

    rows: Array
    length: float
    unloaded: Array
    stiffness: Array
    stress: Array


STRESS_AT = 12 * NODES + 1 + STRAINS + STRAINS**2
"""Where the carried stress begins in a cell's data; it is the last of them."""


@inlined
def read(w: Pointer) -> Data:
    """The cell whose numbers begin at ``w``."""
    at = 12 * NODES
    length = numba.carray(shift(w, at), (1,))[0]
    unloaded = numba.carray(shift(w, at + 1), (STRAINS,))
    stiffness = numba.carray(shift(w, at + 1 + STRAINS), (STRAINS, STRAINS))
    stress = numba.carray(shift(w, STRESS_AT), (STRAINS,))
    return Data(numba.carray(w, (NODES, 4, 3)), length, unloaded, stiffness, stress)


@inlined
def _node_of(a: int) -> int:
    return a // 4 + (ENDS if a % 4 >= 2 else 0)


@inlined
def _half_of(a: int) -> int:
    return a % 2


@inlined
def _kind(node: int) -> int:
    return SURFACE if node < ENDS else CROSSING


@compiled
def gather(H: Array, q: Array) -> None:
    """Vectors ``q`` (8, 3) from the rows of a cell's nodes (4, 4, 3)."""
    for a in range(VECTORS):
        store(q[a], 0, load_row(H[_node_of(a)], _half_of(a) + (1 if a % 4 >= 2 else 0)))


@compiled
def gather_motion(H: Array, h: Array, q: Array) -> None:
    """``δq`` (8, 3) from motions ``h`` (4, 6) of the nodes along their axes."""
    for a in range(VECTORS):
        node = _node_of(a)
        d1, d2, d3 = axes(_kind(node), H[node])
        store(q[a], 0, rotate(d1, d2, d3, load(h[node], 3 * _half_of(a))))


@compiled
def pull(H: Array, f: Array, out: Array) -> None:
    """Add forces ``f`` (8, 3) on the vectors to those on the nodes, ``out`` (4, 6)."""
    for a in range(VECTORS):
        node, at = _node_of(a), 3 * _half_of(a)
        d1, d2, d3 = axes(_kind(node), H[node])
        local = rotate_back(d1, d2, d3, load_row(f, a))
        for k in range(3):
            out[node, at + k] += local[k]


@compiled
def pull_matrix(H: Array, K: Array, R: Array, half: Array, out: Array) -> None:
    """Add ``K`` (24, 24) on the vectors to the matrix of the nodes, ``out`` (4, 6, 4, 6).

    ``R`` (4, 3, 3) and ``half`` (3, 3): work.
    """
    for node in range(NODES):
        for k, axis in enumerate(axes(_kind(node), H[node])):
            store(R[node, k], 0, axis)
    for a in range(VECTORS):
        i, first = _node_of(a), 3 * _half_of(a)
        for b in range(VECTORS):
            j, second = _node_of(b), 3 * _half_of(b)
            for m in range(3):
                for n in range(3):
                    half[m, n] = 0.0
                    for k in range(3):
                        half[m, n] += K[3 * a + m, 3 * b + k] * R[j, n, k]
            for m in range(3):
                for n in range(3):
                    for k in range(3):
                        out[i, first + m, j, second + n] += R[i, m, k] * half[k, n]


@compiled
def find_levers(length: float, q: Array, z: Array) -> None:
    """Levers ``z`` (11, 3) from the vectors ``q`` (8, 3)."""
    chord, rate = 1.5 / length, 1.0 / length
    for j in range(3):
        z[0, j], z[2, j] = q[1, j], q[5, j]
        z[1, j] = chord * (q[4, j] - q[0, j]) - 0.25 * (q[1, j] + q[5, j])
        for k in range(2):
            one, other = q[2 + k, j], q[6 + k, j]
            z[3 + 3 * k, j], z[5 + 3 * k, j] = one, other
            z[4 + 3 * k, j] = 0.5 * (one + other)
            z[9 + k, j] = rate * (other - one)


@compiled
def pull_levers(length: float, fz: Array, f: Array) -> None:
    """Forces ``f`` (8, 3) on the vectors of forces ``fz`` (11, 3) on the levers."""
    chord, rate = 1.5 / length, 1.0 / length
    for j in range(3):
        middle = fz[1, j]
        f[0, j], f[4, j] = -chord * middle, chord * middle
        f[1, j], f[5, j] = fz[0, j] - 0.25 * middle, fz[2, j] - 0.25 * middle
        for k in range(2):
            half, turned = 0.5 * fz[4 + 3 * k, j], rate * fz[9 + k, j]
            f[2 + k, j] = fz[3 + 3 * k, j] + half - turned
            f[6 + k, j] = fz[5 + 3 * k, j] + half + turned


@compiled
def find_strains(z: Array, e: Array) -> None:
    """Strains ``e`` (18,) of levers, without taking those of the unloaded cell off."""
    e[:] = 0.0
    for t in range(TERMS):
        a, b = _FIRST[t], _SECOND[t]
        product = z[a, 0] * z[b, 0] + z[a, 1] * z[b, 1] + z[a, 2] * z[b, 2]
        e[_STRAIN[t]] += _FACTOR[t] * product


@compiled
def pull_stress(z: Array, S: Array, fz: Array) -> None:
    """Forces ``fz`` (11, 3) on the levers of stress ``S`` (18,)."""
    fz[:] = 0.0
    for t in range(TERMS):
        a, b, s = _FIRST[t], _SECOND[t], _FACTOR[t] * S[_STRAIN[t]]
        for j in range(3):
            fz[a, j] += s * z[b, j]
            fz[b, j] += s * z[a, j]


@compiled
def lever_table(length: float, T: Array) -> None:
    """Levers of the vectors as a matrix, shape (11, 8)."""
    T[:] = 0.0
    chord, rate = 1.5 / length, 1.0 / length
    T[0, 1], T[2, 5] = 1.0, 1.0
    T[1, 0], T[1, 4], T[1, 1], T[1, 5] = -chord, chord, -0.25, -0.25
    for k in range(2):
        T[3 + 3 * k, 2 + k], T[5 + 3 * k, 6 + k] = 1.0, 1.0
        T[4 + 3 * k, 2 + k], T[4 + 3 * k, 6 + k] = 0.5, 0.5
        T[9 + k, 2 + k], T[9 + k, 6 + k] = -rate, rate


@compiled
def change_rows(z: Array, T: Array, B: Array) -> None:
    """``∂e/∂q``, shape (18, 8, 3)."""
    B[:] = 0.0
    for t in range(TERMS):
        k, a, b, s = _STRAIN[t], _FIRST[t], _SECOND[t], _FACTOR[t]
        for i in range(VECTORS):
            first, second = s * T[a, i], s * T[b, i]
            for j in range(3):
                B[k, i, j] += first * z[b, j] + second * z[a, j]


@compiled
def add_geometric(S: Array, T: Array, G: Array) -> None:
    """Add the matrix of stress ``S`` (18,), the same for each component, to ``G`` (8, 8)."""
    for t in range(TERMS):
        a, b, s = _FIRST[t], _SECOND[t], _FACTOR[t] * S[_STRAIN[t]]
        for i in range(VECTORS):
            for k in range(VECTORS):
                G[i, k] += s * (T[a, i] * T[b, k] + T[b, i] * T[a, k])

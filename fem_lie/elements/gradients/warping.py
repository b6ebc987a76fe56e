r"""Restrained warping of thin-walled sections (Vlasov): springs between the twists of elements.

A section of warping stiffness ``EI_ω`` that twists by ``κ₁`` per length is displaced along the
beam by ``κ₁ ω(y, z)``, and where that changes along the beam there is a bimoment ``−EI_ω κ₁'``::

    W = ½ ∫ EI_ω κ₁'² ds

The twist of an element from a to b is that of its strains, ``(r_y,b·r_z,a − r_y,a·r_z,b)/2ℓ``, its
change that from one to the next over the distance of their middles. Where warping is held the twist
is zero at the end, half an element away. So the amplitude of warping is no unknown.
(V. Z. Vlasov, *Thin-Walled Elastic Beams* (1961).)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.rods.springs import Springs
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, shift
from fem_lie.lie.kinds.kind import CROSSING, axes
from fem_lie.lie.tuples import load_row, rotate, rotate_back, store

_DATA = 36


class WarpingSprings(NamedTuple):
    """Changes of twist that cost energy.

    Attributes:
        nodes: CROSSING nodes in a row, shape (b, 3); at a held end the last two are the same.
        shares: ``1/2ℓ`` of both elements, zero for the second one at a held end, shape (b, 2).
        stiffness: ``EI_ω`` over the distance, shape (b,).
        natural: Change of twist of the unloaded beam, shape (b,).
    """

    nodes: Indices
    shares: Array
    stiffness: Array
    natural: Array

    @classmethod
    def between(
        cls, rows: Array, ends: Indices, lengths: Array, stiffness: float, held: Indices
    ) -> WarpingSprings:
        """Of a beam.

        Args:
            rows: Of all nodes, unloaded, shape (n, 4, 3).
            ends: CROSSING nodes of both ends of the elements, shape (m, 2).
            lengths: Of the elements, shape (m,).
            stiffness: ``EI_ω``.
            held: CROSSING nodes where warping is held.
        """
        first, second = np.nonzero(ends[:, 1, np.newaxis] == ends[np.newaxis, :, 0])
        last = np.flatnonzero(np.isin(ends, held).any(axis=1))
        once = np.isin(ends[last], held).sum(axis=1)
        last = np.repeat(last, once)
        nodes = np.concatenate(
            [np.column_stack([ends[first], ends[second, 1]]), ends[last][:, [0, 1, 1]]]
        )
        half = 0.5 / lengths
        shares = np.concatenate(
            [
                np.column_stack([half[first], half[second]]),
                np.column_stack([half[last], np.zeros(len(last))]),
            ]
        )
        middles = 0.5 * np.concatenate([lengths[first] + lengths[second], lengths[last]])
        y, z = rows[nodes, 1], rows[nodes, 2]
        twists = [
            np.einsum("bj,bj->b", y[:, k + 1], z[:, k])
            - np.einsum("bj,bj->b", y[:, k], z[:, k + 1])
            for k in range(2)
        ]
        natural = shares[:, 1] * twists[1] - shares[:, 0] * twists[0]
        return cls(nodes, shares, np.asarray(stiffness / middles), natural)

    @classmethod
    def joined(cls, parts: Sequence[WarpingSprings]) -> WarpingSprings:
        """All of several."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


@inlined
def _gradient(q: Array, data: Array, g: Array) -> None:
    """Derivative ``g`` (6, 3) of the change of twist, in ``r_y, r_z`` of the three nodes ``q``."""
    a, b = data[0], data[1]
    for j in range(3):
        g[0, j], g[1, j] = a * q[3, j], -a * q[2, j]
        g[2, j] = -b * q[5, j] - a * q[1, j]
        g[3, j] = b * q[4, j] + a * q[0, j]
        g[4, j], g[5, j] = b * q[3, j], -b * q[2, j]


@inlined
def _dot(a: Array, b: Array) -> float:
    total = 0.0
    for i in range(6):
        for j in range(3):
            total += a[i, j] * b[i, j]
    return total


@inlined
def _change(H: Array, data: Array, q: Array, g: Array) -> float:
    """Vectors, gradient, and the change of twist less that of the unloaded beam."""
    for i in range(6):
        store(q[i], 0, load_row(H[i // 2], 1 + i % 2))
    _gradient(q, data, g)
    return 0.5 * _dot(q, g) - data[3]


@inlined
def _pull(H: Array, g: Array, factor: float, out: Array) -> None:
    for i in range(6):
        d1, d2, d3 = axes(CROSSING, H[i // 2])
        local = rotate_back(d1, d2, d3, load_row(g, i))
        for k in range(3):
            out[i // 2, 3 * (i % 2) + k] += factor * local[k]


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """``W`` of a spring."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(shift(w, _DATA), (4,))
    q, g = numba.carray(stack(18), (6, 3)), numba.carray(stack(18), (6, 3))
    change, value = _change(H, data, q, g), numba.carray(A, (1,))
    value[0] += 0.5 * data[2] * change * change


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Its gradient."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(shift(w, _DATA), (4,))
    q, g = numba.carray(stack(18), (6, 3)), numba.carray(stack(18), (6, 3))
    change = _change(H, data, q, g)
    _pull(H, g, data[2] * change, numba.carray(A, (3, 6)))


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Its Hessian, column by column; the gradient is linear in the vectors."""
    H, data = numba.carray(w, (3, 4, 3)), numba.carray(shift(w, _DATA), (4,))
    q, g = numba.carray(stack(18), (6, 3)), numba.carray(stack(18), (6, 3))
    d, dg = numba.carray(stack(18), (6, 3)), numba.carray(stack(18), (6, 3))
    change, K = _change(H, data, q, g), numba.carray(A, (3, 6, 3, 6))
    for i in range(6):
        d1, d2, d3 = axes(CROSSING, H[i // 2])
        for k in range(3):
            unit = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
            d[:] = 0.0
            store(d[i], 0, rotate(d1, d2, d3, unit))
            _gradient(d, data, dg)
            column = K[:, :, i // 2, 3 * (i % 2) + k]
            _pull(H, g, data[2] * _dot(g, d), column)
            _pull(H, dg, data[2] * change, column)


class Warping(Springs):
    """Springs of restrained warping, on the nodes of their assembly."""

    label = "restrained warping"

    def __init__(self, springs: WarpingSprings, count: int) -> None:
        """Pack the springs, on the nodes of an assembly of so many."""
        values = np.column_stack([springs.shares, springs.stiffness, springs.natural])
        super().__init__((energy_kernel, force_kernel, matrix_kernel), values, springs, count)

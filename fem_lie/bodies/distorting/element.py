"""Element of beams with sections that distort: two frames, and modal nodes with amplitudes.

All strains are products of vectors at the midpoint: with directors ``d`` and their differences,
``Γ = (x′·d₁ − …, x′·d₂, x′·d₃)`` and ``κ = (d₂′·d₃, d₃′·d₁, d₁′·d₂)`` as in
:mod:`fem_lie.elements.beams.directors`, to second order in the rotation along an element;
amplitudes are products with constant unit vectors. The energy is that of
:mod:`fem_lie.sections.distortion.distortion`. One point does not lock, and leaves no amplitude
without energy. The strains (Γ, κ) have the residual bending flexibility of MacNeal.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback, inlined
from fem_lie.elements.beams.element import with_bending_flexibility
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.assembly import CellFunctions
from fem_lie.forms.small_energy.cell import (
    add_energy,
    add_forces,
    add_tangent_at_stress,
    update_stress,
)
from fem_lie.forms.small_energy.element import (
    PACKED_SIGNATURE,
    Element,
    cell_data,
    element,
    unpacked,
)
from fem_lie.lie.node_types.node_type import NodeType
from fem_lie.sections.distortion.distortion import AXIS, products_of_strains

PER_NODE = 6
"""Amplitudes of a modal node."""

_DX, _D, _DD, _ROWS = 0, 1, 4, 7
"""First index of the vectors: ``x′``, directors, their derivatives, amplitudes and their rates."""


def modal_nodes(count: int) -> int:
    """Number of modal nodes for a number of amplitudes.

    Args:
        count: Number of amplitudes.
    """
    return -(-count // PER_NODE)


def element_of(count: int) -> Element:
    """Element of cells with the frames of both ends, then the modal nodes of both.

    Args:
        count: Number of amplitudes of a section.
    """
    modal = modal_nodes(count)
    constant = _ROWS + 4 * modal
    products = [(k, _DX, _D + k, 1.0) for k in range(3)]
    products += [(3 + k, _DD + (k + 1) % 3, _D + (k + 2) % 3, 1.0) for k in range(3)]
    for of_strain, first in ((AXIS, _ROWS + 2 * modal), (AXIS + count, _ROWS)):
        products += [(of_strain + k, first + k // 3, constant + k % 3, 1.0) for k in range(count)]
    return element(
        [NodeType.FRAME] * 2 + [NodeType.MODAL] * (2 * modal),
        products,
        vectors=constant,
        strains=AXIS + 2 * count,
        constants=3,
        pairs=products_of_strains(count),
    )


def data_of(
    of: Element, frames: Array, lengths: Array, stiffness: Array, second_order: Array
) -> Array:
    """Data of cells.

    Args:
        of: Element.
        frames: Unloaded frames of both ends, shape (m, 2, 4, 3).
        lengths: Unloaded lengths of the cells, shape (m,).
        stiffness: Stiffness on the strains (Γ, κ, a′, a), shape (m, s, s).
        second_order: Factors of the stress of second order, shape (m, c, s).
    """
    m, strains = stiffness.shape[:2]
    T = _tables(lengths, len(of.cells.types) // 2 - 1)
    z = np.einsum("mvr,mrj->mvj", T[:, 0, :_ROWS, :8], frames.reshape(m, 8, 3))
    natural = np.zeros((m, strains))
    natural[:, :3] = np.einsum("mj,mkj->mk", z[:, _DX], z[:, _D:_DD])
    for k in range(3):
        pair = z[:, _DD + (k + 1) % 3], z[:, _D + (k + 2) % 3]
        natural[:, 3 + k] = np.einsum("mj,mj->m", *pair)
    softer = lengths[:, np.newaxis, np.newaxis] * _flexible(stiffness, lengths)
    factors = lengths[:, np.newaxis] * second_order.reshape(m, -1)
    parameters = np.concatenate([natural, softer.reshape(m, -1), factors], axis=1)
    unit = np.broadcast_to(np.eye(3), (m, 1, 3, 3))
    return cell_data(of, T, parameters[:, np.newaxis], constants=unit)


def _tables(lengths: Array, modal: int) -> Array:
    """Vectors at the midpoint from those of the nodes, shape (m, 1, vectors, r)."""
    m, rate = len(lengths), 1.0 / lengths
    first = 8  # vectors of both frames: x and three directors each
    T = np.zeros((m, 1, _ROWS + 4 * modal, first + 4 * modal))
    T[:, 0, _DX, 0], T[:, 0, _DX, 4] = -rate, rate
    for k in range(3):
        T[:, 0, _D + k, [1 + k, 5 + k]] = 0.5
        T[:, 0, _DD + k, 1 + k], T[:, 0, _DD + k, 5 + k] = -rate, rate
    for k in range(2 * modal):
        a, b = first + k, first + 2 * modal + k
        T[:, 0, _ROWS + k, [a, b]] = 0.5
        T[:, 0, _ROWS + 2 * modal + k, a], T[:, 0, _ROWS + 2 * modal + k, b] = -rate, rate
    return T


def _flexible(stiffness: Array, lengths: Array) -> Array:
    """Stiffness with the residual bending flexibility of the strains (Γ, κ), shape (m, s, s)."""
    scale = 1.0 / np.sqrt(np.einsum("mii->mi", stiffness))
    scales = scale[:, :, np.newaxis] * scale[:, np.newaxis]
    C = scales * np.linalg.inv(scales * stiffness)
    own = C[:, :AXIS, :AXIS]
    along = lengths[:, np.newaxis] * np.eye(1, 6)
    C[:, :AXIS, :AXIS] = np.linalg.inv(with_bending_flexibility(np.linalg.inv(own), along))
    found = np.linalg.inv(C / scales) / scales
    return np.asarray(0.5 * (found + found.swapaxes(1, 2)))


@inlined
def _element_at(c: Pointer) -> Element:
    """Element whose constants are at the address ``c``."""
    return Element(unpacked(c), None, None, None, ((), (), (), ()), 1)


@callback(PACKED_SIGNATURE)
def energy_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Energy of a cell."""
    add_energy(_element_at(c), A, w)


@callback(PACKED_SIGNATURE)
def forces_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Forces of a cell."""
    add_forces(_element_at(c), A, w)


@callback(PACKED_SIGNATURE)
def tangent_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Tangent stiffness of a cell."""
    add_tangent_at_stress(_element_at(c), A, w)


@callback(PACKED_SIGNATURE)
def stress_of_cell(A: Pointer, w: Pointer, c: Pointer, h: Pointer) -> None:
    """Linearised stress of a cell."""
    update_stress(_element_at(c), A, w, h)


FUNCTIONS = CellFunctions(energy_of_cell, forces_of_cell, tangent_of_cell, stress_of_cell)

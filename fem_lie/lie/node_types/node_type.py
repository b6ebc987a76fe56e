"""Node types, and the functions in which they differ: compiled, for one node.

The type of a node is an integer: ``group + 2 · parametrisation`` for a frame, which is less than
:data:`POSITION_GRADIENT`, or a member of :class:`NodeType`. A node that is not a frame has one or
two coordinate vectors, :func:`vector_count` rows of its coordinates ``H`` from row
:func:`first_vector` on; their increments add, and ``v`` holds their rates along the node's axes.
The other rows of ``H`` have no inertia and take no force; they only define the axes along which the
equations are written. To add a node type, give it a number, a line in :data:`TRAITS` and a branch
in each function of this module.
"""

from __future__ import annotations

from enum import IntEnum
from math import sqrt
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.copies import copy_matrix
from fem_lie.lie.motions import Parametrisation
from fem_lie.lie.series import exponential, rotation_vector
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)

POSITION_GRADIENT, POSITION, SURFACE_GRADIENT, MIXED_DERIVATIVE, MODAL = 4, 5, 6, 7, 8
"""Node types that are not frames; the numbers of frames are smaller."""
WITH_GRADIENTS = POSITION_GRADIENT, SURFACE_GRADIENT, MIXED_DERIVATIVE
"""Node types whose velocity is more than a translation and a rotation."""

_OPPOSITE = 1e-12  # 1 + cosine: there is no smallest rotation to the opposite direction


class NodeType(IntEnum):
    """Type of a node: the meaning of its coordinates ``H`` and of its unknowns."""

    FRAME = 0
    POSITION_GRADIENT = POSITION_GRADIENT
    POSITION = POSITION
    SURFACE_GRADIENT = SURFACE_GRADIENT
    MIXED_DERIVATIVE = MIXED_DERIVATIVE
    MODAL = MODAL


class Traits(NamedTuple):
    """Properties of a node type.

    Attributes:
        unknowns: Number of unknowns.
        rows: Rows of ``H`` with inertia and forces.
        clamp_holds: Unknowns that a clamp holds at zero, so that position and direction are kept,
            shape (6,).
        description: Coordinates of such nodes, for messages.
    """

    unknowns: int
    rows: range
    clamp_holds: tuple[bool, ...]
    description: str


_SURFACES = "positions and surface gradients"

TRAITS = MappingProxyType(
    {
        NodeType.FRAME: Traits(6, range(4), (True,) * 6, "frames"),
        # the length of x' is the axial stretch, and stays free
        NodeType.POSITION_GRADIENT: Traits(
            6, range(2), (True,) * 3 + (False, True, True), "positions and position gradients"
        ),
        NodeType.POSITION: Traits(3, range(1), (True,) * 6, "positions"),
        NodeType.SURFACE_GRADIENT: Traits(
            6, range(2), (True,) * 3 + (False, False, True), _SURFACES
        ),
        NodeType.MIXED_DERIVATIVE: Traits(6, range(1, 3), (False, False, True) * 2, _SURFACES),
        NodeType.MODAL: Traits(6, range(1, 3), (False,) * 6, "modal amplitudes"),
    }
)


def node_types_of(nodes: Indices, groups: Indices, parametrisation: Parametrisation) -> Indices:
    """Type number of each node, shape (n,).

    Args:
        nodes: :class:`NodeType` of each node, shape (n,).
        groups: Group of each node, shape (n,); only those of frames are used.
        parametrisation: Parametrisation of the rotations of frames.
    """
    frames = groups + 2 * int(parametrisation)
    return np.where(nodes == NodeType.FRAME, frames, nodes).astype(np.int64)


def at_rest(node_types: Indices) -> Indices:
    """Node types with all frames on SE(3), where the acceleration is the rate of the twist."""
    return np.where(node_types < POSITION_GRADIENT, 0, node_types)


def on_r3(node_types: Indices) -> Flags:
    """Mask of the nodes that are frames on R³×SO(3), shape (n,)."""
    return np.asarray((node_types < POSITION_GRADIENT) & (node_types & 1 == 1))


def has_position(node_types: Indices) -> Flags:
    """Mask of the nodes that have a position of their own, shape (n,)."""
    return np.asarray(node_types < MIXED_DERIVATIVE)


@inlined
def vector_count(node_type: int) -> int:
    """Number of coordinate vectors of a node that is not a frame."""
    return 1 if node_type == POSITION else 2


@inlined
def first_vector(node_type: int) -> int:
    """Row of ``H`` with the first coordinate vector: 0, or 1 if row 0 is only a copy."""
    return 1 if node_type >= MIXED_DERIVATIVE else 0


@inlined
def axes(node_type: int, H: Array) -> tuple[Vector, Vector, Vector]:
    """Orthonormal axes of the node, in global components."""
    if node_type == MODAL:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    if node_type == MIXED_DERIVATIVE:
        _, e1, e2, e3 = exponential((0.0, 0.0, 0.0), load_row(H, 3))
        return e1, e2, e3
    second, third = load_row(H, 2), load_row(H, 3)
    if node_type == SURFACE_GRADIENT:
        return cross(second, third), second, third
    along = load_row(H, 1)
    if node_type == POSITION_GRADIENT:
        along = _unit(along)
    return along, second, third


@inlined
def set_axes(node_type: int, H: Array, e1: Vector, e2: Vector, e3: Vector) -> None:
    """Rotate the axes of a node to ``(e₁, e₂, e₃)``, unless its coordinate vectors determine them.

    Coordinates of frames and position-gradient nodes determine their axes; those of modal nodes are
    the global axes.
    """
    if node_type == MODAL:
        return
    if node_type == MIXED_DERIVATIVE:
        store_row(H, 3, rotation_vector(e1, e2, e3))
        return
    if node_type == POSITION:
        store_row(H, 1, e1)
    store_row(H, 2, e2)
    store_row(H, 3, e3)


@inlined
def second_vector(node_type: int, H: Array) -> Vector:
    """Second coordinate vector of a node that is not a frame; zero if there is none."""
    if node_type == POSITION:
        return 0.0, 0.0, 0.0
    return load_row(H, first_vector(node_type) + 1)


@inlined
def axes_spin(node_type: int, H: Array, rate: Vector) -> Vector:
    """Angular velocity of the node's axes, in these axes, at the rate ``v[3:]`` of ``x'``.

    The axes of a position-gradient node rotate with ``e₁ × Rᵀẋ' / |x'|``; those of all others are
    constant.
    """
    if node_type != POSITION_GRADIENT:
        return 0.0, 0.0, 0.0
    slope = load_row(H, 1)
    factor = 1.0 / sqrt(dot(slope, slope))
    return 0.0, -rate[2] * factor, rate[1] * factor


@compiled
def add_increment(node_type: int, H: Array, d: Array, out: Array) -> None:
    """Add the increment ``d`` (6,) to the coordinate vectors of a node that is not a frame.

    The axes of a position-gradient node rotate by the smallest rotation between the tangents.
    """
    if node_type != POSITION_GRADIENT:
        at = first_vector(node_type)
        copy_matrix(H, out)
        for k in range(vector_count(node_type)):
            store_row(out, at + k, plus(load_row(H, at + k), load(d, 3 * k)))
        return
    old, second, new = load_row(H, 1), load_row(H, 2), plus(load_row(H, 1), load(d, 3))
    old, tangent = _unit(old), _unit(new)
    # the smallest rotation between the tangents, orthonormal to round-off
    along = dot(second, tangent) / max(1.0 + dot(old, tangent), _OPPOSITE)
    second = minus(second, scaled(along, plus(old, tangent)))
    second = _unit(minus(second, scaled(dot(second, tangent), tangent)))
    store_row(out, 0, plus(load_row(H, 0), load(d, 0)))
    store_row(out, 1, new)
    store_row(out, 2, second)
    store_row(out, 3, cross(tangent, second))


@inlined
def _unit(a: Vector) -> Vector:
    return scaled(1.0 / sqrt(dot(a, a)), a)

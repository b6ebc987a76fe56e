r"""What a kind of node is, and all in which nodes that are no frames differ: compiled, one node.

A number says which kind a node is: ``group + 2 · parametrisation`` of a frame, below :data:`SLOPE`,
or one of :class:`NodeKind`. Of the others some rows of ``H``, :func:`straight` of them from
:func:`first` on, have increments that add, and ``v`` is their rates along the node's axes; the
other rows are carried along, have no inertia and feel no force, and only say in which components
the equations are written. To add such a kind: a number, its traits, and its branch in each of the
functions here.
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

SLOPE, POINT, SURFACE, CROSSING, AMPLITUDE = 4, 5, 6, 7, 8
"""Numbers of the kinds that are no frames; all frames have smaller ones."""

_OPPOSITE = 1e-12  # 1 + cosine: there is no smallest rotation to the opposite direction


class NodeKind(IntEnum):
    """What a body's nodes are."""

    FRAME = 0
    SLOPE = SLOPE
    POINT = POINT
    SURFACE = SURFACE
    CROSSING = CROSSING
    AMPLITUDE = AMPLITUDE


class Traits(NamedTuple):
    """What is known of a kind of node beforehand.

    Attributes:
        unknowns: How many it has.
        rows: Which rows of ``H`` have inertia and take forces.
        clamped: Which unknowns are zero where place and direction do not change, shape (6,).
        what: Such nodes have, for messages.
    """

    unknowns: int
    rows: range
    clamped: tuple[bool, ...]
    what: str


_SURFACES = "places and slopes of a surface"

TRAITS = MappingProxyType(
    {
        NodeKind.FRAME: Traits(6, range(4), (True,) * 6, "frames"),
        # the slope's length is stretch, and stays free
        NodeKind.SLOPE: Traits(6, range(2), (True,) * 3 + (False, True, True), "places and slopes"),
        NodeKind.POINT: Traits(3, range(1), (True,) * 6, "places"),
        NodeKind.SURFACE: Traits(6, range(2), (True,) * 3 + (False, False, True), _SURFACES),
        NodeKind.CROSSING: Traits(6, range(1, 3), (False, False, True) * 2, _SURFACES),
        NodeKind.AMPLITUDE: Traits(6, range(1, 3), (False,) * 6, "amplitudes of shapes"),
    }
)


def kinds_of(nodes: Indices, groups: Indices, parametrisation: Parametrisation) -> Indices:
    """The number of each node: ``nodes`` are :class:`NodeKind`, ``groups`` those of frames."""
    frames = groups + 2 * int(parametrisation)
    return np.where(nodes == NodeKind.FRAME, frames, nodes).astype(np.int64)


def at_rest(kinds: Indices) -> Indices:
    """The same with all frames on SE(3), where acceleration is the rate of the twist."""
    return np.where(kinds < SLOPE, 0, kinds)


def on_r3(kinds: Indices) -> Flags:
    """Which nodes are frames on R³×SO(3)."""
    return np.asarray((kinds < SLOPE) & (kinds & 1 == 1))


def placed(kinds: Indices) -> Flags:
    """Which nodes have a place of their own."""
    return np.asarray(kinds < CROSSING)


@inlined
def straight(kind: int) -> int:
    """How many rows of a node that is no frame have increments that add."""
    return 1 if kind == POINT else 2


@inlined
def first(kind: int) -> int:
    """Which row is the first of these: the place, unless another node has it."""
    return 1 if kind >= CROSSING else 0


@inlined
def axes(kind: int, H: Array) -> tuple[Vector, Vector, Vector]:
    """The node's own axes, unit vectors in global components."""
    if kind == AMPLITUDE:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    if kind == CROSSING:
        _, e1, e2, e3 = exponential((0.0, 0.0, 0.0), load_row(H, 3))
        return e1, e2, e3
    second, third = load_row(H, 2), load_row(H, 3)
    if kind == SURFACE:
        return cross(second, third), second, third
    along = load_row(H, 1)
    if kind == SLOPE:
        along = _unit(along)
    return along, second, third


@inlined
def set_axes(kind: int, H: Array, e1: Vector, e2: Vector, e3: Vector) -> None:
    """Turn the axes of a node whose straight rows do not say them: of all but frames and slopes.

    Amplitudes have none that could turn.
    """
    if kind == AMPLITUDE:
        return
    if kind == CROSSING:
        store_row(H, 3, rotation_vector(e1, e2, e3))
        return
    if kind == POINT:
        store_row(H, 1, e1)
    store_row(H, 2, e2)
    store_row(H, 3, e3)


@inlined
def slope(kind: int, H: Array) -> Vector:
    """The second straight row of a node that is no frame, zero if there is none."""
    if kind == POINT:
        return 0.0, 0.0, 0.0
    return load_row(H, first(kind) + 1)


@inlined
def turning(kind: int, H: Array, rate: Vector) -> Vector:
    """Angular velocity of the axes, in them, for the ``rate`` ``v[3:]``.

    Those of a slope have ``e₁ × Rᵀẋ' / |x'|``, all others keep their directions.
    """
    if kind != SLOPE:
        return 0.0, 0.0, 0.0
    first = load_row(H, 1)
    stretch = 1.0 / sqrt(dot(first, first))
    return 0.0, -rate[2] * stretch, rate[1] * stretch


@compiled
def carry(kind: int, H: Array, d: Array, out: Array) -> None:
    """The node ``H`` that is no frame moved by ``d``; axes of slopes by the smallest rotation."""
    if kind != SLOPE:
        at = first(kind)
        copy_matrix(H, out)
        for k in range(straight(kind)):
            store_row(out, at + k, plus(load_row(H, at + k), load(d, 3 * k)))
        return
    old, beside, new = load_row(H, 1), load_row(H, 2), plus(load_row(H, 1), load(d, 3))
    old, tangent = _unit(old), _unit(new)
    # the smallest rotation between the tangents, set right to round-off
    along = dot(beside, tangent) / max(1.0 + dot(old, tangent), _OPPOSITE)
    beside = minus(beside, scaled(along, plus(old, tangent)))
    beside = _unit(minus(beside, scaled(dot(beside, tangent), tangent)))
    store_row(out, 0, plus(load_row(H, 0), load(d, 0)))
    store_row(out, 1, new)
    store_row(out, 2, beside)
    store_row(out, 3, cross(tangent, beside))


@inlined
def _unit(a: Vector) -> Vector:
    return scaled(1.0 / sqrt(dot(a, a)), a)

r"""What a kind of node is, and all in which nodes that are no frames differ: compiled, one node.

A number says which kind a node is: ``group + 2 · parametrisation`` of a frame, below :data:`SLOPE`,
or one of :class:`NodeKind`. Of the others the first rows of ``H``, :func:`straight` of them, have
increments that add, and ``v`` is their rates along the node's axes; the rows after these are
carried along, have no inertia and feel no force, and only say in which components the equations are
written. To add such a kind: a number, its traits, and its branch in each of the functions here.
"""

from __future__ import annotations

from enum import IntEnum
from math import sqrt
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.motions import Parametrisation
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store_frame,
    store_row,
)

SLOPE, POINT = 4, 5
"""Numbers of the kinds that are no frames; all frames have smaller ones."""

_OPPOSITE = 1e-12  # 1 + cosine: there is no smallest rotation to the opposite direction


class NodeKind(IntEnum):
    """What a body's nodes are."""

    FRAME = 0
    SLOPE = SLOPE
    POINT = POINT


class Traits(NamedTuple):
    """What is known of a kind of node beforehand.

    Attributes:
        unknowns: How many it has.
        rows: How many of the rows of ``H`` have inertia and take forces.
        clamped: Which unknowns are zero where place and direction do not change, shape (6,).
        what: Such nodes have, for messages.
    """

    unknowns: int
    rows: int
    clamped: tuple[bool, ...]
    what: str


TRAITS = MappingProxyType(
    {
        NodeKind.FRAME: Traits(6, 4, (True,) * 6, "frames"),
        # the slope's length is stretch, and stays free
        NodeKind.SLOPE: Traits(6, 2, (True, True, True, False, True, True), "places and slopes"),
        NodeKind.POINT: Traits(3, 1, (True,) * 6, "places"),
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


@inlined
def straight(kind: int) -> int:
    """How many rows of a node that is no frame have increments that add."""
    return 2 if kind == SLOPE else 1


@inlined
def axes(kind: int, H: Array) -> tuple[Vector, Vector, Vector]:
    """The node's own axes, unit vectors in global components."""
    first = load_row(H, 1)
    if kind == SLOPE:
        first = _unit(first)
    return first, load_row(H, 2), load_row(H, 3)


@inlined
def slope(kind: int, H: Array) -> Vector:
    """The second straight row of a node that is no frame, zero if there is none."""
    return load_row(H, 1) if kind == SLOPE else (0.0, 0.0, 0.0)


@inlined
def turning(kind: int, H: Array, rate: Vector) -> Vector:
    """Angular velocity of the axes, in them, for the ``rate`` ``v[3:]``.

    Those of a slope have ``e₁ × Rᵀẋ' / |x'|``, those of a point keep their directions.
    """
    if kind != SLOPE:
        return 0.0, 0.0, 0.0
    first = load_row(H, 1)
    stretch = 1.0 / sqrt(dot(first, first))
    return 0.0, -rate[2] * stretch, rate[1] * stretch


@compiled
def carry(kind: int, H: Array, d: Array, out: Array) -> None:
    """The node ``H`` that is no frame moved by ``d``; axes of slopes by the smallest rotation."""
    if kind == POINT:
        store_frame(out, plus(load_row(H, 0), load(d, 0)), *axes(kind, H))
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

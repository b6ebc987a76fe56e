"""The local error of one step, and where in the scene it is largest."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.lie.kinds import floating, inertia, pull_all
from fem_lie.lie.tuples import dot, load

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


class StepError(NamedTuple):
    """Largest errors of one step over all nodes.

    Attributes:
        translation: Of positions, length.
        rotation: Of rotations, rad, and of position gradients.
        translation_node: The moving node with the first; ``rotation_node``: with the second.
    """

    translation: float
    rotation: float
    translation_node: int
    rotation_node: int


@compiled
def largest(e: Array, lengths: Flags) -> tuple[float, float, int, int]:
    """Largest norms of the halves of errors (n, 6) that are lengths and of others, and their nodes.

    ``lengths`` (n, 2) are which halves are.
    """
    translation = rotation = 0.0
    first = second = 0
    for i in range(e.shape[0]):
        for half in range(2):
            part = load(e[i], 3 * half)
            square = dot(part, part)
            if lengths[i, half]:
                if square > translation or square != square:  # nan stays
                    translation, first = square, i
            elif square > rotation or square != square:
                rotation, second = square, i
    return np.sqrt(translation), np.sqrt(rotation), first, second


def add_inertia_forces(
    equations: Equations, H: Array, q: Array, factor: float, forces: Array
) -> None:
    """Add ``factor Lᵀ G q`` at frames ``H``: ``q`` (n, 4, 3), ``forces`` (n, 6).

    Reduced-order bodies are felt by rows that change as ``q`` says, from rest.
    """
    work, kinds = np.empty_like(q), equations.unknowns.kinds
    indptr, indices, blocks = equations.tables.inertia
    inertia.multiply(indptr, indices, blocks, q, work)
    bodies, numbers = equations.tables.floating
    if bodies[0]:
        _add_floating(kinds, H, q, bodies, numbers, work)
    pull_all(kinds, H, work, factor, forces.reshape(-1))


@compiled
def _add_floating(
    kinds: Indices, H: Array, q: Array, integers: Indices, numbers: Array, out: Array
) -> None:
    """Add inertia of reduced-order bodies whose rows accelerate by ``q``, without their weight."""
    still, with_weight = np.zeros((q.shape[0], 6)), np.zeros_like(q)
    floating.add_forces(kinds, H, still, q, integers, numbers, out)
    floating.add_forces(kinds, H, still, np.zeros_like(q), integers, numbers, with_weight)
    out -= with_weight


def largest_gaps(H: Array, other: Array) -> tuple[float, float]:
    """Largest distances and angles between frames of the same nodes, shape (n, 4, 3)."""
    gap = np.linalg.norm(other[:, 0] - H[:, 0], axis=1).max()
    turned = lie.se3_relative(H, other)[:, 3:]
    return float(gap), float(np.linalg.norm(turned, axis=1).max())

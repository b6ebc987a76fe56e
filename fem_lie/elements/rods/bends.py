"""Rotational springs between successive edges of discrete rods: bending without frames.

For edges ``e`` and ``f`` at an angle ``φ``, the curvature over the length ``ℓ``, half of both
edges, is that of ``κb = 2 e × f/(|e||f| + e·f)``, whose norm is ``2 tan φ/2``::

    W = ½ EI/ℓ (|κb| − κ₀)²,    |κb|² = 4 (1 − x)/(1 + x),    x = e·f/(|e||f|)

with the natural curvature ``κ₀``, which has no direction. (Bergou, Wardetzky, Robinson, Audoly &
Grinspun, *ACM Trans. Graph.* 27 (2008) 63; Jawed, Novelia & O'Reilly, *A Primer on the Kinematics
of Discrete Elastic Rods*, 2018.) At a clamped end ``e`` is fixed in space, and ``ℓ`` is half of
``f``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled
from fem_lie.forms.cell_sums import CellSum, CellTerm, Pattern
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.cell import add_energy, add_forces, add_tangent
from fem_lie.forms.small_energy.element import CELL_SIGNATURE, cell_data, element
from fem_lie.lie.node_types.node_type import NodeType


class _Data(Protocol):
    @property
    def nodes(self) -> Indices:
        """Nodes of each spring, shape (b, 3)."""


class Springs(CellTerm):
    """Term of springs: energy, forces and matrix summed over springs.

    Attributes:
        springs: Record of the springs.
    """

    of_bodies = True

    def __init__(self, kernels: Sequence[Any], values: Array, springs: _Data, count: int) -> None:
        """Bind the kernels.

        Args:
            kernels: Compiled functions for energy, forces and matrix.
            values: Data of each spring behind the coordinates of its nodes, shape (b, any).
            springs: Record of the springs.
            count: Number of nodes of the assembly.
        """
        nodes, data = springs.nodes, np.ascontiguousarray(values, dtype=np.float64)
        none = np.zeros(1), np.zeros((len(nodes), 1))
        self._energy, self._forces, self._matrix = (
            CellSum(nodes, kernel.address, data, *none, written=12 * nodes.shape[1])
            for kernel in kernels
        )
        self._pattern = Pattern.of(nodes, count)
        self.springs = springs

    @property
    def contents(self) -> _Data:
        """Record of the springs."""
        return self.springs


_STRAIGHT = 1e-12
"""Natural ``|κb|`` below which a line is straight up to round-off."""


class Successive(NamedTuple):
    """Pairs of successive edges.

    Attributes:
        nodes: Ends of the first edge and of the second one, which starts where the first ends,
            shape (b, 3).
        edges: Both edges, shape (b, 2).
    """

    nodes: Indices
    edges: Indices


class Bends(NamedTuple):
    """Rotational springs between edges.

    Attributes:
        nodes: As of :class:`Successive`; at a clamped end the first two are equal.
        stiffness: ``EI/ℓ``, shape (b,), N m.
        natural: ``κ₀``, shape (b,).
        fixed: First edges where they are fixed in space, zero elsewhere, shape (b, 3).
        laid: Initial lengths of both edges, shape (b, 2).
    """

    nodes: Indices
    stiffness: Array
    natural: Array
    fixed: Array
    laid: Array

    @classmethod
    def between(
        cls, positions: Array, along: Successive, flexibility: Array, natural: bool
    ) -> Bends:
        """Springs between successive edges.

        Args:
            positions: Initial positions of the nodes, shape (n, 3).
            along: Pairs of edges.
            flexibility: ``ℓ/EI`` of each edge, shape (m,).
            natural: Whether the initial curvature is the natural one.
        """
        e, f = np.diff(positions[along.nodes], axis=1).swapaxes(0, 1)
        u, v = (a / np.linalg.norm(a, axis=1, keepdims=True) for a in (e, f))
        size = 2 * np.linalg.norm(u - v, axis=1) / np.linalg.norm(u + v, axis=1)
        stiffness = 2.0 / flexibility[along.edges].sum(axis=1)
        own: Array = np.where(size > _STRAIGHT, size, 0.0) if natural else np.zeros(len(size))
        laid = np.stack([np.linalg.norm(a, axis=1) for a in (e, f)], axis=1)
        return cls(along.nodes, np.asarray(stiffness), own, np.zeros_like(e), laid)

    @classmethod
    def at_ends(cls, nodes: Indices, fixed: Array, flexibility: Array) -> Bends:
        """Springs at clamped ends, over half of their edges.

        Args:
            nodes: End node, and the other node of its edge, shape (b, 2).
            fixed: Fixed first edges, as long as the edges at the ends, shape (b, 3).
            flexibility: ``ℓ/EI`` of the edges, shape (b,).
        """
        # as long as the adjacent edges
        laid = np.repeat(np.linalg.norm(fixed, axis=1)[:, np.newaxis], 2, axis=1)
        stiffness = np.asarray(2.0 / flexibility)
        return cls(nodes[:, [0, 0, 1]], stiffness, np.zeros(len(nodes)), fixed, laid)

    @classmethod
    def joined(cls, parts: Sequence[Bends]) -> Bends:
        """Concatenation of several records."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _vectors(bends: Bends) -> tuple[Array, Array]:
    """``T`` and ``z₀`` of ``e/|e|`` and ``f/|f| − e/|e|``, with initial lengths of edges.

    For a straight initial line the second vector is zero, so that its products lose no digits.
    """
    e, f = (1.0 / size[:, np.newaxis] for size in bends.laid.T)
    free = (np.linalg.norm(bends.fixed, axis=1, keepdims=True) == 0).astype(float)
    first = e * free * [-1.0, 1.0, 0.0]
    tables = np.stack([first, f * [0.0, -1.0, 1.0] - first], axis=1)
    constant = np.stack([e * bends.fixed, -e * bends.fixed], axis=1)
    return tables[:, np.newaxis], constant[:, np.newaxis]


@compiled
def _squared_curvature(products: tuple[float, ...], parameters: tuple[float, ...]) -> tuple[float]:
    """Squared curvature ``|κb|²`` from the products."""
    ee, eg, gg = products
    along = ee + eg
    sum_ = math.sqrt(ee * (ee + 2.0 * eg + gg)) + along
    return (4.0 * (ee * gg - eg * eg) / (sum_ * sum_),)


@compiled
def _bending(strains: tuple[float, ...], parameters: tuple[float, ...]) -> float:
    """Energy ``½ EI/ℓ (|κb| − κ₀)²``; smooth and isotropic at a straight line."""
    stiffness, natural = parameters
    if natural > 0.0:
        if strains[0] > 0.0:
            change = math.sqrt(strains[0]) - natural
            return 0.5 * stiffness * change * change
        return 0.5 * stiffness * natural * natural + 0.0 * strains[0]
    return 0.5 * stiffness * strains[0]


ELEMENT = element(
    [NodeType.POSITION] * 3,
    [(0, 0), (0, 1), (1, 1)],
    vectors=2,
    parameters=2,
    strain=_squared_curvature,
    law=_bending,
    offsets=True,
)


@callback(CELL_SIGNATURE)
def energy_of_spring(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Energy of a spring."""
    add_energy(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def forces_of_spring(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Forces of a spring."""
    add_forces(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_spring(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Tangent stiffness of a spring."""
    add_tangent(ELEMENT, A, w)


class BendingSprings(Springs):
    """Springs between the edges of discrete rods, on the nodes of their assembly."""

    label = "bending springs"

    def __init__(self, bends: Bends, count: int) -> None:
        """Pack the springs, on an assembly with ``count`` nodes."""
        tables, constant = _vectors(bends)
        parameters = np.column_stack([bends.stiffness, bends.natural])[:, np.newaxis]
        values = cell_data(ELEMENT, tables, parameters, offsets=constant)
        functions = energy_of_spring, forces_of_spring, tangent_of_spring
        super().__init__(functions, values, bends, count)
        self._matrix.used = 3

"""Drilling of six-parameter shells: how stiff, on which nodes, and as a term of its own.

Its energy is in :mod:`fem_lie.elements.shells.drilling_sums`.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum, auto

import basix
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.elements.shells.drilling_sums import (
    PlainShapes,
    add_forces,
    add_tangent,
    cell_data,
    energy_kernel,
    force_kernel,
    strains,
)
from fem_lie.forms.abilities import LinearisedStress
from fem_lie.forms.cell_forms import FormTable
from fem_lie.forms.cell_sums import CellSum
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.motions import add_turnings
from fem_lie.mesh.shapes import rule, tabulated

FRACTION = 0.01
"""γ over ``G t³/h²``; from 1 to 1e-8 nothing changes (docs/six_parameters.md)."""

_SHEAR, _TWIST = 2, 5  # of the eight strains


class Parameters(Enum):
    """Unknowns of the nodes of a shell.

    ``AUTOMATIC``: five, or six where something needs the sixth: a joint, link, prescribed motion or
    moment that takes hold of the rotation of a node, a kink or a branch. ``FIVE``: a place and a
    director. ``FIVE_CARRIED``: the same, and the frames are turned about their directors as the
    mid-surface turns, after each time step: nothing depends on it but how long a matrix can be
    kept. ``SIX``: whole frames.
    """

    AUTOMATIC = auto()
    FIVE = auto()
    FIVE_CARRIED = auto()
    SIX = auto()


def drilling_stiffness(
    stiffness: Array, areas: Array, cells: Indices, bound: Iterable[int]
) -> Array:
    """γ of each cell, force per length, shape (m,).

    Args:
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        areas: Of the cells, shape (m,).
        cells: Nodes of each cell, shape (m, k).
        bound: Nodes that take moments about their normals alone.
    """
    membrane = stiffness[:, _SHEAR, _SHEAR]
    soft = FRACTION * 12.0 * stiffness[:, _TWIST, _TWIST] / areas
    around = np.isin(cells, list(bound)).any(axis=1)
    return np.where(around, membrane, np.minimum(soft, membrane))


class DrillingAssembly(Term, LinearisedStress):
    """Forces, tangent and energy on the nodes of an assembly of shells.

    Attributes:
        carried: Stress γ c at the points of integration, flat.
    """

    label, of_bodies, conserved = "drilling of shells with six parameters", True, True

    def __init__(
        self,
        frames: Array,
        cells: Indices,
        kind: basix.CellType,
        degree: int,
        quadrature_degree: int,
        directions: Array,
        stiffness: Array,
        pattern: tuple[Indices, Indices],
    ) -> None:
        """Evaluate the unloaded surface.

        Args:
            frames: Unloaded frames of the nodes, shape (n, 4, 3).
            cells: Nodes of each cell, shape (m, k).
            kind: Of the cells.
            degree: Of their edges.
            quadrature_degree: As of the element.
            directions: Vector of each cell whose projection onto the surface is the first axis.
            stiffness: γ of each cell, shape (m,).
            pattern: Rows and columns of the blocks of the tangent.
        """
        points, w = rule(kind.name, quadrature_degree)
        middle = np.asarray(basix.geometry(kind)).mean(axis=0, keepdims=True)
        table = tabulated(kind.name, degree, np.vstack([points, middle]))
        self._cells, N = cells.astype(np.int64), np.ascontiguousarray(table[0, :-1])
        tangents = np.einsum("agk,mkj->mgaj", table[1:], frames[cells, 0])
        normal = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        e2 = np.cross(normal, directions[:, np.newaxis])
        axes = np.stack([np.cross(e2, normal), e2], axis=2)
        axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
        inverse = np.linalg.inv(np.einsum("mgaj,mgbj->mgab", tangents, axes)[:, :-1])
        G = np.einsum("mgba,agk->mgbk", inverse, table[1:, :-1])
        # what nodes carry are the axes of the centre
        A = np.einsum("mbj,mkdj->mkbd", axes[:, -1], frames[cells, 1:])
        self._shapes: PlainShapes = N, G, A
        area = w * np.linalg.norm(normal[:, :-1], axis=-1)
        self._area, self._weight = area, area * stiffness[:, np.newaxis]
        self._gamma = stiffness[:, np.newaxis]
        self._rest, self._stress = np.zeros_like(area), np.zeros_like(area)
        self._change = np.zeros_like(area)
        self._rest[:] = self._strain(frames, np.zeros((len(frames), 6)))[0]
        indptr, indices = pattern
        key = np.repeat(np.arange(len(frames)), np.diff(indptr)) * len(frames) + indices
        pairs = len(frames) * self._cells[:, :, np.newaxis] + self._cells[:, np.newaxis]
        self._place = np.searchsorted(key, pairs)
        rows = np.repeat(np.arange(len(frames)), np.diff(indptr))
        self._pairs = rows, indices.astype(np.int64)
        self._diagonal = np.flatnonzero(rows == indices)
        self._all = np.ones(len(frames), dtype=bool)
        data = cell_data(self._shapes, self._weight, self._rest)
        sizes = np.array(N.shape[::-1], dtype=np.float64)
        none = np.zeros((len(cells), 1))
        self._forces, self._energy = (
            CellSum(self._cells, kernel.address, data, sizes, none, apart=True)
            for kernel in (force_kernel, energy_kernel)
        )

    @property
    def stress_update(self) -> LinearisedStress:
        """The moments."""
        return self

    @property
    def carried(self) -> Array:
        """See the class; a view."""
        return self._stress.reshape(-1)

    def _strain(self, H: Array, h: Array) -> tuple[Array, Array]:
        c = np.empty_like(self._rest)
        strains(H, self._cells, self._shapes, self._rest, h.reshape(-1, 6), (c, self._change))
        return c, self._change

    @property
    def pairs(self) -> Pairs:
        """Those of the shells."""
        return self._pairs

    @property
    def over_cells(self) -> tuple[FormTable, FormTable]:
        """Of forces and of energy."""
        return self._forces.table, self._energy.table

    def room(self) -> Array:
        """For all forces."""
        return np.zeros((len(self._all), 6))

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H`` to ``out``, shape (n, 6)."""
        forces = self.room() if kept is None else kept
        forces[:] = 0.0
        add_forces(H, self._cells, self._shapes, self._rest, self._weight, forces)
        out += forces

    def energy(self, H: Array) -> float:
        """Stored energy."""
        c, _ = self._strain(H, np.zeros((len(H), 6)))
        return float(0.5 * np.sum(self._weight * c**2))

    def tangent(self, H: Array, kept: Array) -> Array:
        """Derivatives in twists, with the carried stress."""
        blocks = np.zeros((len(self._pairs[0]), 6, 6))
        factors = self._weight, self._area * self._stress
        add_tangent(H, self._cells, self._shapes, factors, self._place, blocks)
        add_turnings(kept, -1.0, self._diagonal, self._all, blocks)
        return blocks

    def restore(self, carried: Array) -> None:
        """See the base class."""
        self.carried[:] = carried

    def clear_stress(self) -> None:
        """See the base class."""
        self.carried[:] = 0.0

    def reset_stress(self, H: Array) -> None:
        """See the base class."""
        self.carry(H, np.zeros((len(H), 6)))

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on to the end of the increment ``h`` (n, 6) from frames ``H``."""
        c, change = self._strain(H, h)
        self._stress[:] = self._gamma * (c + change)

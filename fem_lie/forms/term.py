"""Terms: what adds forces, energy and a matrix to the equations of nodes, inertia and joints apart.

Elements, pressure, springs and damping are terms. Nobody who sums them up asks which they are: they
say themselves what they have, and how they may be summed.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.forms.abilities import (
    GroundForces,
    LinearisedStress,
    LocalUnknowns,
    LowRankTangent,
    PassageCheck,
    PathDependence,
    StepForces,
    ViscousForces,
)
from fem_lie.forms.cell_forms import FormTable

Pairs: TypeAlias = tuple[Indices, Indices]
"""First and second node of each pair that a matrix couples."""


@compiled
def add_at(target: Array, place: Indices, blocks: Array) -> None:
    """``target[place] += blocks``, of any square blocks.

    Raises:
        ValueError: There are not as many places as blocks: pairs have changed since these were
            found, and compiled code would read what is not there.
    """
    if place.shape[0] != blocks.shape[0]:
        raise ValueError("there must be a place for each block: the pairs of a term have changed")
    size = blocks.shape[1]
    for b in range(place.shape[0]):
        for k in range(size):
            for n in range(size):
                target[place[b], k, n] += blocks[b, k, n]


class PushedPieces(NamedTuple):
    """Straight pieces on which ``(x_j − x_i) × ½ (R_i + R_j) w`` acts, half of it on each end.

    Attributes:
        nodes: i and j of each piece, shape (s, 2).
        across: ``w`` at present, shape (s, 3).
    """

    nodes: Indices
    across: Array


class FollowingTable(NamedTuple):
    """Forces as a sum over cells, on nodes that follow those of the equations.

    Attributes:
        table: Of the cells.
        master: Of each node that the table numbers, shape (k,).
        offset: Frames of these in their master nodes' frames, shape (k, 4, 3).
    """

    table: FormTable
    master: Indices
    offset: Array


class NearCells(Protocol):
    """Forces of the cells that some nodes have."""

    def add_forces(self, H: Array, out: Array) -> None:
        """Add all forces on these nodes, and some on others, to ``out`` (≥ nodes that move, 6)."""


class CellMatrices(Protocol):
    """Matrices summed over cells, see :class:`~fem_lie.forms.cell_sums.CellSum`."""

    cells: npt.NDArray[np.integer[Any]]
    own_only: bool

    def choose(self, cells: Flags) -> None:
        """See there."""


class Term(ABC):
    """Forces on nodes, with the sign of a residual: those of an energy are its gradient.

    Forces and twists have components along the nodes' axes; nodes are rows of frames ``H``, of
    which the first may move.

    Attributes:
        label: What messages call it.
        version: Of :attr:`pairs`; another number means other pairs. They may change when forces
            are asked for, and the tangent that is asked for afterwards has them; with
            :attr:`tables` they stay.
        load: Whether it acts from outside: it does work and stores no energy.
        of_bodies: Whether it acts within bodies or on them, and not between them.
        within_joints: Whether the sums over all joints have its forces, their power, and what
            :meth:`geometric` is, but not its tangents.
        conserved: Whether conserving schemes have its forces over a step.
        within_frames: Whether its energy is one of coordinates within frames of bodies, of which
            conserving schemes know by the bodies.
        turning: Whether a load turns with nodes or is a moment, and so has no potential.
        amplitude: Factor of a load, which may be changed.
    """

    label: str = "forces"
    version: int = 0
    amplitude: float = 1.0
    load = of_bodies = within_joints = within_frames = conserved = turning = False

    # --- what it has beside forces and a tangent ---

    @property
    def viscosity(self) -> ViscousForces | None:
        """Forces that depend on twists; default: none, as of all that follow."""
        return None

    @property
    def stress_update(self) -> LinearisedStress | None:
        """Stress, or unknowns of its own, that is updated linearly from iterate to iterate."""
        return None

    @property
    def local(self) -> LocalUnknowns | None:
        """Unknowns of cells for which to solve before forces are asked for."""
        return None

    @property
    def path(self) -> PathDependence | None:
        """What is to know of accepted states."""
        return None

    @property
    def passage(self) -> PassageCheck | None:
        """By which steps are checked."""
        return None

    @property
    def over_step(self) -> StepForces | None:
        """Forces over a step that are no sum over cells."""
        return None

    @property
    def low_rank(self) -> LowRankTangent | None:
        """The tangent as a low-rank correction of a matrix without it."""
        return None

    @property
    def ground(self) -> GroundForces | None:
        """Forces whose other side is ground."""
        return None

    @property
    def has_friction(self) -> bool:
        """Whether forces depend on how nodes have moved since the last accepted state."""
        return self.path is not None and self.path.friction

    # --- forces ---

    @property
    @abstractmethod
    def pairs(self) -> Pairs:
        """Nodes of the blocks of :meth:`tangent`, which move."""

    def room(self) -> Array:
        """For those of the forces that :meth:`tangent` takes; default: none."""
        return np.empty((0, 6))

    @abstractmethod
    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H``.

        Args:
            H: Frames.
            out: Shape (≥ nodes that move, 6).
            kept: See :meth:`room`, overwritten.
        """

    @abstractmethod
    def tangent(self, H: Array, kept: Array) -> Array:
        """Derivative of the forces in the twists of the nodes, (pairs, 6, 6).

        What is carried is in it as it is carried.

        Args:
            H: Frames.
            kept: What :meth:`add_forces` kept at these frames.
        """

    def linear_forces(self, H: Array, kept: Array, h: Array) -> Array:
        """The forces of :meth:`room` that increments ``h`` (n, 6) add, to first order.

        Args:
            H: Frames, the stress of which is carried.
            kept: What :meth:`add_forces` kept at these frames.
            h: Local increments of the nodes.
        """
        forces = self.room()
        if len(forces):
            rows, columns = self.pairs
            np.add.at(forces, rows, np.einsum("pij,pj->pi", self.tangent(H, kept), h[columns]))
        return forces

    def add_tangent(self, H: Array, kept: Array, place: Indices, K: Array) -> None:
        """Add :meth:`tangent` to blocks of a larger matrix.

        Args:
            H: Frames.
            kept: As there.
            place: Of each pair among the blocks, shape (pairs,).
            K: Blocks, shape (any, 6, 6).
        """
        add_at(K, place, self.tangent(H, kept))

    def near(self, nodes: Flags) -> NearCells | None:
        """The same forces on some nodes alone, if that is less work.

        Args:
            nodes: Which, shape (≥ nodes that move,).
        """
        return None

    def geometric(self, H: Array) -> Array | None:
        """What the derivative has beside :meth:`tangent`, of forces that are not carried.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
        """
        return None

    def energy(self, H: Array) -> float:
        """Stored energy, of which the forces are the gradient; of loads zero.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
        """
        return 0.0

    @property
    def tables(self) -> tuple[FormTable, FormTable] | None:
        """Forces and energy as sums over cells, to be joined to others, if they are just that."""
        return None

    @property
    def over_cells(self) -> tuple[FormTable, FormTable] | None:
        """The same for schemes that take cells one by one; default: :attr:`tables`."""
        return self.tables

    @property
    def following(self) -> FollowingTable | None:
        """Forces as such a sum over nodes that follow those of the equations."""
        return None

    @property
    def matrices(self) -> Sequence[CellMatrices]:
        """The sums over the same cells that tangents are, if they are just that."""
        return ()

    @property
    def contents(self) -> object:
        """All that the forces are made of, but for the amplitude."""
        return None

    # --- what pairs follow from: asked of terms whose pairs change ---

    @property
    def seen(self) -> Array:
        """The places for which :attr:`pairs` were found; default: they stay."""
        return np.empty((0, 3))

    def see_again(self, seen: Array) -> None:
        """Have the pairs again that there were when :attr:`seen` was copied.

        Args:
            seen: Copied version of the pairs.
        """
        assert not len(seen)

    # --- over a step ---

    @property
    def pieces(self) -> PushedPieces | None:
        """The forces as conserving schemes have those of pressure, on nodes of bodies."""
        return None

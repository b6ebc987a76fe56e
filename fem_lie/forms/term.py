"""Terms: forces, energy and a matrix of the equations, except for inertia and joints.

Elements, pressure, springs and damping are terms. The code that sums them does not distinguish
them: each term declares its abilities and how it may be summed.
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
    ContactState,
    GroundForces,
    LinearisedStress,
    LocalUnknowns,
    LowRankTangent,
    PassageCheck,
    PathDependence,
    StepForces,
    ViscousForces,
)
from fem_lie.forms.cell_forms import FormArrays

Pairs: TypeAlias = tuple[Indices, Indices]
"""First and second node of each pair that a matrix couples."""


@compiled
def add_at(target: Array, index: Indices, blocks: Array) -> None:
    """Add square blocks, ``target[index] += blocks``.

    Raises:
        ValueError: There are more or fewer indices than blocks: the pairs of a term have changed
            since the indices were computed.
    """
    if index.shape[0] != blocks.shape[0]:
        raise ValueError("expected an index for each block: the pairs of a term have changed")
    size = blocks.shape[1]
    for b in range(index.shape[0]):
        for k in range(size):
            for n in range(size):
                target[index[b], k, n] += blocks[b, k, n]


class PushedPieces(NamedTuple):
    """Straight segments with forces ``(x_j − x_i) × ½ (R_i + R_j) w``, half at each end.

    Attributes:
        nodes: Nodes i and j of each segment, shape (s, 2).
        across: Current ``w``, shape (s, 3).
    """

    nodes: Indices
    across: Array


class AttachedForms(NamedTuple):
    """Forces as a sum over cells, on nodes rigidly attached to nodes of the equations.

    Attributes:
        arrays: Packed arrays of the cells.
        master: Master node of each node that the arrays number, shape (k,).
        offset: Frames of these nodes in the frames of their masters, shape (k, 4, 3).
    """

    arrays: FormArrays
    master: Indices
    offset: Array


class NearCells(Protocol):
    """Forces of the cells that contain some nodes."""

    def add_forces(self, H: Array, out: Array) -> None:
        """Add all forces on these nodes, and some on others, to ``out`` (≥ moving nodes, 6)."""


class CellMatrices(Protocol):
    """Matrices summed over cells, see :class:`~fem_lie.forms.cell_sums.CellSum`."""

    cells: npt.NDArray[np.integer[Any]]
    own_only: bool

    def choose(self, cells: Flags) -> None:
        """Choose the cells of the matrices, see :meth:`~fem_lie.forms.cell_sums.CellSum.choose`."""


class Term(ABC):
    """Forces on nodes with the sign of a residual: those of an energy are its gradient.

    Forces and twists have components along nodal axes; ``H`` are nodal coordinates of all nodes, of
    which the first ones move.

    Attributes:
        label: Name in messages.
        version: Version of :attr:`pairs`, which a term increases when its pairs change. They may
            change when forces are evaluated; the next tangent then has the new pairs. The pairs of
            a term with :attr:`tables` do not change.
        load: Whether it is an external load, which does work and stores no energy.
        of_bodies: Whether it acts within or on single bodies, and not between bodies.
        within_joints: Whether sums over all joints include its forces, their power and
            :meth:`geometric`, but not its tangent.
        conserved: Whether conserving schemes evaluate its forces over a step.
        within_frames: Whether it is the energy of coordinates within frames of bodies, which
            conserving schemes evaluate by bodies.
        turning: Whether it is a load that rotates with nodes, or a moment, and so has no potential.
        amplitude: Factor of a load, which may change.
        strains_set: Number of times that stress-free strains were set.
    """

    label: str = "forces"
    version: int = 0
    amplitude: float = 1.0
    strains_set: int = 0
    load = of_bodies = within_joints = within_frames = conserved = turning = False

    # --- abilities beyond forces and a tangent ---

    @property
    def viscosity(self) -> ViscousForces | None:
        """Forces that depend on twists; default: none, as for all of these properties."""
        return None

    @property
    def stress_update(self) -> LinearisedStress | None:
        """Independent stress or local unknowns, updated linearly between iterates."""
        return None

    @property
    def of_contact(self) -> ContactState | None:
        """State that a file has under the number of the contact."""
        return None

    @property
    def local(self) -> LocalUnknowns | None:
        """Unknowns of cells that must be solved before forces are evaluated."""
        return None

    @property
    def path(self) -> PathDependence | None:
        """Dependence on accepted states."""
        return None

    @property
    def passage(self) -> PassageCheck | None:
        """Check of steps for surfaces that pass through each other."""
        return None

    @property
    def over_step(self) -> StepForces | None:
        """Forces over a step that are not a sum over cells."""
        return None

    @property
    def low_rank(self) -> LowRankTangent | None:
        """Tangent as a low-rank correction of a matrix without it."""
        return None

    @property
    def ground(self) -> GroundForces | None:
        """Forces between nodes and ground."""
        return None

    @property
    def has_friction(self) -> bool:
        """Whether forces depend on the motion of nodes since the last accepted state."""
        return self.path is not None and self.path.friction

    # --- forces ---

    @property
    @abstractmethod
    def pairs(self) -> Pairs:
        """First and second node of each block of :meth:`tangent`, (pairs,) each; both move."""

    def workspace(self) -> Array:
        """Zero array for the forces that :meth:`tangent` reads; default: empty."""
        return np.empty((0, 6))

    @abstractmethod
    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H``.

        Args:
            H: Nodal coordinates.
            out: Forces, shape (≥ moving nodes, 6).
            kept: Array of :meth:`workspace`, overwritten.
        """

    @abstractmethod
    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness: derivative of the forces in the twists of the nodes, (pairs, 6, 6).

        It uses the current independent stress.

        Args:
            H: Nodal coordinates.
            kept: Forces that :meth:`add_forces` stored at these coordinates.
        """

    def linear_forces(self, H: Array, kept: Array, h: Array) -> Array:
        """First-order change of the forces of :meth:`workspace` by increments ``h`` (n, 6).

        Args:
            H: Nodal coordinates of the current independent stress.
            kept: Forces that :meth:`add_forces` stored at these coordinates.
            h: Increments along nodal axes.
        """
        forces = self.workspace()
        if len(forces):
            rows, columns = self.pairs
            np.add.at(forces, rows, np.einsum("pij,pj->pi", self.tangent(H, kept), h[columns]))
        return forces

    def add_tangent(self, H: Array, kept: Array, index: Indices, K: Array) -> None:
        """Add :meth:`tangent` to blocks of a larger matrix.

        Args:
            H: Nodal coordinates.
            kept: See :meth:`tangent`.
            index: Index of the block of each pair, shape (pairs,).
            K: Blocks, shape (any, 6, 6).
        """
        add_at(K, index, self.tangent(H, kept))

    def near(self, nodes: Flags) -> NearCells | None:
        """Forces on some nodes only, if that is less work; else ``None``.

        Args:
            nodes: Mask of the nodes, shape (≥ moving nodes,).
        """
        return None

    def geometric(self, H: Array) -> Array | None:
        """Part of the tangent stiffness that :meth:`tangent` omits, shape (pairs, 6, 6).

        It belongs to forces without a stress field. ``None``: there is none.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
        """
        return None

    def energy(self, H: Array) -> float:
        """Stored energy, whose gradient the forces are; zero for loads, J.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
        """
        return 0.0

    @property
    def tables(self) -> tuple[FormArrays, FormArrays] | None:
        """Tables of forces and energy if these are sums over cells; else ``None``."""
        return None

    @property
    def over_cells(self) -> tuple[FormArrays, FormArrays] | None:
        """The tables for schemes that evaluate cells individually; default: :attr:`tables`."""
        return self.tables

    @property
    def attached_cells(self) -> AttachedForms | None:
        """Forces as a sum over cells on nodes attached to those of the equations."""
        return None

    @property
    def matrices(self) -> Sequence[CellMatrices]:
        """Tangent stiffness as sums over the cells of :attr:`tables`; empty if it is none."""
        return ()

    @property
    def contents(self) -> object:
        """All data on which the forces depend, except for the amplitude."""
        return None

    # --- positions that determine the pairs, for terms whose pairs change ---

    @property
    def pair_positions(self) -> Array:
        """Positions for which :attr:`pairs` were computed; empty if the pairs do not change."""
        return np.empty((0, 3))

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the pairs that belong to an earlier copy of :attr:`pair_positions`.

        Args:
            pair_positions: Copied version of the pairs.
        """
        assert not len(pair_positions)

    # --- over a step ---

    @property
    def pieces(self) -> PushedPieces | None:
        """Line segments with pressure, for conserving schemes; ``None`` if there are none."""
        return None

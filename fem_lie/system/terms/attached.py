"""Terms of bodies on the master nodes of their nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices
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
from fem_lie.forms.cell_forms import NO_ROWS, FormArrays, of_deforming_cells, of_some_cells
from fem_lie.forms.term import AttachedForms, CellMatrices, Pairs, PushedPieces, Term
from fem_lie.system.nodes.numbering import MasterMap
from fem_lie.system.terms.attached_abilities import (
    AttachedGround,
    AttachedLowRank,
    AttachedPassage,
    AttachedPath,
    AttachedStepForces,
    AttachedStress,
    AttachedUnknowns,
    AttachedViscosity,
)
from fem_lie.system.terms.attached_nodes import AttachedNodes
from fem_lie.system.terms.near import AttachedCells


def on_master_nodes(term: Term, where: slice, master_map: MasterMap) -> Term:
    """A term of bodies, transformed to the master nodes of its nodes.

    Args:
        term: The term on nodes of bodies.
        where: Slice of its nodes among all.
        master_map: Master node of each node.
    """
    master = master_map.master[where]
    sums = term.of_bodies and not term.load and term.path is None and term.tables is not None
    if (
        sums
        and term.matrices
        and all((_spread(master, each.cells) == 0).all() for each in term.matrices)
    ):
        return RigidCells(term, where, master_map)
    return AttachedTerm(term, where, master_map)


def _spread(master: Indices, cells: npt.NDArray[np.integer[Any]]) -> Indices:
    return np.ptp(master[cells], axis=1)


class RigidCells(Term):
    """Cells whose nodes are all attached to the same node: they store energy, without forces."""

    of_bodies = conserved = True

    def __init__(self, term: Term, where: slice, master_map: MasterMap) -> None:
        """Store the term; for the arguments see :func:`on_master_nodes`."""
        self.term, self.label, self.within_frames = term, term.label, term.within_frames
        self._nodes = AttachedNodes(where, master_map)
        self._stored: tuple[int, float] | None = None

    @property
    def pairs(self) -> Pairs:
        """None."""
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)

    @property
    def attached_cells(self) -> AttachedForms:
        """None: all forces are known."""
        none = FormArrays(NO_ROWS, np.empty(0, dtype=np.int64))
        return AttachedForms(none, self._nodes.master, self._nodes.offset)

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add nothing: the forces on one node are in equilibrium."""

    def tangent(self, H: Array, kept: Array) -> Array:
        """Empty."""
        return np.empty((0, 6, 6))

    def energy(self, H: Array) -> float:
        """Stored energy, which only a change of stress-free strains changes."""
        if self._stored is None or self._stored[0] != self.term.strains_set:
            # in the frames of the master nodes, so that it is the same to the last bit
            self._stored = self.term.strains_set, self.term.energy(self._nodes.offset)
        return self._stored[1]


class AttachedTerm(Term):
    """A term of bodies, transformed to the master nodes of its nodes.

    Attributes:
        term: The term on nodes of bodies.
    """

    def __init__(self, term: Term, where: slice, master_map: MasterMap) -> None:
        """Find the master nodes.

        Args:
            term: The term on nodes of bodies.
            where: Slice of its nodes among all.
            master_map: Master node of each node.
        """
        self.term, self.label = term, term.label
        self.load, self.of_bodies, self.turning = term.load, term.of_bodies, term.turning
        self.conserved, self._nodes = term.conserved, AttachedNodes(where, master_map)
        self.within_frames = term.within_frames

    # --- abilities in addition to forces and a tangent ---

    @property
    def viscosity(self) -> ViscousForces | None:
        """Viscous forces of the term."""
        of = self.term.viscosity
        return None if of is None else AttachedViscosity(self.term, of, self._nodes)

    @property
    def stress_update(self) -> LinearisedStress | None:
        """Linearised stress update of the term."""
        of = self.term.stress_update
        return None if of is None else AttachedStress(of, self._nodes)

    @property
    def of_contact(self) -> ContactState | None:
        """State of the contact, on nodes of bodies."""
        return self.term.of_contact

    @property
    def local(self) -> LocalUnknowns | None:
        """Local unknowns of the term."""
        of = self.term.local
        return None if of is None else AttachedUnknowns(of, self._nodes)

    @property
    def path(self) -> PathDependence | None:
        """Path dependence of the term."""
        of = self.term.path
        return None if of is None else AttachedPath(of, self._nodes)

    @property
    def passage(self) -> PassageCheck | None:
        """Passage check of the term."""
        of = self.term.passage
        return None if of is None else AttachedPassage(of, self._nodes)

    @property
    def over_step(self) -> StepForces | None:
        """Forces of the term over a step."""
        of = self.term.over_step
        return None if of is None else AttachedStepForces(self.term, of, self._nodes)

    @property
    def low_rank(self) -> LowRankTangent | None:
        """Low-rank tangent of the term."""
        of = self.term.low_rank
        return None if of is None else AttachedLowRank(of, self._nodes)

    @property
    def ground(self) -> GroundForces | None:
        """Forces of the term on ground."""
        of = self.term.ground
        return None if of is None else AttachedGround(of, self._nodes)

    @property
    def version(self) -> int:  # type: ignore[override]
        """Version of the node pairs of the term."""
        return self.term.version

    @property
    def amplitude(self) -> float:
        """Load amplitude of the term."""
        return self.term.amplitude

    @amplitude.setter
    def amplitude(self, value: float) -> None:
        self.term.amplitude = value

    @property
    def pairs(self) -> Pairs:
        """Master nodes of the node pairs of the term."""
        return self._nodes.masters(self.term.pairs)

    @property
    def matrices(self) -> Sequence[CellMatrices]:
        """Cell matrices of the term."""
        return self.term.matrices

    @property
    def cells(self) -> Indices:
        """Master nodes of the cells of the term, shape (m, k)."""
        return np.asarray(self._nodes.master[self.matrices[0].cells])

    # --- forces ---

    def workspace(self) -> Array:
        """Array for the forces that the tangent needs, on the nodes of the term."""
        return self.term.workspace()

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H``."""
        if self._nodes.direct:
            self.term.add_forces(H[self._nodes.where], out[self._nodes.where], kept)
            return
        forces = np.zeros((len(self._nodes.master), 6))
        self.term.add_forces(self._nodes.frames(H), forces, kept)
        self._nodes.collect(forces, out)

    def near(self, nodes: Flags) -> AttachedCells | None:
        """Forces on some nodes only, if that is less work, or ``None``."""
        if self.term.tables is None:
            return None
        table = of_some_cells(self.term.tables[0], nodes[self._nodes.master])
        return AttachedCells(table, self._nodes.master, self._nodes.offset)

    @property
    def attached_cells(self) -> AttachedForms | None:
        """Cells that deform, if not all nodes are master nodes."""
        if self.term.tables is None or self._nodes.direct:
            return None
        deforming = of_deforming_cells(self.term.tables[0], self._nodes.master)
        return AttachedForms(deforming, self._nodes.master, self._nodes.offset)

    def linear_forces(self, H: Array, kept: Array, h: Array) -> Array:
        """Change of the forces of :meth:`workspace` along increments, on the nodes of the term."""
        return self.term.linear_forces(self._nodes.frames(H), kept, self._nodes.twists(h))

    def tangent(self, H: Array, kept: Array) -> Array:
        """Derivative of the forces in the twists of the master nodes, (pairs, 6, 6)."""
        return self._nodes.blocks(self.term.tangent(self._nodes.frames(H), kept), self.term.pairs)

    def add_tangent(self, H: Array, kept: Array, index: Indices, K: Array) -> None:
        """Add :meth:`tangent` to blocks ``K`` at ``index``."""
        if self._nodes.direct:
            self.term.add_tangent(H[self._nodes.where], kept, index, K)
        else:
            super().add_tangent(H, kept, index, K)

    def geometric(self, H: Array) -> Array | None:
        """Derivative of forces that are not stored, shape (pairs, 6, 6), or ``None``."""
        blocks = self.term.geometric(self._nodes.frames(H))
        return None if blocks is None else self._nodes.blocks(blocks, self.term.pairs)

    def energy(self, H: Array) -> float:
        """Stored energy, of which the forces are the gradient; of loads zero."""
        return self.term.energy(self._nodes.frames(H))

    @property
    def tables(self) -> tuple[FormArrays, FormArrays] | None:
        """Cell tables of the term, if all of its nodes are master nodes."""
        tables = self.term.tables
        if tables is None or not self._nodes.direct:
            return None
        forces, energy = (FormArrays(t.rows, self._nodes.where.start + t.nodes) for t in tables)
        return forces, energy

    @property
    def contents(self) -> object:
        """Data on which the forces depend, without the amplitude."""
        return self.term.contents

    @property
    def pair_positions(self) -> Array:
        """Positions at which the node pairs were found; empty if the pairs are constant."""
        return self.term.pair_positions

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the node pairs of :attr:`pair_positions`."""
        self.term.restore_pairs(pair_positions)

    @property
    def pieces(self) -> PushedPieces | None:
        """Pressure segments of the term, on nodes of bodies."""
        return self.term.pieces

"""A term on nodes of bodies, seen from the nodes that these follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.forms.cell_forms import FormTable, of_some_cells
from fem_lie.forms.term import (
    CellMatrices,
    Done,
    Ends,
    FollowingTable,
    Pairs,
    PushedPieces,
    StiffRows,
    Term,
)
from fem_lie.system.nodes.attachment import Attachment, collect, expand, expand_twists
from fem_lie.system.terms.near import FollowingCells


class Followed(Term):
    """What a term on all nodes, or some, does on their leaders.

    Attributes:
        term: On nodes of bodies.
    """

    def __init__(self, term: Term, where: slice, attachment: Attachment) -> None:
        """Find the leaders.

        Args:
            term: On nodes of bodies.
            where: Which of all nodes its nodes are.
            attachment: Which node follows which.
        """
        self.term, self.label = term, term.label
        self.load, self.viscous, self.in_space = term.load, term.viscous, term.in_space
        self.of_bodies, self.carries, self.settles = term.of_bodies, term.carries, term.settles
        self.conserved, self.secant, self.turning = term.conserved, term.secant, term.turning
        self.on_ground, self.rubs, self.apart = term.on_ground, term.rubs, term.apart
        self.steady, self.watches, self.parts = term.steady, term.watches, term.parts
        self.within_frames = term.within_frames
        self._leader, self._offset = attachment.leader[where], attachment.offset[where]
        numbers = np.arange(len(attachment.leader))[where]
        self._direct = bool(np.isin(numbers, attachment.leaders).all())
        if not self._direct:
            # Ad(C⁻¹): twist of a node from that of its leader
            self._turn = lie.se3_adjoint(lie.se3_inverse(self._offset))
        first = int(self._leader[0]) if len(self._leader) else 0
        self._where = slice(first, first + len(self._leader))

    # --- nodes ---

    def _frames(self, H: Array) -> Array:
        if self._direct:
            return H[self._where]
        out = np.empty((len(self._leader), 4, 3))
        expand(H, self._leader, self._offset, out)
        return out

    def _twists(self, v: Array) -> Array:
        if self._direct:
            return v[self._where]
        out = np.empty((len(self._leader), 6))
        expand_twists(v, self._leader, self._offset, out)
        return out

    def _moved(self, blocks: Array) -> Array:
        if self._direct:
            return blocks
        r, c = self.term.pairs
        return np.asarray(self._turn[r].transpose(0, 2, 1) @ blocks @ self._turn[c])

    @property
    def version(self) -> int:  # type: ignore[override]
        """That of the term."""
        return self.term.version

    @property
    def amplitude(self) -> float:
        """That of the term."""
        return self.term.amplitude

    @amplitude.setter
    def amplitude(self, value: float) -> None:
        self.term.amplitude = value

    @property
    def pairs(self) -> Pairs:
        """Leaders of the term's."""
        rows, columns = self.term.pairs
        return self._leader[rows], self._leader[columns]

    @property
    def matrices(self) -> Sequence[CellMatrices]:
        """Those of the term."""
        return self.term.matrices

    @property
    def cells(self) -> Indices:
        """Leaders of the nodes of these, shape (m, k)."""
        return np.asarray(self._leader[self.matrices[0].cells])

    # --- forces ---

    def room(self) -> Array:
        """See the base class; on the term's nodes."""
        return self.term.room()

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """See the base class."""
        if self._direct:
            self.term.add_forces(H[self._where], out[self._where], kept)
            return
        forces = np.zeros((len(self._leader), 6))
        self.term.add_forces(self._frames(H), forces, kept)
        collect(forces, self._leader, self._offset, out)

    def near(self, nodes: Flags) -> FollowingCells | None:
        """See the base class."""
        if self.term.tables is None:
            return None
        table = of_some_cells(self.term.tables[0], nodes[self._leader])
        return FollowingCells(table, self._leader, self._offset)

    @property
    def following(self) -> FollowingTable | None:
        """See the base class."""
        if self.term.tables is None or self._direct:
            return None
        return FollowingTable(self.term.tables[0], self._leader, self._offset)

    def linear_forces(self, H: Array, kept: Array, h: Array) -> Array:
        """See the base class; on the term's nodes."""
        return self.term.linear_forces(self._frames(H), kept, self._twists(h))

    def tangent(self, H: Array, kept: Array) -> Array:
        """See the base class."""
        return self._moved(self.term.tangent(self._frames(H), kept))

    def add_tangent(self, H: Array, kept: Array, place: Indices, K: Array) -> None:
        """See the base class."""
        if self._direct:
            self.term.add_tangent(H[self._where], kept, place, K)
        else:
            super().add_tangent(H, kept, place, K)

    def stiff_rows(self, H: Array) -> StiffRows:
        """See the base class."""
        found = self.term.stiff_rows(self._frames(H))
        if self._direct:
            nodes = np.where(found.nodes >= 0, found.nodes + self._where.start, -1)
            return found._replace(nodes=nodes)
        turned = np.einsum("msk,mskl->msl", found.rows, self._turn[found.nodes])
        nodes = np.where(found.nodes >= 0, self._leader[found.nodes], -1)
        return StiffRows(nodes, turned, found.stiffness)

    def geometric(self, H: Array) -> Array | None:
        """See the base class."""
        blocks = self.term.geometric(self._frames(H))
        return None if blocks is None else self._moved(blocks)

    def energy(self, H: Array) -> float:
        """See the base class."""
        return self.term.energy(self._frames(H))

    @property
    def tables(self) -> tuple[FormTable, FormTable] | None:
        """Those of the term, if its nodes lead."""
        tables = self.term.tables
        if tables is None or not self._direct:
            return None
        forces, energy = (FormTable(t.rows, self._where.start + t.nodes) for t in tables)
        return forces, energy

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        if self._direct:
            self.term.add_viscous_forces(H[self._where], v[self._where], out[self._where])
            return
        forces = np.zeros((len(self._leader), 6))
        self.term.add_viscous_forces(self._frames(H), self._twists(v), forces)
        collect(forces, self._leader, self._offset, out)

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """See the base class."""
        forces = np.zeros((len(self._leader), 6))
        self.term.add_of_ground(self._frames(H), self._twists(v), forces)
        collect(forces, self._leader, self._offset, out)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """See the base class."""
        by_twists, by_frames = self.term.viscous_tangent(self._frames(H), self._twists(v))
        return self._moved(by_twists), None if by_frames is None else self._moved(by_frames)

    # --- what is carried ---

    @property
    def carried(self) -> Array:
        """See the base class."""
        return self.term.carried

    @property
    def contents(self) -> object:
        """See the base class."""
        return self.term.contents

    def carry(self, H: Array, h: Array) -> None:
        """See the base class."""
        self.term.carry(self._frames(H), self._twists(h))

    def accept(self, H: Array) -> None:
        """See the base class."""
        self.term.accept(self._frames(H))

    def check_passage(self, start: Array, end: Array) -> None:
        """See the base class."""
        self.term.check_passage(self._frames(start), self._frames(end))

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """See the base class."""
        half = None if middle is None else self._frames(middle)
        self.term.watch(self._frames(start), self._frames(end), h, half)

    @property
    def watched(self) -> Array:
        """See the base class."""
        return self.term.watched

    def watch_again(self, watched: Array) -> None:
        """See the base class."""
        self.term.watch_again(watched)

    def restore(self, carried: Array) -> None:
        """See the base class."""
        self.term.restore(carried)

    def settle(self, H: Array) -> None:
        """See the base class."""
        self.term.settle(self._frames(H))

    def clear_stress(self) -> None:
        """See the base class."""
        self.term.clear_stress()

    def reset_stress(self, H: Array) -> None:
        """See the base class."""
        self.term.reset_stress(self._frames(H))

    @property
    def seen(self) -> Array:
        """See the base class."""
        return self.term.seen

    def see_again(self, seen: Array) -> None:
        """See the base class."""
        self.term.see_again(seen)

    # --- over a step: on nodes of bodies ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """See the base class."""
        return self.term.add_over_step(ends, out, ground)

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """See the base class; ``H`` are frames of leaders."""
        return self._moved(self.term.tangent_over_step(ends, self._frames(H)))

    def overlaps(self, H: Array) -> bool:
        """See the base class; ``H`` are frames of leaders."""
        return self.term.overlaps(self._frames(H))

    @property
    def pieces(self) -> PushedPieces | None:
        """Those of the term, on nodes of bodies."""
        return self.term.pieces

"""Constraints of any type on attachment frames.

The rows of such a set are the nodes on which its items act directly, then one row per attachment,
then rows that do not move by themselves. Frames and twists of attachments are those of
:mod:`fem_lie.attachments`; forces on the six components of an attachment are transformed to its
nodes by the transpose of its Jacobian. Averaging attachments contribute to the matrix by their mean
coordinates, see :mod:`.averages`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.attachments.attachment import locate
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Point
from fem_lie.forms.term import add_at
from fem_lie.joints.connection import Connection
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.constraint_sets.averages import AveragedPairs
from fem_lie.system.constraint_sets.constraint_set import (
    ConstrainedFrames,
    ConstraintSet,
    HistoryKey,
    Means,
    Numbered,
    Place,
    Start,
    SystemFrames,
)
from fem_lie.system.nodes.held_attachments import HeldAttachments


class FramesOnAttachments:
    """Frames on which the constraints of a set on attachments act.

    Attributes:
        attachments: The attachments.
        moving: Independent frames of the system on which items act directly, shape (k,).
        fixed: Frames of the system that are not independent, shape (f,).
    """

    def __init__(self, items: Sequence[Numbered], constrained: SystemFrames) -> None:
        """Collect the points of the items."""
        points = [point for item in items for point in item.item.points]
        self.attachments = HeldAttachments(
            [p for p in points if p.joint_attachment is not None], constrained.numbering
        )
        self._system = constrained
        touched = {constrained.of(point) for point in points if point.joint_attachment is None}
        for item in items:
            if definition := item.item.sliding_definition():
                touched.update(int(row) for row in constrained.ends(definition.beam)[0].ravel())
        order = np.array(sorted(touched), dtype=np.int64)
        self.moving, self.fixed = (
            order[order < constrained.count],
            order[order >= constrained.count],
        )
        self.count = len(self.moving) + self.attachments.count
        self.frames = self.inner_frames(
            constrained.frames, self.attachments.locate(constrained.frames)[0]
        )
        free = np.zeros(self.attachments.count, dtype=bool)
        self.held = np.concatenate(
            [constrained.held[self.moving], np.zeros((len(free), 6), dtype=bool)]
        )
        self.still = np.concatenate(
            [constrained.still[self.moving], free, constrained.still[self.fixed]]
        )

    def inner_frames(self, H: Array, attachments: Array) -> Array:
        """All of these frames in one array."""
        return np.concatenate([H[self.moving], attachments, H[self.fixed]])

    def of(self, point: Point) -> int:
        """Number of the frame of a point."""
        if point.joint_attachment is not None:
            return len(self.moving) + self.attachments.number(point)
        return int(self._here(np.array(self._system.of(point))))

    def initial(self, point: Point) -> Array:
        """That frame where the nodes of the point are in the initial configuration, (4, 3)."""
        attachment = point.joint_attachment
        if point.body is None or attachment is None:
            return self._system.initial(point)
        nodes, data = point.body.frames[list(attachment.nodes)], np.array([attachment.data])
        return np.asarray(locate(attachment.kind, nodes[np.newaxis], data)[0][0])

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """Frames at both ends of a beam's elements, see :meth:`.SystemFrames.ends`."""
        ends, offsets = self._system.ends(beam)
        return self._here(ends), offsets

    def _here(self, numbers: Indices) -> Indices:
        found = np.searchsorted(self.moving, numbers)
        beyond = self.count + np.searchsorted(self.fixed, numbers)
        return np.where(numbers < self._system.count, found, beyond)


def on_attachments(item: Numbered) -> bool:
    """Whether any point of an item is an attachment."""
    return any(point.joint_attachment is not None for point in item.item.points)


class OnAttachments(ConstraintSet):
    """A set of another type, on attachments.

    Attributes:
        inner: The set of the other type.
        constrained: Frames on which the constraints of that set act.
    """

    def __init__(
        self,
        kind: type[ConstraintSet],
        items: Sequence[Numbered],
        constrained: SystemFrames,
        start: Start,
    ) -> None:
        """Build the inner set on frames of its own.

        Args:
            kind: Type of the inner set.
            items: Items that act on attachments.
            constrained: Frames of the system.
            start: Numbers of the first constraint and incidence.
        """
        self.start, self.constrained = start, FramesOnAttachments(items, constrained)
        self._system_count, self._attachments = constrained.count, self.constrained.attachments
        local: ConstrainedFrames = self.constrained
        self.inner = kind(items, local, Start())
        self.owner, self.angular = self.inner.owner, self.inner.angular
        self.targets = self.inner.targets
        self.what = f"{kind.what} on points that are not nodes"
        self.of_velocities = kind.of_velocities
        k, g = len(self.constrained.moving), self._attachments.count
        self._by_itself = np.tile(np.eye(6), (k, 1, 1))
        # entries move each row of the set: the row itself, or the nodes of its attachment
        self._of = np.concatenate([np.arange(k), k + self._attachments.of])
        self._nodes = np.concatenate([self.constrained.moving, self._attachments.nodes])
        self._entries = np.split(
            np.arange(len(self._of)), np.searchsorted(self._of, range(1, k + g))
        )
        self._connect()
        self._pair()

    def _connect(self) -> None:
        """Incidences with nodes of the system, and their relation to those of the inner set."""
        inner, nodes = self.inner.incidences, self._nodes
        entries_of = [self._entries[row] for row in inner.nodes]
        touched: list[set[int]] = [set() for _ in range(self.m)]
        for row, entries in zip(inner.rows, entries_of, strict=True):
            touched[row].update(int(node) for node in nodes[entries])
        self.incidences = Incidences.of(touched, self._system_count)
        self._inner_incidence = np.repeat(np.arange(len(inner.nodes)), [len(e) for e in entries_of])
        self._incidence_entry: Indices = np.concatenate([np.empty(0, dtype=np.int64), *entries_of])
        rows, at = inner.rows[self._inner_incidence], nodes[self._incidence_entry]
        self._to_incidence = (
            self.start.incidence + self.incidences.find(rows, at[:, np.newaxis])[:, 0]
        )

    def _pair(self) -> None:
        """Node pairs between entries of coupled rows, within attachments, and of averaging ones."""
        rows, columns = self.inner.pairs
        moves = (rows < self.constrained.count) & (columns < self.constrained.count)
        self._inner_index = np.where(moves, np.cumsum(moves).reshape(moves.shape) - 1, -1)
        first, second = rows[moves], columns[moves]
        self._blocks = len(first)
        averaged = np.append(np.full(len(self.constrained.moving), -1), self._attachments.averaged)
        both = (averaged[first] >= 0) & (averaged[second] >= 0)
        triples = [
            np.stack(np.broadcast_arrays(p, *np.ix_(self._entries[a], self._entries[b])))
            for p, a, b in zip(np.flatnonzero(~both), first[~both], second[~both], strict=True)
        ]
        none = np.empty((3, 0), dtype=np.int64)
        flat = (each.reshape(3, -1) for each in triples)
        self._block, self._left, self._right = np.concatenate([none, *flat], axis=1)
        between = np.flatnonzero(both)
        ends = averaged[first[between]], averaged[second[between]]
        self._averaged = AveragedPairs(self._attachments, between, *ends)
        self._sparse = (
            np.concatenate([self._nodes[self._left], self._attachments.rows]),
            np.concatenate([self._nodes[self._right], self._attachments.columns]),
        )
        rows, columns = (
            np.concatenate(each) for each in zip(self._sparse, self._averaged.nodes, strict=True)
        )
        self.pairs = rows, columns

    @property
    def means(self) -> Means | None:
        """Mean coordinates of averaging attachments, which couple the last of :attr:`pairs`."""
        return self._averaged.means

    @property
    def sparse(self) -> tuple[Indices, Indices]:
        """:attr:`pairs` without those of :attr:`means`; :meth:`geometric` takes either."""
        return self._sparse

    @property
    def bound(self) -> Indices:
        """Rows on which it acts directly."""
        return self.constrained.moving

    @property
    def empty(self) -> bool:
        """Whether it has no constraint, spring or coordinate."""
        return self.inner.empty

    # --- between both sorts of rows ---

    def _inner_frames(self, H: Array) -> tuple[Array, Array]:
        """Frames of the inner rows, and the Jacobian of each row in each entry, (e, 6, 6)."""
        frames, J = self._attachments.locate(H)
        return self.constrained.inner_frames(H, frames), np.concatenate([self._by_itself, J])

    def _twists(self, J: Array, v: Array) -> Array:
        """Twists of the inner rows."""
        rows = self.constrained
        found = np.zeros((rows.count + len(rows.fixed), 6))
        np.add.at(found, self._of, np.einsum("eij,ej->ei", J, v[self._nodes]))
        given = rows.fixed < len(v)
        found[rows.count :][given] = v[rows.fixed[given]]
        return found

    def _give(self, J: Array, forces: Array, count: int, r: Array) -> None:
        """Add forces on inner rows to those of the system, of which ``count`` have forces."""
        rows, target = self.constrained, r[: 6 * count].reshape(-1, 6)
        np.add.at(target, self._nodes, np.einsum("eij,ei->ej", J, forces[self._of]))
        given = rows.fixed < count
        target[rows.fixed[given]] += forces[rows.count :][given]

    def _forces(self, H: Array, v: Array, multipliers: Array, scale: Array) -> tuple[Array, Array]:
        """Forces on the inner rows, and violations of the inner set."""
        r = np.zeros(6 * len(H) + self.m)
        self.inner.evaluate(H, v, multipliers, scale, len(H), r)
        return r[: 6 * len(H)].reshape(-1, 6), r[6 * len(H) :]

    def _add_pulled(self, J: Array, blocks: Array, index: Indices, K: Array) -> None:
        """Add blocks of pairs of inner rows, transformed to node pairs, without averaged ones."""
        pulled = J[self._left].transpose(0, 2, 1) @ blocks[self._block] @ J[self._right]
        add_at(K, index[: len(pulled)], pulled)

    def _add_averaged(
        self, H: Array, blocks: Array, forces: Array, index: Indices, K: Array
    ) -> None:
        """Add contributions of averaging attachments to the last pairs."""
        own = index[len(self._sparse[0]) :]
        if len(own):
            self._averaged.add(H, self._averaged.core(H, blocks, forces), own, K)

    # --- equations ---

    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add constraint forces ``Bᵀλ`` and spring forces to ``r``; set its rows ``scale · Φ``."""
        frames, J = self._inner_frames(H)
        given = multipliers[self.own], scale[self.own]
        forces, values = self._forces(frames, self._twists(J, v), *given)
        self._give(J, forces, count, r)
        r[6 * count :][self.own] = values

    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set the violations ``Φ`` or ``W V`` in its rows of ``out``."""
        frames, J = self._inner_frames(H)
        found = np.zeros(self.m)
        self.inner.values(frames, self._twists(J, v), found)
        out[self.own] = found

    def jacobian(self, H: Array, rows: Array) -> None:
        """Add ``∂Φ/∂h``, one row of six per incidence, to the constraint Jacobian ``rows``."""
        frames, J = self._inner_frames(H)
        own = np.zeros((len(self.inner.incidences.nodes), 6))
        self.inner.jacobian(frames, own)
        self._add_rows(J, own, rows)

    def _add_rows(self, J: Array, own: Array, rows: Array) -> None:
        """Add rows per incidence of the inner set to those of the nodes."""
        moved = np.einsum("lij,li->lj", J[self._incidence_entry], own[self._inner_incidence])
        np.add.at(rows, self._to_incidence, moved)

    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add the geometric stiffness of the inner set, and of attachments under its forces."""
        _, J = self._inner_frames(H)
        blocks, forces = self._bent(H, multipliers)
        self._add_pulled(J, blocks, index, K)
        within = index[len(self._left) : len(self._sparse[0])]
        add_at(K, within, self._attachments.bend(H, forces))
        self._add_averaged(H, blocks, forces, index, K)

    def _bent(self, H: Array, multipliers: Array) -> tuple[Array, Array]:
        """Geometric stiffness of the inner set between its rows, and its forces on attachments."""
        frames, _ = self._inner_frames(H)
        blocks, own = np.zeros((self._blocks, 6, 6)), multipliers[self.own]
        self.inner.geometric(frames, own, self._inner_index, blocks)
        forces, _ = self._forces(frames, np.zeros((0, 6)), own, np.ones(self.m))
        return blocks, forces[len(self.constrained.moving) : self.constrained.count]

    def mean_stiffness(self, H: Array, multipliers: Array) -> tuple[Array, Array]:
        """``S`` (e, r, 6) and the core ``C`` (w, r, w, r) of the geometric stiffness ``Sᵀ C S``."""
        return self._attachments.spread(H), self._averaged.core(H, *self._bent(H, multipliers))

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set rates, with the changes of twists of attachments at constant twists of nodes."""
        frames, J = self._inner_frames(H)
        found, (by_change, unused) = np.zeros((2, self.m)), np.zeros((2, self.m))
        self.inner.rates(frames, self._twists(J, v), *found)
        change = np.zeros((len(frames), 6))
        change[len(self.constrained.moving) : self.constrained.count] = self._attachments.changes(
            H, v
        )
        self.inner.rates(frames, change, by_change, unused)
        first[self.own], second[self.own] = found[0], found[1] + by_change

    def initial(self, H: Array) -> Array:
        """Targets that keep initial values, shape (m,); zero for all other constraints."""
        return self.inner.initial(self._inner_frames(H)[0])

    # --- springs and dampers ---

    @property
    def depends_on_time(self) -> bool:
        """Whether force laws may depend on time."""
        return self.inner.depends_on_time

    def set_clock(self, time: float) -> None:
        """Set the time at which force laws are evaluated."""
        self.inner.set_clock(time)

    def check_laws(self) -> None:
        """Raise the error of a force law, if there was one."""
        self.inner.check_laws()

    @property
    def springs(self) -> Array:
        """Stiffness, damping and rest value of each spring, shape (k, 3)."""
        return self.inner.springs

    def scale_spring(self, item: Connection, factor: float) -> None:
        """Multiply the stiffness and damping of the scene, or the law, of an item by a factor."""
        self.inner.scale_spring(item, factor)

    def stiffen(
        self, H: Array, v: Array, index: Indices, stiff: float, damp: float, K: Array
    ) -> None:
        """Add ``(stiff k + damp c) bᵀb`` of springs and dampers to blocks, as :meth:`geometric`."""
        frames, J = self._inner_frames(H)
        blocks = np.zeros((self._blocks, 6, 6))
        twists = self._twists(J, v) if len(v) else v
        self.inner.stiffen(frames, twists, self._inner_index, stiff, damp, blocks)
        self._add_without_forces(H, J, blocks, index, K)

    def add_friction(
        self, H: Array, v: Array, multipliers: Array, index: Indices, factor: float, K: Array
    ) -> None:
        """Add derivatives of friction in twists to blocks, as :meth:`geometric`."""
        frames, J = self._inner_frames(H)
        blocks, own = np.zeros((self._blocks, 6, 6)), multipliers[self.own]
        twists = self._twists(J, v)
        self.inner.add_friction(frames, twists, own, self._inner_index, factor, blocks)
        self._add_without_forces(H, J, blocks, index, K)

    def add_friction_columns(self, H: Array, v: Array, multipliers: Array, rows: Array) -> None:
        """Add derivatives of friction in multipliers to ``rows``, as :meth:`jacobian`."""
        frames, J = self._inner_frames(H)
        own = np.zeros((len(self.inner.incidences.nodes), 6))
        given = self._twists(J, v), multipliers[self.own]
        self.inner.add_friction_columns(frames, *given, own)
        self._add_rows(J, own, rows)

    def _add_without_forces(
        self, H: Array, J: Array, blocks: Array, index: Indices, K: Array
    ) -> None:
        """Add blocks of the inner set, without its forces on attachments."""
        self._add_pulled(J, blocks, index, K)
        self._add_averaged(H, blocks, np.zeros((self._attachments.count, 6)), index, K)

    def stretch_springs(self, H: Array, h: Array) -> None:
        """Change rest values of springs by the changes of coordinates along ``h`` (n, 6)."""
        frames, J = self._inner_frames(H)
        self.inner.stretch_springs(frames, self._twists(J, h))

    def spring_energy(self, H: Array) -> float:
        """Energy of all springs."""
        return self.inner.spring_energy(self._inner_frames(H)[0])

    def damper_loss(self, H: Array, v: Array, multipliers: Array) -> float:
        """Power dissipated by dampers and friction."""
        frames, J = self._inner_frames(H)
        return self.inner.damper_loss(frames, self._twists(J, v), multipliers[self.own])

    # --- rotations within a step ---

    def move_reference_angles(self, H: Array, h: Array) -> None:
        """Move reference angles along the increment ``h`` (n, 6) of nodes, made from ``H``."""
        frames, J = self._inner_frames(H)
        self.inner.move_reference_angles(frames, self._twists(J, h))

    def mark(self) -> None:
        """Take the reference angles as those of the accepted state."""
        self.inner.mark()

    def check_branch(self, H: Array) -> None:
        """Refuse a state in which an angle or axis may be on a wrong branch."""
        self.inner.check_branch(self._inner_frames(H)[0])

    @property
    def preloaded(self) -> bool:
        """Whether there are springs with a prescribed rest value."""
        return self.inner.preloaded

    def preload(self, H: Array, part: float) -> None:
        """Apply a fraction of the preload of springs with a prescribed rest value."""
        self.inner.preload(self._inner_frames(H)[0], part)

    # --- history variables ---

    def accept(self, H: Array) -> None:
        """Update history variables that frames do not determine, at an accepted state."""
        self.inner.accept(self._inner_frames(H)[0])

    @property
    def history_variables(self) -> tuple[Array, ...]:
        """History variables that :meth:`accept` updates; arrays that may be written."""
        return self.inner.history_variables

    @property
    def history_keys(self) -> tuple[list[HistoryKey], ...]:
        """Joint and coordinate of each history variable, independent of other items."""
        return self.inner.history_keys

    # --- results ---

    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on side A of each item, in its axes there, to the rows of items."""
        frames, J = self._inner_frames(H)
        self.inner.wrenches(frames, self._twists(J, v), multipliers[self.own], out)

    def coordinates(self, H: Array, out: Array) -> None:
        """Set the coordinates of its items in ``out``, shape (c,)."""
        self.inner.coordinates(self._inner_frames(H)[0], out)

    def places(self) -> dict[int, Place]:
        """Positions of items; on an attachment relative to its nearest node at the start."""
        rows, found = self.constrained, {}
        for item, (row, offset, side, axes) in self.inner.places().items():
            at, force = self._outer(row), None if side is None else self._outer(side)
            if at is None:
                spot = rows.frames[row, 0] + offset @ rows.frames[row, 1:]
                at, offset = self._attachments.nearest(row - len(rows.moving), spot)
            found[item] = Place(at, offset, force, axes)
        return found

    def _outer(self, row: int) -> int | None:
        """Row of the system of a row of :attr:`inner`; ``None`` for an attachment."""
        rows = self.constrained
        if row >= rows.count:
            return int(rows.fixed[row - rows.count])
        return int(rows.moving[row]) if row < len(rows.moving) else None

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""
        return self.inner.outward

"""All contacts of a scene that have impacts: one table of pairs, and the results of a step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import uncounted
from fem_lie._jit.records import Record
from fem_lie.bodies.body import Body
from fem_lie.contact.cones.jacobian import along
from fem_lie.contact.contact import Contact
from fem_lie.contact.convex.table import polyhedra_of
from fem_lie.contact.impact.records import (
    BETWEEN,
    CLOSED,
    FIRST,
    SECOND,
    Masses,
    Touch,
    Work,
    work_of,
)
from fem_lie.contact.impact.rows import (
    find_crossed,
    find_jump,
    point_of,
    set_centres,
    set_gaps,
)
from fem_lie.contact.sides.kinematics import touched
from fem_lie.contact.sides.pairs import NearPairs, SlotPairs
from fem_lie.contact.sides.passage import Passage
from fem_lie.contact.sides.table import ROUND, Nodes, Side, joined_sides
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import cross, dot, load, load_row, plus, rotate_back, scaled

TIME, PAIR, GAP, POSITION, IMPULSE, SLIP, STICKS, WIDTH = 0, 1, 2, 3, 6, 9, 12, 13
"""Columns: end of the step, number of the pair, gap, contact point of the first side, impulse on
it, its tangential velocity (global components), and whether the contact sticks."""


@uncounted
def energy(masses: Masses, H: Array, v: Array) -> float:
    """Kinetic energy, and potential energy of constant forces."""
    total = 0.0
    for body in range(v.shape[0]):
        u, ω = load(v[body], 0), load(v[body], 3)
        total += 0.5 * masses.mass[body] * dot(u, u)
        for i in range(3):
            for j in range(3):
                total += 0.5 * ω[i] * masses.J[body, i, j] * ω[j]
        total -= dot(load(masses.force[body], 0), load_row(H[body], 0))
    return total


@uncounted
def note_works(w: Work, k: int, v: Array, report: Record) -> None:
    """Work of normal impulses and of friction impulses, with mean velocities."""
    problem = w.cones
    report.impact = report.friction = 0.0
    for i in range(k):
        for j in range(3):
            mean = 0.5 * (along(problem.rows, i, v, j) + along(problem.rows, i, w.v, j))
            if j == 0:
                report.impact += mean * problem.r[i, j]
            else:
                report.friction += mean * problem.r[i, j]


@uncounted
def note_ground(masses: Masses, w: Work, k: int, report: Record) -> None:
    """Impulse of ground on all bodies, and its moment about the origin."""
    problem = w.cones
    report.ground[:] = 0.0
    for i in range(k):
        block = problem.rows.first[i]
        if problem.rows.first[i + 1] - block > 1:  # a contact between two bodies
            continue
        body, impulse, turning = problem.rows.nodes[block], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for j in range(3):
            given = problem.responses.values[block, j]
            impulse = plus(impulse, scaled(problem.r[i, j] * masses.mass[body], load(given, 0)))
            turning = plus(turning, scaled(problem.r[i, j], load(given, 3)))
        J, H = masses.J[body], w.H[1, body]
        local = rotate_back(load_row(J, 0), load_row(J, 1), load_row(J, 2), turning)
        moment = plus(cross(load_row(H, 0), impulse), global_components(H, local))
        for j in range(3):
            report.ground[j] += impulse[j]
            report.ground[3 + j] += moment[j]


@uncounted
def show(
    time: float,
    h: float,
    touch: Touch,
    w: Work,
    k: int,
    ends: tuple[Array, Array],
    workspace: Array,
    count: Indices,
) -> None:
    """Append the first ``k`` active contacts with an impulse to the rows of ``workspace``.

    Args:
        time: End of the step.
        h: Step size; a contact that slides less than a closed gap in it sticks.
        touch: Pairs.
        w: Workspace of the step.
        k: Number of active contacts.
        ends: Frames and velocities, shape (n, 6), at the end.
        workspace: Rows of results, shape (·, :data:`WIDTH`), overwritten.
        count: Number of rows, shape (1,), updated.
    """
    problem, (H, v) = w.cones, ends
    for e in range(k):
        if not problem.r[e, 0] > 0.0:
            continue
        c, row = w.chosen[e], workspace[count[0]]
        at = touched(touch.a, touch.pairs[c, 0], point_of(H, touch, c))
        row[TIME], row[PAIR], row[GAP] = time, c, w.gaps[c]
        block = problem.rows.first[e]
        sign = 1.0 if touch.a.nodes[touch.pairs[c, 0], 0] >= 0 else -1.0
        impulse, slip = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for m in range(3):
            d = scaled(sign, load(problem.rows.values[block, m], 0))
            impulse = plus(impulse, scaled(problem.r[e, m], d))
            if m > 0:
                slip = plus(slip, scaled(along(problem.rows, e, v, m), d))
        for m in range(3):
            row[POSITION + m], row[IMPULSE + m], row[SLIP + m] = at[m], impulse[m], slip[m]
        slow = touch.closed[c] / h
        row[STICKS] = 1.0 if dot(slip, slip) <= slow * slow else 0.0
        count[0] += 1


_SMALL = 1e-4
"""Least length of a ball over the size of its body: gaps have the round-off of positions."""

_ROOM = 1.25
"""Room of a new workspace over the pairs that are there, so that few lists need another one."""


class Touching:
    """Pairs that may touch, and their state from step to step.

    Attributes:
        touch: The pairs.
        of: Index of the contact of each pair, shape (m,).
        work: Workspace of the pairs.
        polyhedra: Polyhedra whose contact manifolds are among the pairs.
        arms: Largest distance of a point of each body from its centre, shape (n,).
    """

    def __init__(
        self,
        contacts: Sequence[Contact],
        nodes: Nodes,
        sizes: Array,
        H: Array,
        on_masters: Callable[[Side], Side] | None = None,
        rotates: Flags | None = None,
    ) -> None:
        """Collect the contacts of a scene.

        Args:
            contacts: All contacts with the law :class:`~fem_lie.contact.Impact`.
            nodes: Gives the numbers of the nodes of a body in the scene.
            sizes: Characteristic lengths of the bodies, shape (n,).
            H: Initial frames, shape (n, 4, 3).
            on_masters: Expresses a side by the master nodes of its nodes; default: no node is
                rigidly attached to another.
            rotates: Nodes that have rotations, shape (n,); default: all.

        Raises:
            ValueError: Friction acts between balls neither of which rotates.
        """
        # slots of polyhedra are last
        contacts = sorted(contacts, key=lambda contact: len(contact.pair.impact.manifolds) > 0)
        manifolds = [list(contact.pair.impact.manifolds) for contact in contacts]
        sides = [contact.pair.impact.sides(nodes) for contact in contacts]
        if on_masters is not None:
            sides = [each._replace(a=on_masters(each.a), b=on_masters(each.b)) for each in sides]
        self._a, self._b = (
            joined_sides(parts) for parts in zip(*((a, b) for a, b, _, _ in sides), strict=True)
        )
        self._near = [
            (SlotPairs if own else NearPairs)(a, b, kind=kind, same=same)
            for own, (a, b, kind, same) in zip(manifolds, sides, strict=True)
        ]
        self.polyhedra = polyhedra_of(
            [pair for own in manifolds for pair in own], nodes, on_masters
        )
        for contact, near in zip(contacts, self._near, strict=True):
            if contact.ignore_initial:
                near.ignore(H)
        self._first = np.zeros((len(sides) + 1, 2), dtype=np.int64)
        self._first[1:] = np.cumsum([(len(a.radii), len(b.radii)) for a, b, _, _ in sides], axis=0)
        self._kinds = np.array([each.kind for each in sides])
        laws = [contact.law.impact(contact.label) for contact in contacts]
        numbers = [(law.friction, law.restitution) for law in laws]
        self._friction, self._restitution = np.array(numbers, dtype=np.float64).T.copy()
        self._lengths = [self._length(side, sizes) for side in (self._a, self._b)]
        rotates = np.ones(len(sizes), dtype=np.bool_) if rotates is None else rotates
        self._centred = [self._is_centred(side, rotates) for side in (self._a, self._b)]
        self._refuse_centred(contacts)
        self._keys = np.array([float(contact.key(nodes)) for contact in contacts])
        self._versions: tuple[int, ...] = ()
        self._count, self._room = len(sizes), -1
        self.arms = self._arms
        self.update(H)

    def update(self, H: Array, far: float = 0.0) -> None:
        """Update the lists of near pairs at frames ``H``, for steps that move points by ``far``."""
        self._far = far
        for each in self._near:
            each.part(H)
            each.widen(4.0 * far)
            each.update(H)
        versions = tuple(each.version for each in self._near)
        if versions == self._versions:
            return
        before = (self.touch.pairs, self.work.impulses.copy()) if self._versions else None
        self._versions = versions
        self._set()
        set_gaps(self.touch, H, 0, self.work.gaps)
        if before is not None:
            self._remember(*before)

    @staticmethod
    def _length(side: Side, sizes: Array) -> Array:
        """Radii of balls, and sizes of the bodies of points; zero for ground."""
        of_bodies = np.append(sizes, 0.0)[side.nodes[:, 0]]
        radii = np.maximum(np.abs(side.radii), _SMALL * of_bodies)
        return np.where(side.radii != 0.0, radii, of_bodies)

    @staticmethod
    def _is_centred(side: Side, rotates: Flags) -> Flags:
        """Balls on nodes without rotations, which take no moment."""
        found: Flags = ~np.append(rotates, True)[side.nodes[:, 0]] & (side.radii != 0.0)
        return found

    def _refuse_centred(self, contacts: Sequence[Contact]) -> None:
        for index, contact in enumerate(contacts):
            low, high = self._first[index : index + 2]
            a, b = (centred[low[k] : high[k]].any() for k, centred in enumerate(self._centred))
            if self._friction[index] and a and b:
                raise ValueError(
                    f"{contact.label}: friction acts between balls on nodes without rotations, "
                    "which take no moment; give no friction"
                )

    def _set(self) -> None:
        lists = [each.now + first for each, first in zip(self._near, self._first, strict=False)]
        pairs = np.concatenate(lists)
        self.of: Indices = np.repeat(np.arange(len(lists)), [len(each) for each in lists])
        of = self.of
        lengths = np.maximum(self._lengths[0][pairs[:, 0]], self._lengths[1][pairs[:, 1]])
        first, second = self._centred[0][pairs[:, 0]], self._centred[1][pairs[:, 1]]
        self.touch = Touch(
            self._a,
            self._b,
            pairs,
            self._kinds[of],
            self._friction[of],
            self._restitution[of],
            CLOSED * lengths,
            np.where(first, FIRST, np.where(second, SECOND, BETWEEN)),
            self.arms,
        )
        count, slots = len(pairs), self.polyhedra.slots
        slots += count - slots[-1]
        if count > self._room:
            self._room = int(_ROOM * count)
            self.work: Work = work_of(self._room, self._count)

    def _remember(self, pairs: Indices, impulses: Array) -> None:
        """Set the impulses of pairs that were in the list before; those of others are zero."""
        count = len(self._b.radii)
        touching = np.flatnonzero(impulses[: len(pairs)].any(axis=1))
        keys, old = (p[:, 0] * count + p[:, 1] for p in (self.touch.pairs, pairs[touching]))
        _, here, there = np.intersect1d(keys, old, return_indices=True)
        self.work.impulses[:] = 0.0
        self.work.impulses[here] = impulses[touching][there]

    def named(self, shown: Array) -> Array:
        """Rows of :func:`show`, with the key of the contact and both points instead of the pair."""
        pair = shown[:, PAIR].astype(np.int64)
        of = self.of[pair]
        positions = self.touch.pairs[pair] - self._first[of]
        parts = shown[:, :PAIR], self._keys[of, np.newaxis], positions, shown[:, PAIR + 1 :]
        return np.concatenate(parts, axis=1)

    @property
    def has_manifolds(self) -> bool:
        """Whether there are polyhedra; their many arrays take time to pass to compiled code."""
        return len(self.polyhedra.pairs) > 0

    def passed(self, start: Array, end: Array) -> tuple[int, Passage] | None:
        """A pair whose contact was missed in a step, and its motion; ``None``: there is none.

        Args:
            start: Frames at the start of the step.
            end: Frames at the end of the step.
        """
        if self.has_manifolds:
            pair = find_crossed(self.touch, self.polyhedra, start, end)
        else:
            pair = find_jump(self.touch, start, end)
        return None if pair < 0 else (pair, self.way(pair, start, end))

    def way(self, pair: int, start: Array, end: Array) -> Passage:
        """Relative motion of a pair in a step."""
        i, j = self.touch.pairs[pair]
        X = np.empty((2, 2, 3))
        for k, H in enumerate((start, end)):
            set_centres(H, self.touch, pair, X[k])
        separation = X[:, 0] - X[:, 1]
        reach = self._a.radii[i] + self._b.radii[j]
        of = int(np.searchsorted(self.polyhedra.slots, pair, side="right")) - 1
        if of >= 0:
            reach = self.polyhedra.thin[of]
        return Passage(float(np.linalg.norm(separation[1] - separation[0])), float(reach))

    def names(self, pair: int, bodies: Mapping[Body, Indices]) -> list[str]:
        """Labels of the bodies of a pair.

        Args:
            pair: Number of the pair.
            bodies: Independent nodes of each body.
        """
        labels = {int(node): body.label for body, nodes in bodies.items() for node in nodes}
        i, j = self.touch.pairs[pair]
        nodes = self._a.nodes[i, 0], self._b.nodes[j, 0]
        return [labels.get(int(node), "ground") for node in nodes]

    def saved_state(self) -> dict[str, Array]:
        """State that the next steps depend on."""
        pair_positions = {f"near.{k}": each.pair_positions for k, each in enumerate(self._near)}
        pair_positions["margins"] = np.array([each.margin for each in self._near])
        pair_positions["slots"] = self.polyhedra.ids.astype(np.float64)
        count, work = len(self.touch.pairs), self.work
        return pair_positions | {"gaps": work.gaps[:count], "impulses": work.impulses[:count]}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        for k, each in enumerate(self._near):
            each.widen(float(kept["margins"][k]))
            each.restore_pairs(kept[f"near.{k}"])
        self._versions = tuple(each.version for each in self._near)
        self._set()
        self.polyhedra.ids[:] = kept["slots"].astype(np.int64)
        count, work = len(self.touch.pairs), self.work
        work.gaps[:count], work.impulses[:count] = kept["gaps"], kept["impulses"]

    @property
    def _arms(self) -> Array:
        found = np.zeros(self._count)
        for side in (self._a, self._b):
            on = side.nodes >= 0
            np.maximum.at(found, side.nodes[on], np.linalg.norm(side.arms[on], axis=1))
        return found

    @property
    def thin(self) -> float:
        """Least sum of the radii of two balls; smaller displacements cannot skip a contact."""
        sums, ends = (
            [float(each) for each in self.polyhedra.thin],
            [self._first[:-1], self._first[1:]],
        )
        for (i, j), (after_i, after_j), kind in zip(*ends, self._kinds, strict=True):
            if kind == ROUND:
                sums.append(self._a.radii[i:after_i].min() + self._b.radii[j:after_j].min())
        return float(min((each for each in sums if each > 0.0), default=np.inf))

    @property
    def patience(self) -> float:
        """Largest displacement of points before the lists of near pairs have to be updated.

        It is that of one step if pairs are ignored until they separate.
        """
        if any(each.ignores for each in self._near):
            return self._far
        return min((each.patience for each in self._near if not each.fixed), default=np.inf)

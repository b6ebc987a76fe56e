"""All contacts of a scene by impacts: one table of pairs, and what they did in a step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.bodies.body import Body
from fem_lie.contact.contact import Contact
from fem_lie.contact.convex.features import APART, PLANE, ROUND
from fem_lie.contact.convex.table import polyhedra_of
from fem_lie.contact.impact.jacobian import along
from fem_lie.contact.impact.records import (
    CLOSED,
    FRICTION,
    GROUND,
    IMPACT,
    Masses,
    Touch,
    Work,
    work_of,
)
from fem_lie.contact.impact.rows import find_crossed, nearest, set_centres, set_gaps
from fem_lie.contact.impact.sweeps import Dense, Past
from fem_lie.contact.laws.law import Impact
from fem_lie.contact.sides.pairs import NearPairs, SlotPairs
from fem_lie.contact.sides.passage import Passage
from fem_lie.contact.sides.table import Nodes, Side, joined_sides
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import cross, dot, load, load_row, plus, rotate_back, scaled

TIME, PAIR, GAP, POSITION, IMPULSE, SLIP, STICKS, WIDTH = 0, 1, 2, 3, 6, 9, 12, 13
"""Columns: end of the step, number of the pair, gap, place of the first side, impulse on it, its
velocity across the normal, global components, and whether that is none."""


@uncounted
def energy(masses: Masses, H: Array, v: Array) -> float:
    """Kinetic, and that of constant forces."""
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
def note_works(w: Work, k: int, v: Array, told: Array) -> None:
    """Work of normal impulses and of friction, by the mean velocities of their rows."""
    problem = w.cones
    told[IMPACT], told[FRICTION] = 0.0, 0.0
    for i in range(k):
        for j in range(3):
            mean = 0.5 * (along(problem.rows, i, v, j) + along(problem.rows, i, w.v, j))
            told[IMPACT if j == 0 else FRICTION] += mean * problem.r[i, j]


@uncounted
def note_ground(masses: Masses, w: Work, k: int, told: Array) -> None:
    """Impulses of ground on bodies, and their moments about the origin."""
    problem = w.cones
    told[GROUND:] = 0.0
    for i in range(k):
        block = problem.rows.first[i]
        if problem.rows.first[i + 1] - block > 1:  # it is between two bodies
            continue
        body, impulse, turning = problem.rows.nodes[block], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for j in range(3):
            given = problem.pushes.values[block, j]
            impulse = plus(impulse, scaled(problem.r[i, j] * masses.mass[body], load(given, 0)))
            turning = plus(turning, scaled(problem.r[i, j], load(given, 3)))
        J, H = masses.J[body], w.H[1, body]
        local = rotate_back(load_row(J, 0), load_row(J, 1), load_row(J, 2), turning)
        moment = plus(cross(load_row(H, 0), impulse), global_components(H, local))
        for j in range(3):
            told[GROUND + j] += impulse[j]
            told[GROUND + 3 + j] += moment[j]


@uncounted
def show(
    time: float,
    h: float,
    touch: Touch,
    w: Work,
    k: int,
    ends: tuple[Array, Array],
    room: Array,
    count: Indices,
) -> None:
    """Append the first ``k`` contacts that take part and push, as rows of ``room``.

    Args:
        time: End of the step.
        h: Its size; what slides less than closed gaps in it sticks.
        touch: Pairs.
        w: Work of the step.
        k: How many take part.
        ends: Frames at the end, and velocities there, shape (n, 6).
        room: With room for them, shape (·, :data:`WIDTH`).
        count: How many rows there are, shape (1,), updated.
    """
    problem, (H, v) = w.cones, ends
    for e in range(k):
        if not problem.r[e, 0] > 0.0:
            continue
        c, row = w.chosen[e], room[count[0]]
        at, _ = nearest(H, touch, c)
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


def _arrays(record: tuple[object, ...]) -> Iterator[Array]:
    """All of them, of records in it, too, but for rooms of methods."""
    for each in record:
        if isinstance(each, Dense | Past):
            continue
        if isinstance(each, tuple):
            yield from _arrays(each)
        elif isinstance(each, np.ndarray):
            yield each


class Touching:
    """Pairs that may touch, and what is kept of them from step to step.

    Attributes:
        touch: The pairs.
        of: To which contact each belongs, shape (m,).
        work: Of these.
        polyhedra: Whose contact manifolds are among the pairs.
        arm: The largest distance of a place from the centre of its body.
    """

    def __init__(
        self,
        contacts: Sequence[Contact],
        nodes: Nodes,
        sizes: Array,
        H: Array,
        on_masters: Callable[[Side], Side] | None = None,
    ) -> None:
        """Join the contacts.

        Args:
            contacts: By impacts, all of them.
            nodes: Numbers of a body's nodes.
            sizes: Lengths of the bodies, shape (n,).
            H: Frames in the beginning, shape (n, 4, 3).
            on_masters: A side by the nodes that its nodes follow; default: none follows another.
        """
        # slots of polyhedra come last
        contacts = sorted(contacts, key=lambda contact: len(contact.pair.impact.manifolds) > 0)
        manifolds = [list(contact.pair.impact.manifolds) for contact in contacts]
        sides = [contact.pair.impact.sides(nodes) for contact in contacts]
        if on_masters is not None:
            sides = [each._replace(a=on_masters(each.a), b=on_masters(each.b)) for each in sides]
        self._a, self._b = (
            joined_sides(parts) for parts in zip(*((a, b) for a, b, _, _ in sides), strict=True)
        )
        self._near = [
            (SlotPairs if own else NearPairs)(a, b, flat=flat, same=same)
            for own, (a, b, flat, same) in zip(manifolds, sides, strict=True)
        ]
        self.polyhedra = polyhedra_of(
            [pair for own in manifolds for pair in own], nodes, on_masters
        )
        self.arm = self._arm
        for contact, near in zip(contacts, self._near, strict=True):
            if contact.ignore_initial:
                near.ignore(H)
        self._first = np.zeros((len(sides) + 1, 2), dtype=np.int64)
        self._first[1:] = np.cumsum([(len(a.radii), len(b.radii)) for a, b, _, _ in sides], axis=0)
        self._kinds = np.array(
            [
                APART if own else (PLANE if each.flat else ROUND)
                for own, each in zip(manifolds, sides, strict=True)
            ]
        )
        laws = [contact.law for contact in contacts]
        numbers = [(law.friction, law.restitution) for law in laws if isinstance(law, Impact)]
        self._friction, self._restitution = np.array(numbers, dtype=np.float64).T.copy()
        self._lengths = [self._length(side, sizes) for side in (self._a, self._b)]
        self._keys = np.array([float(contact.key(nodes)) for contact in contacts])
        self._versions: tuple[int, ...] = ()
        self._count = len(sizes)
        self.update(H)

    def update(self, H: Array, far: float = 0.0) -> None:
        """Look again who is near whom, at frames ``H`` before steps that move places so ``far``."""
        self._far = far
        for each in self._near:
            each.part(H)
            each.widen(4.0 * far)
            each.update(H)
        versions = tuple(each.version for each in self._near)
        if versions == self._versions:
            return
        before = (self.touch.pairs, self.work.impulses) if self._versions else None
        self._versions = versions
        self._set()
        set_gaps(self.touch, H, self.work.gaps)
        if before is not None:
            self._remember(*before)

    @staticmethod
    def _length(side: Side, sizes: Array) -> Array:
        """Radii of balls, and sizes of the bodies that points are on; zero of ground."""
        of_bodies = np.append(sizes, 0.0)[side.nodes[:, 0]]
        return np.where(side.radii != 0.0, np.abs(side.radii), of_bodies)

    def _set(self) -> None:
        lists = [each.now + first for each, first in zip(self._near, self._first, strict=False)]
        pairs = np.concatenate(lists)
        self.of: Indices = np.repeat(np.arange(len(lists)), [len(each) for each in lists])
        of = self.of
        self.touch = Touch(
            self._a,
            self._b,
            pairs,
            self._kinds[of],
            self._friction[of],
            self._restitution[of],
            CLOSED * np.maximum(self._lengths[0][pairs[:, 0]], self._lengths[1][pairs[:, 1]]),
            self.arm,
        )
        count, slots = len(pairs), self.polyhedra.slots
        slots += count - slots[-1]
        self.work: Work = work_of(count, self._count)

    def _remember(self, pairs: Indices, impulses: Array) -> None:
        """Take over impulses of the pairs that there were."""
        count = len(self._b.radii)
        keys, old = (p[:, 0] * count + p[:, 1] for p in (self.touch.pairs, pairs))
        _, here, there = np.intersect1d(keys, old, return_indices=True)
        self.work.impulses[here] = impulses[there]

    def named(self, shown: Array) -> Array:
        """Rows of :mod:`.observed`; key of the contact and both its places instead of the pair."""
        pair = shown[:, PAIR].astype(np.int64)
        of = self.of[pair]
        places = self.touch.pairs[pair] - self._first[of]
        parts = shown[:, :PAIR], self._keys[of, np.newaxis], places, shown[:, PAIR + 1 :]
        return np.concatenate(parts, axis=1)

    def passed(self, start: Array, end: Array) -> tuple[int, Passage] | None:
        """A pair whose contact was missed in a step, and how far it moved; None: there is none.

        Args:
            start: Frames at the start of the step.
            end: At its end.
        """
        pair = find_crossed(self.touch, self.polyhedra, start, end)
        return None if pair < 0 else (pair, self.way(pair, start, end))

    def way(self, pair: int, start: Array, end: Array) -> Passage:
        """How a pair moved in a step."""
        i, j = self.touch.pairs[pair]
        X = np.empty((2, 2, 3))
        for k, H in enumerate((start, end)):
            set_centres(H, self.touch, pair, X[k])
        apart = X[:, 0] - X[:, 1]
        reach = self._a.radii[i] + self._b.radii[j]
        of = int(np.searchsorted(self.polyhedra.slots, pair, side="right")) - 1
        if of >= 0:
            reach = self.polyhedra.thin[of]
        return Passage(float(np.linalg.norm(apart[1] - apart[0])), float(reach))

    def names(self, pair: int, bodies: Mapping[Body, Indices]) -> list[str]:
        """Of the bodies of a pair.

        Args:
            pair: Its number.
            bodies: Nodes of each body, those that lead.
        """
        labels = {int(node): body.label for body, nodes in bodies.items() for node in nodes}
        i, j = self.touch.pairs[pair]
        nodes = self._a.nodes[i, 0], self._b.nodes[j, 0]
        return [labels.get(int(node), "ground") for node in nodes]

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        seen = {f"near.{k}": each.seen for k, each in enumerate(self._near)}
        seen["skins"] = np.array([each.skin for each in self._near])
        seen["slots"] = self.polyhedra.ids.astype(np.float64)
        return seen | {f"work.{k}": values for k, values in enumerate(_arrays(self.work))}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for k, each in enumerate(self._near):
            each.widen(float(kept["skins"][k]))
            each.see_again(kept[f"near.{k}"])
        self._versions = tuple(each.version for each in self._near)
        self._set()
        self.polyhedra.ids[:] = kept["slots"].astype(np.int64)
        for k, values in enumerate(_arrays(self.work)):
            values[...] = kept[f"work.{k}"]

    @property
    def _arm(self) -> float:
        levers = [side.levers[side.nodes[:, 0] >= 0, 0] for side in (self._a, self._b)]
        return float(np.linalg.norm(np.concatenate(levers), axis=1).max(initial=0.0))

    @property
    def thin(self) -> float:
        """The least sum of radii of balls in what touches: who moves less jumps over nothing."""
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
        """How far places may move until the list has to be looked at again.

        That is for one step where pairs are ignored until they part.
        """
        if any(each.ignores for each in self._near):
            return self._far
        return min((each.patience for each in self._near if not each.fixed), default=np.inf)

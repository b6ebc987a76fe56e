"""Contact forces in each state of a result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Flags, Indices, instance
from fem_lie._summary import Summarised
from fem_lie.contact.contact import Contact
from fem_lie.contact.laws.law import ContactTerm
from fem_lie.forms.abilities import FRICTION_COLUMNS
from fem_lie.pictures.bodies import Arrows
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in, require_states, state_number


@dataclass(frozen=True, eq=False, repr=False)
class ContactForces(Summarised):
    """All active contact points in T states, one state after the other.

    Attributes:
        states: Index of the state of each row, among the T, increasing, shape (k,).
        points: Numbers of the points of both sides, in the order of their surfaces, shape (k, 2); a
            plane or a hollow sphere is on the second side.
        gaps: Gaps, negative where surfaces overlap, shape (k,).
        positions: Closest point of the first side, global components, shape (k, 3).
        forces: Contact force on the first side with friction, global components, shape (k, 3); for
            impacts the impulse of the last step divided by the step size. Friction of a penalty
            along lines acts at Gauss points of its own, which are rows of their own.
        count: T.
        impulses: For impacts: impulse in the last step, shape (k, 3).
        slips: For impacts: tangential velocity of the first side, shape (k, 3).
        sticks: For impacts: whether that is zero to round-off, shape (k,).
    """

    states: Indices
    points: Indices
    gaps: Array
    positions: Array
    forces: Array
    count: int
    impulses: Array | None = None
    slips: Array | None = None
    sticks: Flags | None = None

    @property
    def total(self) -> Array:
        """Resultant on the first side in each state, shape (T, 3)."""
        found = np.zeros((self.count, 3))
        np.add.at(found, self.states, self.forces)
        return found

    @property
    def touching(self) -> Indices:
        """Number of active contact points in each state, shape (T,)."""
        return np.bincount(self.states, minlength=self.count)

    @property
    def penetration(self) -> Array:
        """Largest overlap in each state, zero without contact, shape (T,)."""
        found = np.zeros(self.count)
        np.maximum.at(found, self.states, -self.gaps)
        return found

    def arrows(self, state: int = -1) -> Arrows:
        """Forces in a state, for pictures: ``result.picture(name, arrows=found.arrows())``.

        Args:
            state: Index of the state among the T; default: the last one.

        Raises:
            ValueError: There is no such state.
        """
        here = self.states == state_number(state, self.count)
        return Arrows(self.positions[here], self.forces[here])


def contact_forces(
    result: Result | StaticResult, contact: Contact, states: Sequence[int] | None = None
) -> ContactForces:
    """Contact forces of a contact in states of a result.

    Args:
        result: A result of dynamics, of statics or of a path, of a scene with the contact.
        contact: The contact.
        states: Indices of the states; default: all.

    Raises:
        ValueError: A body of the contact is not in the result, or there is no such state, or the
            result has no impulses or no friction forces of the contact.
    """
    require_states(result)
    instance(contact, Contact, "contact", "a Contact")
    nodes = {body: nodes_in(result.info, body) for body in contact.bodies}
    count = len(result.frames)
    chosen = range(count) if states is None else [state_number(state, count) for state in states]
    key = contact.key(nodes.__getitem__)
    if contact.law.impulsive:
        return _of_impacts(result, key, chosen)
    friction = _friction_of(result, contact, key)
    term = contact.term(nodes.__getitem__)
    if not term.ignores:
        found = [_in_state(term, result, k) for k in chosen]
    else:
        # ignored pairs depend on all earlier states
        every = [_in_state(term, result, k) for k in range(max(chosen, default=-1) + 1)]
        found = [every[k] for k in chosen]
    found = [
        _with_friction(each, friction[friction[:, 0] == k])
        for k, each in zip(chosen, found, strict=True)
    ]
    rows = np.repeat(np.arange(len(found)), [len(each[0]) for each in found])
    points, gaps, positions, forces = (np.concatenate(part) for part in zip(*found, strict=True))
    return ContactForces(rows, points, gaps, positions, forces, len(found))


def _in_state(
    term: ContactTerm, result: Result | StaticResult, k: int
) -> tuple[Indices, Array, Array, Array]:
    """Points, gaps, positions and forces of active contact points."""
    H = np.ascontiguousarray(result.frames[k])
    if term.ignores:
        term.accept(H)
    v = np.zeros((len(H), 6))
    if isinstance(result, Result):
        v[:] = result.velocities[k]
    return term.touching(H, v)


def _friction_of(result: Result | StaticResult, contact: Contact, key: int) -> Array:
    """Rows of :class:`~fem_lie.results.record.FrictionForces` of a contact by penalty."""
    if not contact.has_friction:
        return np.empty((0, 2 + FRICTION_COLUMNS))
    if result.friction is None:
        raise ValueError(
            f"contact_forces: the result has no friction forces of {contact.label}. They are "
            "recorded at the ends of steps that do not conserve energy: expected a result of a run "
            "with save_every=..., not with times between steps, and with Record.FORCES"
        )
    rows = result.friction.each
    return rows[rows[:, 1] == key]


def _with_friction(
    normal: tuple[Indices, Array, Array, Array], friction: Array
) -> tuple[Indices, Array, Array, Array]:
    """Contact points of a state with friction forces, which may act at other points."""
    points, gaps, positions, forces = normal
    pairs = friction[:, 2:4].astype(np.int64)
    same = (pairs[:, np.newaxis] == points).all(axis=2)
    at, here = np.nonzero(same)
    np.add.at(forces, here, friction[at, 8:])
    others = ~same.any(axis=1)
    return (
        np.concatenate([points, pairs[others]]),
        np.concatenate([gaps, friction[others, 4]]),
        np.concatenate([positions, friction[others, 5:8]]),
        np.concatenate([forces, friction[others, 8:]]),
    )


def _of_impacts(result: Result | StaticResult, key: int, chosen: Sequence[int]) -> ContactForces:
    """Contacts with an impulse in the last step before each of the states."""
    recorded = result.contacts if isinstance(result, Result) else None
    if recorded is None or not isinstance(result, Result):
        raise ValueError("contact_forces: the result has no contacts by impacts")
    step, rows = float(recorded.times[0]), recorded.each[recorded.each[:, 1] == key]
    here = [np.flatnonzero(np.abs(rows[:, 0] - result.times[k]) < 0.49 * step) for k in chosen]
    states = np.repeat(np.arange(len(here)), [len(each) for each in here])
    rows = rows[np.concatenate([*here, np.zeros(0, dtype=np.int64)])]
    return ContactForces(
        states,
        rows[:, 2:4].astype(np.int64),
        rows[:, 4],
        rows[:, 5:8],
        rows[:, 8:11] / step,
        len(here),
        rows[:, 8:11],
        rows[:, 11:14],
        rows[:, 14] > 0.0,
    )

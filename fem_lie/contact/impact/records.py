"""What compiled functions of impacts are given, what they work with, and what they tell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.impact.jacobian import BlockRows, empty_rows
from fem_lie.contact.impact.sweeps import Cones, cones_of
from fem_lie.contact.sides.table import Side

CLOSED = 1e-9
"""Gaps of closed contacts, as a part of a length of theirs; over a step it is a speed."""

CONTACTS, SWEEPS, RESIDUAL, PENETRATION, IMPACT, FRICTION, GROUND = range(7)
"""Places in what is told of a step; from the last on impulse of ground and its moment, six."""
TOLD = GROUND + 6

LARGEST = 1e-3
"""Residual of the cones with which a step has failed."""


class Touch(NamedTuple):
    """Pairs of places that may touch.

    Attributes:
        a: First places, on rigid bodies or ground.
        b: Second ones, or planes.
        pairs: Shape (m, 2).
        kinds: What the pairs are, :data:`~fem_lie.contact.convex.features.ROUND` and others, (m,).
        friction: μ, shape (m,).
        restitution: e, shape (m,).
        closed: Gap below which a contact is closed, shape (m,).
        arm: The largest distance of a place from the centre of its body.
    """

    a: Side
    b: Side
    pairs: Indices
    kinds: Indices
    friction: Array
    restitution: Array
    closed: Array
    arm: float


class Masses(NamedTuple):
    """What impulses do to bodies.

    Attributes:
        mass: Shape (n,).
        J: Inertia tensors in the bodies' axes, shape (n, 3, 3).
        inverse: Of these, shape (n, 3, 3).
        force: Constant forces on the bodies, which have a potential, shape (n, 3).
    """

    mass: Array
    J: Array
    inverse: Array
    force: Array


class Work(NamedTuple):
    """Of a step.

    Attributes:
        cones: Of the contacts that take part.
        chosen: Which those are, shape (m,).
        joined: Whether a contact takes part, shape (m,).
        gaps: At the start of a step, and at its end, shape (m,).
        smooth: At the end of the step without contacts, shape (m,).
        before: Rows at the start of those that were closed.
        speed: Along the normal at the start, shape (m,).
        incoming: At the time of the impact, shape (m,).
        part: Of the step up to it, shape (m,).
        target: Gap that is reached, shape (m,).
        nu: Impulses times times that move bodies apart, shape (m,).
        apart: Gaps less those targets, shape (m,).
        impulses: In the last step, shape (m, 3).
        rows: Normal rows.
        pushes: Velocities by unit impulses along these.
        own: Their products at one contact, shape (m,).
        last: ``nu`` after the last sweep, in the order of ``near``, shape (m,).
        turned: ``moved`` then, shape (n, 6).
        moved: Of bodies, shape (n, 6).
        H: Frames without contacts, and those of the last pass, shape (2, n, 4, 3).
        v: Velocities without contacts, shape (n, 6).
        mean: A block of a force, shape (3, 6).
        near: Contacts whose places are looked at, shape (m,).
        axis: By which tangents are chosen, shape (m,).
        close: Which may touch in this step at all, shape (m,).
        many: How many these are, shape (1,).
    """

    cones: Cones
    chosen: Indices
    joined: Flags
    gaps: Array
    smooth: Array
    before: BlockRows
    speed: Array
    incoming: Array
    part: Array
    target: Array
    nu: Array
    apart: Array
    impulses: Array
    rows: BlockRows
    pushes: BlockRows
    own: Array
    last: Array
    turned: Array
    moved: Array
    H: Array
    v: Array
    mean: Array
    near: Indices
    axis: Indices
    close: Indices
    many: Indices


_BODIES = 2
"""Nodes at one contact of rigid bodies."""


def _pushes_of(rows: BlockRows) -> BlockRows:
    """Rows of ``M⁻¹ B̄ᵀ`` of free rigid bodies: those of the same nodes."""
    return rows._replace(values=np.zeros_like(rows.values))


def work_of(m: int, n: int) -> Work:
    """Of ``m`` pairs of places and ``n`` bodies."""
    z = np.zeros
    rows, normals = (empty_rows(m, _BODIES, components) for components in (3, 1))
    before = empty_rows(m, _BODIES, 3)
    before.first[:] = _BODIES * np.arange(m + 1)
    problem = cones_of(rows, _pushes_of(rows), n)
    whole = np.zeros(m, dtype=np.int64)
    return Work(
        cones=problem,
        chosen=whole.copy(),
        joined=np.zeros(m, dtype=np.bool_),
        gaps=z(m),
        smooth=z(m),
        before=before,
        speed=z(m),
        incoming=z(m),
        part=z(m),
        target=z(m),
        nu=z(m),
        apart=z(m),
        impulses=z((m, 3)),
        rows=normals,
        pushes=_pushes_of(normals),
        own=z(m),
        last=z(m),
        turned=z((n, 6)),
        moved=z((n, 6)),
        H=z((2, n, 4, 3)),
        v=z((n, 6)),
        mean=z((3, 6)),
        near=whole.copy(),
        axis=whole.copy(),
        close=whole.copy(),
        many=np.zeros(1, dtype=np.int64),
    )

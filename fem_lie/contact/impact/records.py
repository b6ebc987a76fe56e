"""Records of the compiled impact solver: its input, its workspace and what it reports."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit.records import Records, record_type
from fem_lie.contact.cones.jacobian import BlockRows, empty_rows
from fem_lie.contact.cones.sweeps import Cones, cones_of
from fem_lie.contact.sides.table import Side

CLOSED = 1e-9
"""Gap of a closed contact relative to a length of the pair; divided by a step, a velocity."""

BETWEEN, FIRST, SECOND = 0, 1, 2
"""Where friction acts: at the contact point, or at the centre of the first or the second point. A
node without rotations takes no moment, so friction acts at its position, on the other side as well,
which keeps the angular momentum."""

STEP_REPORT = record_type(
    contacts=float,
    sweeps=float,
    residual=float,
    penetration=float,
    impact=float,
    friction=float,
    ground=(float, 6),
)
"""Report of a step: number of active contacts and of sweeps, residual of the cones, largest
overlap, work of normal impulses and of friction, impulse of ground and its moment."""


def step_reports(steps: int) -> Records:
    """Zero reports of ``steps`` steps."""
    return np.zeros(steps, STEP_REPORT.layout)


LARGEST = 1e-3
"""Residual of the cones above which a step has failed."""


class Touch(NamedTuple):
    """Pairs of points that may touch.

    Attributes:
        a: First points, on rigid bodies or ground.
        b: Second points, or planes.
        pairs: Indices of both points, shape (m, 2).
        kinds: Kind of each pair, :data:`~fem_lie.contact.sides.table.ROUND` and others, (m,).
        friction: μ, shape (m,).
        restitution: e, shape (m,).
        closed: Gap below which a contact is closed, shape (m,).
        friction_at: Where friction acts: :data:`BETWEEN` and others, shape (m,).
        arms: Largest distance of a point of each body from its centre, shape (n,).
    """

    a: Side
    b: Side
    pairs: Indices
    kinds: Indices
    friction: Array
    restitution: Array
    closed: Array
    friction_at: Indices
    arms: Array


class Masses(NamedTuple):
    """Mass properties of the bodies.

    Attributes:
        mass: Mass, shape (n,).
        J: Inertia tensors in the bodies' axes, shape (n, 3, 3).
        inverse: Inverse inertia tensors, shape (n, 3, 3).
        force: Constant forces on the bodies, which have a potential, shape (n, 3).
    """

    mass: Array
    J: Array
    inverse: Array
    force: Array


class Work(NamedTuple):
    """Workspace of a step.

    Attributes:
        cones: Problem of the active contacts.
        chosen: Pairs of the active contacts, shape (m,).
        joined: Whether each pair is active, shape (m,).
        gaps: Gaps at the start of a step, then at its end, shape (m,).
        smooth: Gaps at the end of the step without contacts, shape (m,).
        before: Rows at the start, of contacts that were closed.
        speed: Normal velocity at the start, shape (m,).
        incoming: Normal velocity at the time of the impact, shape (m,).
        part: Fraction of the step before the impact, shape (m,).
        target: Target gap at the end, shape (m,).
        nu: Position impulses: impulses times time, which move bodies apart, shape (m,).
        separation: Gaps minus target gaps, shape (m,).
        impulses: Impulses in the last step, shape (m, 3).
        rows: Normal rows.
        responses: Velocities per unit impulse along these rows.
        own: Products of both at the same contact, shape (m,).
        last: ``nu`` after the last sweep, in the order of ``near``, shape (m,).
        turned: ``moved`` after the last sweep, shape (n, 6).
        moved: Displacements of the bodies, shape (n, 6).
        H: Frames without contacts, and those of the last pass, shape (2, n, 4, 3).
        v: Velocities without contacts, shape (n, 6).
        mean: Workspace for a block of forces, shape (3, 6).
        near: Pairs whose positions are corrected, shape (m,).
        axis: Axis from which the tangents are made, shape (m,).
        close: Pairs that may touch in this step, shape (m,).
        many: Their number, shape (1,).
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
    separation: Array
    impulses: Array
    rows: BlockRows
    responses: BlockRows
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
"""Number of nodes at one contact of rigid bodies."""


def _responses_of(rows: BlockRows) -> BlockRows:
    """Uninitialised rows of ``M⁻¹ B̄ᵀ`` of free rigid bodies, with the same nodes as ``B``."""
    return rows._replace(values=np.zeros_like(rows.values))


def work_of(m: int, n: int) -> Work:
    """Workspace for ``m`` pairs of points and ``n`` bodies."""
    z = np.zeros
    rows, normals = (empty_rows(m, _BODIES, components) for components in (3, 1))
    before = empty_rows(m, _BODIES, 3)
    before.first[:] = _BODIES * np.arange(m + 1)
    problem = cones_of(rows, _responses_of(rows), n)
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
        separation=z(m),
        impulses=z((m, 3)),
        rows=normals,
        responses=_responses_of(normals),
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

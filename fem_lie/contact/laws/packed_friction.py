"""Friction of all pairs of a contact in one compiled call, with tables of stations and anchors.

A call with a record of many arrays spends more time on these than on the work for a few pairs.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._jit.packed_arrays import unpacking
from fem_lie.contact.laws import friction_over_steps as over_steps
from fem_lie.contact.laws.anchors import (
    Anchors,
    CoulombLaw,
    add_tractions,
    clear,
    empty_anchors,
    found,
    overlap_energy,
    set_anchors,
    set_rows,
    slip_work,
    tractions,
)
from fem_lie.contact.laws.damped_friction import damping_tractions
from fem_lie.contact.sides.table import stations_of
from fem_lie.forms.abilities import Ends
from fem_lie.lie.tuples import dot, load_row

_anchors_of = unpacking(Anchors)


@compiled
def set_tractions(H: Array, stations: Indices, anchors: Indices, law: CoulombLaw, τ: Array) -> None:
    """Set the tractions of all pairs, shape (m, 3).

    Args:
        H: Frames.
        stations: Table of stations.
        anchors: Table of anchors.
        law: Constants.
        τ: Overwritten.
    """
    points, known = stations_of(stations), _anchors_of(anchors)
    tractions(H, points.at, known, found(known.keys, points.keys), law, τ)


@compiled
def add_friction(
    H: Array,
    types: Indices,
    stations: Indices,
    anchors: Indices,
    law: CoulombLaw,
    grounded: bool,
    out: Array,
) -> None:
    """Add friction forces to nodal forces, for all pairs or for pairs with ground only.

    Args:
        H: Frames.
        types: Types of all nodes.
        stations: Table of stations.
        anchors: Table of anchors.
        law: Constants.
        grounded: Whether only pairs with ground count.
        out: Updated, (≥ nodes, 6).
    """
    points, known = stations_of(stations), _anchors_of(anchors)
    which, τ = found(known.keys, points.keys), np.empty((points.keys.shape[0], 3))
    tractions(H, points.at, known, which, law, τ)
    add_tractions(H, types, points.at, known, which, τ, grounded, out)


@compiled
def spring_energy(H: Array, stations: Indices, anchors: Indices, law: CoulombLaw) -> float:
    """Energy stored in the tangential springs; arguments as for :func:`add_friction`."""
    points, known = stations_of(stations), _anchors_of(anchors)
    τ, total = np.empty((points.keys.shape[0], 3)), 0.0
    tractions(H, points.at, known, found(known.keys, points.keys), law, τ)
    for e in range(τ.shape[0]):
        t = load_row(τ, e)
        total += dot(t, t) * points.at.weight[e]
    return 0.5 / law.holding * total


@compiled
def set_again(
    H: Array,
    middle: Array,
    types: Indices,
    stations: Indices,
    anchors: tuple[Indices, Indices],
    law: CoulombLaw,
    τ: Array,
) -> tuple[float, float]:
    """Set anchors anew, with springs that have the tractions ``τ``, shape (m, 3).

    Args:
        H: Frames.
        middle: Frames at which the points of both sides meet.
        types: Types of all nodes.
        stations: Table of stations.
        anchors: Tables of the anchors before, and of those that are set; may be the same.
        law: Constants.
        τ: Tractions.

    Returns:
        The energy of the overlaps, and the work of slip since the anchors were set before.
    """
    (at, keys, a, b), known = stations_of(stations), _anchors_of(anchors[0])
    m, after = keys.shape[0], _anchors_of(anchors[1])
    springs, forces = np.empty((m, 3)), np.empty((m, 3))
    for e in range(m):
        for k in range(3):
            springs[e, k] = τ[e, k] / law.holding
            forces[e, k] = at.weight[e] * τ[e, k]
    lost = slip_work(H, known, found(keys, known.keys), forces, springs)
    clear(after)
    set_anchors(H, middle, types, at, a, b, springs, after)
    after.keys[:] = keys
    after.forces[:] = forces
    return overlap_energy(H, at, law.normal), lost


@compiled
def friction_rows(
    H: Array,
    v: Array,
    types: Indices,
    stations: Indices,
    anchors: Indices,
    law: CoulombLaw,
    out: Array,
) -> int:
    """Set the rows of pairs with friction forces, see :func:`.anchors.set_rows`; their number.

    Args:
        H: Frames.
        v: Twists.
        types: Types of all nodes.
        stations: Table of stations.
        anchors: Table of anchors.
        law: Constants.
        out: Zero before, shape (m, 9).
    """
    (at, keys, _, _), known = stations_of(stations), _anchors_of(anchors)
    which, forces = found(known.keys, keys), np.empty((keys.shape[0], 3))
    damping_tractions(H, v, types, at, known, which, law, forces)
    for e in range(keys.shape[0]):
        for k in range(3):
            forces[e, k] *= at.weight[e]
            if which[e] >= 0:
                forces[e, k] += known.forces[which[e], k]
    set_rows(H, types, at, which, forces, out)
    count = 0
    for e in range(keys.shape[0]):
        if out[e, 6] != 0.0 or out[e, 7] != 0.0 or out[e, 8] != 0.0:
            for k in range(out.shape[1]):
                out[count, k] = out[e, k]
            count += 1
    return count


@compiled
def add_over_step(
    ends: Ends,
    types: Indices,
    stations: Indices,
    anchors: Indices,
    law: CoulombLaw,
    held: Array,
    out: Array,
    ground: Array,
) -> tuple[float, float, float]:
    """Add the friction forces of a step.

    Args:
        ends: Both ends of the step.
        types: Types of all nodes.
        stations: Table of stations at the end.
        anchors: Table of anchors.
        law: Constants.
        held: Tractions of the springs at the end, overwritten, shape (m, 3).
        out: Forces and moments, see :func:`.friction_over_steps.add_over_step`.
        ground: The same.

    Returns:
        Energy stored at the end, work done, and the dissipated part of it.
    """
    (at, keys, _, _), known = stations_of(stations), _anchors_of(anchors)
    m = keys.shape[0]
    arms, over = empty_anchors(m), over_steps.empty_slips(m)
    over_steps.set_over_step(ends, types, at, known, found(known.keys, keys), law, arms, over)
    over_steps.add_over_step(ends, types, at, arms, over.τ, out, ground)
    held[:] = over.held
    return over_steps.energies(law, at, over)

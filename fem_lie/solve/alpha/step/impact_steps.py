"""Steps of free rigid bodies that touch, compiled: the step without contacts, then these."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.contact.convex.table import Polyhedra
from fem_lie.contact.impact import records
from fem_lie.contact.impact.positions import deepest
from fem_lie.contact.impact.records import FRICTION, GROUND, IMPACT, LARGEST, Masses, Touch, Work
from fem_lie.contact.impact.resolve import resolve
from fem_lie.contact.impact.rows import find_crossed, set_ahead
from fem_lie.contact.impact.touching import show
from fem_lie.contact.impact.velocities import largest_speed
from fem_lie.lie.motions import to_local
from fem_lie.lie.tuples import load_row, negative, rotate_back, scaled, store
from fem_lie.solve.alpha.step.free_body import (
    BODY,
    INCREMENT,
    RESIDUAL,
    Bodies,
    Body,
    End,
    Kept,
    Loads,
    Options,
    Plan,
    Start,
    State,
    make_step,
    residual,
)
from fem_lie.solve.alpha.step.free_steps import act, book, load_of
from fem_lie.solve.alpha.step.node import Scheme

MADE, STALE, FAILED, UNSETTLED, CROSSED, FULL, OVERLAPPING = range(7)
"""Why steps end: all are made; it has to be looked again who is near whom; a body's iteration has
failed; contacts have not settled; a ball has gone through another; there is no more room for what
results have of contacts; bodies still overlap."""


class Contacts(NamedTuple):
    """What contacts need besides.

    Attributes:
        tolerance: Of the residual of the cones.
        patience: How far places may move until it has to be looked again.
        arm: The largest distance of a place from its body's centre.
        thin: How far places move at least that go through others.
        failed: The pair that went through each other or still overlaps, shape (1,).
        sum: How far they may have moved, shape (1,).
        times: At the ends of these steps, shape (last − first + 1,).
        told: Of these steps, see :data:`fem_lie.contact.impact.records.REPORT_SIZE`, shape (·, 13).
        booked: Work of contacts, and impulse of ground and its moment so far, shape (7,).
        done: These at the rows of these steps, shape (kept, 7).
        room: For what results have of each contact, see :mod:`fem_lie.contact.impact.touching`.
        shown: How many rows of it are filled, shape (1,).
    """

    tolerance: float
    patience: float
    arm: float
    thin: float
    failed: Indices
    sum: Array
    times: Array
    told: Array
    booked: Array
    done: Array
    room: Array
    shown: Indices


@compiled
def _accelerate(m: float, J: Array, inverse: Array, f: Array, here: Start) -> None:
    """Accelerations without contacts, after velocities have jumped."""
    for k in range(6):
        here.vdot[k] = 0.0
    force, moment = residual(1, m, J, f, here.H, here.v, here.vdot)
    store(here.vdot, 0, scaled(-1.0 / m, force))
    rows = load_row(inverse, 0), load_row(inverse, 1), load_row(inverse, 2)
    store(here.vdot, 3, negative(rotate_back(*rows, moment)))
    for k in range(6):
        here.a[k] = here.vdot[k]


@inlined
def _changed(v: Array, smooth: Array, H: Array, before: Array) -> bool:
    """Whether contacts have changed a body, shapes (6,) and (4, 3)."""
    for k in range(6):
        if v[k] != smooth[k]:
            return True
    return H[0, 0] != before[0, 0] or H[0, 1] != before[0, 1] or H[0, 2] != before[0, 2]


@inlined
def _take_back(state: State, H: Array, v: Array) -> None:
    """Frames and velocities are those of the start of the step again."""
    state.H[:], state.v[:] = H, v


@linked
def advance(
    p: Scheme,
    options: Options,
    bodies: Bodies,
    loads: Loads,
    amplitude: Array,
    state: State,
    plan: Plan,
    rows: Kept,
    touch: Touch,
    polyhedra: Polyhedra,
    masses: Masses,
    work: Work,
    contacts: Contacts,
) -> tuple[int, int, int]:
    """Steps ``first … last`` of all bodies; as :func:`~.free_steps.advance`, with contacts.

    Frames and velocities after a step that failed are those of its start.

    Returns:
        The last step that was made, the number of factorisations, and why it ended there.
    """
    always = Options(options.tolerance, options.limit, 1, 0.0, False)
    mass, J, scaling, group = bodies
    n = len(mass)
    end = End(np.empty(6), np.empty((4, 3)), np.empty(6), np.empty(6), np.empty(6))
    f, rate, note, twist, seen = (
        np.empty((n, 12)),
        np.empty(6),
        np.zeros(3),
        np.empty(6),
        np.empty(7),
    )
    H0, v0, factorisations, row = np.empty_like(state.H), np.empty_like(state.v), 0, plan.row
    for index in range(plan.first, plan.last + 1):
        speed = largest_speed(state.v, contacts.arm)
        if contacts.sum[0] + p.h * speed > contacts.patience:
            return index - 1, factorisations, STALE
        if contacts.shown[0] + touch.pairs.shape[0] > contacts.room.shape[0]:
            return index - 1, factorisations, FULL
        at = index - plan.first
        H0[:], v0[:] = state.H, state.v
        for i in range(n):
            body = Body(group[i], mass[i], J[i], scaling[i])
            here = Start(
                state.H[i], state.v[i], state.vdot[i], state.a[i], state.memory[i], state.kept[i]
            )
            load_of(loads, amplitude[at], i, f[i])
            count, made = make_step(p, options, body, f[i], here, end, note)
            factorisations += made
            if count == 0 and options.rescue:
                count, made = make_step(p, always, body, f[i], here, end, note)
                factorisations += made
            if count == 0:
                rows.failed[BODY] = i
                rows.failed[INCREMENT], rows.failed[RESIDUAL] = note[INCREMENT], note[RESIDUAL]
                _take_back(state, H0, v0)
                return index - 1, factorisations, FAILED
            rows.iterations[at] = max(count, rows.iterations[at])
        told = contacts.told[at]
        start = H0, v0
        set_ahead(touch, polyhedra, H0, state.H, work.gaps, work.impulses)
        if resolve(p.h, touch, masses, start, state.H, state.v, work, contacts.tolerance, told):
            if not told[records.RESIDUAL] <= LARGEST:
                _take_back(state, H0, v0)
                return index - 1, factorisations, UNSETTLED
            contacts.failed[0] = deepest(touch, work)
            if contacts.failed[0] >= 0:
                _take_back(state, H0, v0)
                return index - 1, factorisations, OVERLAPPING
            for i in range(n):
                if _changed(state.v[i], work.v[i], state.H[i], work.H[0, i]):
                    here = Start(
                        state.H[i],
                        state.v[i],
                        state.vdot[i],
                        state.a[i],
                        state.memory[i],
                        state.kept[i],
                    )
                    _accelerate(mass[i], J[i], masses.inverse[i], f[i], here)
            contacts.booked[0] -= told[IMPACT] + told[FRICTION]
            for k in range(6):
                contacts.booked[1 + k] += told[GROUND + k]
        speed = max(speed, largest_speed(state.v, contacts.arm))
        contacts.sum[0] += p.h * speed
        if p.h * speed > 0.5 * contacts.thin:
            contacts.failed[0] = find_crossed(touch, polyhedra, H0, state.H)
            if contacts.failed[0] >= 0:
                _take_back(state, H0, v0)
                return index - 1, factorisations, CROSSED
        kept = index % plan.every == 0 or index == plan.total
        for i in range(n):
            to_local(group[i], state.H[i], state.v[i], state.vdot[i], twist, rate)
            act(f[i], loads.constant[i], state.H[i], twist, seen)
            book(p.h, seen, state.rates[i], state.booked[i])
            if kept:
                rows.frames[row, i], rows.velocities[row, i] = state.H[i], twist
                rows.done[row - plan.row] += state.booked[i]
        if kept:
            many = int(told[records.CONTACTS])
            ends = state.H, state.v
            show(contacts.times[at], p.h, touch, work, many, ends, contacts.room, contacts.shown)
            contacts.done[row - plan.row] = contacts.booked
            row += 1
    return plan.last, factorisations, MADE

"""Steps of free rigid bodies with impacts, compiled: the step without contacts, then contacts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie._jit.records import Records
from fem_lie.contact.convex.table import Polyhedra
from fem_lie.contact.impact.positions import deepest
from fem_lie.contact.impact.records import LARGEST, Masses, Touch, Work
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
    Loads,
    Options,
    Plan,
    ResultRows,
    Start,
    State,
    make_step,
    residual,
)
from fem_lie.solve.alpha.step.free_steps import act, add_to_balance, load_of
from fem_lie.solve.alpha.step.node import Scheme

MADE, STALE, FAILED, UNSETTLED, CROSSED, FULL, OVERLAPPING = range(7)
"""Why the loop returns: all steps are made; the list of neighbours is outdated; the iteration of a
body has failed; contacts have not converged; a ball has passed through a surface; the buffer of
contact results is full; bodies still overlap."""


class Contacts(NamedTuple):
    """Further data of contacts.

    Attributes:
        tolerance: For the residual of the cones.
        patience: How far points may move until neighbours are searched again.
        arms: Largest distance of a point of each body from its centre, shape (n,).
        thin: Smallest motion at which points are checked for passing through surfaces.
        failed: Pair that passed through each other or still overlaps, shape (1,).
        sum: Bound on the motion since the last search, shape (1,).
        times: Times at the ends of these steps, shape (last − first + 1,).
        statistics: Contact statistics of these steps, see
            :data:`fem_lie.contact.impact.records.STEP_REPORT`, zero, shape (·,).
        balance: Work of contacts, impulse on the ground and its moment so far, shape (7,).
        done: The same at the recorded steps, shape (kept, 7).
        buffer: Buffer for the data of each contact, see :mod:`fem_lie.contact.impact.touching`.
        shown: Number of filled rows of the buffer, shape (1,).
    """

    tolerance: float
    patience: float
    arms: Array
    thin: float
    failed: Indices
    sum: Array
    times: Array
    statistics: Records
    balance: Array
    done: Array
    buffer: Array
    shown: Indices


@compiled
def _accelerate(m: float, J: Array, inverse: Array, f: Array, here: Start) -> None:
    """Accelerations without contacts, after a jump of velocities."""
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
    """Whether contacts have changed a body; shapes (6,) and (4, 3)."""
    for k in range(6):
        if v[k] != smooth[k]:
            return True
    return H[0, 0] != before[0, 0] or H[0, 1] != before[0, 1] or H[0, 2] != before[0, 2]


@inlined
def _take_back(state: State, H: Array, v: Array) -> None:
    """Restore frames and velocities at the start of the step."""
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
    rows: ResultRows,
    touch: Touch,
    polyhedra: Polyhedra,
    masses: Masses,
    work: Work,
    contacts: Contacts,
) -> tuple[int, int, int]:
    """Make steps ``first … last`` of all bodies as :func:`~.free_steps.advance`, with contacts.

    If a step failed, frames and velocities are those at its start.

    Returns:
        The last step made, the number of factorisations, and why the loop returned.
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
        speed = largest_speed(state.v, contacts.arms)
        if contacts.sum[0] + p.h * speed > contacts.patience:
            return index - 1, factorisations, STALE
        if contacts.shown[0] + touch.pairs.shape[0] > contacts.buffer.shape[0]:
            return index - 1, factorisations, FULL
        at = index - plan.first
        H0[:], v0[:] = state.H, state.v
        for i in range(n):
            body = Body(group[i], mass[i], J[i], scaling[i])
            here = Start(
                state.H[i],
                state.v[i],
                state.vdot[i],
                state.a[i],
                state.convergence[i],
                state.kept[i],
            )
            load_of(loads, amplitude[at], i, f[i])
            count, made = make_step(p, options, body, f[i], here, end, note)
            factorisations += made
            if count == 0 and options.full_newton_fallback:
                count, made = make_step(p, always, body, f[i], here, end, note)
                factorisations += made
            if count == 0:
                rows.failed[BODY] = i
                rows.failed[INCREMENT], rows.failed[RESIDUAL] = note[INCREMENT], note[RESIDUAL]
                _take_back(state, H0, v0)
                return index - 1, factorisations, FAILED
            rows.iterations[at] = max(count, rows.iterations[at])
        statistics = contacts.statistics[at]
        start = H0, v0
        set_ahead(touch, polyhedra, H0, state.H, work.gaps, work.impulses)
        if resolve(
            p.h, touch, masses, start, state.H, state.v, work, contacts.tolerance, statistics
        ):
            if not statistics.residual <= LARGEST:
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
                        state.convergence[i],
                        state.kept[i],
                    )
                    _accelerate(mass[i], J[i], masses.inverse[i], f[i], here)
            contacts.balance[0] -= statistics.impact + statistics.friction
            for k in range(6):
                contacts.balance[1 + k] += statistics.ground[k]
        speed = max(speed, largest_speed(state.v, contacts.arms))
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
            add_to_balance(p.h, seen, state.rates[i], state.balance[i])
            if kept:
                rows.frames[row, i], rows.velocities[row, i] = state.H[i], twist
                rows.done[row - plan.row] += state.balance[i]
        if kept:
            many = int(statistics.contacts)
            ends = state.H, state.v
            show(contacts.times[at], p.h, touch, work, many, ends, contacts.buffer, contacts.shown)
            contacts.done[row - plan.row] = contacts.balance
            row += 1
    return plan.last, factorisations, MADE

"""Explicit steps in one compiled loop."""

from __future__ import annotations

from typing import Annotated, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie._jit.packed_arrays import (
    Integers1,
    Integers2,
    Numbers1,
    Numbers2,
    Numbers3,
    one,
    unpacking,
)
from fem_lie._jit.records import Records, record_type
from fem_lie.bodies.balances import BY_REACTIONS
from fem_lie.lie.node_types import wrench
from fem_lie.lie.tuples import add_wrench, load_row
from fem_lie.solve.explicit.nodes import PlainMasses, decay, drift, kick, twists
from fem_lie.system.nodes.sums import residual
from fem_lie.system.outer_forces import look_and_sum_up

DONE, RESIDUAL = range(2)
"""Why the loop returns: the last step is made; a residual is needed."""

PROGRESS = record_type(step=int, phase=int)
"""Progress of a run: number of steps made, and phase within a step."""
BETWEEN, MOVED, WEIGHED = range(3)
"""Phases: between steps; forces are needed; forces are known."""

PlainSteps: TypeAlias = tuple[float, bool, bool, bool, bool, bool]
"""Plain tuple of :class:`Steps`."""


class Steps(NamedTuple):
    """Options of the loop.

    Attributes:
        h: Step size.
        summed: Whether forces are one compiled sum.
        accounts: Whether the loop updates the energy balance.
        held: Whether there are supports.
        loads: Whether loads contribute to the balance.
        joints: Whether springs contribute to it.
    """

    h: float
    summed: bool
    accounts: bool
    held: bool
    loads: bool
    joints: bool


class Packed(NamedTuple):
    """Arrays of a run.

    Attributes:
        masses: See :class:`~fem_lie.solve.explicit.nodes.Masses`.
        H: Frames of all nodes, ground and prescribed motions.
        p: Momenta, (n, 6).
        v: Twists, (n, 6).
        rest: Zeros, (n, 6).
        none: Multipliers, and their scale: empty.
        r: Residual, (6 n,).
        held: Fixed components of the residual.
        supports: Supported nodes, and which of their unknowns, as numbers.
        reaction: Force and moment of the supports about the origin, (6,).
        forces: Packed residual, see :func:`~fem_lie.system.nodes.sums.residual`.
        balance_table: See :func:`~fem_lie.system.outer_forces.look_and_sum_up`.
        balance: Energy balance and impulses so far.
        progress: See :data:`PROGRESS`.
        decay: Decay of momenta over half a step, see :func:`~fem_lie.solve.explicit.nodes.decay`.
    """

    masses: PlainMasses
    H: Numbers3
    p: Numbers2
    v: Numbers2
    rest: Numbers2
    none: Numbers1
    r: Numbers1
    held: Integers1
    supports: tuple[Integers1, Integers2]
    reaction: Numbers1
    forces: Integers2
    balance_table: Integers2
    balance: Numbers1
    progress: Annotated[Records, one(PROGRESS)]
    decay: Numbers2


_packed = unpacking(Packed)


@compiled
def reactions(
    kinds: Indices, H: Array, r: Array, nodes: Indices, held: Indices, out: Array
) -> None:
    """Resultant of the supports about the origin, (6,), from the nodes' residual at rest."""
    own = np.empty(6)
    out[:] = 0.0
    for s in range(nodes.shape[0]):
        i = nodes[s]
        for k in range(6):
            own[k] = r[6 * i + k] if held[s, k] else 0.0
        f, m = wrench(kinds[i], H[i], own)
        add_wrench(out, 0, load_row(H[i], 0), f, m)


@linked
def weigh(table: Indices, held: bool) -> None:
    """Forces at the current frames, in one sum, and support reactions there."""
    this = _packed(table)
    rest, none = this.rest, this.none
    residual(this.H, rest, rest, none, none, this.r, this.forces)
    if held:
        nodes, unknowns = this.supports
        reactions(this.masses[0], this.H, this.r, nodes, unknowns, this.reaction)
    for row in this.held:
        this.r[row] = 0.0


@inlined
def _add_reaction(balance: Array, reaction: Array, h: float) -> None:
    """Add half a step of it to the balance."""
    for k in range(6):
        balance[BY_REACTIONS + k] += 0.5 * h * reaction[k]


@linked
def look(table: Indices, steps: PlainSteps, h: float) -> None:
    """Account for loads and springs over the last time ``h``."""
    this, how = _packed(table), Steps(*steps)
    twists(this.masses, this.H, this.p, this.v)
    end = this.H, this.v, this.none, this.none
    look_and_sum_up(h, end, how.loads, how.joints, this.balance_table)


@linked
def _close(table: Indices, steps: PlainSteps) -> None:
    """Apply the forces of the second half of a step."""
    this, how = _packed(table), Steps(*steps)
    kick(this.masses, this.H, this.r, 0.5 * how.h, this.p)
    if how.accounts and (how.loads or how.joints):
        look(table, steps, how.h)


@linked
def run(table: Indices, steps: PlainSteps, last: int) -> int:
    """Advance to the end of step ``last``; returns why the loop returned.

    Args:
        table: Packed arrays, see :class:`Packed`.
        steps: Options of the loop.
        last: Last step.
    """
    this, how = _packed(table), Steps(*steps)
    progress, masses = this.progress[0], this.masses
    while True:
        if progress.phase == BETWEEN:
            if progress.step >= last:
                return DONE
            progress.step += 1
            kick(masses, this.H, this.r, 0.5 * how.h, this.p)
            decay(this.decay, this.p)
            drift(masses, this.p, how.h, this.H)
            decay(this.decay, this.p)
            progress.phase = MOVED
        if progress.phase == MOVED:
            progress.phase = WEIGHED
            if not how.summed:
                return RESIDUAL
            held = how.accounts and how.held
            if held:
                _add_reaction(this.balance, this.reaction, how.h)
            weigh(table, held)
            if held:
                _add_reaction(this.balance, this.reaction, how.h)
        _close(table, steps)
        progress.phase = BETWEEN

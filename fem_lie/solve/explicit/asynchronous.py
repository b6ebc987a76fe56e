r"""Asynchronous variational integration: every cell has its own step size.

The discrete action has a term for each cell and each of its steps. It is stationary if nodes move
freely, under dead loads only, between the times of their cells, and if a cell that is due applies
an impulse to its nodes, its force times its own step (Lew, Marsden, Ortiz & West, ARMA 167 (2003)
85). Momentum and angular momentum are exact, and the energy does not drift. With equal steps this
is the explicit scheme, of second order; otherwise it is at least of first order.

All other forces (contact, springs, pressure, loads in time) are one more cell with a step of its
own, and nodes with rotations or joints move with it, see :mod:`.outer`. This step divides the
largest one: its impulses, half a step before and half a step after each of its times, are complete
where results are reported. Without cells in the queue it is the explicit scheme.

The step of a cell is a fraction of the smallest ``2/ω`` of its nodes (:mod:`.stable`). Cells next
to a stiffer one therefore make steps as small as that one: with larger ones their impulses would
excite its vibration in resonance, the known limit of multiple-step schemes.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import partial
from math import ceil
from typing import ClassVar

import numpy as np

from fem_lie._arrays import Array, Flags, number
from fem_lie._state import attributes
from fem_lie.bodies.model import MassMatrix
from fem_lie.forms.cell_forms import (
    CELLS,
    NODES,
    FormArrays,
    joined,
    of_other_cells,
    of_some_cells,
)
from fem_lie.lie.motions import Group
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.explicit import events
from fem_lie.solve.explicit.explicit import convect_axes, convects_axes, unsupported
from fem_lie.solve.explicit.nodes import Masses
from fem_lie.solve.explicit.outer import (
    CommonMotion,
    OuterForces,
    stiffness_in_contact,
    together,
)
from fem_lie.solve.explicit.stable import (
    masses_of,
    refuse_floating,
    squared_frequencies,
    stiffness_at_nodes,
)
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.motion.policies import FactoriseOnce
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.rotations import Rotations, by_momenta
from fem_lie.system.equations import Equations, TimeState

_log = logging.getLogger(__name__)

_ROUND_OFF = 1e-9
"""Fraction of a step that is round-off where steps are counted."""


@dataclass(frozen=True)
class Asynchronous(Integrator):
    """Explicit scheme with a step of each cell; the ``step`` of :meth:`run` is the largest one.

    It is meant for nets and other bodies with position nodes, some of whose cells are much stiffer
    or shorter than the others. It supports what :class:`~fem_lie.Explicit` does, except for impacts
    and divided scenes. Cells of position nodes without joints and damping have steps of their own.
    All else has one common step: contact by penalty, springs, pressure and loads in time; nodes
    with rotations or gradients, joints or damping, and the cells around them. It is the smallest
    step that one of these or a cell of their nodes needs, also where a contact is still open.

    Results are reported at multiples of ``step``; their ``iterations`` are the steps of cells, and
    one for each common step. Work and impulses in the energy balance are integrated by the
    trapezoidal rule over ``step``, which must resolve them, as contact with ground, to be accurate.

    Attributes:
        courant: Steps of cells over the largest stable ones.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> net = fl.Net([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [[0, 1, 2]], tube)
        >>> net.pin(net.point(0), net.point(2))
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> _ = scene.add(net)
        >>> result = fl.schemes.Asynchronous().run(scene, duration=1e-2, step=1e-3)
        >>> bool(result.energy_error < 1e-3)
        True
    """

    _wanted_step: ClassVar[str] = (
        "chooses the steps of cells by itself: expected the largest one as a number and no "
        "that jumps"
    )

    courant: float = 0.8

    def __post_init__(self) -> None:
        """Check the options."""
        number(self.courant, "courant")
        if not 0.0 < self.courant <= 1.0:
            raise ValueError(f"expected 0 < courant ≤ 1 for stable steps, got {self.courant}")

    def _equations(self, scene: Scene) -> Equations:
        equations = Equations(scene, dynamics=True, group=Group.R3xSO3, mass=MassMatrix.LUMPED)
        _refuse(equations)
        return equations

    def _integration(self, equations: Equations, step: float) -> AsynchronousRun:
        return AsynchronousRun(equations, step, self.courant)


class AsynchronousRun(Integration[Recorder]):
    """Run of the asynchronous scheme."""

    STATE = attributes(
        "flight.H",
        "flight.v",
        "flight.times",
        "queue.made",
        "queue.heap",
        "queue.steps",
        "outer",
        "common",
        "_made",
        "_count",
        "balance",
    )

    def __init__(self, equations: Equations, step: float, courant: float) -> None:
        """Set up without computing anything.

        Args:
            equations: Equations of the scene, with lumped inertia.
            step: Largest step of a cell; results are reported at its multiples.
            courant: Steps of cells over the largest stable ones.
        """
        super().__init__(FactoriseOnce(), equations, step)
        self.equations_state = equations.history_variables
        self._rotations = Rotations(by_momenta)
        self.masses = masses_of(equations)
        chosen = together(equations, self.masses)
        cells = _cells(equations)
        queued = of_other_cells(cells, chosen)
        self.outer = OuterForces(equations, ~chosen, of_some_cells(cells, chosen))
        self.flight = _flight(equations, self.masses, chosen)
        H, v, times = (array.copy() for array in self.flight[:3])
        self.shown = self.flight._replace(H=H, v=v, times=times)
        largest = self._largest_steps(courant)
        self._parts = ceil(self.h / largest[self.outer.nodes].min(initial=self.h) - _ROUND_OFF)
        self.queue = _queue(queued, largest)
        motion = equations, self.masses, chosen, self._between
        self.common = CommonMotion(*motion) if chosen.any() else None
        steps = self.queue.steps
        summary = len(steps), float(steps.min(initial=step)), float(steps.max(initial=0.0))
        _log.info("%d cells, steps from %.4g to %.4g", *summary)
        self._convects_axes = convects_axes(self.masses)
        self.balance, self._made, self._count = equations.energy_balance(), 0, 0
        self._still = np.zeros((equations.unknowns.moving, 6))

    def _largest_steps(self, courant: float) -> Array:
        """Largest step of cells around each node, (n,): ``2/ω``, see :mod:`.stable`."""
        equations = self.equations
        K = stiffness_at_nodes(equations, equations.start.frames)
        K += stiffness_in_contact(equations, self.masses)
        squares = squared_frequencies(equations, self.masses, K)
        found, stiff = np.full(len(squares), self.h), squares > 0.0
        found[stiff] = np.minimum(self.h, courant * 2.0 / np.sqrt(squares[stiff]))
        return found

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create the history of results."""
        if not plan.saving.with_balance:
            self.balance.rest()
        return Recorder(self.equations, plan, progress, store)

    def start(self) -> None:
        """Compute the initial state."""
        if self.common is not None and self.common.joints is not None:
            check_velocities(self.equations, self._between)
        self._record_state(0.0)
        if self.outer:
            self.outer.evaluate(0.0, self.flight.H)
        self.balance.open(0.0, *self._now)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self.shown.H

    @property
    def index(self) -> int:
        """Number of steps made."""
        return self._made

    @property
    def _between(self) -> float:
        return self.h / self._parts

    @property
    def _now(self) -> TimeState:
        H, v = self.shown.H, self._still.copy()
        v[:, :3] = np.einsum("nai,ni->na", H[: len(v), 1:], self.shown.v)
        if self.common is None:
            return TimeState(H, v, self._still, np.zeros(0))
        return self.common.state(H, v)

    def _record_state(self, time: float) -> None:
        if len(self.queue.steps):
            events.state_at((*self.flight,), (*self.queue,), time, (*self.shown,))
        else:
            self.shown.H[:], self.shown.v[:] = self.flight.H, self.flight.v

    def _advance(self, history: Recorder) -> bool:
        last = history.next_stop(self._made) if self.balance.empty else self._made + 1
        if not (self._go_through_events(last) if self.outer else self._go(last * self.h)):
            return False
        self._made, history.count, time = last, self._count, last * self.h
        if not self.balance.empty:
            self._record_state(time)
            self.balance.add(self.h, time, *self._now)
        return True

    def _go(self, time: float) -> bool:
        """Make all steps of cells that are due before a time; return whether they were made."""
        if len(self.queue.steps):
            self._count += events.run((*self.flight,), (*self.queue,), time)
        return bool(np.isfinite(self.flight.v).all())

    def _go_through_events(self, last: int) -> bool:
        """Advance to the end of step ``last`` with forces in no cell; return whether it was."""
        outer, flight, size = self.outer, (*self.flight,), self._between
        for part in range(self._made * self._parts + 1, last * self._parts + 1):
            time, start = self.h * (part / self._parts), self.flight.H.copy()
            events.kick(flight, 0.5 * size, outer.r)
            if not self._go(time):
                return False
            events.fly(flight, time)
            if not self._move_together(time):
                return False
            events.kick(flight, 0.5 * size, outer.r)
            self.shown.H[:] = self.flight.H
            self._count += 1
            if not self._accept_history(start):
                return False
        return True

    def _move_together(self, time: float) -> bool:
        """Move the nodes that do so to a time and evaluate forces; return whether joints closed."""
        H, outer, common = self.flight.H, self.outer, self.common
        if common is None:
            outer.evaluate(time, H)
            return True
        made = common.step(H, outer.r, partial(outer.evaluate, time, H))
        if not made and common.joints is not None and np.isfinite(common.p).all():
            self.reason = common.joints.open
        return made and bool(np.isfinite(common.p).all())

    def _failure(self, steps: int) -> str:
        text = (
            f"step {self._made} of {steps} (h = {self.h:g}) failed: numbers are not finite; a "
            "scene that becomes stiffer needs a smaller courant"
        )
        return self._because(text, steps, self._made)

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self._made)
        wanted = history.wants(self._made)
        if wanted:
            time = self._made * self.h
            if self._convects_axes:
                convect_axes(self.equations, self.flight.H, self.outer.r.reshape(-1))
                if self.common is not None:
                    self.common.restart()
            self._record_state(time)
            now = self._now
            self._rotations.note_velocities(self._between, now.v, self.equations.unknowns.kinds)
            history.fill(time, *now, self.balance.so_far)
        return wanted

    def _result(self, history: Recorder) -> Result:
        self._rotations.report()
        return history.result(0, history.seconds)


def _cells(equations: Equations) -> FormArrays:
    """Cells of all terms that are sums over cells."""
    tables = [term.tables[0] for term in equations.arrays.terms if term.tables is not None]
    return FormArrays(*joined(tables, [0] * len(tables)))


def _flight(equations: Equations, masses: Masses, chosen: Flags) -> events.Flight:
    """Nodes at the start.

    Args:
        equations: Equations of the scene.
        masses: Lumped inertia of its nodes.
        chosen: Nodes that do not fly, (n,).
    """
    n, H = len(chosen), equations.start.frames.copy()
    held = np.ascontiguousarray(equations.unknowns.held[:, :3])
    light = np.where(chosen | held.all(axis=1), 0.0, 1.0 / masses.masses[:, 0])
    dead = np.einsum("nai,ni->na", H[:n, 1:], equations.arrays.conservative[:, 0])
    fall = np.einsum("nai,na->ni", H[:n, 1:], np.where(held, 0.0, dead)) * light[:, np.newaxis]
    local = np.where(chosen[:, np.newaxis], 0.0, equations.start.velocities[:n, :3])
    moving = np.einsum("nai,na->ni", H[:n, 1:], local)
    return events.Flight(H, moving, np.zeros(n), np.ascontiguousarray(fall), light, held)


def _queue(cells: FormArrays, largest: Array) -> events.Queue:
    """Cells at the start, with the smallest step of their nodes.

    Args:
        cells: The cells.
        largest: Largest step of cells around each node, (n,).
    """
    rows, nodes = cells
    many = np.repeat(rows[:, NODES], rows[:, CELLS])
    steps = np.full(len(many), np.inf)
    np.minimum.at(steps, np.repeat(np.arange(len(many)), many), largest[nodes])
    form = np.repeat(np.arange(len(rows)), rows[:, CELLS])
    made, heap = np.zeros(len(steps), np.int64), np.arange(len(steps))
    return events.Queue(rows, nodes, form, steps, made, heap)


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` if the scheme does not support the scene."""
    refuse_floating("Asynchronous", equations)
    refuse("Asynchronous", unsupported(equations))

r"""Asynchronous variational integration: every cell has its own step size.

The discrete action has a term for each cell and each of its steps. It is stationary if nodes move
freely, under dead loads only, between the times of their cells, and if a cell that is due applies
an impulse to its nodes, its force times its own step (Lew, Marsden, Ortiz & West, ARMA 167 (2003)
85). Momentum and angular momentum are exact, and the energy does not drift. With equal steps this
is the explicit scheme, of second order; otherwise it is at least of first order.

The step of a cell is a fraction of the smallest ``2/ω`` of its nodes (:mod:`.stable`). Cells next
to a stiffer one therefore make steps as small as that one: with larger ones their impulses would
excite its vibration in resonance, the known limit of multiple-step schemes.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fem_lie._arrays import Array, Indices, number
from fem_lie._state import attributes
from fem_lie.bodies.model import MassMatrix
from fem_lie.forms.cell_forms import CELLS, FIRST, NO_ROWS, NODES
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.lie.node_types import POSITION
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.explicit import events
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.motion.policies import FactoriseOnce
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.system.equations import Equations, TimeState

_log = logging.getLogger(__name__)

_SMALL = 1e-6  # over the length of the model: step of difference quotients of forces


@dataclass(frozen=True)
class Asynchronous(Integrator):
    """Explicit scheme with a step of each cell; the ``step`` of :meth:`run` is the largest one.

    It is meant for nets and other bodies with position nodes, some of whose cells are much stiffer
    or shorter than the others. Results are reported at multiples of ``step``; their ``iterations``
    are the steps of cells. Joints, springs, damping and contact are not supported; fixed positions,
    gravity and forces fixed in space are. Work and impulses are integrated by the trapezoidal rule
    over ``step``.

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
        equations = Equations(scene, dynamics=True, mass=MassMatrix.LUMPED)
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
        n, known = equations.unknowns.moving, equations.arrays
        tables = [term.tables[0] for term in known.terms if term.tables is not None]
        self._rows: Indices = np.concatenate([NO_ROWS, *(t[0] for t in tables)])
        at = np.cumsum([0, *(len(t[1]) for t in tables)])
        first = np.repeat(at[:-1], [len(t[0]) for t in tables])
        self._rows[:, FIRST] += first
        self._nodes: Indices = np.concatenate([np.empty(0, np.int64), *(t[1] for t in tables)])
        mass = known.inertia.blocks[:, 0, 0]
        held = np.ascontiguousarray(equations.unknowns.held[:, :3])
        light = np.where(held.all(axis=1), 0.0, 1.0 / mass)
        H = equations.start.frames.copy()
        dead = np.einsum("nai,ni->na", H[:n, 1:], known.conservative[:, 0])
        fall = np.einsum("nai,na->ni", H[:n, 1:], np.where(held, 0.0, dead)) * light[:, np.newaxis]
        moving = np.einsum("nai,na->ni", H[:n, 1:], equations.start.velocities[:n, :3])
        self.flight = events.Flight(H, moving, np.zeros(n), np.ascontiguousarray(fall), light, held)
        self.shown = self.flight._replace(H=H.copy(), v=moving.copy(), times=np.zeros(n))
        steps = self._own_steps(light, courant)
        form = np.repeat(np.arange(len(self._rows)), self._rows[:, CELLS])
        heap = np.arange(len(steps))
        zero = np.zeros(len(steps), np.int64)
        self.queue = events.Queue(self._rows, self._nodes, form, steps, zero, heap)
        summary = len(steps), float(steps.min(initial=step)), float(steps.max(initial=0.0))
        _log.info("%d cells, steps from %.4g to %.4g", *summary)
        self.balance, self._made, self._count = equations.energy_balance(), 0, 0
        self._still, self._none = np.zeros((n, 6)), np.zeros(0)

    def _own_steps(self, light: Array, courant: float) -> Array:
        """Steps of all cells: ``2/ω`` of their nodes, see :mod:`fem_lie.solve.explicit.stable`."""
        size = _SMALL * self.equations.unknowns.length
        H = self.equations.start.frames.copy()
        K = events.stiffness_at_nodes(H, self._rows, self._nodes, size)
        many = np.repeat(self._rows[:, NODES], self._rows[:, CELLS])
        of_cell = np.repeat(np.arange(len(many)), many)
        K = 0.5 * (K + K.swapaxes(1, 2)) * (many[of_cell] * light[self._nodes])[:, None, None]
        around, squares = np.zeros((len(light), 3, 3)), np.zeros(len(many))
        np.add.at(around, self._nodes, K)
        np.maximum.at(squares, of_cell, np.linalg.eigvalsh(around)[self._nodes, -1])
        stiff = squares > 0.0
        found = np.full(len(many), self.h)
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
        self._record_state(0.0)
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
    def _now(self) -> TimeState:
        H, n = self.shown.H, len(self._still)
        v = np.zeros((n, 6))
        v[:, :3] = np.einsum("nai,ni->na", H[:n, 1:], self.shown.v)
        return TimeState(H, v, self._still, self._none)

    def _record_state(self, time: float) -> None:
        if len(self.queue.steps):
            events.state_at((*self.flight,), (*self.queue,), time, (*self.shown,))

    def _advance(self, history: Recorder) -> bool:
        last = history.next_stop(self._made) if self.balance.empty else self._made + 1
        time = last * self.h
        self._count += events.run((*self.flight,), (*self.queue,), time)
        self._made, history.count = last, self._count
        if not np.isfinite(self.flight.v).all():
            return False
        if not self.balance.empty:
            self._record_state(time)
            self.balance.add(self.h, time, *self._now)
        return True

    def _failure(self, steps: int) -> str:
        return (
            f"step {self._made} of {steps} (h = {self.h:g}) failed: numbers are not finite; a "
            "scene that becomes stiffer needs a smaller courant"
        )

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self._made)
        wanted = history.wants(self._made)
        if wanted:
            time = self._made * self.h
            self._record_state(time)
            history.fill(time, *self._now, self.balance.total)
        return wanted

    def _result(self, history: Recorder) -> Result:
        return history.result(0, history.seconds)


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` if the scheme does not support the scene."""
    unknowns, arrays = equations.unknowns, equations.arrays
    mass_damping = len(arrays.damping.indptr) > 0
    viscous = mass_damping or any(term.viscosity is not None for term in arrays.terms)
    massless = bool((arrays.inertia.blocks[:, 0, 0] <= 0.0).any())
    reasons = {
        "nodes with other unknowns than positions": bool((unknowns.kinds != POSITION).any()),
        "joints": unknowns.m > 0,
        "springs between bodies": len(joint_arrays(arrays.joints).springs) > 0,
        "damping": viscous,
        "nodes without mass": massless,
        "loads that change in time, following loads and moments": unknowns.time_dependent
        or not unknowns.has_potential,
        "contact and pressure": any(t.tables is None for t in arrays.terms),
    }
    refuse("Asynchronous", reasons, "Explicit, where that supports the scene, or GeneralisedAlpha")

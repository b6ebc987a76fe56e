"""Forces over a step that are evaluated in Python, when compiled steps request them.

They are forces of joints on attachment frames or on nodes without frames, viscous forces of cells
of such nodes, contact forces, and loads that rotate with bodies or act on points other than nodes.
Such loads are evaluated at the midpoint of the step, and do their work along its increments.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._jit.call_back import CalledBack
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, DAMPING, WORK
from fem_lie.forms.abilities import Ends, ViscousForces
from fem_lie.forms.term import Term
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.node_types.forces import wrench
from fem_lie.lie.node_types.node_type import axes
from fem_lie.lie.tuples import (
    add_wrench,
    dot,
    load,
    load_row,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
)
from fem_lie.solve.conserving.midpoint.any_node import span_from_python
from fem_lie.solve.conserving.midpoint.end_forces import BESIDE, LOSS, ON_GROUND, EndForces
from fem_lie.solve.conserving.python_forces.constraints import OtherConstraints
from fem_lie.solve.conserving.python_forces.joints import Joints
from fem_lie.solve.conserving.step.records import (
    ERROR,
    FORCES,
    JOINTS,
    LEARN,
    TOUCHES,
    Model,
    Span,
    State,
    Step,
)
from fem_lie.solve.secants import Secants
from fem_lie.system.equations import Equations


class StepInProgress(Protocol):
    """Data of a run on which the forces depend.

    Attributes:
        s: Start of the step.
        this: The step.
        model: Constant arrays of the scene.
        size: Step size.
    """

    s: State
    this: Step
    model: Model
    size: float


class PythonForces:
    """Callbacks of compiled steps: forces, and improved corrections.

    Attributes:
        joints: Joints of the scene, unless compiled steps evaluate them.
        between: Whether there is anything to do between two steps.
        contacts: Contacts among these forces, if there are any.
        touching: Whether contacts may act in the current step. If not, they are not evaluated.
        learns: Secants of corrections; ``None`` if there are none.
    """

    def __init__(
        self,
        equations: Equations,
        run: StepInProgress,
        contacts: EndForces,
        shared: PythonForces | None = None,
    ) -> None:
        """Set up without computing anything.

        Args:
            equations: Equations of the scene.
            run: Run whose steps request these forces.
            contacts: Contacts of the scene.
            shared: Callbacks of another run with which the state is shared; default: none.
        """
        known, n = equations.arrays, equations.unknowns.moving
        self._run, self._kinds, vectors = run, known.kinds, known.kinds >= POSITION_GRADIENT
        self.joints: Joints | OtherConstraints | None = (
            joints_of(equations) if shared is None else shared.joints
        )
        of_vectors = [term for term in known.terms if vectors[term.pairs[0]].all()]
        self._viscous = _viscous(of_vectors)
        self._loads = [term for term in known.terms if acts_in_the_middle(term)]
        self._twists, self._forces = np.zeros((2, n, 6))
        self.contacts, self.touching = contacts if contacts else None, False
        # the other nodes have their own convergence criteria
        self._frames_alone, self._shared = not run.model.vectors, equations.shared
        self._contact_forces = np.zeros((n + BESIDE, 6))
        self.between = bool(self.joints or self.contacts)
        self.learns: Secants | None = None
        self._add, self._learn = (
            CalledBack(action, self._failed) for action in (self._add_forces, self._improve)
        )
        self._always = bool(self.joints or self._viscous or self._loads)
        self.touch(False)
        run.model.addresses[JOINTS] = self.joints is not None

    def learn(self, secants: Secants | None) -> None:
        """Improve corrections by these secants from now on; ``None``: no longer."""
        self.learns = secants
        self._run.model.addresses[LEARN] = 0 if secants is None else self._learn.address

    def touch(self, touching: bool) -> None:
        """Set :attr:`touching` for the current step; contacts that do not act store no energy."""
        self.touching, addresses = touching, self._run.model.addresses
        addresses[FORCES] = self._add.address if touching or self._always else 0
        addresses[TOUCHES] = touching and self._frames_alone
        if self.contacts is not None and not touching:
            self.contacts.energy = 0.0

    @property
    def pushes(self) -> bool:
        """Whether the last contact forces are nonzero, on any rank."""
        return self._shared.any(bool(self._contact_forces.any()))

    def look_ahead(self) -> None:
        """Determine whether contacts act at the predicted end of the step."""
        run, along = self._run, Span(*self._run.this.coordinates)
        coordinates = along.delta, along.mean, along.end, along.middle
        span_from_python(self._kinds, run.s.H, run.this.step, coordinates)
        self._find_contact_forces()
        self.touch(self.pushes)

    def _find_contact_forces(self) -> None:
        assert self.contacts is not None
        s, along = self._run.s, Span(*self._run.this.coordinates)
        # cells themselves correct the energy that round-off has added
        leak = 0.0 if self._run.model.total else float(s.filter_state.leak)
        ends = Ends(s.H, along.end, along.mean, along.delta)
        self.contacts.set(ends, leak, self._contact_forces)

    def accept(self) -> None:
        """Make the end of the step the start of the next one, for contacts."""
        if self.contacts is None or not self.touching:
            return
        self.contacts.accept()
        if not self.pushes:
            self.contacts.overlap(self._run.s.H)

    def begin(self) -> None:
        """Begin a step from the current state."""
        if self.joints is not None:
            self.joints.begin(self._run.s.H)
        if self.learns is not None:
            self.learns.forget()

    def check(self) -> None:
        """Raise the error of a callback, if there was one."""
        self._run.model.addresses[ERROR] = 0
        self._add.check()
        self._learn.check()

    def _failed(self) -> None:
        self._run.model.addresses[ERROR] = 1

    def _improve(self) -> None:
        assert self.learns is not None
        self.learns.improve(self._run.this.r[1])

    def _add_forces(self) -> None:
        run = self._run
        s, this, along = run.s, run.this, Span(*run.this.coordinates)
        if self.joints is not None:
            self.joints.add_forces(run.model, s, this, run.size)
        for viscosity in self._viscous:
            _mean_rates(self._kinds, along.middle, this.step, run.size, self._twists)
            self._forces[:] = 0.0
            viscosity.add_viscous_forces(along.middle, self._twists, self._forces)
            lost = _add_viscous(self._kinds, along.middle, self._twists, self._forces, this.outer)
            this.losses[DAMPING] += run.size * lost
        for term in self._loads:
            self._forces[:] = 0.0
            term.add_forces(along.middle, self._forces)
            _add_load(self._kinds, along.middle, this.step, self._forces, this.outer, this.losses)
        if self.touching:
            n, forces = len(this.step), self._contact_forces
            self._find_contact_forces()
            this.outer[:] += forces[:n]
            this.losses[BY_REACTIONS : BY_REACTIONS + 6] += forces[n + ON_GROUND]
            this.losses[DAMPING] += forces[n + LOSS, 0]


def joints_of(equations: Equations) -> Joints | OtherConstraints | None:
    """Joints of a scene, if some act on more than two frames or on nodes without frames."""
    pairs = None if equations.arrays.pairs_of_all is None else Joints(equations)
    if len(equations.unknowns.other_constraints) > (pairs is not None and pairs.on_attachments):
        return OtherConstraints(equations, pairs)
    return pairs if pairs is not None and pairs.needed else None


def acts_in_the_middle(term: Term) -> bool:
    """Whether a term is a load that acts at the midpoint of a step."""
    return term.load and term.pieces is None and term.over_step is None


def _viscous(terms: Sequence[Term]) -> list[ViscousForces]:
    """Terms with viscous forces by strain rates."""
    found = [t.viscosity for t in terms if not t.within_joints]
    return [viscosity for viscosity in found if viscosity is not None and viscosity.rates is None]


@compiled
def _mean_rates(kinds: Indices, middle: Array, step: Array, h: float, out: Array) -> None:
    """Mean velocities (n, 6) along the axes of the nodes at the midpoint of the step."""
    for i in range(out.shape[0]):
        d1, d2, d3 = axes(kinds[i], middle[i])
        for at in (0, 3):
            rate = scaled(1.0 / h, load(step[i], at))
            store(out[i], at, rotate_back(d1, d2, d3, rate))


@compiled
def _add_viscous(kinds: Indices, middle: Array, rates: Array, forces: Array, out: Array) -> float:
    """Add forces (n, 6) along these axes, at these velocities, to ``out``; returns their power.

    They do not oppose rigid motions ``ω × r̄`` of the midpoint, however far the step rotates.
    """
    power = 0.0
    for i in range(rates.shape[0]):
        d1, d2, d3 = axes(kinds[i], middle[i])
        for at in (0, 3):
            f = load(forces[i], at)
            power += dot(f, load(rates[i], at))
            store(out[i], at, plus(load(out[i], at), rotate(d1, d2, d3, f)))
    return power


@compiled
def _add_load(
    kinds: Indices, middle: Array, step: Array, forces: Array, out: Array, losses: Array
) -> None:
    """Add the forces of a load to ``out``, and its work and impulse to ``losses``.

    Args:
        kinds: Types of the nodes, (n,).
        middle: Nodes at the midpoint of the step.
        step: Increments, (n, 6).
        forces: Forces along the axes of the nodes, with the sign of a residual, (n, 6).
        out: Forces along increments, (n, 6), updated.
        losses: See :class:`~fem_lie.solve.conserving.step.records.Step`, updated.
    """
    for i in range(forces.shape[0]):
        d1, d2, d3 = axes(kinds[i], middle[i])
        for at in (0, 3):
            f = rotate(d1, d2, d3, load(forces[i], at))
            store(out[i], at, plus(load(out[i], at), f))
            losses[WORK] -= dot(f, load(step[i], at))
        force, moment = wrench(kinds[i], middle[i], forces[i])
        x = load_row(middle[i], 0)
        add_wrench(losses, BY_LOADS, x, scaled(-1.0, force), scaled(-1.0, moment))

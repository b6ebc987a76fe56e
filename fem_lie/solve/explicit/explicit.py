"""Explicit steps on the group with lumped inertia: the scheme, and a run of it.

Inertia is lumped: the mass matrix is block diagonal, so that each node has its own momentum
(:mod:`.nodes`). A step is::

    p ← p − ½ h f(H),    H ← H moved for h with the constant momenta p,    p ← p − ½ h f(H)

with forces ``f`` without inertia. Positions and position gradients move by central differences;
frames rotate about their mass centres as free rigid bodies by the discrete mechanics of Moser &
Veselov, exactly on the group. It is the variational scheme of the trapezoidal rule (Verlet; Marsden
& West, Acta Numerica 10 (2001) 357): symmetric, symplectic, of second order; momentum and angular
momentum are exact, and the energy oscillates without drift. Mass-proportional damping multiplies
momenta by ``exp(−½ h α)`` before and after the motion, which is exact without forces.

Steps are stable up to ``2/ω`` of the largest frequency, for which cells give an upper bound at the
start (:mod:`.stable`); larger steps raise an error. Joints are kept closed by multipliers with the
block-diagonal inertia (:mod:`.joints`); they do not raise any frequency. Without joints one
compiled loop makes the steps with all forces; only time-dependent loads, pressure and contact
return to Python.

Contacts by impacts change frames and momenta at the end of a step by impulses in Coulomb's cones,
with restitution, as in the other schemes (:mod:`fem_lie.solve.impacts`; time stepping of J. J.
Moreau, CISM 302 (1988) 1). Their compliance is that of the lumped inertia with joints; forces of
the next step are those of the changed frames.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._jit.records import block_of
from fem_lie._state import attributes, put_back, saved
from fem_lie.bodies.model import MassMatrix
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import MIXED_DERIVATIVE, SURFACE_GRADIENT
from fem_lie.parts.part_scene import ScenePart, divided
from fem_lie.results import Result
from fem_lie.results.record import with_others
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.explicit import loop, nodes
from fem_lie.solve.explicit.joints import Joints
from fem_lie.solve.explicit.stable import (
    StableStep,
    damping_rates,
    masses_of,
    node_name,
    refuse_floating,
    stable_step,
)
from fem_lie.solve.impacts.contacts import CoupledContacts
from fem_lie.solve.impacts.step_end import Rule, StepEnd, refuse_impacts
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.motion.policies import FactoriseOnce
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps, Plan
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.whole_state import MovingState
from fem_lie.solve.rotations import Rotations, by_momenta
from fem_lie.system.equations import Equations, TimeState

_log = logging.getLogger(__name__)

_AT_A_TIME = 20_000_000
"""Steps times unknowns (about a second) after which the loop returns, so that it can be
interrupted."""

_PREFIX = "fem_lie_dynamics_"
"""Prefix of PETSc's option ``divided_from``, that of other schemes."""

_COMMON = "decisions", "progress"
"""State that all ranks of a divided scene have in common."""

_NOWHERE: Indices = np.empty((0, 5), dtype=np.int64)


class ExplicitRun(Integration[Recorder]):
    """Run of the explicit scheme.

    The state between steps is frames and momenta at the same time, and the forces there.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions.
        p: Momenta, see :mod:`.nodes`, (n, 6).
        v: Twists, (n, 6).
        began: Time before the first step; another one if steps have changed their size.
    """

    STATE = attributes(
        "H", "p", "v", "r", "reaction", "progress", "_joints", "balance", "_contacts"
    )

    def __init__(
        self, equations: Equations, step: float, masses: nodes.Masses, limit: StableStep
    ) -> None:
        """Allocate all arrays without computing anything.

        Args:
            equations: Equations of the scene, with lumped inertia.
            step: Step size.
            masses: Lumped inertia of its nodes.
            limit: Largest stable step at the start.
        """
        super().__init__(FactoriseOnce(), equations, step)
        self.equations_state = equations.history_variables
        self._rotations = Rotations(by_momenta)
        unknowns, known = equations.unknowns, equations.arrays
        n = unknowns.moving
        self.masses, self.limit, self._n, self.began = masses, limit, n, 0.0
        self._changing = unknowns.time_dependent
        self.H, self.p, self.v = equations.start.frames.copy(), np.zeros((n, 6)), np.zeros((n, 6))
        m = unknowns.m
        self._rest, self._none, self._one = np.zeros((n, 6)), np.zeros(m), np.ones(m)
        self._decay = np.exp(-0.5 * step * damping_rates(equations, masses))
        joined = unknowns.constraints > 0
        self._joints = Joints(equations, masses, self._decay) if joined else None
        self.r, self.reaction = np.zeros(unknowns.size), np.zeros(6)
        self.balance = equations.energy_balance()
        self._forces = equations.residual(self._instant, self._one, self.r)
        supports = np.flatnonzero(known.supported.any(axis=1))
        balance, table = self.balance, self._forces.addresses
        shared = equations.shared
        summed = known.in_one_sum and table is not None and not m
        self._summed = summed and not shared.several
        self._largest = int(shared.largest(float(n)))
        self._supported = len(supports) > 0
        self._convects_axes = shared.any(convects_axes(masses))
        self._remembers = shared.any(any(term.passage or term.path for term in known.terms))
        self.progress = loop.PROGRESS()
        packed = loop.Packed(
            masses,
            self.H,
            self.p,
            self.v,
            self._rest,
            self._none,
            self.r,
            np.flatnonzero(unknowns.held),
            (supports, known.supported[supports].astype(np.int64)),
            self.reaction,
            _NOWHERE if table is None else table,
            balance.addresses,
            balance.total,
            self.progress,
            self._decay,
        )
        self._packed = PackedArrays(packed)
        self._contacts: CoupledContacts | None = None
        if impacts := equations.scene.impacts:
            rule = Rule(step, 2.0 / step**2, 2.0 / step)  # of a constant force from rest
            self._contacts = CoupledContacts(impacts, equations, rule, None)

    @property
    def _balance_in_loop(self) -> bool:
        """Whether the compiled loop updates the energy balance, except for supports."""
        balance = self.balance
        compiled = self._summed and self._contacts is None
        return not balance.empty and balance.compiled_but_held and compiled

    @property
    def _how(self) -> loop.PlainSteps:
        looks = self.balance.looks
        return (*loop.Steps(self.h, self._summed, self._balance_in_loop, self._supported, *looks),)

    @property
    def _most(self) -> int:
        """Number of steps between two returns to Python."""
        one_by_one = self.equations.shared.any(self._changing or self._looks)
        return 1 if one_by_one else max(1, _AT_A_TIME // (6 * self._largest))

    @property
    def _looks(self) -> bool:
        """Whether the energy balance is updated in Python after each step."""
        return not self.balance.empty and not self._balance_in_loop

    @property
    def _instant(self) -> TimeState:
        """State at rest: forces depend on positions only."""
        return TimeState(self.H, self._rest, self._rest, self._none)

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create the history of results."""
        if not plan.saving.with_balance:
            self.balance.rest()
        if self._contacts is not None:
            self._contacts.history.begin(plan.steps)
        return Recorder(self.equations, plan, progress, store)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self.H

    @property
    def index(self) -> int:
        """Number of steps made."""
        return int(self.progress.step)

    @property
    def time(self) -> float:
        """Time of the current state."""
        return self.began + self.index * self.h

    def start(self) -> None:
        """Compute the initial momenta and forces."""
        if self._joints is not None:
            check_velocities(self.equations, self.h)
        nodes.momenta((*self.masses,), self.H, self.equations.start.velocities, self.p)
        self._begin(0.0)

    def _begin(self, time: float) -> None:
        """Compute forces from the current frames and momenta, and start to account for them."""
        nodes.twists((*self.masses,), self.H, self.p, self.v)
        self.balance.look(time, *self._moving)
        if self._balance_in_loop:
            # without supports, which are accounted for separately
            loop.look(self._packed.addresses, self._how, 0.0)
        self._weigh()

    def _weigh(self) -> None:
        """Compute forces from the current frames."""
        if self._summed:
            loop.weigh(self._packed.addresses, self._balance_in_loop)
        else:
            self.equations.residual(self._instant, self._one, self.r, self._forces)

    def divided_state(self) -> dict[str, Array]:
        """See the base class; motion is the momenta, and multipliers are the last impulses."""
        impulses = self._none if self._joints is None else self._joints.impulses
        found = self.H[: self._n], self.p[np.newaxis], impulses[np.newaxis], self.balance.so_far
        moving = MovingState(*found)
        return saved(self, _COMMON) | moving._asdict()

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided."""
        put_back(self, _COMMON, common)
        time = self.time
        now = self.equations.prescribed(time)
        now.act()
        self.H[: self._n], self.H[self._n + 1 :] = state.frames, now.frames
        self.p[:] = state.motion[0]
        self.equations.history_variables.update_stress(self.H)
        if self._joints is not None:
            self._joints.impulses[:] = state.multipliers[0]
        self.balance.restart(state.balance, time, *self._moving)
        self._begin(time)

    @property
    def _moving(self) -> TimeState:
        if self._joints is None:
            return TimeState(self.H, self.v, self._rest, self._none)
        return TimeState(self.H, self.v, *self._joints.forces(self.H, self.v))

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        return self._go_towards(history.next_stop(self.index))

    def _go_towards(self, stop: int) -> bool:
        """Make the next step, or several up to ``stop``; return whether they were made."""
        last = min(stop, self.index + self._most)
        if self._changing:
            self.equations.prescribed(self.began + (self.index + 1) * self.h).act()
        if self._contacts is not None:
            return self._struck(self._contacts)
        if self._joints is not None:
            return self._joined(self._joints)
        how, start = self._how, self.H.copy()
        while loop.run(self._packed.addresses, how, last) == loop.RESIDUAL:
            self.equations.residual(self._instant, self._one, self.r, self._forces)
            if self._remembers:
                if not self._accept_history(start):
                    return False
                start[:] = self.H
        if not self.equations.shared.all(bool(np.isfinite(self.p).all())):
            return False
        self._look()
        return True

    def _look(self) -> None:
        if self._looks:
            nodes.twists((*self.masses,), self.H, self.p, self.v)
            self.balance.add(self.h, self.time, *self._moving)

    def _joined(self, joints: Joints) -> bool:
        """Make the next step with joints; return whether it was made."""
        self.progress.step += 1
        start = self.H.copy()
        made = joints.step(self.h, self.H, self.p, self.r, self._weigh)
        if not made or not self._accept_history(start):
            return False
        self._look()
        return True

    def _struck(self, contacts: CoupledContacts) -> bool:
        """Make the next step, with impacts at its end; return whether it was made."""
        start, last = self.H.copy(), self.index + 1
        nodes.twists((*self.masses,), self.H, self.p, self.v)
        contacts.begin(self.H, self.v, self.time)
        contacts.history.begin_step(last)
        if self._joints is not None:
            self.progress.step += 1
            if not self._joints.step(self.h, self.H, self.p, self.r, self._weigh):
                return False
        else:
            while loop.run(self._packed.addresses, self._how, last) == loop.RESIDUAL:
                self.equations.residual(self._instant, self._one, self.r, self._forces)
        if not np.isfinite(self.p).all():
            return False
        return self._touch(contacts) and self._accept_history(start)

    def _touch(self, contacts: CoupledContacts) -> bool:
        """Apply contact impulses at the end of a step; return whether contacts were solved."""
        time, n = self.time, self._n
        nodes.twists((*self.masses,), self.H, self.p, self.v)
        changed = contacts.resolve(StepEnd(self.H, self.v, time))
        if contacts.failure:
            self.reason = contacts.failure
            contacts.abandon()
            return False
        now = self._moving
        self.balance.add(self.h, time, *now)
        if changed is not None:
            before = now._replace(H=self.H.copy(), v=self.v.copy())
            self.H[:n] = changed.frames[:n]
            nodes.momenta((*self.masses,), self.H, changed.twists, self.p)
            nodes.twists((*self.masses,), self.H, self.p, self.v)
            if self._joints is not None:
                self._joints.restart()
            self._weigh()
            lost = self.balance.collide(time, before, self._moving, contacts.work)
            contacts.statistics.impact = -lost - contacts.statistics.friction
        contacts.history.add(self.index, block_of(contacts.statistics))
        self.reason = contacts.passed(self.H)
        return not self.reason

    def _failure(self, steps: int) -> str:
        if self.reason:
            return self._because("", steps, self.index)
        if self._joints is not None and np.isfinite(self.p).all():
            return f"step {self.index} of {steps} (h = {self.h:g}) failed: {self._joints.open}"
        return (
            f"step {self.index} of {steps} (h = {self.h:g}) failed: numbers are not finite. At the "
            f"start steps up to {self.limit.step:.4g} were stable; a scene that becomes stiffer "
            "wants smaller ones"
        )

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self.index)
        wanted = history.wants(self.index)
        if wanted:
            if self._convects_axes:
                self._convect_axes()
            nodes.twists((*self.masses,), self.H, self.p, self.v)
            history.count, time = self.index, self.time
            now = self._moving
            if self._contacts is not None:
                joined = now.multipliers + self._contacts.reactions / self.h
                now = now._replace(multipliers=joined)
            self._rotations.note_velocities(self.h, self.v, self.equations.unknowns.kinds)
            history.fill(time, *now, self.balance.so_far)
            if self._contacts is not None and self.index:
                self._contacts.record(self.H, time)
        return wanted

    def _convect_axes(self) -> None:
        """Update convected axes, and write forces along the new ones."""
        convect_axes(self.equations, self.H, self.r)
        if self._joints is not None:
            self._joints.restart()

    def _result(self, history: Recorder) -> Result:
        self._rotations.report()
        if self._contacts is None:
            return history.result(0, history.seconds)
        steps = self._contacts.history.result(self.h)
        history.add(steps)
        return with_others(history.result(0, history.seconds), {"contacts": steps})


def convects_axes(masses: nodes.Masses) -> bool:
    """Whether there are points with convected axes of their surroundings.

    Cables have those of the tangent.
    """
    return bool(np.isin(masses.kinds, (SURFACE_GRADIENT, MIXED_DERIVATIVE)).any())


def convect_axes(equations: Equations, H: Array, r: Array) -> None:
    """Update convected axes of frames ``H``, and write forces ``r`` along the new ones."""
    before = H.copy()
    equations.history_variables.rotate_axes(H)
    nodes.write_in_new_axes(equations.unknowns.kinds, before, H, r)


def limit_of(equations: Equations, masses: nodes.Masses) -> StableStep:
    """The largest stable step at the start; it is logged."""
    limit = stable_step(equations, masses, equations.start.frames)
    _log.info("the largest stable step is %.4g", limit.step)
    return limit


def stable_masses(
    equations: Equations, step: float, count: int | None = None
) -> tuple[nodes.Masses, StableStep]:
    """Lumped inertia, and the largest stable step; ``ValueError`` if the steps are larger.

    Args:
        equations: Equations with lumped inertia.
        step: Step size, or that of whole steps.
        count: Number of steps in a whole one; default: there are no whole steps.
    """
    own = step / (count or 1)
    masses = masses_of(equations)
    limit = limit_of(equations, masses)
    with equations.shared.errors(ValueError):
        if not own <= limit.step and limit.node >= 0:
            needed = "" if count is None else f": {ceil(step / limit.step)} steps in a whole one"
            raise ValueError(
                f"Explicit: expected a stable step, at most {limit.step:.4g} for the cells "
                f"around {node_name(equations, limit.node)}, got {own:g}{needed}"
            )
    return masses, limit


@dataclass(frozen=True)
class Explicit(Integrator):
    """Explicit scheme with constant steps; :meth:`stable_step` returns the largest stable one.

    It is meant for nets, impacts and waves: problems whose steps have to be as small as the time in
    which a wave passes an element anyway. It supports all nodes except those of reduced-order
    bodies, mass-proportional damping, supports, joints, springs, loads, and contact by penalty and
    by impacts, with friction. Joints and impacts need a small system of equations in each step
    (:mod:`.joints`), and steps are then made from Python. On several ranks, each rank has the steps
    of its part of a large scene without impacts.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.Explicit().run(scene, duration=1.0, step=0.01)
        >>> bool(result.angular_momentum_error < 1e-12)
        True
    """

    def stable_step(self, scene: Scene) -> float:
        """Largest stable step of the scene at its start; infinite without stiffness.

        Args:
            scene: The scene.

        Raises:
            ValueError: The scheme does not support the scene, or no step is stable.
        """
        require_scene(scene)
        equations = self._equations(scene)
        return limit_of(equations, masses_of(equations)).step

    def _equations(self, scene: Scene) -> Equations:
        return self.equations(scene)

    def equations(self, scene: Scene, part: ScenePart | None = None) -> Equations:
        """Equations of a scene; ``ValueError`` if the scheme does not support the scene.

        Args:
            scene: The scene.
            part: What this rank has of it, if it is divided.
        """
        equations = Equations(
            scene.without_impacts(),
            dynamics=True,
            group=Group.R3xSO3,
            mass=MassMatrix.LUMPED,
            part=part,
        )
        with equations.shared.errors(ValueError):
            _refuse(equations)
            if equations.scene.impacts:
                refuse_impacts(equations)
        return equations

    def _divided_equations(self, scene: Scene, plan: Plan) -> Equations | None:
        """Equations of the part of this rank."""
        refused = {
            "steps of different sizes": not isinstance(plan, EqualSteps),
            "contacts by impacts": any(each.law.impulsive for each in scene.contacts),
        }
        part = divided(scene, _PREFIX, refused)
        return None if part is None else self.equations(scene, part)

    def _integration(self, equations: Equations, step: float) -> ExplicitRun:
        return ExplicitRun(equations, step, *stable_masses(equations, step))


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` if the scheme does not support the scene."""
    refuse_floating("Explicit", equations)
    refuse("Explicit", unsupported(equations))


def unsupported(equations: Equations) -> dict[str, bool]:
    """What explicit steps do not support, and whether the scene has it."""
    unknowns, arrays = equations.unknowns, equations.arrays
    dampers = bool(np.any(joint_arrays(arrays.joints).springs[:, 1] != 0.0))
    return {
        "force laws without a potential (ForceLaw)": unknowns.laws_without_potential,
        "friction in joints (JointFriction)": unknowns.joint_friction,
        "velocity constraints (KnifeEdge, RollingDisc), whose motion makes no action stationary": (
            unknowns.of_velocities > 0
        ),
        "drives": unknowns.driven,
        "redundant constraints": unknowns.may_be_redundant,
        "prescribed motions": len(equations.start.frames) > unknowns.moving + 1,
        "supports along axes fixed in space (Shell.roller)": bool(equations.supports),
        "damping by strain rates and dampers": dampers
        or any(
            term.viscosity is not None and term.viscosity.rates is None for term in arrays.terms
        ),
        "strains that change in time": unknowns.strains_change,
    }

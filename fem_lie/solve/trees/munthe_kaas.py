"""Runge-Kutta scheme of order four on the group, for rigid bodies in trees of joints.

The unknowns are the relative frames of joints and the rates along their free columns: constraints
hold to round-off, and there are no multipliers and no matrix. :mod:`.elimination` computes
accelerations in time proportional to the number of bodies, :mod:`.steps` has the scheme, and
:mod:`.graph` the tree. Steps are explicit: stable if the step size times the largest frequency of
the scene is below 2.8. Work and impulses are integrated by the same quadrature.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._state import ChangingArrays, attributes
from fem_lie.bodies.balances import SIZE
from fem_lie.bodies.rigid import RigidBody
from fem_lie.joints.equations.joint_arrays import views
from fem_lie.lie.motions import Group
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.growing import GrowingRecorder
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.integrator import Integrator, refuse
from fem_lie.solve.motion.policies import FactoriseOnce
from fem_lie.solve.motion.step_log import LargestError, StepError
from fem_lie.solve.motion.variable_steps import Stepper, side
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps, EqualSteps
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.step_control import Control
from fem_lie.solve.trees import reported, steps
from fem_lie.solve.trees.blocks import INERTIA
from fem_lie.solve.trees.elimination import Motion
from fem_lie.solve.trees.graph import Tree, tree_of
from fem_lie.system.equations import Equations, TimeState

_ROUND_OFF = 1e-12
"""Largest difference of dead loads from weights, over the largest weight."""

_AT_A_TIME = 2_000_000
"""Steps times bodies (about a second) after which the loop returns, so that it can be
interrupted."""


class MuntheKaasRun(Integration[Recorder]):
    """Run with constant steps."""

    STATE = attributes("X", "w", "slopes", "rows", "H", "v", "_made", "balance")

    def __init__(self, equations: Equations, step: float, tree: Tree) -> None:
        """Allocate all arrays without computing anything.

        Args:
            equations: Equations of the scene.
            step: Step size.
            tree: Its tree; gravity is zero if there are other forces.
        """
        super().__init__(FactoriseOnce(), equations, step)
        self.equations_state = equations.history_variables
        unknowns, arrays, z = equations.unknowns, equations.arrays, np.zeros
        n, m, k, d = unknowns.moving, unknowns.m, len(tree.X), len(tree.w)
        self.tree, self.X, self.w = tree, tree.X.copy(), tree.w.copy()
        self.H, self.v, self.a = equations.start.frames.copy(), z((n, 6)), z((n, 6))
        self.slopes, self.rows = z((steps.STAGES + 1, 2, d)), z((steps.STAGES + 1, SIZE))
        self.now = Motion(
            X=z((k, 4, 3)),
            w=z(d),
            v=z((k, 6)),
            coriolis=z((k, 6)),
            inertia=z((k, INERTIA)),
            p=z((k, 6)),
            u=z((d, 6)),
            e=z((d, 2)),
            a=z((k, 6)),
            rate=z(d),
        )
        self.multipliers, self._none, self._rest = z(m), z(m), z((n, 6))
        self._r, self._made = z(unknowns.size), 0
        self.balance = equations.energy_balance()
        self._forced = not uniform_gravity(equations)
        self._changing = unknowns.time_dependent
        self._forces = equations.residual(self._instant, self._none, self._r)
        addresses = self._forces.addresses
        self._summed = arrays.in_one_sum and addresses is not None and not self._changing
        self._packed = PackedArrays(
            steps.Run(
                links=tree.links,
                now=self.now,
                X=self.X,
                w=self.w,
                angle=z(d),
                zero=z(d),
                slopes=self.slopes,
                link=tree.link,
                own=np.ascontiguousarray(tree.own),
                spatial=z((k, 4, 3)),
                H=self.H,
                v=self.v,
                a=self.a,
                rest=self._rest,
                none=self._none,
                r=self._r,
                joints=arrays.joints,
                probes=arrays.probes,
                forces=z((0, 5), dtype=np.int64) if addresses is None else addresses,
                actions=self.balance.addresses,
                rows=self.rows,
                ground=z((1, 6)),
                total=self.balance.total,
                pairs=tree.joints,
                wrenches=tree.wrenches,
            )
        )

    @property
    def _how(self) -> steps.PlainOptions:
        balance, arrays = self.balance, self.equations.arrays
        compiled = not balance.empty and balance.compiled
        return (*steps.Options(self._summed, self._forced, compiled, *balance.looks, arrays.turns),)

    @property
    def _in_loop(self) -> bool:
        """Whether steps need nothing from Python."""
        return (self._summed or not self._forced) and not self._looks

    @property
    def _looks(self) -> bool:
        """Whether the balance is evaluated in Python."""
        return not (self.balance.empty or self.balance.compiled)

    @property
    def _instant(self) -> TimeState:
        """State of a stage, whose forces are those without acceleration."""
        return TimeState(self.H, self.v, self._rest, self._none)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes and ground."""
        return self.H

    @property
    def index(self) -> int:
        """Number of steps made."""
        return self._made

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """Create the history of results."""
        if not plan.saving.with_balance:
            self.balance.rest()
        return Recorder(self.equations, plan, progress, store)

    # --- steps ---

    def start(self) -> None:
        """Compute the initial accelerations.

        Raises:
            ValueError: Velocities violate a joint.
        """
        check_velocities(self.equations, self.h)
        self._begin(0.0)

    def _begin(self, time: float) -> None:
        """Evaluate the first stage at the current state."""
        self.slopes[0, 0] = self.w
        self._stage(0, time, 0.0)

    def _stage(self, stage: int, time: float, h: float) -> None:
        """Evaluate a stage of a step of size ``h`` at its own ``time``."""
        table, how = self._packed.addresses, self._how
        steps.place(table, how, stage, h)
        if self._changing:
            self.equations.prescribed(time).act()
        if self._forced and not self._summed:
            self.equations.residual(self._instant, self._none, self._r, self._forces)
        steps.solve(table, how, stage)
        if self._looks:
            reported.observe(table, self.multipliers)
            self.balance.rates(TimeState(self.H, self.v, self.a, self._none), self.rows[stage])
            steps.add_ground(table, stage)

    def _stages(self, start: float, h: float, end: float) -> None:
        """Evaluate all stages of a step from ``start``, the last with forces of time ``end``."""
        for stage in range(1, steps.STAGES + 1):
            time = min(start + steps.TIMES[stage] * h, end)
            self._stage(stage, time, h)

    def _advance(self, history: Recorder) -> bool:
        most = max(1, _AT_A_TIME // max(1, len(self.v))) if self._in_loop else 1
        last = min(history.next_stop(self._made), self._made + most)
        if self._in_loop:
            steps.advance(self._packed.addresses, self._how, self.h, last - self._made)
        else:
            begun, time = self.H.copy(), self._made * self.h
            self._stages(time, self.h, last * self.h)
            self._close(self.h)
            if not self._accept_history(begun):
                return False
        self._made = history.count = last
        return bool(np.isfinite(self.w).all())

    def _close(self, h: float) -> None:
        """End a step made from Python."""
        steps.close(self._packed.addresses, self._how, h)
        reported.observe(self._packed.addresses, self.multipliers)

    def _failure(self, steps: int) -> str:
        text = "numbers are not finite; explicit steps must resolve the fastest motion"
        return self._because("", steps, self._made) or (
            f"step {self._made} of {steps} (h = {self.h:g}) failed: {text}, expected smaller ones"
        )

    # --- results ---

    def _now(self) -> TimeState:
        """State after a step, with accelerations and joint forces."""
        reported.observe(self._packed.addresses, self.multipliers)
        return TimeState(self.H, self.v, self.a, self.multipliers)

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self._made)
        wanted = history.wants(self._made)
        if wanted:
            history.fill(self._made * self.h, *self._now(), self.balance.total)
        return wanted

    def _result(self, history: Recorder) -> Result:
        return history.result(0, history.seconds)


class MuntheKaasSteps(MuntheKaasRun):
    """Steps of any size, see :class:`~fem_lie.solve.motion.variable_steps.Stepper`."""

    STATE = attributes("h")

    make_many = None

    def __init__(self, equations: Equations, control: Control, tree: Tree) -> None:
        """Set up without computing anything."""
        super().__init__(equations, control.size, tree)
        self._error, self.increment, self.factorisations = np.zeros_like(self.v), np.nan, 0
        self._largest = LargestError(equations)
        changed = "X", "w", "slopes", "rows", "H", "v", "balance.total"
        self._changed = ChangingArrays(self, changed)

    @property
    def twists(self) -> Array:
        """Current twists of the nodes."""
        return self.v

    def begin(self, h: float) -> None:
        """Start at time 0 with steps of size ``h``."""
        self.h = h
        self.X[:], self.w[:] = self.tree.X, self.tree.w
        self.start()
        self._now()

    def set_step(self, time: float, h: float) -> None:
        """Set the size of the next step, on which no state depends."""
        self.h = h

    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``; return 1, or 0 if it failed."""
        h = end - start
        self._stages(start, h, end - side(end, h) if lands else end)
        reported.errors(self._packed.addresses, h, self._error)
        self._close(h)
        self._made = index
        return int(np.isfinite(self.w).all())

    def estimate(self, before: Any, start: float, end: float) -> StepError:
        """Difference of the last step from the embedded scheme."""
        return self._largest.of(self._error)

    def saved(self) -> dict[str, Array]:
        """A copy of the state."""
        return self._changed.saved_state()

    def take_back(self, state: Mapping[str, Array]) -> None:
        """Restore a saved state."""
        self._changed.restore(state)

    def restore_from(self, other: MuntheKaasSteps, state: Mapping[str, Array]) -> None:
        """Take the state that another stepper has saved."""
        self.take_back(state)

    def damp_oscillations(self, time: float, h: float) -> None:
        """There are no unresolved oscillations in an explicit step."""

    def pass_event(self, time: float, restitution: Array | None = None) -> None:
        """Evaluate the first stage with loads of ``time``."""
        assert restitution is None, "explicit steps have no limits"
        self._begin(time)

    def record(self, recorder: GrowingRecorder, index: int, iterations: int) -> None:
        """Record the current state in the next row."""
        recorder.fill(0.0, *self._now(), self.balance.total)

    def recorder(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> GrowingRecorder:
        """Create the history of results."""
        return GrowingRecorder(self.equations, plan, progress, store)

    def leave_balance(self) -> None:
        """Skip the energy balance."""
        self.balance.rest()

    def refactorise_at(self, time: float) -> None:
        """There is no matrix."""


@dataclass(frozen=True)
class MuntheKaas(Integrator):
    """Explicit scheme of order four for rigid bodies in trees of joints, without constraints.

    Runge-Kutta steps on the group (Munthe-Kaas 1999) of the relative frames of joints; the work of
    a step grows with the number of bodies. Bodies move freely or are joined by fixed, spherical,
    revolute, prismatic, cylindrical, screw, planar, universal and in-plane joints, without loops;
    loads, springs, force laws and contact by penalties without friction may act on them.
    :class:`~fem_lie.schemes.AdaptiveStep` chooses steps by the embedded scheme of order three.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0.1, 8.0, 0.1), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.schemes.MuntheKaas().run(scene, duration=1.0, step=1e-3)
        >>> bool(result.energy_error < 1e-8)
        True
    """

    _order = 3

    def _equations(self, scene: Scene) -> Equations:
        _refuse(scene)
        equations = Equations(scene, dynamics=True, group=Group.SE3)
        self._tree(equations)
        return equations

    def _tree(self, equations: Equations) -> Tree:
        uniform = uniform_gravity(equations)
        return tree_of(equations, equations.scene.gravity if uniform else np.zeros(3))

    def _integration(self, equations: Equations, step: float) -> MuntheKaasRun:
        return MuntheKaasRun(equations, step, self._tree(equations))

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        return partial(_stepper, self)


def _stepper(scheme: MuntheKaas, equations: Equations, control: Control) -> MuntheKaasSteps:
    return MuntheKaasSteps(equations, control, scheme._tree(equations))


def _refuse(scene: Scene) -> None:
    """Raise ``ValueError`` if the scheme does not support the scene."""
    flexible = [body.label for body in scene.bodies if not isinstance(body, RigidBody)]
    binding = [each.label for each in scene.connections if each.size]
    rolling = [each.label for each in scene.joints if each.velocity_definitions()]
    sliding = [
        each.label
        for each in (*scene.joints, *scene.connections)
        if each.sliding_definition() is not None
    ]
    friction = [each.label for each in scene.connections if each.friction is not None]
    contacts = [c.label for c in scene.contacts if c.law.impulsive or c.law.friction > 0.0]
    reasons = {
        "flexible bodies, whose frequencies no explicit step resolves": flexible,
        "drives and gears, which constrain coordinates of joints": binding,
        "velocity constraints": rolling,
        "points that slide along beams": sliding,
        "clamps (join the body to ground by Fixed)": [c.point.label for c in scene.clamps],
        "prescribed motions": [motion.point.label for motion in scene.motions],
        "contact with impacts or friction": contacts,
        "friction by forces of joints, which it eliminates": friction,
    }
    refuse("MuntheKaas", {f"{what} ({found[0]})": True for what, found in reasons.items() if found})


def uniform_gravity(equations: Equations) -> bool:
    """Whether the weight of the bodies in a uniform field is the only force."""
    arrays, unknowns = equations.arrays, equations.unknowns
    others = len(views(arrays.joints).springs) > 0 or len(arrays.terms) > 0
    if others or unknowns.time_dependent or not arrays.in_one_sum or len(arrays.damping.indptr):
        return False
    dead, moment, following = arrays.loads
    weight = np.einsum("nk,j->nkj", arrays.inertia.blocks[:, 0], equations.scene.gravity)
    same = np.abs(dead - weight) <= _ROUND_OFF * np.abs(weight).max(initial=0.0)
    return bool(same.all()) and not moment.any() and not following.any()

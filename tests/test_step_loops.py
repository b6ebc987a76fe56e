"""Inside the loops of time steps: what they do that recorded states do not show.

Compiled loops make the steps that are made one by one without them; failed, divided and rejected
steps leave what they have to; matrices are derivatives of residuals.
"""

from __future__ import annotations

import copy
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.conserving_mixed import SCENES as MIXED
from benchmarks.scale import chain
from demos.double_pendulum import STEP, pendulum
from fem_lie._jit.records import fields_of
from fem_lie.solve.alpha import newton
from fem_lie.solve.alpha.run import Run as AlphaRun
from fem_lie.solve.alpha.staleness import staleness
from fem_lie.solve.alpha.step.nodes import correct
from fem_lie.solve.alpha.variable import AlphaSteps
from fem_lie.solve.composed.momentum_parts import MomentumPart
from fem_lie.solve.composed.run import ComposedRun
from fem_lie.solve.conserving.run import Run as ConservingRun
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.variable import ConservingSteps
from fem_lie.solve.motion.limits import Limits
from fem_lie.solve.motion.policies import Ruled
from fem_lie.solve.motion.variable_steps import VariableSteps
from fem_lie.solve.recording import window
from fem_lie.solve.variational.run import VariationalRun
from tests import test_conserving_starts as starts
from tests import test_divided_steps as divided_steps
from tests import test_dynamics as dynamics
from tests import test_policies as policies
from tests import test_saving as saving
from tests.random_scenes import random_scene
from tests.scene_builder import build
from tests.test_composed import driven, rigid_pendulum
from tests.test_conserving_steps import AnySize, hinged
from tests.test_energy_momentum import bars, plate

SHOWN = ("seconds", "info", "steps")
"""Of results, what is not compared: time, and what has no numbers of its own."""


class Passed(fl.extend.PolicyState):
    """Those of another policy, which have to be asked for."""

    def __init__(self, inner: fl.extend.PolicyState) -> None:
        self._inner = inner

    def before_iteration(self, iteration: int) -> fl.extend.Refactorisation | bool:
        return self._inner.before_iteration(iteration)

    def after_step(self, iterations: int) -> None:
        self._inner.after_step(iterations)

    @property
    def asks(self) -> bool:
        return self._inner.asks

    def answer(self, iterations: int, rate: float, staleness: float) -> None:
        self._inner.answer(iterations, rate, staleness)


class Asked(fl.schemes.Automatic):
    """As Automatic, which no loop can decide by."""

    def begin(self, bound: bool) -> fl.extend.PolicyState:
        return Passed(super().begin(bound))


def same(one: fl.Result, other: fl.Result) -> None:
    """All that was found, to the last bit."""
    for name in (field.name for field in fields(one) if field.name not in SHOWN):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


def watched(monkeypatch) -> dict[str, int]:
    """How often steps are iterated in Python, and how often a run goes on."""
    calls = {"_iterate": 0, "_advance": 0}

    def count(name):
        function = getattr(AlphaRun, name)

        def counted(self, *arguments, **named):
            calls[name] += 1
            return function(self, *arguments, **named)

        monkeypatch.setattr(AlphaRun, name, counted)

    for name in calls:
        count(name)
    return calls


@pytest.mark.parametrize("case", [1, 2, 3])
def test_the_double_pendulum_goes_through_the_loop(monkeypatch, case):
    calls, options = watched(monkeypatch), {"cost": 4.0, "refresh": 3.0}
    scene, step = pendulum(case)[0], STEP[case]
    given = {"duration": 400 * step, "step": step, "progress": False}
    compiled = fl.GeneralisedAlpha(policy=fl.schemes.Automatic(**options)).run(scene, **given)
    assert calls["_iterate"] == 0 and calls["_advance"] < 20
    one_by_one = fl.GeneralisedAlpha(policy=Asked(**options)).run(scene, **given)
    assert calls["_iterate"] >= 400
    same(compiled, one_by_one)
    if case != 2:
        assert compiled.phi_updates > compiled.k_updates > 0


def test_friction_in_joints_goes_through_the_loop(monkeypatch):
    calls, options = watched(monkeypatch), {"cost": 4.0, "refresh": 3.0}
    scene, given = pendulum(3)[0], {"duration": 0.12, "step": 3e-4, "progress": False}
    for joint in [each for each in scene.joints if isinstance(each, fl.joints.Revolute)]:
        scene.add(fl.joints.JointFriction(joint, 0.3, stiction_speed=0.05, radius=0.1))
    assert scene.connections
    compiled = fl.GeneralisedAlpha(policy=fl.schemes.Automatic(**options)).run(scene, **given)
    assert calls["_iterate"] == 0 and compiled.balance[-1, 1] > 0.0
    same(compiled, fl.GeneralisedAlpha(policy=Asked(**options)).run(scene, **given))
    assert calls["_iterate"] >= 400


@pytest.mark.parametrize(
    "policy",
    [
        fl.schemes.IterationLimit(3),
        fl.schemes.ConstraintsOnly(3),
        fl.schemes.EveryIteration(),
        fl.schemes.FactoriseOnce(),
    ],
    ids=repr,
)
def test_every_policy_with_a_rule_decides_likewise(policy):
    scene = pendulum(3)[0]

    class Same(fl.schemes.RefactorisationPolicy):
        full_newton_fallback = policy.full_newton_fallback

        def begin(self, bound: bool) -> fl.extend.PolicyState:
            return Passed(policy.begin(bound))

    given = {"duration": 0.03, "step": 3e-4, "progress": False}
    one, other = (fl.GeneralisedAlpha(policy=p).run(scene, **given) for p in (policy, Same()))
    same(one, other)


@pytest.mark.parametrize("save", [{"save_every": 7}, {"save_at": 0.0013}, {"save_at": [0.011]}])
def test_what_is_kept_is_the_same(save):
    scene = pendulum(3)[0]
    given = {"duration": 0.02, "step": 2e-4, "progress": False} | save
    one, other = (
        fl.GeneralisedAlpha(policy=p).run(scene, **given) for p in (fl.schemes.Automatic(), Asked())
    )
    same(one, other)


@pytest.mark.parametrize("seed", range(24))
def test_random_scenes_move_alike(seed):
    """With loads in time, motions, supports, shells, redundant joints and all else there is."""
    found = []
    for policy in (fl.schemes.Automatic(cost=4.0, refresh=3.0), Asked(cost=4.0, refresh=3.0)):
        scene = build(random_scene(seed), static=False).scene
        scheme = fl.GeneralisedAlpha(policy=policy)
        try:
            found.append(scheme.run(scene, duration=0.05, step=2.5e-3, progress=False))
        except fl.ConvergenceError as error:
            found.append(error.result)
    same(*found)


def test_steps_that_change_are_the_same():
    scene = pendulum(3)[0]
    step = fl.schemes.AdaptiveStep(1e-3, first=1e-4)
    one, other = (
        fl.GeneralisedAlpha(policy=p).run(scene, duration=0.05, step=step, progress=False)
        for p in (fl.schemes.Automatic(), Asked())
    )
    same(one, other)
    np.testing.assert_array_equal(one.steps.sizes, other.steps.sizes)


@pytest.mark.parametrize("held", [False, True])
def test_axes_of_solids_are_turned_in_the_loop(monkeypatch, held):
    """As after steps made one by one; where positions are held, reactions count."""
    calls, options = watched(monkeypatch), {"cost": 4.0, "refresh": 3.0}
    law = fl.sections.NeoHooke(1e5, 0.3, 1000.0)
    body = fl.Solid.brick((0.2, 0.1, 0.1), law, cells=(2, 1, 1), name="brick")
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    if held:
        body.roller("c=0", (0, 0, 1))
    body.add_velocity(omega=(0, 0, 20.0), about=(0, 0, 0))
    given = {"duration": 0.1, "step": 1e-3, "progress": False}
    compiled = fl.GeneralisedAlpha(policy=fl.schemes.Automatic(**options)).run(scene, **given)
    assert calls["_iterate"] == 0
    assert calls["_advance"] < 20 or held
    one_by_one = fl.GeneralisedAlpha(policy=Asked(**options)).run(scene, **given)
    same(compiled, one_by_one)
    turned = compiled.frames[:, :, 1:] - compiled.frames[0, :, 1:]
    assert (np.abs(turned).max() > 1.0) is not held


@pytest.mark.parametrize("scene", [rigid_pendulum, lambda: bars()[0]], ids=["rigid", "bars"])
def test_the_compiled_loop_of_the_variational_scheme_makes_the_same_steps(monkeypatch, scene):
    """To the last bit, with refactorised matrices within it, and with the energy balance."""
    scheme = fl.schemes.Variational(policy=fl.schemes.Automatic(cost=3.0, patience=3))
    plan = {"duration": 0.06, "step": 2e-3, "save_every": 5}
    quick = scheme.run(scene(), **plan)
    monkeypatch.setattr(VariationalRun, "_alone", property(lambda self: False))
    slow = scheme.run(scene(), **plan)
    same(quick, slow)
    assert quick.factorisations == slow.factorisations > 1


@dynamics.groups
@pytest.mark.parametrize("radius", [0.0, 0.6, 0.8])
def test_start_stands_for_the_acceleration_before_the_first_step(radius, group):
    """``a₀`` is ``v̇`` at ``(α_m − α_f) h`` to second order; ``v̇₀`` in its place is first order."""
    angle, speed = 0.3, 1.0
    moment = dynamics.MASS * dynamics.G * dynamics.LENGTH / dynamics.INERTIA_ABOUT_PIVOT
    errors = []
    for step in (2e-2, 1e-2):
        scene, _ = dynamics.pendulum(angle, speed, group)
        run = AlphaRun(
            fl.GeneralisedAlpha(radius=radius), fl.extend.Equations(scene, dynamics=True), step
        )
        run.start()
        # time runs backwards: the pendulum with the opposite speed
        before = dynamics.exact_pendulum(
            np.array([0.0, (run.p.af - run.p.am) * step]), angle, -speed
        )
        errors.append(abs(run.s.a[0, 4] - moment * np.cos(before[0][-1])))
    assert np.log2(errors[0] / errors[1]) > 1.9, errors


@dynamics.groups
@dynamics.maps
def test_iteration_matrix_is_the_derivative_of_the_residual(group, parametrisation):
    """At a random state with rotations of half a radian in the step, column by column."""
    scheme = fl.GeneralisedAlpha(parametrisation=parametrisation)
    equations = fl.extend.Equations(
        dynamics.mixed_scene(group), dynamics=True, parametrisation=parametrisation
    )
    run, size = AlphaRun(scheme, equations, 1e-2), equations.unknowns.size
    run.start()
    s, rng, epsilon = run.s, np.random.default_rng(5), 1e-6
    s.motion[:] = rng.normal(size=s.motion.shape)
    s.d[:] = 0.3 * rng.normal(size=s.d.shape)
    run.multipliers[:] = rng.normal(size=run.multipliers.shape)

    def residual_at(dx: np.ndarray) -> np.ndarray:
        state = tuple(part.copy() for part in s)
        weights = run.multipliers.copy()
        correct(tuple(run.p), state, dx.copy(), *run._sizes, weights)
        r = np.empty(size)
        H1, motion = state[1], state[2]
        equations.residual(fl.extend.TimeState(H1, motion[6], motion[7], weights), run.scale, r)
        return r

    zero, weights = np.zeros(size), run.multipliers.copy()
    correct(tuple(run.p), tuple(s), zero.copy(), *run._sizes, weights)
    now = fl.extend.TimeState(s.H1, s.twist1, s.rate1, run.multipliers)
    equations.residual(now, run.scale, zero, run.forces)
    run._fill(s.H1, s.H1, run.scale, turned=False)
    matrix = equations.matrix.matrix.convert("dense").getDenseArray()
    numeric = np.empty_like(matrix)
    for j, e in enumerate(epsilon * np.eye(size)):
        numeric[:, j] = (residual_at(-e) - residual_at(e)) / (2 * epsilon)
    largest = np.abs(numeric).max(axis=1, keepdims=True)
    # epsilon² of third derivatives, round-off over epsilon
    assert (np.abs(matrix - numeric) < 1e-7 * largest).all()


def test_iterations_count_attempts_that_failed(monkeypatch):
    """With a matrix that is kept too long four iterations do not do: steps are done again."""
    corrections = []

    def counted(*arguments: Any) -> float:
        corrections.append(arguments)
        return correct(*arguments)

    monkeypatch.setattr(newton, "correct", counted)
    result = dynamics.flexible_pendulum(Asked(1e9, 100, 1e9), max_iterations=4)
    after_fallback = np.diff(result.iterations) > 4
    assert after_fallback.any()
    assert result.iterations[-1] == len(corrections)
    # and as many without Python between them
    compiled = dynamics.flexible_pendulum(fl.schemes.Automatic(1e9, 100, 1e9), max_iterations=4)
    same(compiled, result)


class Deaf(fl.schemes.Automatic):
    """As without asking: all is refactorised when new constraints no longer bring back the best."""

    def begin(self, bound: bool) -> fl.extend.PolicyState:
        rule = super().begin(bound).rule
        assert rule is not None and rule.asks
        return Ruled(rule._replace(asks=False))


def test_automatic_keeps_mass_and_stiffness_that_are_not_to_blame():
    """Stiff bars on hinges: what turns is the constraints."""
    full, other = policies.arm(policy=fl.schemes.EveryIteration())
    asking, tip = policies.arm(policy=fl.schemes.Automatic(cost=5, refresh=5))
    deaf, _ = policies.arm(policy=Deaf(cost=5, refresh=5))
    assert asking.k_updates < deaf.k_updates / 4
    # what else there is to lose is less than was lost to make all anew
    assert asking.iterations[-1] < 1.2 * deaf.iterations[-1]
    position = asking.position(tip.point("end"))
    np.testing.assert_allclose(position, full.position(other.point("end")), atol=1e-8)


@pytest.mark.parametrize("group", fl.lie.Group)
def test_staleness_is_the_rate_at_which_an_old_matrix_converges(group):
    """Without constraints twice the matrix leaves half of each correction, the same matrix none."""
    scene = fl.Scene()
    section = fl.Section.circle(0.005, policies.MATERIAL)
    bar = scene.add(fl.Beam.straight((0, 0, 0), (0.4, 0.3, 0), section, cells=4).set_group(group))
    bar.add_velocity(omega=(1, 2, 3), about=(0, 0, 0))
    equations = fl.extend.Equations(scene, dynamics=True)
    run = AlphaRun(fl.GeneralisedAlpha(), equations, 1e-3)
    run.start()
    s, rng = run.s, np.random.default_rng(3)
    now = fl.extend.TimeState(s.H1, s.twist1, s.rate1, run.multipliers)
    equations.residual(now, run.scale, run.r, run.forces)
    run._factorise(s.H1)

    def rate() -> float:
        x = rng.normal(size=equations.unknowns.size)
        return staleness(equations, run.solver, run._plain[0], s, run.multipliers, run._sizes, x)

    # differences of residuals have errors of round-off over their size, and of its square
    assert rate() < 1e-5
    equations.matrix.csr[0][:] *= 2.0
    equations.matrix.matrix.stateIncrease()
    equations.matrix.matrix.assemble()
    run.solver.factorise()
    assert rate() == pytest.approx(0.5, abs=1e-5)


def in_parts(monkeypatch, size: float) -> None:
    """Let every step but the first one fail in full."""
    go = ConservingRun._go

    def fails(
        self: ConservingRun, last: int, rule: tuple[int, float], *, always: bool = False
    ) -> int:
        if self.size == size and self.index:
            if not always:
                self._begin()
            return loop.FAILED
        return go(self, min(last, self.index + 1), rule, always=always)

    monkeypatch.setattr(ConservingRun, "_go", fails)


@pytest.mark.parametrize("scheme", [starts.CONSERVES, starts.DECAYS], ids=["conserves", "decays"])
def test_parts_conserve_and_their_error_is_of_second_order(monkeypatch, scheme):
    duration, finest = 0.12, 1.25e-4
    exact = starts.CONSERVES.run(starts.hanging(), duration=duration, step=finest)
    sizes = 4e-3, 2e-3
    whole = [scheme.run(starts.hanging(), duration=duration, step=size) for size in sizes]
    found = []
    for size in sizes:
        in_parts(monkeypatch, size)
        found.append(scheme.run(starts.hanging(), duration=duration, step=size))
        monkeypatch.undo()
        assert found[-1].divided == round(duration / size) - 1
        starts.check_balances(found[-1])

    def error(result: fl.Result, name: str) -> float:
        every = round(result.times[1] / finest)
        return np.abs(getattr(result, name) - getattr(exact, name)[::every]).max()

    for name in ("frames", "velocities", "joint_forces", "reactions"):
        assert error(found[0], name) > 3.5 * error(found[1], name)
    assert error(found[0], "frames") < error(whole[0], "frames")


class Shifted(ConservingRun):
    """In whose joints something is missing that no increment has made."""

    def start(self):
        super().start()
        self.s.H[self.moving - 1, 0, 0] += 1e-9


class ShiftedSteps(fl.EnergyMomentum):
    def _integration(self, equations, step):
        return Shifted(self.options(), equations, step)


def test_what_constraints_miss_is_led_back():
    """A thousandth in each step; increments alone, whose round-off adds up, do not know of it."""
    steps = 200
    result = ShiftedSteps().run(MIXED["crane"](), duration=steps * 2e-4, step=2e-4, save_every=10)
    missing = result.joint_violations[:, -1]
    assert missing[0] == pytest.approx(1e-9, rel=1e-3)
    assert missing[-1] == pytest.approx(1e-9 * 0.999**steps, rel=0.02)


def fail_in_full(monkeypatch, h: float) -> None:
    """Let every composed step of size ``h`` but the first fail when half of its parts are made."""
    one_part, make = ComposedRun._one_part, MomentumPart.make

    def fails(self: ComposedRun) -> bool:
        middle = self._position.part == len(self._order) // 2
        whole = self.division.level == 0 and self.index > 0
        return not (whole and middle) and one_part(self)

    def makes(self: MomentumPart, start: float, last: float, earlier: float) -> bool:
        whole = min(abs(self.h / h - part) for part in fl.schemes.FiveStages().parts) < 1e-9
        return not (whole and start > 1.2 * h and start / h % 1.0 > 0.2) and make(
            self, start, last, earlier
        )

    monkeypatch.setattr(ComposedRun, "_quick", False)
    monkeypatch.setattr(ComposedRun, "_one_part", fails)
    monkeypatch.setattr(MomentumPart, "make", makes)


@pytest.mark.parametrize("scheme", divided_steps.COMPOSED.values(), ids=divided_steps.COMPOSED)
@pytest.mark.parametrize("scene", [rigid_pendulum, driven], ids=["free", "driven"])
def test_composed_steps_keep_their_order_in_parts(monkeypatch, scheme, scene):
    """They are composed steps of half the size, and so is the motion."""
    duration, h = 0.06, 4e-3
    whole, half = (scheme.run(scene(), duration=duration, step=step) for step in (h, h / 2))
    fail_in_full(monkeypatch, h)
    found = scheme.run(scene(), duration=duration, step=h, save_every=1)
    assert found.divided == len(found.times) - 2
    for name in ("frames", "velocities"):
        exact = getattr(half, name)[::2]
        far, near = (np.abs(getattr(each, name) - exact).max() for each in (whole, found))
        assert near < 0.2 * far
    assert found.joint_violations.max() <= 1e-12


@pytest.mark.parametrize("rows", [1, 10**9])
@pytest.mark.parametrize("scheme", saving.SCHEMES)
@pytest.mark.parametrize("save_at", [None, 0.0047])
def test_a_file_has_the_same_and_a_resumed_run_too(tmp_path, monkeypatch, scheme, save_at, rows):
    """However many rows pass at a time."""
    plan = {"duration": 0.1, "step": 2e-3, "save_at": save_at}
    whole = saving.SCHEMES[scheme].run(saving.top(), **plan)
    monkeypatch.setattr(window, "BUFFER_BYTES", rows)
    file = tmp_path / "run.h5"
    write = window.Window._saved_state
    for stop in (1, 3):
        calls = [0]

        def memory(self, calls=calls, stop=stop):
            calls[0] += 1
            if calls[0] > stop:
                raise KeyboardInterrupt
            return write(self)

        monkeypatch.setattr(window.Window, "_saved_state", memory)
        with pytest.raises(KeyboardInterrupt):
            if file.exists():
                saving.SCHEMES[scheme].resume(saving.top(), file)
            else:
                saving.SCHEMES[scheme].run(saving.top(), file=file, checkpoint_every=9, **plan)
        assert len(fl.Result.load(file).times)
    monkeypatch.setattr(window.Window, "_saved_state", write)
    resumed = saving.SCHEMES[scheme].resume(saving.top(), file)
    saving.same(resumed, whole, rtol=0, atol=0)
    saving.same(fl.Result.load(file), whole, rtol=0, atol=0)
    assert isinstance(resumed.frames, np.memmap)


SCHEMES = {
    "generalised-α": fl.GeneralisedAlpha(),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(radius=0.8),
}


def parts(state: Any) -> dict[str, np.ndarray]:
    """All arrays of a state that a step may change, by name; not what counts the tries."""
    if state is None or isinstance(state, float | np.ndarray):
        return {"": np.array(state)}
    if hasattr(state, "_asdict"):
        state = state._asdict()
    items = state.items() if isinstance(state, dict) else enumerate(state)
    return {
        f"{name}.{inner}": array
        for name, part in items
        if not str(name).startswith("progress")
        for inner, array in parts(part).items()
    }


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_rejected_step_leaves_the_state_as_it_was(monkeypatch, scheme):
    """All of it to the last bit: motion, forces, accounts, fields of cells, turns of joints."""
    stepper = AlphaSteps if scheme == "generalised-α" else ConservingSteps
    take_back, changed = stepper.take_back, set()

    def watched(self, state):
        kept = parts(copy.deepcopy(state))
        tried = parts(self.saved())
        changed.update(name for name in kept if np.any(kept[name] != tried[name]))
        take_back(self, state)
        for name, array in parts(self.saved()).items():
            np.testing.assert_array_equal(array, kept[name], err_msg=name)

    monkeypatch.setattr(stepper, "take_back", watched)
    scene, _ = plate("Hellinger-Reissner")
    wheel = scene.add(fl.RigidBody(1.0, (0.1, 0.2, 0.1), (0, 0, 3)))
    wheel.add_velocity(omega=(0, 0, 40.0), about=wheel.point("centre"))
    scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0, 1)))
    steps = fl.schemes.AdaptiveStep(0.3, first=1e-2, largest=1e-2)
    result = SCHEMES[scheme].run(scene, duration=0.05, step=steps, progress=False)
    assert len(result.steps.rejected) >= 1
    if stepper is ConservingSteps:
        assert {
            "s.H.",
            "s.V.",
            "s.account.",
            "equations.history_variables.joints.",
            "cells.0.",
        } <= changed


@pytest.mark.parametrize("scheme", ["energy-momentum", "energy-decaying"])
def test_a_change_of_the_step_keeps_impulses_and_rates(monkeypatch, scheme):
    """What is left over has its impulse, and changes of velocity their acceleration."""
    set_step, felt = ConservingSteps.set_step, []

    def watched(self, time, h):
        old, before = self.h, copy.deepcopy(self.s._asdict())
        set_step(self, time, h)
        assert self.h == pytest.approx(h, rel=1e-12)
        for name, power in {"last_residual": -1, "w": 1, "w_F": 1}.items():
            expected = before.pop(name) * (h / old) ** power
            np.testing.assert_allclose(getattr(self.s, name), expected, rtol=1e-12)
        lag = before.pop("filter_state")
        lag.length *= (h / old) ** 2
        for name, number in fields_of(lag).items():
            now = fields_of(self.s.filter_state)[name]
            np.testing.assert_allclose(now, number, rtol=1e-12, err_msg=name)
        for name, array in before.items():
            np.testing.assert_array_equal(getattr(self.s, name), array, err_msg=name)
        if h != old:
            felt.append([np.abs(self.s.last_residual).max(), np.abs(self.s.w).max()])

    monkeypatch.setattr(ConservingSteps, "set_step", watched)
    scene, _, _ = bars()
    SCHEMES[scheme].run(scene, duration=0.02, step=AnySize(1e-3), progress=False)
    largest = np.max(felt, axis=0)
    assert largest[0] > 0.0
    assert largest[1] > 0.0 or scheme == "energy-momentum"


@pytest.mark.parametrize("scheme", SCHEMES.values())
def test_rejected_steps_leave_the_turns_of_joints(monkeypatch, scheme):
    """Angles are counted on from the last step that was accepted, whatever was tried since."""
    attempt, turned = VariableSteps._attempt, []

    def watched(self, history) -> bool:
        connections = self._stepper.equations.system.connections
        before = connections.history_variables.copy()
        made = attempt(self, history)
        turned.append((made, np.abs(connections.history_variables - before).max()))
        if made:
            connections.accept(self._stepper.frames)
            assert np.abs(connections.history_variables - before).max() > 0.0
        return made

    monkeypatch.setattr(VariableSteps, "_attempt", watched)
    choice = fl.schemes.AdaptiveStep(1e-3, first=1e-2, refinement=3)
    scheme.run(hinged(), duration=0.1, step=choice)
    rejected = [change for made, change in turned if not made]
    assert len(rejected) >= 1 and max(rejected) == 0.0


def test_corrections_of_a_planar_chain_are_made_in_the_loop(monkeypatch):
    """Forces out of its plane are round-off, of which factors leave large fractions."""
    calls, plain = [], fl.extend.DirectSolver.correct

    def observed(solver):
        plain(solver)
        calls.append(solver._refines)

    monkeypatch.setattr(fl.extend.DirectSolver, "correct", observed)
    result = fl.GeneralisedAlpha(radius=0.8).run(chain(10), duration=0.2, step=1e-3)
    assert max(calls) > 0
    assert len(calls) <= 2 * result.factorisations + 10


def test_a_stop_that_pulls_over_a_step_opens_at_its_end(monkeypatch):
    """If one that was closed in spite of its pull at the start still pulls at the end."""
    lift = {"force": (0, 0, 40.0), "history": lambda t: float(t > 0.4)}
    free, kept = Limits.separate, []

    def once_closed(self, *given):
        kept.append(bool(self.closed.any()))
        return len(kept) > 1 and free(self, *given)

    monkeypatch.setattr(Limits, "separate", once_closed)
    scene = fl.Scene(gravity=(0.0, 0.0, -10.0))
    ball = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), position=(0.0, 0.0, 1.0)))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), ball.point("centre"), name="rail"))
    scene.add(fl.joints.Limit(rail.displacement, lower=-1.0))
    scene.add(fl.PointLoad(ball.point("centre"), **lift))
    step = fl.schemes.ConstantStep(0.01)
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=1.0, step=step)
    assert kept[0]
    struck, opened = result.steps.event_times
    assert 0.0 < opened - struck <= 0.01 + 1e-12
    height = result.coordinate("rail") + 1.0
    np.testing.assert_allclose(height[-1], 5.0 * (1.0 - opened) ** 2, rtol=1e-9)

"""The compiled loop of generalised-α makes the steps that are made one by one without it."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

import fem_lie as fl
from demos.double_pendulum import STEP, pendulum
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.variational.run import VariationalRun
from tests.random_scenes import random_scene
from tests.scene_builder import build
from tests.test_composed import rigid_pendulum
from tests.test_energy_momentum import bars

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
        function = getattr(Run, name)

        def counted(self, *arguments, **named):
            calls[name] += 1
            return function(self, *arguments, **named)

        monkeypatch.setattr(Run, name, counted)

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

"""What steps that change keep: a rejected one leaves nothing, and sizes carry what is theirs."""

import copy
from typing import Any

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.solve.alpha.variable import AlphaSteps
from fem_lie.solve.conserving.variable import ConservingSteps
from fem_lie.solve.motion.variable_steps import VariableSteps
from tests.test_conserving_steps import AnySize, hinged
from tests.test_energy_momentum import bars, plate

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
        assert {"s.H.", "s.V.", "s.account.", "equations.memory.joints.", "cells.0."} <= changed


@pytest.mark.parametrize("scheme", ["energy-momentum", "energy-decaying"])
def test_a_change_of_the_step_keeps_impulses_and_rates(monkeypatch, scheme):
    """What is left over has its impulse, and changes of velocity their acceleration."""
    set_step, felt = ConservingSteps.set_step, []

    def watched(self, time, h):
        old, before = self.h, {name: a.copy() for name, a in self.s._asdict().items()}
        set_step(self, time, h)
        assert self.h == pytest.approx(h, rel=1e-12)
        for name, power in {"carry": -1, "w": 1, "w_F": 1}.items():
            expected = before.pop(name) * (h / old) ** power
            np.testing.assert_allclose(getattr(self.s, name), expected, rtol=1e-12)
        lag = before.pop("filter_state")
        lag.length *= (h / old) ** 2
        np.testing.assert_allclose(self.s.filter_state.tolist(), lag.tolist(), rtol=1e-12)
        for name, array in before.items():
            np.testing.assert_array_equal(getattr(self.s, name), array, err_msg=name)
        if h != old:
            felt.append([np.abs(self.s.carry).max(), np.abs(self.s.w).max()])

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

    def watched(self) -> bool:
        connections = self._stepper.equations.system.connections
        before = connections.memory.copy()
        made = attempt(self)
        turned.append((made, np.abs(connections.memory - before).max()))
        if made:
            connections.accept(self._stepper.frames)
            assert np.abs(connections.memory - before).max() > 0.0
        return made

    monkeypatch.setattr(VariableSteps, "_attempt", watched)
    choice = fl.schemes.AdaptiveStep(1e-3, first=1e-2, refinement=3)
    scheme.run(hinged(), duration=0.1, step=choice)
    rejected = [change for made, change in turned if not made]
    assert len(rejected) >= 1 and max(rejected) == 0.0

"""Steps of conserving schemes that have no end from where they usually begin."""

import logging
from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.random_scenes import STUDIES, allowed, difference, outcome, ways
from tests.random_scenes import CONSERVING, STEP, random_scene
from tests.scene_builder import build
from tests.test_resume import same, stopped

CONSERVES, DECAYS = fl.EnergyMomentum(), fl.EnergyDecaying()
BENT_AT_ONCE = 12
"""Steps of random scenes in which a beam is to be bent from the first moment on."""


def scene(seed: int, steps: int = BENT_AT_ONCE) -> fl.Scene:
    return build(random_scene(seed, replace(CONSERVING, steps=steps))).scene


def check_balances(result: fl.Result) -> None:
    assert result.balance_error < 1e-10
    assert result.momentum_error < 1e-12
    assert result.angular_momentum_error < 1e-12
    assert result.joint_violations.max(initial=0.0) < 1e-12


@pytest.mark.parametrize("scheme", [CONSERVES, DECAYS], ids=["conserves", "decays"])
@pytest.mark.parametrize("seed", [28, 53])
def test_waves_that_a_step_does_not_resolve_have_an_end(scheme, seed):
    """Predicted from their velocities they are far from it, and the iteration went astray."""
    result = scheme.run(scene(seed), duration=BENT_AT_ONCE * STEP, step=STEP)
    assert result.divided == 0
    check_balances(result)


PLAN = {"duration": 12 * STEP, "step": 2 * STEP}


@pytest.fixture(scope="module")
def divided():
    return CONSERVES.run(scene(4), **PLAN)


def test_a_step_without_an_end_is_made_in_parts(divided):
    assert 0 < divided.divided < 6
    check_balances(divided)
    assert np.allclose(divided.times, 2 * STEP * np.arange(7))


def test_resumed_after_steps_in_parts_is_the_same_to_the_last_bit(tmp_path, caplog, divided):
    file = tmp_path / "run.h5"
    stopped(CONSERVES, scene(4), file, 5, **PLAN)
    resumed = CONSERVES.resume(scene(4), file)
    same(resumed, divided)
    assert resumed.divided == fl.Result.load(file).divided == divided.divided
    assert f"{divided.divided} of 6 steps were divided into up to" in caplog.text


def hanging() -> fl.Scene:
    """A clamped beam with a bar on a hinge, pushed while its strain changes."""
    made = fl.Scene()
    section = fl.Section.circle(0.01, fl.Material(1e8, 0.3, 1100.0))
    beam = made.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=4))
    bar = made.add(fl.Beam.straight((0.5, 0, 0), (0.9, 0, 0), section, cells=1))
    made.add(fl.Clamp(beam.point("start")))
    made.add(fl.joints.Revolute(beam.point("end"), bar.point("start"), axis=(0, 1, 0)))
    made.add(
        fl.PointLoad(bar.point("end"), (0, 0, 0.05), history=lambda t: (1 - np.cos(20 * t)) ** 2)
    )
    made.add(
        fl.loads.Eigenstrain(
            beam, (0, 0, 0, 0, 0.2, 0), history=lambda t: (1 - np.cos(10 * t)) ** 2
        )
    )
    return made


def test_a_step_that_has_no_end_in_parts_says_so():
    with pytest.raises(fl.ConvergenceError, match="did it in 64 sub-steps") as caught:
        fl.EnergyMomentum(max_iterations=1).run(scene(4), **PLAN)
    assert caught.value.result.divided == 0


def test_round_off_of_far_positions_is_no_reason_for_parts(caplog):
    """Forces of joints that it makes are larger, the smaller the parts: 0.2 of the whole."""
    study = STUDIES["energy-momentum"]
    scenes = ways(random_scene(9, study.wanted), 9)
    near, far = (outcome(study, scenes[name]) for name in ("as it is", "moved by 1e6"))
    assert difference(near, far)[0] <= allowed("moved by 1e6")
    assert "parts" not in caplog.text


@pytest.mark.slow
def test_an_iteration_gone_astray_is_no_round_off():
    """Among folded elements all is felt: a step was taken to be done, with 10⁶ times the energy."""
    data = replace(random_scene(22, replace(CONSERVING, steps=1300)), loads=())
    result = DECAYS.run(
        build(data).scene, duration=1300 * STEP, step=STEP, save_every=10, progress=False
    )
    assert result.balance is not None
    work = np.abs(result.balance).max() + np.abs(result.potential - result.potential[0]).max()
    assert (result.kinetic + result.elastic).max() < 3.0 * (result.total_energy[0] + work)
    assert result.balance_error < 1e-10


@pytest.mark.slow
def test_steps_that_converge_slowly_are_given_time():
    """Nearly all energy is in waves that the step does not resolve: a rate of 0.8 to 0.95."""
    data = replace(random_scene(44, replace(CONSERVING, steps=620)), loads=())
    result = CONSERVES.run(
        build(data).scene, duration=620 * STEP, step=STEP, save_every=10, progress=False
    )
    check_balances(result)


def test_policies_that_make_no_matrix_make_no_parts(caplog):
    caplog.set_level(logging.WARNING)
    with pytest.raises(fl.ConvergenceError, match="a policy that may refactorise"):
        fl.EnergyMomentum(policy=fl.schemes.FactoriseOnce()).run(
            scene(4), duration=12 * STEP, step=STEP
        )
    assert "parts" not in caplog.text

"""Composed schemes: their order in all reported quantities, invariants, interruption, bad input."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.interruption import interrupted
from tests.test_energy_momentum import ARRAYS, SQUARE, bars, plate, same

COMPOSITIONS = {
    "five": fl.schemes.FiveStages(),
    "nine": fl.schemes.NineStages(),
    "triple": fl.schemes.TripleJump(),
}
SCHEMES = {name: fl.schemes.Composed(composition=how) for name, how in COMPOSITIONS.items()}


def orders(scheme, scene, duration, numbers, names):
    """Observed between the last three of runs with so many steps each, for each name."""
    ends = []
    for steps in numbers:
        result = scheme.run(scene(), duration=duration, step=duration / steps, save_every=steps)
        ends.append([getattr(result, name)[-1] for name in names])
    far, near = (
        [np.abs(a - b).max() for a, b in zip(one, two, strict=True)] for one, two in pairwise(ends)
    )
    return np.log2(np.array(far) / np.array(near))


@pytest.mark.parametrize("how", COMPOSITIONS.values(), ids=COMPOSITIONS)
def test_conditions_of_fourth_order(how):
    assert sum(how.parts) == pytest.approx(1.0, abs=1e-14)
    assert sum(part**3 for part in how.parts) == pytest.approx(0.0, abs=1e-14)
    assert how.parts == how.parts[::-1]
    assert sum(how.halves) == pytest.approx(1.0, abs=1e-14)


def flying() -> fl.Scene:
    """A soft beam that turns, flies and bends."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), SQUARE, cells=3))
    beam.add_velocity(omega=(3, 1, -8), about=(0.2, 0, 0))
    beam.velocities[:, 2] += 4.0 * beam.frames[:, 0, 0]
    return scene


@pytest.mark.parametrize(
    ("scheme", "steps"), [("five", (16, 32, 64)), ("nine", (8, 16, 32)), ("triple", (32, 64, 128))]
)
def test_fourth_order_of_a_flying_beam(scheme, steps):
    found = orders(SCHEMES[scheme], flying, 0.01, steps, ("frames", "velocities"))
    np.testing.assert_allclose(found, 4.0, atol=0.15)


def rigid_pendulum() -> fl.Scene:
    """Two rigid bodies with a revolute joint that is not linear, under gravity."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one = scene.add(fl.RigidBody(1.0, (2e-3, 5e-3, 6e-3), position=(0.2, 0, 0)))
    two = scene.add(fl.RigidBody(0.7, (1e-3, 3e-3, 3e-3), position=(0.5, 0, 0)))
    scene.add(fl.joints.Revolute(fl.ground(), one.point("centre"), at=(0, 0, 0), axis=(0, 1, 0)))
    scene.add(
        fl.joints.Revolute(
            one.point("centre"), two.point("centre"), at=(0.4, 0, 0), axis=(0, 1, 0.5)
        )
    )
    return scene


def test_fourth_order_with_joints():
    names = "frames", "velocities", "joint_forces"
    found = orders(SCHEMES["five"], rigid_pendulum, 0.4, (16, 32, 64), names)
    np.testing.assert_allclose(found, 4.0, atol=0.15)


MOMENTA = {
    name: fl.schemes.Composed(fl.schemes.Variational(), how) for name, how in COMPOSITIONS.items()
}
"""Schemes whose parts are those of the variational one."""


@pytest.mark.parametrize(("scheme", "steps"), [("five", (16, 32, 64)), ("triple", (64, 128, 256))])
def test_fourth_order_of_variational_parts(scheme, steps):
    names = "frames", "velocities", "joint_forces"
    found = orders(MOMENTA[scheme], rigid_pendulum, 0.4, steps, names)
    np.testing.assert_allclose(found, 4.0, atol=0.1)
    found = orders(MOMENTA[scheme], flying, 0.01, [2 * n for n in steps], names[:2])
    np.testing.assert_allclose(found, 4.0, atol=0.1)


@pytest.mark.parametrize("scheme", MOMENTA.values(), ids=MOMENTA)
def test_momenta_of_variational_parts(scheme):
    """They are exact; joints are closed at the end of each step; the energy goes up and down."""
    result = scheme.run(flying(), duration=0.05, step=1e-3)
    assert result.momentum_error <= 1e-13
    assert result.angular_momentum_error <= 1e-13
    assert 1e-12 <= result.energy_error <= 1e-4
    held = scheme.run(bars()[0], duration=0.04, step=4e-3)
    assert held.angular_momentum_error <= 1e-12
    assert held.joint_violations.max() <= 1e-13


def test_work_of_variational_parts():
    """Books are those of the trapezoidal rule, and close with steps."""
    far, near = (
        MOMENTA["five"].run(driven(), duration=0.1, step=step).balance_error
        for step in (2e-3, 1e-3)
    )
    assert near <= 0.35 * far <= 1e-2


def driven() -> fl.Scene:
    """A rigid arm that is driven, beside one that is held and pushed."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    arm = scene.add(fl.RigidBody(1.0, (2e-3, 5e-3, 6e-3), position=(0.2, 0, 0)))
    hinge = scene.add(
        fl.joints.Revolute(fl.ground(), arm.point("centre"), at=(0, 0, 0), axis=(0, 1, 0))
    )
    scene.add(fl.joints.Drive(hinge.angle, lambda t: 0.5 * (1.0 - np.cos(3.0 * t))))
    soft = scene.add(fl.Beam.straight((0, 1, 0), (0.3, 1, 0), SQUARE, cells=2))
    scene.add(fl.Clamp(soft.point("start")))
    scene.add(
        fl.PointLoad(soft.point("end"), force=(0, 0, 0.1), history=lambda t: 1.0 - np.cos(40.0 * t))
    )
    return scene


def test_fourth_order_with_functions_of_time():
    """But for what drives need, whose accelerations are differences of the second order."""
    names = "frames", "velocities", "reactions"
    found = orders(SCHEMES["five"], driven, 0.02, (16, 32, 64), names)
    np.testing.assert_allclose(found, 4.0, atol=0.2)


def test_work_is_accounted_for():
    result = SCHEMES["five"].run(driven(), duration=0.1, step=2e-3)
    assert result.balance_error <= 1e-12
    assert abs(result.balance[-1, 0]) > 1e-3


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
@pytest.mark.parametrize("joint", [fl.joints.Spherical, fl.joints.Revolute, fl.joints.Fixed])
def test_invariants_to_round_off(scheme, joint):
    scene = bars(joint=joint)[0]
    result = scheme.run(scene, duration=0.4, step=1e-2)
    assert result.energy_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12
    assert result.joint_violations.max() <= 1e-13
    assert result.elastic.max() > 1e-3 * result.kinetic[0]


@pytest.mark.parametrize("name", ["MITC4", "Hu-Washizu"])
def test_shells(name):
    scene, _ = plate(name)
    result = SCHEMES["five"].run(scene, duration=0.05, step=5e-3)
    assert result.energy_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12
    assert result.momentum_error <= 1e-12


def test_what_is_kept_in_between_changes_nothing():
    """The compiled loop over steps, and one step after the other."""
    scheme = SCHEMES["five"]
    whole = scheme.run(bars()[0], duration=0.2, step=1e-2)
    ends = scheme.run(bars()[0], duration=0.2, step=1e-2, save_every=20)
    for name in set(ARRAYS) - {"iterations"}:
        np.testing.assert_array_equal(getattr(ends, name)[-1], getattr(whole, name)[-1], name)


def test_a_policy_that_must_be_asked():
    """It is, for each size of parts; what it decides does not change the motion."""

    class Asked(fl.schemes.RefactorisationPolicy):
        def begin(self, bound):
            return fl.schemes.EveryIteration().begin(bound)

    own = fl.schemes.Composed(fl.EnergyMomentum(policy=Asked()))
    asked = own.run(bars()[0], duration=0.05, step=1e-2)
    ruled = SCHEMES["five"].run(bars()[0], duration=0.05, step=1e-2)
    np.testing.assert_allclose(asked.frames[-1], ruled.frames[-1], atol=1e-12)
    assert asked.factorisations > ruled.factorisations


# --- interruption ---


def resumed_as_whole(scheme, scene, plan, file):
    """A run that ends after its second checkpoint, at step 14, and goes on, against a whole one."""
    whole = scheme.run(scene(), **plan)
    with interrupted(2):
        scheme.run(scene(), **plan, file=file, checkpoint_every=7)
    same(scheme.resume(scene(), file), whole)
    same(fl.Result.load(file), whole)


RESUMED = SCHEMES | {"variational": fl.schemes.Composed(fl.schemes.Variational())}


@pytest.mark.parametrize("scheme", RESUMED.values(), ids=RESUMED)
@pytest.mark.parametrize("scene", [lambda: bars()[0], driven], ids=["free", "driven"])
def test_resumed_to_the_last_bit(tmp_path, scheme, scene):
    plan = {"duration": 0.12, "step": 4e-3}
    resumed_as_whole(scheme, scene, plan, tmp_path / "run.h5")


# --- bad input ---


@pytest.mark.parametrize("scheme", [fl.EnergyDecaying(), fl.GeneralisedAlpha(radius=0.8)])
def test_schemes_that_are_not_symmetric(scheme):
    with pytest.raises(ValueError, match=r"only a symmetric scheme .* got .*radius=0.8"):
        fl.schemes.Composed(scheme)


def test_other_kinds():
    with pytest.raises(TypeError, match="scheme"):
        fl.schemes.Composed("energy momentum")
    with pytest.raises(TypeError, match="composition"):
        fl.schemes.Composed(fl.EnergyMomentum(), "yoshida")


@dataclass(frozen=True)
class Parts(fl.schemes.Composition):
    """Any."""

    parts: tuple[float, ...] = ()


@pytest.mark.parametrize("parts", [(), (0.5, 0.5), (0.4, 0.6), (1.3, -1.7, 1.4), (1.0,)])
def test_parts_that_do_not_make_a_step_of_fourth_order(parts):
    with pytest.raises(ValueError, match="the same from either end, with the sum 1"):
        fl.schemes.Composed(composition=Parts(parts))


def test_parts_of_more_sizes_than_are_kept():
    """Yoshida's solution A of order six is of fourth order, too, and has four sizes."""
    w = -1.17767998417887, 0.235573213359357, 0.784513610477560
    middle = 1.0 - 2.0 * sum(w)
    parts = (w[2], w[1], w[0], middle, w[0], w[1], w[2])
    with pytest.raises(ValueError, match="must have 2 sizes at most"):
        fl.schemes.Composed(composition=Parts(parts))


def test_steps_that_change():
    with pytest.raises(ValueError, match=r"constant steps .* got AdaptiveStep"):
        SCHEMES["five"].run(bars()[0], duration=0.1, step=fl.schemes.AdaptiveStep(1e-4))


def test_jumps():
    scene, one, _ = bars()
    late = fl.loads.PiecewiseSmooth(lambda t: float(t > 0.05), (0.05,))
    scene.add(fl.PointLoad(one.point("end"), force=(0, 0, 1), history=late))
    with pytest.raises(ValueError, match=r"discontinuities at the times \[0.05\]"):
        SCHEMES["five"].run(scene, duration=0.1, step=1e-2)


def test_dissipation():
    scene, one, two = bars()
    ends = scene.add(fl.joints.Distance(one.point("start"), two.point("end")))
    scene.add(fl.joints.Spring(ends.length, stiffness=1.0, damping=0.1))
    with pytest.raises(ValueError, match="dampers in connections would add energy"):
        SCHEMES["five"].run(scene, duration=0.1, step=1e-2)


def test_strains_that_change():
    scene, one, _ = bars()
    scene.add(fl.loads.Temperature(one, 10.0, 1e-5, history=lambda t: t))
    with pytest.raises(ValueError, match="strains that change in time"):
        SCHEMES["five"].run(scene, duration=0.1, step=1e-2)


def test_a_step_that_fails():
    with pytest.raises(fl.ConvergenceError, match=r"sub-step 1 of step 1 of 10 .* 2 iterations"):
        fl.schemes.Composed(
            fl.EnergyMomentum(max_iterations=2, policy=fl.schemes.FactoriseOnce())
        ).run(bars()[0], duration=0.1, step=1e-2)
    with pytest.raises(fl.ConvergenceError, match=r"sub-step 1 of step 1 of 10 .* 1 iteration"):
        fl.schemes.Composed(
            fl.schemes.Variational(max_iterations=1, policy=fl.schemes.FactoriseOnce())
        ).run(bars()[0], duration=0.1, step=1e-2)

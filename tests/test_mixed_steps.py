"""Explicit steps of some bodies, implicit ones of others: a wave, order, energy, bad input."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.test_composed import resumed_as_whole
from tests.test_multi_rate import chain, pushed

EXPLICIT = fl.Explicit()
BAR = fl.Section.rectangle(0.02, 0.02, fl.Material(E=1e9, nu=0.0, density=1000.0))
FAST = 1000.0
"""Speed of longitudinal waves in it, m/s."""


def explicit(*bodies, steps=1, **options) -> fl.schemes.MultiRate:
    chosen = {"schemes": dict.fromkeys(bodies, EXPLICIT), **options}
    return fl.schemes.MultiRate(dict.fromkeys(bodies, steps), **chosen)


def wave(cells, periods=1.0, steps=20):
    """The first mode in a bar of 1 m that flies, the second half fine and explicit.

    Returns the result, and the error of positions over the amplitude.
    """
    scene, ω = fl.Scene(), np.pi * FAST
    halves = [
        scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), BAR, cells=k))
        for a, b, k in ((0.0, 0.5, cells), (0.5, 1.0, 4 * cells))
    ]
    for half in halves:
        half.velocities[:, 0] = np.cos(np.pi * half.frames[:, 0, 0])
    scene.add(fl.joints.Fixed(halves[0].point("end"), halves[1].point("start")))
    period = 2.0 / FAST
    scheme = explicit(halves[1], steps=steps)
    result = scheme.run(scene, duration=periods * period, step=period / (10 * cells))
    x0 = np.concatenate([half.frames[:, 0, 0] for half in halves])
    nodes = np.concatenate([result.info.body(half.label).nodes for half in halves])
    u = result.frames[:, nodes, 0, 0] - x0
    exact = np.sin(ω * result.times)[:, np.newaxis] * np.cos(np.pi * x0) / ω
    return result, np.abs(u - exact).max() * ω


def test_a_wave_passes_from_implicit_to_explicit_steps():
    """D'Alembert's solution, by second order; between the schemes no energy is made or lost."""
    errors = []
    for cells in (4, 8):
        result, error = wave(cells)
        errors.append(error)
        assert np.abs(result.balance[:, 0]).max() <= 1e-11 * result.kinetic[0]
        assert result.joint_violations.max() <= 1e-12
        assert result.momentum_error <= 1e-12
    assert errors[1] <= 0.01
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_energy_does_not_drift():
    """It oscillates at 0.8 of the largest stable step, in twenty periods as in the first five."""
    result, _ = wave(2, periods=20.0, steps=2)
    error = np.abs(result.total_energy / result.total_energy[0] - 1.0)
    first = error[: len(error) // 4].max()
    assert 0.0 < first <= 1e-2
    assert error.max() <= 1.1 * first


@pytest.mark.parametrize("scene_of", [chain, pushed], ids=["free", "pushed"])
def test_second_order_to_one_scheme_for_all(scene_of):
    """A rigid body has the same inertia in both, so that only steps differ."""
    fine = fl.EnergyMomentum().run(scene_of()[0], duration=4e-3, step=1e-5, save_every=400)
    errors = []
    for steps in (20, 40):
        scene, _ = scene_of()
        bob = scene.bodies[2]
        result = explicit(bob, steps=4).run(
            scene, duration=4e-3, step=4e-3 / steps, save_every=steps
        )
        names = "frames", "velocities"
        both = [(getattr(result, name)[-1], getattr(fine, name)[-1]) for name in names]
        errors.append([np.abs(a - b).max() for a, b in both])
        assert result.balance_error <= 1e-6
        assert result.momentum_error <= 1e-12
    np.testing.assert_allclose(np.log2(np.divide(*errors)), 2.0, atol=0.1)
    forces = result.joint_forces[-1], fine.joint_forces[-1]
    np.testing.assert_allclose(*forces, atol=2e-4 * np.abs(forces[1]).max())


def test_second_order_with_a_joint_among_explicit_bodies():
    """A beam, and a body fixed to it, under loads that change."""
    ends = []
    for steps in (8, 16, 32):
        scene, two = pushed()
        given = {"duration": 4e-3, "step": 4e-3 / steps, "save_every": steps}
        result = explicit(two, scene.bodies[2], steps=2).run(scene, **given)
        ends.append(result.frames[-1])
        assert result.joint_violations.max() <= 1e-11
    far, near = (np.abs(a - b).max() for a, b in pairwise(ends))
    assert np.log2(far / near) == pytest.approx(2.0, abs=0.1)


def test_steps_that_fail_are_divided(caplog):
    scene, two = chain()
    given = {"duration": 4e-3, "step": 2e-3}
    strict = explicit(two, steps=10, scheme=fl.EnergyMomentum(max_iterations=5))
    parts = strict.run(scene, **given)
    assert parts.divided > 0
    assert "were divided into up to" in caplog.text
    assert parts.energy_error <= 1e-7


@pytest.mark.parametrize("scene_of", [chain, pushed], ids=["free", "pushed"])
def test_resumed_to_the_last_bit(tmp_path, scene_of):
    scene, two = scene_of()
    scheme = explicit(two, scene.bodies[2], steps=2)
    resumed_as_whole(scheme, lambda: scene, {"duration": 8e-3, "step": 5e-4}, tmp_path / "run.h5")


def test_bad_input():
    scene, two = chain()
    one, _, bob = scene.bodies
    span = {"duration": 1e-3, "step": 1e-3}
    message = r"expected a stable step, at most .*, got 0\.01: \d+ steps in a whole one"
    with pytest.raises(ValueError, match=message):
        explicit(two, steps=1).run(scene, duration=0.01, step=0.01)
    with pytest.raises(ValueError, match="or, among schemes, Explicit"):
        fl.schemes.MultiRate({}, schemes={two: fl.GeneralisedAlpha()})
    stranger = fl.RigidBody(1.0, (1, 1, 1), name="stranger")
    with pytest.raises(ValueError, match="stranger has steps of its own and is not in the scene"):
        explicit(stranger).run(scene, **span)
    ball = fl.contact.Sphere(bob.point("centre"), 0.05)
    touching = fl.contact.Sphere(one.point("start"), 0.05)
    floor = fl.contact.Plane(fl.ground(), at=(0, 0, -1), normal=(0, 0, 1))
    scene.add(fl.contact.Contact(ball, floor, fl.contact.Penalty(1e3, friction=0.1)))
    with pytest.raises(ValueError, match="MultiRate does not support friction of contacts in expl"):
        explicit(bob).run(scene, **span)
    scene.add(fl.contact.Contact(ball, floor, fl.contact.Impact()))
    with pytest.raises(ValueError, match="Impact is for GeneralisedAlpha"):
        explicit(bob).run(scene, **span)
    scene.add(fl.contact.Contact(ball, touching, fl.contact.Penalty(1e3)))
    with pytest.raises(ValueError, match="got Contact between"):
        explicit(bob).run(scene, **span)

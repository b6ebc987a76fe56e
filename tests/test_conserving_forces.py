"""Conserving schemes: forces of joints, drives and springs at the ends of steps."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.conserving_joints import JOINTS, two_bodies
from tests.test_energy_momentum import bars

END = 0.16


def with_spring(kind: str) -> tuple[fl.Scene, fl.Connection]:
    scene, joint = two_bodies(kind)
    return scene, scene.add(
        fl.joints.Spring(joint.coordinates()[0], stiffness=20.0, damping=0.5, rest=0.1)
    )


def with_drive() -> tuple[fl.Scene, fl.Connection]:
    scene, joint = two_bodies("revolute")
    return scene, scene.add(fl.joints.Drive(joint.angle, lambda t: 8.0 * t**3))


def held_apart() -> tuple[fl.Scene, fl.Connection]:
    scene, joint = two_bodies("distance")
    return scene, scene.add(fl.joints.Drive(joint.length))


KINDS = [kind for kind in JOINTS if kind != "distance"]  # which only measures
CASES = {kind: lambda kind=kind: two_bodies(kind) for kind in KINDS} | {
    "rod": held_apart,
    "spring along an angle": lambda: with_spring("revolute"),
    "spring along a length": lambda: with_spring("distance"),
    "drive": with_drive,
}


def forces(make, scheme, step: float) -> np.ndarray:
    """At eight times."""
    scene, joint = make()
    steps = round(END / step)
    result = scheme.run(scene, duration=END, step=step, save_every=steps // 8)
    return result.joint_force(joint)[1:]


def order(coarse: np.ndarray, middle: np.ndarray, fine: np.ndarray) -> float:
    return float(np.log2(np.abs(coarse - middle).max() / np.abs(middle - fine).max()))


@pytest.mark.parametrize("make", CASES.values(), ids=CASES)
@pytest.mark.parametrize(
    "scheme", [fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.8)], ids=["conserving", "decaying"]
)
def test_forces_of_joints_are_of_second_order(make, scheme):
    """At the ends of steps, from the very first on, and the same as by generalised-α.

    What alternates since the start of a decaying run falls from step to step, and is not met
    exactly by weights for what stays; of a rod's force, which errs by 2e-6 with the coarsest step,
    that shows.
    """
    found = [forces(make, scheme, step) for step in (4e-3, 2e-3, 1e-3)]
    rod = make is held_apart and isinstance(scheme, fl.EnergyDecaying)
    assert order(*found) > (1.5 if rod else 1.85)
    other = [forces(make, fl.GeneralisedAlpha(), step) for step in (2e-3, 1e-3)]
    limits = [(4 * fine - coarse) / 3 for coarse, fine in (found[1:], other)]
    np.testing.assert_allclose(*limits, atol=1e-3 * np.abs(limits[1]).max())


def test_forces_of_joints_between_beams_are_of_second_order():
    """Two soft bars that swing: what is resolved of their waves is."""

    def run(step: float) -> np.ndarray:
        scene, one, two = bars(gravity=(0, 0, -9.81), joint=fl.joints.Revolute, cells=2)
        for bar in (one, two):
            bar.velocities[:] = 0.0
        steps = round(END / step)
        result = fl.EnergyMomentum().run(scene, duration=END, step=step, save_every=steps // 8)
        return result.joint_force(scene.joints[1])[1:]

    assert order(*(run(step) for step in (5e-4, 2.5e-4, 1.25e-4))) > 1.8

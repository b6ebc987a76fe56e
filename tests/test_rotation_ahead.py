"""How far prescribed frames and driven angles rotate ahead, by functions of any sort."""

from collections.abc import Callable
from math import ceil

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

TURN = 2.0 * np.pi
FRAME_STEP, ANGLE_STEP = np.pi / 4, np.pi / 2
"""Largest rotations of a frame and of an angle in a step."""


def ahead(
    frame: Callable[[float], float] | None, driven: Callable[[float], float] | None, time: float
):
    """Of a frame that rotates about an oblique axis, and of a driven angle, from a time on."""
    scene, axis = fl.Scene(), np.array([0.6, 0.0, 0.8])
    body, wheel = (scene.add(fl.RigidBody(1.0, (1, 1, 1), (x, 0, 0))) for x in (0, 1))
    if frame is not None:
        moved = lambda t: np.vstack([np.zeros((1, 3)), lie.so3_exp(frame(t) * axis).T])  # noqa: E731
        scene.add(fl.PrescribedMotion(body.point("centre"), moved))
    if driven is not None:
        hinge = scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0, 1)))
        scene.add(fl.joints.Drive(hinge.angle, driven))
    return fl.extend.Equations(scene, dynamics=True).prescribed(time)


@pytest.mark.parametrize("turns", [0.1, 0.3, 1, 16, 13 * 16, 21 * 16, 89 * 16])
def test_turns_are_counted_that_samples_of_two_kinds_hide(turns):
    """Of 13 turns in a piece both parts, of which one is 0.382 of it, seem to rotate by 12°."""
    size = turns * TURN
    found = ahead(lambda t: size * t, None, 0.0).limited(1.0)
    assert found == pytest.approx(1.0 / ceil(size / FRAME_STEP - 1e-9), rel=1e-6)


@pytest.mark.parametrize("size", [1.0, 10.0, 1e4])
def test_angles_are_not_counted_in_turns(size):
    found = ahead(None, lambda t: size * t, 0.0).limited(2.0)
    assert found == pytest.approx(2.0 / ceil(2.0 * size / ANGLE_STEP - 1e-9), rel=1e-9)


def test_what_rotates_most_decides_and_back_counts_as_forward():
    one = ahead(lambda t: 3.0 * np.sin(np.pi * t), lambda t: 2.0 * t, 0.0)
    assert one.limited(1.0) == pytest.approx(np.arcsin(6.0 / 8.0 / 3.0) / np.pi, rel=1e-2)


def test_a_jump_is_one_step_and_not_endlessly_many():
    """No step is short enough; the one that is asked for is as good as any."""
    assert ahead(None, lambda t: 1e12 * (t > 0.0), 0.0).limited(1.0) == 1.0


def test_what_does_not_rotate_has_no_limit():
    assert ahead(None, None, 0.3).limited(7.0) == 7.0
    assert ahead(lambda t: 0.0, lambda t: 0.0, 0.3).limited(7.0) == 7.0

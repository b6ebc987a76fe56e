"""How far prescribed frames and driven angles rotate ahead, by functions of any sort."""

from collections.abc import Callable
from math import ceil
from types import SimpleNamespace

import numpy as np
import pytest

from fem_lie import lie
from fem_lie.system.equations.prescribed import ANGLE_STEP, FRAME_STEP, RotationAhead

TURN = 2.0 * np.pi


def ahead(frame: Callable[[float], float] | None, driven: Callable[[float], float] | None):
    """Of a frame that rotates about an oblique axis, and of an angle."""
    axis = np.array([0.6, 0.0, 0.8])

    def frames(t: float) -> np.ndarray:
        if frame is None:
            return np.empty((0, 4, 3))
        return np.vstack([np.zeros((1, 3)), lie.so3_exp(frame(t) * axis).T])[np.newaxis]

    count = int(driven is not None)
    connections = SimpleNamespace(
        targets=lambda t: np.full(count, driven(t) if driven else 0.0),
        angular=np.ones(count, dtype=bool),
        driven=driven is not None,
    )
    motions = [] if frame is None else [frame]
    scene = SimpleNamespace(motions=motions)
    return RotationAhead(
        SimpleNamespace(connections=connections, prescribed_frames=frames, scene=scene)
    )


@pytest.mark.parametrize("turns", [0.1, 0.3, 1, 16, 13 * 16, 21 * 16, 89 * 16])
def test_turns_are_counted_that_samples_of_two_kinds_hide(turns):
    """Of 13 turns in a piece both parts, of which one is 0.382 of it, seem to rotate by 12°."""
    size = turns * TURN
    found = ahead(lambda t: size * t, None).limited(0.0, 1.0)
    assert found == pytest.approx(1.0 / ceil(size / FRAME_STEP - 1e-9), rel=1e-6)


@pytest.mark.parametrize("size", [1.0, 10.0, 1e4])
def test_angles_are_not_counted_in_turns(size):
    found = ahead(None, lambda t: size * t).limited(0.0, 2.0)
    assert found == pytest.approx(2.0 / ceil(2.0 * size / ANGLE_STEP - 1e-9), rel=1e-9)


def test_what_rotates_most_decides_and_back_counts_as_forward():
    one = ahead(lambda t: 3.0 * np.sin(np.pi * t), lambda t: 2.0 * t)
    assert one.limited(0.0, 1.0) == pytest.approx(np.arcsin(6.0 / 8.0 / 3.0) / np.pi, rel=1e-2)


def test_a_jump_is_one_step_and_not_endlessly_many():
    """No step is short enough; the one that is asked for is as good as any."""
    assert ahead(None, lambda t: 1e12 * (t > 0.0)).limited(0.0, 1.0) == 1.0


def test_what_does_not_rotate_has_no_limit():
    assert ahead(None, None).limited(0.3, 7.0) == 7.0
    assert ahead(lambda t: 0.0, lambda t: 0.0).limited(0.3, 7.0) == 7.0

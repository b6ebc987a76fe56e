"""Errors in time from runs with halved steps, of schemes that do not estimate them."""

import numpy as np
import pytest

import fem_lie as fl
from tests.test_composed import rigid_pendulum
from tests.test_explicit import SCHEME as EXPLICIT
from tests.test_explicit import net

SCHEMES = {
    "variational": (fl.schemes.Variational(), 2),
    "explicit": (fl.Explicit(), 2),
    "energy-momentum": (fl.EnergyMomentum(), 2),
    "composed": (fl.schemes.Composed(), 4),
}


@pytest.mark.parametrize("name", SCHEMES)
def test_error_of_a_pendulum(name):
    """Against composed steps that are much smaller."""
    scheme, order = SCHEMES[name]
    found = fl.schemes.estimate_time_error(scheme, rigid_pendulum(), duration=0.2, step=5e-3)
    assert found.order == pytest.approx(order, abs=0.2)
    exact = fl.schemes.Composed().run(rigid_pendulum(), duration=0.2, step=1e-3, save_every=5)
    gaps = np.linalg.norm(found.result.frames - exact.frames, axis=-1)[..., 0].max(axis=1)
    np.testing.assert_allclose(found.times, exact.times)
    assert found.translation[0] == 0.0
    assert found.translation[-1] == pytest.approx(gaps[-1], rel=0.1)


def test_error_of_a_net():
    """Of nodes that are positions."""
    scene = net()[0]
    step = 0.2 * EXPLICIT.stable_step(scene)
    found = fl.schemes.estimate_time_error(EXPLICIT, scene, duration=20 * step, step=step)
    fine = EXPLICIT.run(net()[0], duration=20 * step, step=step / 32, save_every=10**6)
    gap = np.abs(found.result.frames[-1, :, 0] - fine.frames[-1, :, 0]).max()
    assert found.translation[-1] == pytest.approx(gap, rel=0.3)
    assert np.isfinite(found.rotation).all()


def test_rest_has_no_error():
    scene = fl.Scene()
    scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    found = fl.schemes.estimate_time_error(EXPLICIT, scene, duration=0.1, step=0.05)
    assert found.order == np.inf
    assert not found.translation.any()


def test_steps_that_are_no_number():
    with pytest.raises(TypeError, match="step"):
        fl.schemes.estimate_time_error(
            fl.schemes.Variational(), rigid_pendulum(), duration=0.1, step=None
        )

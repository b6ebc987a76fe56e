"""Steps of each cell by itself: those of explicit steps if equal, work, invariants, bad input."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import asynchronous
from tests.test_composed import flying, resumed_as_whole
from tests.test_explicit import CABLE, net

SCHEME = fl.schemes.Asynchronous()


def test_equal_steps_are_explicit_ones():
    step = 0.4 * fl.Explicit().stable_step(net()[0])
    plan = {"duration": 200 * step, "step": step, "save_every": 20}
    here = fl.schemes.Asynchronous(1.0).run(net()[0], **plan)
    there = fl.Explicit().run(net()[0], **plan)
    np.testing.assert_allclose(here.frames, there.frames, atol=1e-12)
    np.testing.assert_allclose(here.velocities, there.velocities, atol=1e-10)


def test_dead_loads_are_followed_exactly():
    """A stone that is thrown, of steps as large as the way."""
    scene = fl.Scene(gravity=(0, 0, -10.0))
    body = scene.add(fl.Net([(0, 0, 0), (1, 0, 0)], [[0, 1]], CABLE))
    body.velocities[:, 0] = 3.0
    result = SCHEME.run(scene, duration=1.0, step=0.5)
    fallen = result.frames[-1, :, 0] - result.frames[0, :, 0]
    np.testing.assert_allclose(fallen, np.broadcast_to([3.0, 0.0, -5.0], (2, 3)), atol=1e-12)


def test_momenta_are_exact():
    result = SCHEME.run(net(pinned=False)[0], duration=0.2, step=1e-2)
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def test_order():
    """One at least."""
    exact = fl.schemes.Asynchronous(0.02).run(asynchronous.net(4, 1, 0.1), duration=0.01, step=2e-3)
    errors = []
    for courant in (0.4, 0.2, 0.1):
        run = fl.schemes.Asynchronous(courant).run(
            asynchronous.net(4, 1, 0.1), duration=0.01, step=2e-3
        )
        errors.append(np.abs(run.frames[-1] - exact.frames[-1]).max())
    assert all(near <= 0.6 * far for far, near in pairwise(errors)), errors


def test_work_around_a_short_element():
    """At least 20 times less than explicit steps, all as small as the short ones want."""
    record = asynchronous.against_explicit(16, 2, 4e-3)
    assert record["asynchronous: less work than explicit"] >= 60.0
    assert record["quarter: less work than explicit"] >= 20.0
    assert record["quarter: error"] <= 5e-3


def test_energy_stays():
    record = asynchronous.long_run(4, 2, 100_000)
    assert record["steps of cells"] >= 90_000
    assert record["energy, largest change"] <= 1e-2
    assert record["energy, last third"] <= 2.0 * record["energy, first third"]


def test_resumed_to_the_last_bit(tmp_path):
    plan = {"duration": 0.03, "step": 1e-3, "save_every": 3}
    resumed_as_whole(SCHEME, lambda: net()[0], plan, tmp_path / "run.h5")


# --- bad input ---


@pytest.mark.parametrize("courant", [0.0, 1.5, -1.0])
def test_courant(courant):
    with pytest.raises(ValueError, match=r"expected 0 < courant ≤ 1"):
        fl.schemes.Asynchronous(courant)


def test_other_nodes():
    with pytest.raises(ValueError, match=r"nodes with other unknowns than positions: use Explicit"):
        SCHEME.run(flying(), duration=0.1, step=1e-2)


def test_steps_that_change():
    with pytest.raises(ValueError, match=r"largest one as a number .* got AdaptiveStep"):
        SCHEME.run(net()[0], duration=0.1, step=fl.schemes.AdaptiveStep(1e-4))

"""The hoop truss antenna: its cables balance, it has one motion, and all bays move alike."""

import importlib

import numpy as np
import pytest

import fem_lie as fl

demo = importlib.import_module("demos.hoop_antenna")
nets = importlib.import_module("demos.antenna_cables")
layout = importlib.import_module("demos.antenna_scene")


@pytest.mark.parametrize("bays", [12, 30])
def test_cables_are_in_equilibrium_at_each_knot_but_those_of_the_rims(bays):
    laid = nets.cables(bays, 12.0)
    ways = np.diff(laid.knots[laid.ends], axis=1)[:, 0]
    pulls = laid.forces[:, np.newaxis] * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    sums = np.zeros_like(laid.knots)
    np.add.at(sums, laid.ends[:, 0], pulls)
    np.add.at(sums, laid.ends[:, 1], -pulls)
    assert len(laid.ends) == 21 * bays
    assert laid.forces.min() > 0.0
    assert np.abs(sums[2 * bays :]).max() < 1e-12 * laid.forces.max()
    # all of the rims pulls inwards, and towards the other net
    assert (np.einsum("kj,kj->k", sums[: 2 * bays], laid.knots[: 2 * bays]) < 0).all()


@pytest.mark.filterwarnings("ignore:the equilibrium is unstable")  # zero is round-off
def test_without_drives_one_motion_is_free_and_with_them_none():
    """LowRankCorrection the six of a rigid body; the next vibration is far away."""
    antenna = layout.Antenna(6, 1, 4.0, elements=1, cells=0, slack=1e-3)
    held = fl.vibrations(antenna.scene, count=8).frequencies
    antenna.scene.connections.remove(antenna.drives[0])
    free = fl.vibrations(antenna.scene, count=8).frequencies
    assert np.sum(held < 1e-3 * held[-1]) == 6
    assert np.sum(free < 1e-3 * free[-1]) == 7


def fold(**parameters):
    return demo.main(duration=4.0, pictures=False, **parameters)


def test_a_ring_without_nets_folds_in_all_bays_alike():
    record = fold(bays=6, driven=6, elements=2, cells=0, step=2e-2)
    assert record["k_updates"] <= 2
    assert record["width"] == pytest.approx(2.0 * np.cos(layout.FOLDED), rel=1e-3)
    assert record["asymmetry"] < 1e-3
    assert record["violation"] < 1e-8
    assert record["momentum_error"] < 1e-6
    assert record["energy_error"] < 1e-3


def test_gears_carry_one_drive_around_the_ring():
    record = fold(bays=6, driven=1, elements=2, cells=0, step=2e-2)
    assert record["width"] == pytest.approx(2.0 * np.cos(layout.FOLDED), rel=0.05)
    assert record["off_posture"] < 0.02


def test_a_ring_with_nets_begins_to_fold():
    record = fold(bays=12, driven=12, elements=1, cells=3, step=2e-2, steps=80)
    assert record["unknowns"] == 60 * 12 + 3 * (8 * 12 + 21 * 12 * 2)
    assert record["asymmetry"] < 1e-3
    assert record["violation"] < 1e-8
    assert record["momentum_error"] < 1e-6
    assert record["energy_error"] < 1e-2


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"bays": 7, "driven": 7}, "even bays"),
        ({"bays": 12, "driven": 5}, "a divisor driven"),
        ({"bays": 8, "driven": 8}, "would be slack"),
        ({"bays": 12, "driven": 12, "slack": 0.1}, "would be slack"),
        ({"policy": "never"}, "auto, secants, nni4, full"),
    ],
)
def test_bad_options_are_refused(parameters, message):
    with pytest.raises(ValueError, match=message):
        fold(**parameters)

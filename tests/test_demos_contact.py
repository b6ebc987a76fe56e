"""Demos of contact against their references, by their records of numbers."""

import importlib

import numpy as np
import pytest

import fem_lie as fl

DEMO = importlib.import_module("demos.rod_in_box")


@pytest.mark.parametrize(
    ("ends", "friction"),
    [
        ("square", 0.0),
        ("square", 0.2),
        ("square", 0.6),
        ("spheres", 0.2),
        ("spheres", 0.6),  # which are wedged in one step
    ],
)
def test_rod_in_box(ends, friction):
    """Where the references are, without a step cut, energy gained or overlap."""
    record = DEMO.main(friction, ends, pictures=False)
    assert record["rod_end_z"] == pytest.approx(DEMO.REFERENCES[ends][friction], abs=2e-4)
    assert record["momentum_error"] < (1e-9 if (ends, friction) == ("spheres", 0.6) else 1e-13)
    assert record["energy_gain"] < 1e-7
    assert record["penetration"] < 1e-12
    assert record["cone_residual"] < 1e-6
    assert record["steps_cut"] == 0


def test_rod_in_box_by_penalty():
    """Without friction it is the same motion, up to 3e-5 m."""
    record = DEMO.main(0.0, law="penalty", step=1e-4, pictures=False)
    assert record["rod_end_z"] == pytest.approx(-0.77548, abs=3e-5)
    # Newton's method leaves a part of forces of 1e9 N/m in each step
    assert record["momentum_error"] < 1e-8
    assert record["steps_cut"] == 0


def test_twisted_beams():
    """A double helix in line contact against its closed form."""
    demo = importlib.import_module("demos.twisted_beams")
    coarse, record = demo.main(8), demo.main(16)
    assert record["error"] < 5e-5
    assert record["error"] < coarse["error"] / 12
    assert record["most_iterations"] <= 7
    assert record["gap"] == pytest.approx(-1e-3, rel=1e-3)
    assert record["iterations"] <= 5 * record["load_steps"]


def test_crossing_beams():
    """Where a point contact of the same penalty has them, and nearly the same with finer ones."""
    demo = importlib.import_module("demos.crossing_beams")
    with pytest.warns(fl.schemes.CoarseElementsWarning, match=r"stretched by 10%|leans by 0\.3"):
        record, finer = demo.main(pictures=False), demo.main(mesh=2, pictures=False)
    assert record["away"] < 0.02
    np.testing.assert_allclose(finer["moved"], record["moved"], atol=2e-3)


def test_rod_in_box_has_no_other_ends():
    with pytest.raises(ValueError, match="--ends must be one of square, spheres, got 'round'"):
        DEMO.main(ends="round", pictures=False)


def test_rod_in_box_has_no_restitution_of_penalties():
    with pytest.raises(ValueError, match="damping, not restitution"):
        DEMO.main(0.2, law="penalty", restitution=0.5, pictures=False)


@pytest.mark.parametrize("friction", [0.2, 0.4, 0.6])
def test_penalty_and_cones_agree_until_a_corner_hits_while_others_slide(friction):
    """After the first impact, in which both corners of an edge slip from rest."""
    ends = [
        DEMO.main(friction, law=law, step=1e-4, duration=0.15, pictures=False)
        for law in ("impact", "penalty")
    ]
    assert ends[1]["rod_end_z"] == pytest.approx(ends[0]["rod_end_z"], abs=1e-4)
    assert ends[1]["iterations_per_step"] < 2


def test_capstan():
    """Forces at both ends of a rope around a drum differ by exp(mu phi)."""
    record = importlib.import_module("demos.capstan").main()
    assert record["error"] < 0.005
    assert record["iterations"] <= 8 * record["load_steps"]


@pytest.mark.slow
def test_folding_sheet():
    """A tube that lies on itself: as wide as its closed equations say, without overlap."""
    record = importlib.import_module("demos.folding_sheet").main(mesh=16, pictures=False)
    later = np.array(record["pressures"]) >= 8.0
    wanted = np.array(record["wanted_widths"])[later]
    np.testing.assert_allclose(np.array(record["widths"])[later], wanted, rtol=0.011)
    wanted = np.array(record["wanted_forces"])[later]
    np.testing.assert_allclose(np.array(record["forces"])[later], wanted, rtol=0.07)
    assert record["overlap"] < 1e-2


def test_net_capture():
    """Momenta stay, and energy and the work of the winch balance, while threads touch."""
    demo = importlib.import_module("demos.net_capture")
    found = demo.main(1, 4, step=5e-4, time=0.2, pull_from=0.06, pictures=False)
    assert min(found["touching_ball"], found["touching_threads"]) > 0
    assert found["work_over_energy"] > 0.1
    assert found["balance_error"] < 1e-10
    assert found["momentum_error"] < 1e-11
    assert found["angular_momentum_error"] < 1e-11
    assert found["passages"] == 0


def test_threads_that_go_through_each_other_are_counted():
    """Two threads without contact, and twice the same ones with it."""
    passages = importlib.import_module("demos.net_passages").passages
    scene = importlib.import_module("demos.net_scene")
    ends = np.array([[-0.5, 0.02, 0.0], [0.5, -0.02, 0.0]])
    path = ends[0] + np.linspace(0.0, 1.0, 9)[:, np.newaxis] * (ends[1] - ends[0])
    above = path[:, [1, 0, 2]] + [0.03, 0.0, 2e-2]
    threads = [fl.Net(each, [range(9)], scene.CABLE) for each in (path, above)]
    threads[1].add_velocity((0.0, 0.0, -2.0))
    bare = fl.Scene()
    for thread in threads:
        bare.add(thread)
    given = {"duration": 0.03, "step": 5e-4, "progress": False}
    assert passages(fl.EnergyMomentum().run(bare, **given), threads) == 1
    lines = [fl.contact.Line(thread, 4e-3) for thread in threads]
    bare.add(fl.contact.Contact(*lines, fl.contact.Penalty(6e5)))
    assert passages(fl.EnergyMomentum().run(bare, **given), threads) == 0


@pytest.mark.slow
def test_a_net_is_closed_by_its_winch():
    """Its edge is within the outline of the ball and around its lowest point in the end."""
    found = importlib.import_module("demos.net_capture").main(pictures=False)
    assert found["mouth"] < 1.0
    assert found["height"] < 0.1
    assert found["balance_error"] < 1e-10
    assert max(found["momentum_error"], found["angular_momentum_error"]) < 1e-11
    assert found["passages"] == 0


def test_dominoes():
    """The row as a mechanism of one degree of freedom between collisions."""
    found = importlib.import_module("demos.dominoes").main(count=6, step=5e-4, pictures=False)
    assert found["largest_time_error"] < 2e-3
    assert abs(found["front_speed"] / found["reference_speed"] - 1) < 5e-3
    assert found["penetration"] < 1e-12

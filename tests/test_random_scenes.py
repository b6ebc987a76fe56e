"""Laws that hold for random small scenes of all kinds of bodies, joints and loads."""

import numpy as np
import pytest

from benchmarks.random_laws import broken
from benchmarks.random_scenes import NEAR, STUDIES, TARGET, allowed, differences
from fem_lie import lie
from tests.random_scenes import (
    CONSERVING,
    HELD,
    MIXED,
    MIXED_CONSERVING,
    MOTION,
    PROPORTIONAL,
    random_scene,
)
from tests.scene_builder import build
from tests.scene_data import arguments, converted, placed, reordered, replaced
from tests.unit_systems import OTHER_SYSTEMS


def _numbers(data):
    return [value for _, value in arguments(data) if isinstance(value, float | np.ndarray)]


@pytest.mark.parametrize(
    "wanted", [MOTION, CONSERVING, HELD, PROPORTIONAL, MIXED, MIXED_CONSERVING]
)
def test_random_scenes_can_be_built(wanted):
    for seed in range(6):
        data = random_scene(seed, wanted)
        scene = build(data, static=not wanted.loose).scene
        assert len(scene.bodies) == len(data.bodies)


def test_units_and_positions_lead_there_and_back():
    data, rng = random_scene(3), np.random.default_rng(0)
    Q, shift = lie.so3_exp(rng.normal(size=3)), rng.normal(size=3)
    for there, back in [
        *((converted(data, u), lambda d, u=u: converted(d, u.inverse)) for u in OTHER_SYSTEMS),
        (placed(data, Q, shift), lambda d: placed(d, Q.T, -Q.T @ shift)),
    ]:
        assert any(
            not np.allclose(a, b) for a, b in zip(_numbers(there), _numbers(data), strict=True)
        )
        for a, b in zip(_numbers(back(there)), _numbers(data), strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-14)


def test_what_is_replaced_is_nothing_else():
    data = random_scene(5)
    paths = [path for path, _ in arguments(data)]
    changed = replaced(data, paths[7], "other")
    differ = [
        path
        for (path, old), (_, new) in zip(arguments(data), arguments(changed), strict=True)
        if old is not new
    ]
    assert differ == [paths[7]]
    assert len(reordered(data, np.random.default_rng(1)).bodies) == len(data.bodies)


@pytest.mark.parametrize("seed", [8, 10])
@pytest.mark.parametrize("study", [name for name in STUDIES if "mixed" not in name])
def test_nothing_depends_on_units_position_direction_and_order(study, seed):
    first, found = differences(STUDIES[study], seed)
    assert not first.failure
    assert {way: e for way, e in found.items() if not e[0] <= allowed(way)} == {}


@pytest.mark.parametrize(
    ("study", "seed"),
    [
        *(("mixed, generalised-α", seed) for seed in (1, 2, 5, 9, 15, 26)),
        ("mixed, energy-momentum", 75),
    ],
)
def test_nothing_depends_on_units_direction_and_order_of_bodies_of_any_kind(study, seed):
    """Rods, cables, solids, thin and ANCF shells, reduced bodies: distance is in the docs."""
    first, found = differences(STUDIES[study], seed, NEAR)
    assert not first.failure
    assert {way: error for way, error in found.items() if not error[0] <= TARGET} == {}


def test_steps_end_at_the_round_off_of_positions_far_away():
    """Increments had to fall below it, by 235 iterations, and steps were divided."""
    first, found = differences(STUDIES["mixed, energy-decaying"], 114, ["moved by 1e3"])
    assert not first.failure
    assert found["moved by 1e3"][0] <= allowed("moved by 1e3")


@pytest.mark.parametrize(
    ("scheme", "seed"),
    [("generalised-α", 2), ("generalised-α", 4)],
)
def test_steps_converge_energy_is_balanced_and_runs_resume(scheme, seed):
    assert broken(scheme, seed) == {}


@pytest.mark.parametrize("seed", [9, 74, 99, 117])
def test_a_turned_scene_iterates_alike(seed):
    """Where components along some axes decided when to stop, forces of joints differed by 1e-7."""
    first, found = differences(STUDIES["generalised-α"], seed, ["turned"])
    assert not first.failure
    assert found["turned"][0] <= 1e-9

"""Statics arrives whatever the levels that are wanted, and says which way it took."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.levels import PROBLEMS, levels, study
from demos.deep_arch import arch

TIP = (4.77099938e-03, 7.15261314e-05, -7.65121277e-02)  # of the helix, by ten load steps


@pytest.mark.parametrize("wanted", [(0.25, 1.0), (0.1, 1.0), (1.0,)], ids=str)
def test_helix_of_ten_turns_arrives_from_any_level(wanted):
    """Its end goes round in circles: displacements do not tell which way is forward."""
    result = fl.statics(PROBLEMS["helix of ten turns"](), levels=wanted)
    np.testing.assert_array_equal(result.factors[-1], 1.0)
    (end,) = (body.points["end"] for body in result.info.bodies)
    np.testing.assert_allclose(result.frames[-1, end, 0], TIP, atol=1e-8)


@pytest.mark.parametrize("number", [0, 4, 9])
def test_arc_length_keeps_its_direction_through_two_limit_points(number):
    """Where a step has its length there are two states; the one behind leads back."""
    scene, _ = arch(40, "stretchable")
    with pytest.warns(fl.stability.UnstableEquilibriumWarning, match="had a maximum"):
        result = fl.follow_loads(scene, levels(number))
    with pytest.warns(fl.stability.UnstableEquilibriumWarning, match="had a maximum"):
        one = fl.follow_loads(scene)
    np.testing.assert_allclose(result.frames[-1, :, 0], one.frames[-1, :, 0], atol=1e-3)


def test_sets_of_levels_arrive_at_the_same_state():
    tally = study(PROBLEMS["three turns by a moment"], 8)
    assert (tally.arrived, tally.same, tally.failed) == (8, 8, [])


def test_each_way_of_loading_is_the_others_fallback():
    """Two load steps are too few for ten turns; the arc length is not."""
    result = fl.statics(
        PROBLEMS["helix of ten turns"](),
        load_steps=2,
        newton=fl.schemes.Newton(smallest_step=0.5, max_iterations=10),
    )
    assert result.load_steps > len(result.factors) == 1  # the steps of the arc length
    assert result.factors[-1] == 1.0 and result.failed_iterations >= 10

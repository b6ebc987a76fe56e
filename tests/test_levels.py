"""Statics arrives whatever the levels that are wanted, and says which way it took."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.levels import PROBLEMS, levels, study
from demos.deep_arch import arch
from fem_lie.solve.statics.arc_length import Passed
from fem_lie.solve.statics.load_steps import SingularStartError, move
from fem_lie.solve.statics.statics import _first_that_arrives
from tests.test_statics import cantilever, stiffness

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


def along(s: float) -> np.ndarray:
    """A path of two nodes that bends."""
    return np.array([[np.sin(s), 1 - np.cos(s), 0.0], [0.0, s, 0.2 * s * s]])


def walk(places: list[np.ndarray], factors: list[float], turned: int = 99) -> list[bool]:
    """``turned``: from this step on the twists are against the displacements."""
    passed = Passed(places[0])
    steps = enumerate(zip(factors[1:], places[1:], places[:-1], strict=True))
    return [
        passed.again(factor, here, (here - before) * (1 if k < turned else -1))
        for k, (factor, here, before) in steps
    ]


def test_running_back_is_noticed_and_a_limit_point_is_not():
    up = np.linspace(0.0, 1.0, 11)
    back = np.linspace(0.97, 0.17, 9)
    states = [along(s) for s in (*up, *back)]
    assert any(walk(states, [*up, *back]))
    # a loop that passes the same places in the same sense goes on
    assert not any(walk(states, [*up, *back], turned=10))
    # the load goes down while the nodes go on
    beyond = [along(s) for s in (*up, *(2.0 - back))]
    assert not any(walk(beyond, [*up, *back]))
    # and where most nodes go back on another way
    aside = [along(s) + np.array([[0, 0, 0.3 * (1 - s)], [0, 0, 0]]) for s in back]
    assert not any(walk([*states[:11], *aside], [*up, *back]))


def test_each_way_of_loading_is_the_others_fallback():
    """Two load steps are too few for ten turns; the arc length is not."""
    result = fl.statics(
        PROBLEMS["helix of ten turns"](),
        load_steps=2,
        newton=fl.schemes.Newton(smallest_step=0.5, max_iterations=10),
    )
    assert result.load_steps > len(result.factors) == 1  # the steps of the arc length
    assert result.factors[-1] == 1.0 and result.failed_iterations >= 10


def test_ways_are_tried_in_turn_and_their_solutions_counted():
    scene = PROBLEMS["three turns by a moment"]()
    good = fl.statics(scene)

    def fails(kind=fl.ConvergenceError):
        raise kind("no equilibrium here", good)

    found = _first_that_arrives([fails, fails, lambda: good])
    assert found.failed_iterations == good.failed_iterations + 2 * good.total_iterations
    with pytest.raises(fl.ConvergenceError, match=r"2 methods were tried: \(1\) no .* \(2\) no"):
        _first_that_arrives([fails, fails])
    with pytest.raises(SingularStartError, match=r"^no equilibrium here$"):
        _first_that_arrives([lambda: fails(SingularStartError), lambda: good])


def test_increment_that_is_nan_anywhere_is_seen():
    """One nan, followed by numbers, must come out: the step has failed."""
    scene, _ = cantilever(stiffness(), 10.0, 2)
    equations = fl.extend.Equations(scene, dynamics=False)
    dx = np.full(equations.unknowns.size, 1e-3)
    dx[8] = np.nan
    assert np.isnan(move(equations, equations.start.frames.copy(), dx, carried=False))

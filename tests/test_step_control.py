"""The controller of step sizes, by itself: what it does with a sequence of errors."""

from math import inf

import pytest

import fem_lie as fl

ORDER = 2


def control(
    first: float = 1e-3, *, events: tuple[float, ...] = (1.0,), largest: float = 1.0
) -> fl.extend.Control:
    return fl.extend.Control(first, 1e-3, 1e-3, events, largest, 1e-9, ORDER)


def levels(*errors: float) -> int:
    chosen = control()
    for error in errors:
        chosen.accept(error)
    return chosen.level


def test_an_error_that_grows_fast_shortens_the_step_before_it_is_too_large():
    assert levels(0.8, 0.6) == 0
    assert levels(0.1, 0.6) == -1


def test_a_larger_step_waits_for_some_of_one_size():
    assert levels(0.01, 0.01) == 0
    assert levels(0.01, 0.01, 0.01) == 2


def test_what_was_before_a_rejection_does_not_count():
    chosen = control()
    chosen.accept(0.05)
    chosen.reject(inf)
    assert chosen.level == -4
    chosen.accept(0.6)
    assert chosen.level == -4


@pytest.mark.parametrize("past", [(0.1,), (0.01, 0.01), (0.8, inf), (0.3, 0.3, 0.3, 2.0)])
def test_a_restored_controller_chooses_the_same_sizes(past):
    """Whatever errors come next: what it has seen of those before counts."""
    for following in ((0.6,), (0.01,), (0.01, 0.01), (0.3, 0.9)):
        one, other = control(events=(0.5, 1.0)), control(events=(0.5, 1.0))
        one.pass_event()
        for error in past:
            (one.accept if error <= 1.0 else one.reject)(error)
        other.restore(one.saved_state())
        for chosen in (one, other):
            for error in following:
                chosen.accept(error)
        assert (one.level, one.next_event) == (other.level, other.next_event)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_after_a_change_the_error_is_expected_that_the_order_gives(order):
    """A shorter step stays if the error falls as ``h^order``; with another order it does not.

    The level stays where ``(θ/e)^I (p/e)^P ≥ 1``, with ``I = 2 P`` and the expected error ``p``.
    """
    expected = 2.0 ** (-0.5 * order)
    limit = 0.8 ** (2 / 3) * expected ** (1 / 3)
    for error, level in ((0.99 * limit, -1), (1.01 * limit, -2)):
        chosen = fl.extend.Control(1e-3, 1e-3, 1e-3, (1.0,), 1.0, 1e-9, order)
        chosen.accept(1.0)
        assert chosen.level == -1
        chosen.accept(error)
        assert chosen.level == level


@pytest.mark.parametrize(("error", "fall"), [(1.1, 1), (8.0, 4), (1e9, 8)])
def test_a_rejected_step_falls_by_its_error(error, fall):
    """To (θ/e)^(1/2) of its size, as the error over the size is of second order; not too far."""
    chosen = control()
    chosen.reject(error)
    assert chosen.level == -fall


def test_steps_are_not_above_the_largest_and_reach_it():
    chosen = control(largest=4e-3)
    for _ in range(30):
        chosen.accept(1e-6)
    assert chosen.size == pytest.approx(4e-3)


def test_some_steps_before_an_event_are_equal_and_fit():
    chosen, time, sizes = control(0.3, events=(2.0, 3.0)), 0.0, []
    while time < 2.0 - 1e-9:
        sizes.append(chosen.fitted(time))
        time += sizes[-1]
    assert sizes == pytest.approx([0.3] * 3 + [0.275] * 4)


def test_rotations_have_the_tolerance_of_positions_over_the_length():
    choice = fl.schemes.AdaptiveStep(1e-3)
    assert choice.control(1.0, 10.0, ORDER).rotation_tolerance == pytest.approx(1e-4)
    chosen = choice.control(1.0, 10.0, ORDER)
    assert chosen.ratio(5e-4, 2e-5, 0.5) == pytest.approx(1.0)
    assert chosen.ratio(1e-4, 1e-4, 0.5) == pytest.approx(2.0)
    assert chosen.ratio(float("nan"), 0.0, 0.5) == inf


def test_rates_that_smaller_steps_do_not_reduce_are_ignored_for_a_while():
    """Such as those of constraints that contradict each other."""
    control = fl.extend.Control(1.0, 1.0, 1.0, (100.0,), 1.0, 1e-12, 2)
    found = [control.believed(50.0) for _ in range(200)]
    assert max(found.count(value) for value in (0.0, 50.0)) == found.count(0.0) > 150
    falling = fl.extend.Control(1.0, 1.0, 1.0, (100.0,), 1.0, 1e-12, 2)
    assert all(falling.believed(50.0 * 0.5**k) for k in range(40))

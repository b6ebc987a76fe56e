"""Random scenes with one argument wrong: nothing is taken in silence."""

import pytest

from tests.random_faults import verdict


@pytest.mark.parametrize("seed", range(40))
def test_a_wrong_argument_is_refused_or_changes_nothing(seed):
    kind, text = verdict(seed)
    assert kind != "bad", text

"""Conserving steps of scenes divided among ranks have the results of one rank, and conserve."""

import divided_conserving
import numpy as np
import pytest
from ranks import on_ranks

OVER_STEP = {"reactions": 1e-7, "velocity": 5e-9, "joint forces": 1e-9, "impulses": 1e-9}
"""What is found from differences of positions over a step, in which nothing damps round-off: how
far results may differ, as those of two policies on one rank do."""


@pytest.fixture(scope="module")
def alone():
    return divided_conserving.results()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ranks", "scenes"),
    [(2, list(divided_conserving.SCENES)), (3, ["linkage", "balls", "linked", "net"])],
)
def test_conserving_steps_of_parts_have_the_results_of_one_rank(alone, tmp_path, ranks, scenes):
    out = tmp_path / "found.npz"
    on_ranks(divided_conserving, ranks, out, *scenes)
    with np.load(out) as found:
        assert found["divided"]
        same(found, {name: each for name, each in alone.items() if name.split(",")[0] in scenes})


def same(found, alone):
    """Whether all numbers are those of one rank, and the balance is one."""
    for name, expected in alone.items():
        if name.endswith("error of balance"):
            assert found[name] <= max(1e-11, 1.1 * expected), name
            continue
        # works are errors of energies
        size = np.abs(alone[name.replace(": balance", ": energies")]).max(initial=0.0)
        allowed = OVER_STEP.get(name.split(": ")[1].rstrip(" 012"), 1e-10)
        np.testing.assert_allclose(found[name], expected, rtol=0, atol=allowed * size, err_msg=name)

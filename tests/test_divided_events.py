"""What happens in runs of divided scenes is what happens on one rank, to the last event."""

import divided_events
import numpy as np
import pytest
from ranks import on_ranks

TIMES = "times", "event times"


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return divided_events.runs(tmp_path_factory.mktemp("alone"))


@pytest.fixture(scope="module")
def divided(tmp_path_factory):
    """Folder with the files of two ranks, and with their results."""
    folder = tmp_path_factory.mktemp("divided")
    on_ranks(divided_events, 2, folder / "found.npz", "runs", str(folder))
    return folder


def same(found, alone):
    """Whether all numbers are those of one rank."""
    for name, expected in alone.items():
        run, what = name.split(": ")
        # losses and works are errors of energies
        of = alone[f"{run}: energies"] if what in ("balance", "event losses") else expected
        # forces contain round-off of positions times the axial stiffness of cells
        allowed = 1e-12 if what in TIMES else 1e-8 if what == "joint forces" else 1e-10
        size = np.abs(of).max(initial=0.0)
        given = {"rtol": 0, "atol": allowed * size, "err_msg": name}
        np.testing.assert_allclose(found[name], expected, **given)


@pytest.mark.slow
def test_events_of_parts_are_those_of_one_rank(alone, divided):
    with np.load(divided / "found.npz") as found:
        assert found["divided"]
        same(found, alone)
        own, other = found["messages"]
    assert "the condition of here_only failed" in own
    assert "the condition of here_only failed" in other and "only here" in other


@pytest.mark.slow
def test_files_of_two_ranks_are_resumed_on_one_and_three(alone, divided, tmp_path):
    same(divided_events.resumed(divided), alone)
    on_ranks(divided_events, 3, tmp_path / "found.npz", "resumed", str(divided))
    with np.load(tmp_path / "found.npz") as found:
        assert found["divided"]
        same(found, alone)


def test_everything_happens(alone):
    """What is compared has impacts, rest, locks, releases and outputs of controllers."""
    for run, least in {"stops": 5, "latched": 3, "controlled": 1, "adaptive": 3}.items():
        assert len(alone[f"{run}: event times"]) >= least, run
    assert alone["stops: event losses"].sum() > 1e-3
    assert len(np.unique(alone["latched: events"])) == 3
    assert np.ptp(alone["latched: sensors"], axis=0).min() > 1e-4

"""Scenes on several ranks: the results of one rank, and a common termination."""

from types import SimpleNamespace

import numpy as np
import parallel_errors
import parallel_scenes
import pytest
from ranks import on_ranks, output_of_ranks

import fem_lie as fl


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return parallel_scenes.results(tmp_path_factory.mktemp("alone") / "run.h5")


def test_scenes_on_two_ranks_find_what_one_finds(alone, tmp_path):
    out = tmp_path / "found.npz"
    on_ranks(parallel_scenes, 2, out)
    with np.load(out) as found:
        assert set(found.files) == set(alone)
        for name, wanted in alone.items():
            size = np.abs(wanted).max()
            np.testing.assert_allclose(found[name], wanted, rtol=0, atol=1e-10 * size, err_msg=name)
    resumed = fl.GeneralisedAlpha().resume(parallel_scenes.pendulum(), out.with_suffix(".h5"))
    np.testing.assert_allclose(resumed.frames, alone["frames"], rtol=0, atol=1e-10)
    # what other ranks write aside is gone, and nothing unfinished stays
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [
        ".before",
        ".checkpoint",
        ".h5",
        ".npz",
        ".saved",
    ]


def test_import_leaves_uncaught_errors_as_they_are(tmp_path):
    script = tmp_path / "plain.py"
    script.write_text(
        "import sys\nbefore = sys.excepthook\nimport fem_lie as fl\n"
        "assert sys.excepthook is before\nfl.Scene()\nassert sys.excepthook is not before\n"
    )
    code, text = output_of_ranks(SimpleNamespace(__file__=script), 2)
    assert code == 0, text


@pytest.mark.parametrize("fault", parallel_errors.FAULTS)
def test_all_ranks_end_together_with_one_message(fault):
    code, text = output_of_ranks(parallel_errors, 2, fault)
    assert code != 0
    assert text.count(parallel_errors.MESSAGES[fault]) == 1, text

"""One rank fails: all end with one message, and what was written can be read and gone on with."""

import numpy as np
import parallel_faults
import pytest
from ranks import output_of_ranks

import fem_lie as fl

SOON = [
    ("error", 1, "shared"),
    ("killed", 0, "shared"),
    ("full", 0, "shared"),
    ("error at once", 1, "own"),
    ("error", parallel_faults.ANYWHERE, "divided"),
    ("killed", parallel_faults.ANYWHERE, "divided"),
    ("left", parallel_faults.ANYWHERE, "divided"),
    ("content", parallel_faults.ANYWHERE, "divided"),
]
LATER = [
    (fault, rank, factors)
    for fault in parallel_faults.MESSAGES
    for rank in (0, 1)
    for factors in ("shared", "own")
    # ranks that solve alone may end as they like
    if (fault, rank, factors) not in SOON and (fault, factors) != ("content", "own")
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return parallel_faults.run(tmp_path_factory.mktemp("whole") / "run.h5")


@pytest.mark.parametrize(
    ("fault", "rank", "factors"),
    [*SOON, *(pytest.param(*given, marks=pytest.mark.slow) for given in LATER)],
)
def test_a_fault_on_one_rank_is_the_end_of_all(whole, tmp_path, fault, rank, factors):
    file = tmp_path / "run.h5"
    code, text = output_of_ranks(parallel_faults, 2, f"{fault},{rank},{factors}", str(file))
    assert code != 0
    assert text.count(parallel_faults.MESSAGES[fault]) == 1, text
    if fault in parallel_faults.AT_ONCE:
        return
    found = fl.Result.load(file)
    assert parallel_faults.FAILS_AT - 2 * parallel_faults.STEP < found.times[-1]
    np.testing.assert_allclose(found.frames, whole.frames[: len(found.times)], rtol=0, atol=1e-10)
    resumed = fl.GeneralisedAlpha().resume(parallel_faults.scene(), file, progress=False)
    # with a new matrix, to the tolerance of the iteration
    allowed = 1e-9 if factors == "divided" else 1e-10
    np.testing.assert_allclose(resumed.frames, whole.frames, rtol=0, atol=allowed)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "run.h5",
        "run.h5.checkpoint",
        "run.h5.checkpoint.before",
    ]

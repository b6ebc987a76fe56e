"""One rank fails: all end with one message, and what was written can be read and gone on with."""

from concurrent.futures import ThreadPoolExecutor

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
    ("error", 1, "divided"),
    ("killed", 0, "divided"),
    ("left", 1, "divided"),
    ("content", 1, "divided"),
    ("full", 0, "divided"),
    ("content at once", 1, "divided"),
]
LATER = [
    ("content in statics", 1, "divided"),
    ("full at once", 0, "divided"),
]
LATER += [
    (fault, rank, factors)
    for fault in parallel_faults.MESSAGES
    for rank, factors in ((0, "own"), (1, "shared"))
    # ranks that solve alone may end as they like, and statics solve without shared factors
    if (fault, rank, factors) not in SOON
    and (fault, factors) != ("content", "own")
    and fault not in ("content in statics", "content at once")
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
    if fault in parallel_faults.WITHOUT_RESULTS:
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


@pytest.mark.slow
@pytest.mark.parametrize("ranks", [1, 3])
def test_a_divided_run_on_a_full_disk_is_resumed_on_other_ranks(whole, tmp_path, ranks):
    file = tmp_path / "run.h5"
    code, text = output_of_ranks(parallel_faults, 2, "full,0,divided", str(file))
    assert code != 0
    assert text.count(parallel_faults.MESSAGES["full"]) == 1, text
    code, text = output_of_ranks(parallel_faults, ranks, "resumed,0,divided", str(file))
    assert code == 0, text
    assert text.count("of them are shared") == (ranks if ranks > 1 else 0), text
    resumed = fl.Result.load(file)
    np.testing.assert_array_equal(resumed.times, whole.times)
    np.testing.assert_allclose(resumed.frames, whole.frames, rtol=0, atol=1e-9)


def test_all_ranks_may_end_within_a_divided_run(tmp_path):
    file = tmp_path / "run.h5"
    given = f"content,{parallel_faults.ALL},divided", str(file)
    code, text = output_of_ranks(parallel_faults, 3, *given)
    assert code == 0, text
    assert "Error" not in text
    assert parallel_faults.MESSAGES["content"] not in text
    assert 0 < fl.Result.load(file).times[-1] < parallel_faults.END


@pytest.mark.slow
def test_a_rank_that_leaves_a_divided_analysis_ends_all():
    """All at once, as the ranks that are left wait for most of the time."""

    def left(name):
        return output_of_ranks(parallel_faults, 2, f"{name},1,divided")

    with ThreadPoolExecutor() as several:
        for name, (code, text) in zip(
            parallel_faults.LEFT, several.map(left, parallel_faults.LEFT), strict=True
        ):
            assert code != 0, name
            assert text.count("RanksError") == 1, text
            assert f"rank 1 of 2 is at the end of the script, which it left in {name};" in text

"""Steps of chosen sizes of divided scenes are those of one rank, with their errors."""

import divided_adaptive
import numpy as np
import pytest
from ranks import on_ranks

ALLOWED = {"joint forces": 1e-8, "impulses": 1e-8, "measured errors": 1e-8}
"""What contains round-off of positions times a stiffness, and differences of two runs; of others
1e-10 of the largest."""

OVER_STEP = {
    **{"velocity": 5e-9, "rotation errors": 1e-8, "joint forces": 1e-9, "impulses": 1e-9},
    "translation errors": 1e-3,
}
"""Likewise of conserving schemes: what is found from differences over a step contains round-off
that nothing damps, and errors depend on the age of the frozen matrix, which that may change."""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return divided_adaptive.runs(tmp_path_factory.mktemp("alone"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ranks", "runs"),
    [(2, list(divided_adaptive.RUNS)), (3, ["driven", "jump", "linkage, conserving"])],
)
def test_parts_choose_the_steps_of_one_rank_and_are_resumed(alone, tmp_path, ranks, runs):
    out = tmp_path / "found.npz"
    on_ranks(divided_adaptive, ranks, out, str(tmp_path), *runs)
    with np.load(out) as found:
        assert found["divided"]
        for name, expected in alone.items():
            run, what = name.split(": ")
            if run.removesuffix(", resumed").removesuffix(", in memory") not in runs:
                continue
            of = alone[f"{run}: energies"] if what == "balance" else expected
            size = np.abs(of).max(initial=0.0)
            conserves = run.split(", ")[1:2] in (["conserving"], ["decaying"])
            rules = OVER_STEP if conserves else ALLOWED
            allowed = rules.get(what.rstrip(" 012"), 1e-10) * size
            given = {"rtol": 0, "atol": allowed, "err_msg": name}
            np.testing.assert_allclose(found[name], expected, **given)


def test_steps_grow_shrink_and_are_rejected(alone):
    """What is compared has sizes of all kinds."""
    sizes = alone["driven: sizes"]
    assert len(np.unique(sizes)) > 3
    assert len(alone["driven: rejected"])
    assert np.isfinite(alone["driven: translation errors"]).all()
    assert alone["driven: measured errors"].max() > 0.0

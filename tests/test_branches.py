"""Branching line meshes on several ranks: whole, or refused on every rank."""

import json

from mpi4py import MPI

import dolfinx
import parallel_branches
import pytest
from ranks import on_ranks


def test_branches_on_one_rank_are_whole():
    numbers = parallel_branches.results(MPI.COMM_SELF)
    assert {numbers[f"{kind} 2"] for kind in ("ours", "of_dolfinx")} == {"17"}
    assert {numbers[f"{kind} 3"] for kind in ("ours", "of_dolfinx")} == {"25"}


@pytest.mark.parametrize("ranks", [2, 3])
def test_branches_on_several_ranks_are_whole_or_refused(ranks, tmp_path):
    on_ranks(parallel_branches, ranks, tmp_path / "out.json")
    outcomes = json.loads((tmp_path / "out.json").read_text())
    assert outcomes["ours 2"] == outcomes["of_dolfinx 2"] == "17"
    assert outcomes["ours 3"] == "25"
    if tuple(map(int, dolfinx.__version__.split(".")[:2])) >= (0, 10):
        return
    refusal = outcomes["of_dolfinx 3"]
    # DOLFINx has cut a user's mesh into one more vertex, or has not
    assert refusal.startswith(
        (
            f"DOLFINx 0.9.0 cut the mesh on {ranks} processes: 1 of its nodes are two, got 26",
            "3 cells meet at a vertex: DOLFINx 0.9",
        )
    )


@pytest.mark.skipif(
    tuple(map(int, dolfinx.__version__.split(".")[:2])) >= (0, 10), reason="cut by 0.9 only"
)
def test_mesh_that_two_ranks_cut_is_detected(tmp_path):
    on_ranks(parallel_branches, 2, tmp_path / "out.json")
    refusal = json.loads((tmp_path / "out.json").read_text())["of_dolfinx 3"]
    assert refusal.endswith("1 of its nodes are two, got 26 instead of 25; use one")

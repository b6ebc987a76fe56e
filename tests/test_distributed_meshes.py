"""Bodies take distributed meshes of DOLFINx as they take those on one process."""

from mpi4py import MPI

import numpy as np
import parallel_meshes
import pytest
from ranks import on_ranks


@pytest.mark.parametrize("ranks", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_bodies_on_distributed_meshes(tmp_path, ranks):
    out = tmp_path / "found.npz"
    on_ranks(parallel_meshes, ranks, out)
    with np.load(out) as found:
        for name, build in parallel_meshes.BUILT.items():
            expected = build(MPI.COMM_SELF)
            size = np.abs(expected).max()
            assert size > 1e-6
            np.testing.assert_allclose(found[name], expected, rtol=0, atol=1e-9 * size)

"""Divided scenes start from an equilibrium as scenes on one rank do, and restart."""

import divided_start
import numpy as np
import pytest
from ranks import on_ranks


def same(found, alone):
    for name, expected in alone.items():
        size = np.abs(expected).max()
        # forces contain round-off of positions times the axial stiffness of cells
        allowed = 1e-6 if "forces" in name else 1e-9
        np.testing.assert_allclose(found[name], expected, 0, allowed * size, err_msg=name)


@pytest.mark.slow
def test_starts_of_parts_are_those_of_one_rank(tmp_path):
    on_ranks(divided_start, 2, tmp_path / "found.npz", str(tmp_path))
    (folder := tmp_path / "alone").mkdir()
    alone = divided_start.runs(folder)
    np.testing.assert_allclose(alone["alpha: angle"], 3.0 * np.pi)
    with np.load(tmp_path / "found.npz") as found:
        assert found["divided"]
        same(found, alone)
        assert all("Drive(angle of hinge) is violated" in text for text in found["messages"])
    same(divided_start.resumed(tmp_path), alone)

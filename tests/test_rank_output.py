"""Files that several ranks write for ParaView have the cells and fields of one rank."""

import meshio
import numpy as np
import parallel_output
import pytest
import pyvista
from ranks import on_ranks

import fem_lie as fl

RANKS = 4
CELLS = {"motion": 15 + 12 + 1, "forces": 6}  # faces, elements and the rigid body


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Folder with the files of one rank."""
    folder = tmp_path_factory.mktemp("alone")
    parallel_output.write(folder)
    return folder


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    """Folder with the files of four ranks."""
    folder = tmp_path_factory.mktemp("several")
    on_ranks(parallel_output, RANKS, folder)
    return folder


def same(found, expected):
    """Whether two grids have the same cells in the same order, and the same fields on them.

    Points between the pieces of two ranks are in both, so fields are compared by cells.
    """
    np.testing.assert_array_equal(found.celltypes, expected.celltypes)
    np.testing.assert_array_equal(found.offset, expected.offset)
    assert set(found.point_data) == set(expected.point_data)
    assert set(found.cell_data) == set(expected.cell_data)
    pairs = {
        "points": (found.points[found.cell_connectivity], expected.points),
        **{
            name: (values[found.cell_connectivity], expected.point_data[name])
            for name, values in found.point_data.items()
        },
    }
    for name, (values, whole) in pairs.items():
        close(values, whole[expected.cell_connectivity], name)
    for name, values in found.cell_data.items():
        close(values, expected.cell_data[name], name)


KINEMATIC = "points", "displacement", "velocity", "angular velocity", "rotation vector", "body"


def close(found, expected, name):
    """Whether values are equal to 1e-10 of the largest, and of 1: directors, radians, forces.

    Strains have the round-off of positions, and forces that of strains times the axial stiffness.
    """
    assert found.dtype == expected.dtype, name
    allowed = 1e-10 if name in KINEMATIC or name.startswith("e") else 1e-8
    size = np.nanmax(np.abs(expected), initial=1.0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=allowed * size, err_msg=name)


@pytest.mark.parametrize("name", parallel_output.SERIES)
def test_series_of_several_ranks_is_that_of_one(alone, several, name):
    one, four = (pyvista.get_reader(folder / f"{name}.pvd") for folder in (alone, several))
    assert four.time_values == one.time_values
    for k in range(len(one.time_values)):
        for reader in (one, four):
            reader.set_active_time_point(k)
        expected, found = one.read()[0], four.read()[0]
        assert expected.n_cells == CELLS[name]
        same(found, expected)


def test_each_rank_writes_its_own_cells(several):
    for name in parallel_output.SERIES:
        pieces = [several / name / f"0_{rank}.vtu" for rank in range(RANKS)]
        counts = [sum(len(block.data) for block in meshio.read(path).cells) for path in pieces]
        assert min(counts) > 0
        assert max(counts) - min(counts) <= 1
        assert sum(counts) == CELLS[name]


def test_single_states_are_written_once(alone, several):
    same(pyvista.read(several / "sheet.vtu"), pyvista.read(alone / "sheet.vtu"))


def test_results_of_several_ranks_are_read_on_one(alone, several):
    one, four = (fl.Result.load(folder / "motion.h5") for folder in (alone, several))
    for body in one.info.bodies:
        close(four.displacements(body.name), one.displacements(body.name), "displacement")
    for joint in one.info.joints:
        close(four.joint_force(joint.name), one.joint_force(joint.name), joint.name)

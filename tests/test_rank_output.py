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


def same(found, expected, order=None):
    """Whether two grids have the same cells in a known order, and the same fields on them.

    Points between the pieces of two ranks are in both, so fields are compared by cells.
    """
    order = np.arange(expected.n_cells) if order is None else order
    np.testing.assert_array_equal(found.celltypes, expected.celltypes[order])
    corners = np.concatenate([expected.get_cell(int(cell)).point_ids for cell in order])
    assert set(found.point_data) == set(expected.point_data)
    assert set(found.cell_data) - {"rank"} == set(expected.cell_data)
    close(found.points[found.cell_connectivity], expected.points[corners], "points")
    for name, values in found.point_data.items():
        close(values[found.cell_connectivity], expected.point_data[name][corners], name)
    for name, values in expected.cell_data.items():
        close(found.cell_data[name], values[order], name)


def owners(several, name):
    """Rank of each cell of a series, in the order of one rank: a single point, lines, faces."""
    bodies = fl.Result.load(several / "motion.h5").info.bodies
    faces = [body.owners for body in bodies if len(body.faces)]
    lines = [body.owners for body in bodies if len(body.cells)]
    points = [body.owners for body in bodies if not len(body.cells) and not len(body.faces)]
    return np.concatenate([*points, *lines, *faces] if name == "motion" else lines[:1])


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
        same(found, expected, np.argsort(owners(several, name), kind="stable"))


@pytest.mark.parametrize("name", parallel_output.SERIES)
def test_each_rank_writes_the_cells_that_it_had(several, name):
    expected = np.bincount(owners(several, name), minlength=RANKS)
    for rank in np.flatnonzero(expected):
        found = meshio.read(several / name / f"0_{rank}.vtu")
        ranks = np.concatenate(found.cell_data["rank"])
        np.testing.assert_array_equal(ranks, np.full(expected[rank], rank))
    assert len(list((several / name).glob("0_*.vtu"))) == np.count_nonzero(expected)


def test_other_ranks_write_equal_shares_of_the_cells(alone, several, tmp_path):
    on_ranks(parallel_output, 2, tmp_path, str(several / "motion.h5"))
    found, expected = (
        pyvista.get_reader(folder / "motion.pvd").read()[0] for folder in (tmp_path, alone)
    )
    for name in set(expected.cell_data) - {"body"}:  # section forces, which the file has not
        del expected.cell_data[name]
    same(found, expected)
    np.testing.assert_array_equal(found.cell_data["rank"], owners(several, "motion"))
    counts = [pyvista.read(tmp_path / f"motion/0_{rank}.vtu").n_cells for rank in range(2)]
    assert counts == [14, 14]


def test_single_states_are_written_once(alone, several):
    same(pyvista.read(several / "sheet.vtu"), pyvista.read(alone / "sheet.vtu"))


def test_results_of_several_ranks_are_read_on_one(alone, several):
    one, four = (fl.Result.load(folder / "motion.h5") for folder in (alone, several))
    for body in one.info.bodies:
        close(four.displacements(body.name), one.displacements(body.name), "displacement")
    for joint in one.info.joints:
        close(four.joint_force(joint.name), one.joint_force(joint.name), joint.name)

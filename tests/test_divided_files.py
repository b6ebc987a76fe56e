"""Files of divided scenes: the results of one rank, and restarts on any number of ranks."""

import shutil

import h5py
import numpy as np
import parallel_files
import pytest
from ranks import on_ranks

import fem_lie as fl

ENERGIES = "kinetic", "elastic", "balance"
OVER_STEP = {"reactions": 1e-7, "velocities": 5e-9, "joint_forces": 1e-9, "impulses": 1e-9}
"""How far results of conserving steps may differ, see test_divided_conserving.py."""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Results of one rank."""
    return parallel_files.numbers(parallel_files.run(tmp_path_factory.mktemp("alone")))


@pytest.fixture(scope="module")
def divided(tmp_path_factory):
    """Folder with the files of two ranks."""
    folder = tmp_path_factory.mktemp("divided")
    on_ranks(parallel_files, 2, folder / "run.npz", "run", str(folder))
    return folder


@pytest.fixture
def killed(divided, tmp_path):
    """Folder with the files as they were after the first checkpoints."""
    for file in divided.glob("*.h5"):
        copy = tmp_path / file.name
        shutil.copy(file, copy)
        shutil.copy(f"{file}.checkpoint.before", f"{copy}.checkpoint")
        with h5py.File(copy, "r+") as rows:
            rows["rows"][:] = parallel_files.EVERY + 1
    return tmp_path


def same(found, alone):
    """Whether all numbers are those of one rank."""
    assert set(found) == set(alone)
    for name, expected in alone.items():
        case, what = name.split(": ")
        size = np.abs(expected).max(initial=0.0)
        if case in parallel_files.CONSERVING:
            if what in ENERGIES:  # works are errors of energies
                size = max(np.abs(alone[f"{case}: {each}"]).max() for each in ENERGIES)
            allowed = OVER_STEP.get(what, 1e-10) * size
            np.testing.assert_allclose(found[name], expected, rtol=0, atol=allowed, err_msg=name)
            continue
        # they contain round-off of positions times the axial stiffness of cells
        of_forces = name.endswith(("impulses", "joint_forces", "reactions"))
        allowed = 1e-8 if of_forces else 1e-10
        np.testing.assert_allclose(found[name], expected, rtol=0, atol=allowed * size, err_msg=name)


def test_ranks_write_one_file_with_the_results_of_one(alone, divided):
    with np.load(divided / "run.npz") as found:
        same(dict(found), alone)
    for file in divided.glob("*.h5"):
        with np.load(f"{file}.checkpoint") as kept:
            assert "whole.frames" in kept, "the scene was not divided"
    results = {file.stem: fl.Result.load(file) for file in divided.glob("*.h5")}
    same(parallel_files.numbers(results), alone)
    for case, result in results.items():
        assert len(result.info.joints) == alone[f"{case}: joint_forces"].shape[1]


def test_killed_ranks_are_resumed_on_one(alone, killed):
    same(parallel_files.numbers(parallel_files.resume(killed)), alone)


SOME = "sheet, implicit", "balls, explicit", "linkage, conserving", "plate, decaying"
THREE = pytest.param(3, SOME, marks=pytest.mark.slow)


@pytest.mark.parametrize(("ranks", "cases"), [(2, ()), THREE])
def test_killed_ranks_are_resumed_on_several(alone, killed, tmp_path, ranks, cases):
    on_ranks(parallel_files, ranks, tmp_path / "found.npz", "resume", str(killed), *cases)
    with np.load(tmp_path / "found.npz") as found:
        of = cases or {name.split(": ")[0] for name in alone}
        same(dict(found), {name: alone[name] for name in alone if name.split(": ")[0] in of})


def test_a_divided_run_is_resumed_with_the_same_scene_only(killed):
    scheme, scene = fl.GeneralisedAlpha(tolerance=1e-12), fl.Scene(gravity=(0, 0, -9.81))
    scene.add(fl.RigidBody(1.0, np.eye(3)))
    with pytest.raises(ValueError, match="another scene"):
        scheme.resume(scene, killed / "net, implicit.h5", progress=False)

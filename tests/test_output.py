"""Every result in every format: saved, VTK, VTX, functions, tables; read back by other programs."""

import csv
import ctypes
import ctypes.util
import sys
from dataclasses import fields
from pathlib import Path

from mpi4py import MPI

import dolfinx
import meshio
import numpy as np
import pytest
import pyvista

import fem_lie as fl
from fem_lie import lie
from tests.own_meshes import own_mesh

MATERIAL = fl.Material(1e7, 0.3, 1e3)
LENGTH = 2.0
FULL = Path("/dev/full")


def own_line(cells: int = 4) -> dolfinx.mesh.Mesh:
    points = np.outer(np.linspace(0, LENGTH, cells + 1), (1.0, 0.0, 0.0))
    return own_mesh(
        points, np.column_stack([np.arange(cells), np.arange(1, cells + 1)]), "interval"
    )


def own_plate(cell: str) -> dolfinx.mesh.Mesh:
    mesh = fl.mesh.parametric_surface(lambda a, b: (LENGTH * a, b / 4, 0.0), (4, 1), cell=cell)
    return own_mesh(mesh.points, mesh.cells, cell)


def own_box() -> dolfinx.mesh.Mesh:
    ends = [(0.0, 0.0, 0.0), (LENGTH, 0.2, 0.2)]
    return dolfinx.mesh.create_box(MPI.COMM_SELF, ends, (4, 1, 1))


SECTION = fl.Section.rectangle(0.04, 0.02, MATERIAL)
LAYER = fl.ShellSection.layer(0.02, MATERIAL)
BODIES = {
    "beam": (own_line, lambda mesh: fl.Beam(mesh, SECTION, name="arm")),
    "director beam": (
        own_line,
        lambda mesh: fl.Beam(mesh, SECTION, formulation=fl.elements.DirectorBeam(2), name="arm"),
    ),
    "shell": (
        lambda: own_plate("quadrilateral"),
        lambda mesh: fl.Shell(mesh, LAYER, name="arm"),
    ),
    "triangles": (lambda: own_plate("triangle"), lambda mesh: fl.Shell(mesh, LAYER, name="arm")),
    "solid": (
        own_box,
        lambda mesh: fl.Solid(
            fl.mesh.volume_from_dolfinx(mesh),
            fl.sections.NeoHooke(E=1e7, nu=0.3, density=1e3),
            degree=2,
            name="arm",
        ),
    ),
}


def scene_of(body, load: float) -> fl.Scene:
    """A cantilever along x, compressed and bent at its end."""
    scene = fl.Scene()
    scene.add(body)
    x = body.frames[:, 0, 0]
    for node in np.flatnonzero(np.isclose(x, 0.0)):
        scene.add(fl.Clamp(body.point(int(node))))
    ends = np.flatnonzero(np.isclose(x, LENGTH))
    for node in ends:
        force = np.array([-1.0, 0.0, 0.2]) * load / len(ends)
        scene.add(fl.PointLoad(body.point(int(node)), force=force))
    return scene


SOLVERS = {
    "statics": (fl.StaticResult, lambda scene: fl.statics(scene, levels=(0.5, 1.0))),
    "path": (fl.stability.EquilibriumPath, lambda scene: fl.follow_path(scene, 1.0)),
    "buckling": (fl.stability.BucklingModes, lambda scene: fl.buckling(scene, 2)),
    "vibrations": (fl.stability.Modes, lambda scene: fl.vibrations(scene, count=2)),
    "response": (
        fl.post.FrequencyResponse,
        lambda scene: fl.post.frequency_response(
            scene, fl.post.BaseExcitation((0, 0, 1.0)), [0.0, 1.0]
        ),
    ),
    "motion": (
        fl.Result,
        lambda scene: fl.GeneralisedAlpha().run(scene, duration=0.02, step=0.01),
    ),
}


COMPLEX = ("vibrations", "response")
MODES = ("buckling", *COMPLEX)
"""Results with displacements about one state."""


@pytest.fixture(scope="module")
def results():
    """Mesh, body and result of each body and solver, computed when first asked for."""
    found = {}

    def result(body: str, solver: str):
        if (body, solver) not in found:
            mesh = BODIES[body][0]()
            made = BODIES[body][1](mesh)
            load = {"beam": 0.2, "director beam": 0.2}.get(body, 0.5)
            found[body, solver] = mesh, made, SOLVERS[solver][1](scene_of(made, load))
        return found[body, solver]

    return result


EVERY = pytest.mark.parametrize("solver", SOLVERS)
ON = pytest.mark.parametrize("kind", BODIES)


def last_displacement(result, body) -> np.ndarray:
    """Displacements of all nodes of the only body, in its numbering, in the last state or mode."""
    nodes = result.info.body(body.name).nodes
    return result._fields_of(len(result._rows().values) - 1)["displacement"][nodes]


def equal(a, b) -> bool:
    """Whether two records have equal contents, bit by bit."""
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and all(
            equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)
        )
    if isinstance(a, dict):
        return list(a) == list(b) and all(equal(a[key], b[key]) for key in a)
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(equal(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")
    return a == b or (a != a and b != b)


@EVERY
def test_files_are_read_back_to_the_bit(results, solver, tmp_path):
    kind = SOLVERS[solver][0]
    _, _, result = results("beam", solver)
    result.save(tmp_path / "result.h5")
    again = kind.load(tmp_path / "result.h5")
    assert equal(again, result)
    assert str(again) == str(result)
    with pytest.raises(ValueError, match=r"end in '\.pvd'"):
        again.write_vtk(tmp_path / "a.vtk")
    bytes_ = bytearray((tmp_path / "result.h5").read_bytes())
    at = bytes_.find(np.ascontiguousarray(result.info.undeformed[1]).tobytes())
    bytes_[at + 3] ^= 1
    (tmp_path / "result.h5").write_bytes(bytes_)
    with pytest.raises(ValueError, match="is damaged"):
        kind.load(tmp_path / "result.h5")


def test_files_of_other_results_are_refused(results, tmp_path):
    results("beam", "statics")[2].save(tmp_path / "statics.h5")
    with pytest.raises(ValueError, match=r"expected a file of a Modes.*'fem_lie StaticResult'"):
        fl.stability.Modes.load(tmp_path / "statics.h5")
    with pytest.raises(ValueError, match="is not a file of results of versions"):
        fl.Result.load(tmp_path / "statics.h5")
    with pytest.raises(FileNotFoundError, match="no file of results"):
        fl.StaticResult.load(tmp_path / "none.h5")


def test_a_path_continues_from_a_file(results, tmp_path):
    _, _, path = results("beam", "path")
    path.save(tmp_path / "path.h5")
    again = fl.stability.EquilibriumPath.load(tmp_path / "path.h5")
    scene = scene_of(BODIES["beam"][1](own_line()), 0.2)
    on, expected = (fl.follow_path(scene, 1.2, start=p.stations[-1]) for p in (again, path))
    np.testing.assert_array_equal(on.frames, expected.frames)
    assert on.factors[-1] == pytest.approx(1.2)


@ON
@EVERY
def test_functions_are_on_the_mesh_that_was_given(results, kind, solver):
    mesh, body, result = results(kind, solver)
    found = result.functions(body)
    displacement = found["displacement"]
    assert displacement.function_space.mesh is mesh
    row = 0 if solver in MODES else -1
    values = result.displacement(body.point((LENGTH, 0.0, 0.0)))[row].real
    x = displacement.function_space.tabulate_dof_coordinates()
    at = np.flatnonzero(np.isclose(x, (LENGTH, 0.0, 0.0)).all(axis=1))
    assert len(at) == 1 and np.abs(values).max() > 1e-6
    np.testing.assert_allclose(displacement.x.array.reshape(-1, 3)[at[0]], values, atol=1e-14)


@ON
def test_functions_of_loaded_results_are_on_a_mesh_of_what_is_drawn(results, kind, tmp_path):
    _, body, result = results(kind, "motion")
    result.save(tmp_path / "run.h5")
    found = fl.Result.load(tmp_path / "run.h5").functions("arm", 1)
    assert set(found) == {
        *("displacement", "rotation vector", "velocity", "angular velocity"),
    }
    x = found["velocity"].function_space.tabulate_dof_coordinates()
    nodes = result.info.body("arm").nodes
    for point, value in zip(x, found["velocity"].x.array.reshape(-1, 3), strict=True):
        node = np.linalg.norm(body.frames[:, 0] - point, axis=1).argmin()
        expected = result.frames[1, nodes[node], 1:].T @ result.velocities[1, nodes[node], :3]
        np.testing.assert_allclose(value, expected, atol=1e-14)


def test_rotation_vectors(results):
    _, body, result = results("beam", "statics")
    rotation = result.functions(body, 0)["rotation vector"]
    x = rotation.function_space.tabulate_dof_coordinates()
    turned = lie.so3_exp(rotation.x.array.reshape(-1, 3)[np.argmax(x[:, 0])])
    end = body.point((LENGTH, 0.0, 0.0))
    np.testing.assert_allclose(turned, result.rotation(end)[0] @ end.frame[1:], atol=1e-14)


@ON
@EVERY
def test_vtk_is_read_by_pyvista_and_meshio(results, kind, solver, tmp_path):
    _, body, result = results(kind, solver)
    result.write_vtk(tmp_path / "series.pvd")
    series = pyvista.get_reader(tmp_path / "series.pvd")
    np.testing.assert_allclose(series.time_values, result._rows().values)
    series.set_active_time_point(len(series.time_values) - 1)
    data = series.read()[0]
    expected = last_displacement(result, body)
    nodes = result.info.body(body.name).nodes
    np.testing.assert_allclose(data.point_data["displacement"][nodes], expected, atol=1e-14)
    files = sorted((tmp_path / "series").glob("*.vtu"))
    assert len(files) == len(series.time_values)
    grid = meshio.read(files[-1])
    np.testing.assert_allclose(grid.point_data["displacement"][nodes], expected, atol=1e-14)
    drawn = result.info.body(body.name)
    assert sum(len(block.data) for block in grid.cells) == len(drawn.cells) + len(drawn.faces)


@pytest.mark.skipif(not FULL.exists(), reason="needs a device that is always full")
def test_a_full_disk_is_an_error_of_vtk_files(results, tmp_path):
    _, _, result = results("beam", "statics")
    result.write_vtk(tmp_path / "series.pvd")
    first, *_ = (tmp_path / "series").glob("*.vtu")
    first.unlink()
    first.symlink_to(FULL)
    (tmp_path / "series.pvd").unlink()
    with pytest.raises(OSError, match="No space left"):
        result.write_vtk(tmp_path / "series.pvd")
    assert not (tmp_path / "series.pvd").exists()


@ON
@EVERY
def test_vtx_is_read_by_adios2(results, kind, solver, tmp_path):
    _, body, result = results(kind, solver)
    result.write_vtx(tmp_path / "series.bp", body)
    times, values = read_vtx(tmp_path / "series.bp", "displacement")
    np.testing.assert_array_equal(times, result._rows().values)
    last = last_displacement(result, body)
    # the same set of vectors, in the order of the mesh
    expected = last if kind in ("solid", "beam") else last[: len(values)]
    np.testing.assert_allclose(
        sorted(np.linalg.norm(values, axis=1)), sorted(np.linalg.norm(expected, axis=1)), atol=1e-14
    )


@EVERY
def test_tables(results, solver, tmp_path):
    _, body, result = results("beam", solver)
    end = body.point((LENGTH, 0.0, 0.0))
    result.write_csv(tmp_path / "table.csv", [end])
    with open(tmp_path / "table.csv", newline="") as file:
        header, *rows = list(csv.reader(file))
    table = dict(zip(header, np.array(rows, dtype=float).T, strict=True))
    label, values = result._rows()
    assert header[0] == label
    np.testing.assert_array_equal(table[label], values)
    modes = solver in MODES
    name = f"{end.label} {'uz' if modes else 'z'}{' re' if solver in COMPLEX else ''}"
    expected = (result.displacement(end) if modes else result.position(end))[:, 2].real
    np.testing.assert_array_equal(table[name], expected)
    quantity, own = {
        "statics": ("reaction arm.node 0 Fz", lambda: result.reactions[:, 0, 2]),
        "path": ("negative pivots", lambda: result.negative_pivots),
        "buckling": ("load factor", lambda: result.factors),
        "vibrations": ("frequency", lambda: result.hertz),
        "response": ("frequency", lambda: result.hertz),
        "motion": ("kinetic", lambda: result.kinetic),
    }[solver]
    np.testing.assert_array_equal(table[quantity], own())
    pandas = pytest.importorskip("pandas")
    frame = result.to_dataframe([end])
    assert frame.index.name == label and list(frame.columns) == header[1:]
    exact = {"index_col": label, "float_precision": "round_trip"}
    read = pandas.read_csv(tmp_path / "table.csv", **exact)
    np.testing.assert_array_equal(read.to_numpy(), frame.to_numpy())
    np.testing.assert_array_equal(read.index, frame.index)


def test_without_pandas_the_way_out_is_named(results, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"needs pandas.*write_csv writes the same table"):
        results("beam", "statics")[2].to_dataframe()


def test_wrong_names_and_bodies(results, tmp_path):
    _, body, result = results("beam", "statics")
    with pytest.raises(ValueError, match=r"end in '\.bp'"):
        result.write_vtx(tmp_path / "a.vtx", body)
    with pytest.raises(ValueError, match=r"end in '\.csv'"):
        result.write_csv(tmp_path / "a.txt")
    with pytest.raises(ValueError, match="has 2 states, got state 2"):
        result.functions(body, 2)
    with pytest.raises(ValueError, match="no body 'other'; there are: 'arm'"):
        result.functions("other")
    with pytest.raises(TypeError, match="body must be a body of the scene, or its name"):
        result.functions(3)
    scene = fl.Scene()
    ball = scene.add(fl.RigidBody(1.0, (1, 1, 1), (0, 0, 0), name="ball"))
    run = fl.GeneralisedAlpha().run(scene, duration=0.02, step=0.01)
    with pytest.raises(ValueError, match="expected a body with a mesh, got RigidBody 'ball'"):
        run.functions(ball)
    with pytest.raises(ValueError, match=r"modes are 1 … 2, got 0"):
        results("beam", "buckling")[2].functions(body, 0)


# --- ADIOS2 by its C library: Debian has no Python module of it -----------------------------------


def read_vtx(path: Path, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times of a VTX series, and a vector field in its last step, shape (n, 3)."""
    library = adios2()
    adios = library.adios2_init_serial()
    io = library.adios2_declare_io(adios, b"reader")
    random_access = 6
    engine = library.adios2_open(io, str(path).encode(), random_access)
    assert engine, f"ADIOS2 cannot open {path}"
    times = variable(library, io, engine, "step", None)
    values = variable(library, io, engine, name, len(times) - 1)
    library.adios2_close(engine)
    library.adios2_finalize(adios)
    return times, values.reshape(-1, 3)


def variable(library, io, engine, name: str, step: int | None) -> np.ndarray:
    """A variable in one step, or a scalar in all."""
    found = library.adios2_inquire_variable(io, name.encode())
    assert found, f"no variable {name}"
    steps = ctypes.c_size_t()
    library.adios2_variable_steps(ctypes.byref(steps), found)
    first, count = (0, steps.value) if step is None else (step, 1)
    library.adios2_set_step_selection(found, ctypes.c_size_t(first), ctypes.c_size_t(count))
    library.adios2_set_block_selection(found, ctypes.c_size_t(0))
    size = ctypes.c_size_t()
    library.adios2_selection_size(ctypes.byref(size), found)
    total = count if step is None else size.value
    values = np.zeros(total)
    sync = 5
    library.adios2_get(engine, found, values.ctypes.data_as(ctypes.c_void_p), sync)
    return values


def adios2():
    names = sorted(Path("/usr/lib").glob("*/libadios2_mpi_c.so*"))
    names += [Path(n) for n in [ctypes.util.find_library("adios2_c")] if n]
    if not names:
        pytest.skip("no C library of ADIOS2")
    library = ctypes.CDLL(str(names[0]))
    pointers = ("init_serial", "declare_io", "open", "inquire_variable")
    for each in pointers:
        getattr(library, f"adios2_{each}").restype = Handle
    return library


class Handle(ctypes.c_void_p):
    """An address that is passed on whole; a number would be cut to 32 bits."""

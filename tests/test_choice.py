"""Choice of the package by the cost of an elimination, and by the values."""

from itertools import pairwise

from petsc4py import PETSc

import numpy as np
import pytest
import scipy.sparse as sp

import fem_lie as fl
from fem_lie.linear import direct
from fem_lie.linear.choice import DISSECTION, MINIMUM_DEGREE, Graph, Solutions, _ordering, choose
from fem_lie.linear.saddle_point import Incidences
from fem_lie.ranks import shared_factors, together
from fem_lie.solve.statics.follow import SceneEquilibrium

STEEL = fl.Material(2.1e11, 0.3, 7850.0)


def cube(cells: int) -> fl.Scene:
    scene = fl.Scene()
    mesh = fl.mesh.parametric_volume(lambda a, b, c: (a, b, c), (cells,) * 3)
    solid = scene.add(fl.Solid(mesh, fl.sections.SaintVenantKirchhoff(1e9, 0.3, 1000.0)))
    for node in solid.points("a=0"):
        scene.add(fl.Clamp(node))
    scene.add(fl.loads.FaceLoad(solid, "a=1", (0.0, 0.0, 1e3)))
    return scene


def plate(cells: int) -> fl.Scene:
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (cells, cells))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL)))
    for node in shell.points("a=0"):
        scene.add(fl.Clamp(node))
    scene.add(fl.loads.EdgeLoad(shell, "a=1", (0.0, 0.0, 1e3)))
    return scene


def lattice(bars: int) -> fl.Scene:
    """Two layers of bars, pinned where they cross."""
    scene, section = fl.Scene(), fl.Section.rectangle(0.001, 0.001, STEEL)
    at: dict[tuple[int, int], list[fl.extend.Point]] = {}
    for layer in range(2):
        for row in range(bars):
            ends = [(0.01 * k, 0.01 * row, 0.0) for k in (0, bars - 1)]
            ends = [(y, x, z) for x, y, z in ends] if layer else ends
            beam = fl.Beam.straight(*ends, section, cells=bars - 1, up=(0, 0, 1))
            scene.add(beam)
            for k in range(bars):
                at.setdefault((row, k) if layer else (k, row), []).append(beam.point(k))
    for one, two in at.values():
        scene.add(fl.joints.Revolute(one, two, axis=(0, 0, 1)))
    for k in range(bars):
        scene.add(fl.Clamp(at[0, k][0]))
    scene.add(fl.PointLoad(at[bars - 1, 0][0], force=(0.1, 0, 0)))
    return scene


def polygon(bars: int, *, closed: bool) -> fl.Scene:
    scene, angles = fl.Scene(), 2 * np.pi * np.arange(bars + 1) / bars
    positions = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    section = fl.Section.circle(0.005, STEEL)
    beams = [
        scene.add(fl.Beam.straight(a, b, section, cells=2, formulation=fl.elements.DirectorBeam(2)))
        for a, b in pairwise(positions)
    ]
    for one, two in pairwise(beams + beams[: int(closed)]):
        scene.add(fl.joints.Spherical(one.point("end"), two.point("start")))
    return scene


@pytest.mark.parametrize("ordering", [MINIMUM_DEGREE, DISSECTION])
@pytest.mark.parametrize("constraints", [0, 5])
def test_cost_is_that_of_eliminating_one_unknown_after_the_other(rng, ordering, constraints):
    n = 40
    held = rng.uniform(size=(n, 6)) < 0.3
    held[:3] = True
    pairs = sp.random(n, n, 0.08, rng=rng) + sp.eye(n)
    pairs = (pairs + pairs.T).tocsr()
    incidences = Incidences.of([set(rng.integers(0, n, 2).tolist()) for _ in range(constraints)], n)
    graph = Graph.of(pairs.indptr, pairs.indices, incidences, held)
    order = _ordering(graph.adjacency, ordering)
    sizes = graph.sizes[order]
    full = graph.adjacency[order][:, order].toarray() != 0
    A = np.repeat(np.repeat(full, sizes, axis=0), sizes, axis=1)
    lengths = []
    for k in range(len(A)):
        column = A[k:, k].copy()
        lengths.append(column.sum())
        A[k:, k:] |= np.outer(column, column)
    cost = graph.cost(ordering)
    assert graph.unknowns == len(A) == (~held).sum() + constraints
    assert cost.fill == sum(lengths)
    assert cost.operations == sum(length**2 for length in lengths)


@pytest.mark.parametrize(
    ("pairs", "least", "most"),
    [
        ([(k, k + 1) for k in range(30)], 1, 1),
        ([(k, (k + 1) % 30) for k in range(30)], 2, 2),
        ([((k - 1) // 3, k) for k in range(1, 40)], 1, 1),
        ([*((k, k + 2) for k in range(30)), *((k, k + 1) for k in range(0, 30, 2))], 2, 2),
        ([*((k, k + 4) for k in range(40)), *((k, k + 1) for k in range(40) if k % 4 < 3)], 3, 6),
    ],
    ids=["chain", "ring", "tree", "ladder", "mesh"],
)
def test_width_separates_chains_from_meshes(pairs, least, most):
    rows, columns = np.array(pairs).T
    n = int(columns.max()) + 1
    nodes = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n))
    incidences = Incidences.of([{0, n - 1}], n)
    free = np.zeros((n, 6), dtype=bool)
    assert least <= Graph.of(nodes.indptr, nodes.indices, incidences, free).width <= most


def packages(scene: fl.Scene, solutions: Solutions, *, dynamics: bool) -> list[str]:
    matrix = fl.extend.Equations(scene, dynamics=dynamics).matrix
    return [each.package for each in choose(matrix, "test_choice_", solutions).methods]


@pytest.mark.parametrize(
    ("scene", "few", "many"),
    [
        (polygon(60, closed=False), ["klu"], ["klu"]),
        (polygon(60, closed=True), ["klu"], ["klu"]),
        (cube(6), ["cholmod", "mumps", "mumps"], ["cholmod", "mumps", "umfpack", "mumps"]),
        (plate(20), ["cholmod", "mumps", "mumps"], ["cholmod", "mumps", "umfpack", "mumps"]),
        (lattice(12), ["mumps", "mumps"], ["umfpack", "mumps"]),
    ],
    ids=["chain", "ring", "solid", "shell", "lattice"],
)
def test_structure_decides_and_not_who_asks(scene, few, many):
    assert packages(scene, Solutions.FEW, dynamics=False) == few
    assert packages(scene, Solutions.MANY, dynamics=True) == many
    assert packages(scene, Solutions.FEW, dynamics=True) == few


def solved(solver: fl.extend.DirectSolver) -> np.ndarray:
    solver.factorise()
    solver.right_hand_side[:] = np.arange(1.0, len(solver.solution) + 1.0)
    solver.solve()
    return solver.solution.copy()


def test_values_decide_whether_one_half_of_the_matrix_is_read():
    model = SceneEquilibrium(cube(5), "test_choice_")
    matrix = model.equations.matrix
    solver = fl.extend.DirectSolver(matrix, "test_choice_", solutions=Solutions.FEW)
    values, columns, pointers = matrix.csr
    b = np.arange(1.0, len(pointers))
    for change, kind in ((0.0, "cholesky"), (0.1, "lu"), (0.0, "lu")):
        kept = values.copy()
        k = pointers[np.flatnonzero(np.diff(pointers) > 1)[3]]
        values[k] += change * np.abs(values).max()
        matrix.matrix.stateIncrease()
        found = solved(solver)
        assert solver._methods[0].kind == kind
        A = sp.csr_matrix((values, columns, pointers))
        np.testing.assert_allclose(A @ found, b, rtol=0, atol=1e-8 * b.max())
        values[:] = kept


def test_a_bad_guess_is_noticed_once(monkeypatch):
    model = SceneEquilibrium(cube(6), "test_choice_")
    matrix = model.equations.matrix
    wanted = solved(
        fl.extend.DirectSolver(matrix, "test_choice_", [fl.extend.Method("lu", "mumps")])
    )
    monkeypatch.setattr(direct, "_LONG", -1.0)
    monkeypatch.setattr(direct, "_FAR", -1.0)
    solver = fl.extend.DirectSolver(matrix, "test_choice_", solutions=Solutions.FEW)
    found = solved(solver)
    assert [method.package for method in solver._methods] == ["mumps", "mumps"]
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())
    solved(solver)
    assert [method.package for method in solver._methods] == ["mumps", "mumps"]


@pytest.mark.parametrize("package", ["cholmod", "klu", "umfpack", "mumps", "superlu"])
@pytest.mark.parametrize("cells", [3, 5])
def test_statics_is_the_same_by_any_package_that_is_asked_for(cells, package):
    wanted = fl.statics(cube(cells)).frames
    prefix = f"test_{package}_{cells}_"
    PETSc.Options(prefix)["pc_factor_mat_solver_type"] = package
    found = fl.statics(cube(cells), petsc_options_prefix=prefix).frames
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13)


@pytest.mark.parametrize("scene", [cube(3), cube(5), plate(4)], ids=["cube", "larger", "plate"])
def test_solvers_leave_no_options_behind_that_nobody_gave(scene):
    given = PETSc.Options("test_left_")
    given["mat_umfpack_pivot_tolerance"] = 0.05
    fl.statics(scene, petsc_options_prefix="test_left_")
    assert given.getAll() == {"mat_umfpack_pivot_tolerance": "0.05"}


def test_a_package_that_is_not_there_is_refused_by_name():
    PETSc.Options("test_missing_")["pc_factor_mat_solver_type"] = "pastiche"
    with pytest.raises(ValueError, match=r"-test_missing_pc_factor_mat_solver_type.*'pastiche'"):
        fl.statics(cube(3), petsc_options_prefix="test_missing_")


def test_factors_with_little_fill_are_shared_by_an_option_alone(monkeypatch):
    monkeypatch.setattr(shared_factors, "several", lambda: True)
    assert shared_factors.shared(10**6, "test_spreads_")
    assert not shared_factors.shared(100, "test_spreads_")
    assert not shared_factors.shared(10**6, "test_spreads_", spreads=False)
    PETSc.Options("test_spreads_")["shared_from"] = 1
    assert shared_factors.shared(100, "test_spreads_", spreads=False)


@pytest.mark.parametrize(
    ("version", "warnings"), [((4, 1, 8), 0), ((5, 0, 7), 1), ((5, 0, 10), 1), ((5, 0, 11), 0)]
)
def test_an_mpi_library_whose_ranks_may_wait_for_ever_is_named(
    monkeypatch, caplog, version, warnings
):
    monkeypatch.setattr(together.MPI, "get_vendor", lambda: ("Open MPI", version))
    monkeypatch.delenv(together.FRAGMENTS, raising=False)
    together.check_library()
    assert len(caplog.records) == warnings
    assert all(together.FRAGMENTS in record.message for record in caplog.records)
    monkeypatch.setenv(together.FRAGMENTS, "-1")
    together.check_library()
    assert len(caplog.records) == warnings

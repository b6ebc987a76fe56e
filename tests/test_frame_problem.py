"""Sums of forms along nodal frames: loads with tangents, and solvers that reject trial points."""

from mpi4py import MPI
from petsc4py import PETSc

import dolfinx
import models
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem import petsc
from own_meshes import own_mesh

import fem_lie as fl

LOADS = {
    "dead_force": fl.extend.dead_force,
    "dead_moment": fl.extend.dead_moment,
    "follower_force": fl.extend.follower_force,
    "follower_moment": fl.extend.follower_moment,
}


def deformed(q: fl.NodalFrames, seed: int = 0) -> np.ndarray:
    h = np.random.default_rng(seed).uniform(-0.5, 0.5, 6 * len(q.frames))
    q.update(h)
    return q.function.x.array.copy()


def ends(mesh: dolfinx.mesh.Mesh, x: float) -> ufl.Measure:
    """Measure ``ds(1)`` of the vertex at ``x``."""
    found = dolfinx.mesh.locate_entities_boundary(mesh, 0, lambda y: np.isclose(y[0], x))
    tags = dolfinx.mesh.meshtags(mesh, 0, found, np.ones(len(found), dtype=np.int32))
    return ufl.Measure("ds", domain=mesh, subdomain_data=tags)(1)


@pytest.mark.parametrize("where", ["dx", "ds"])
@pytest.mark.parametrize("name", LOADS)
def test_tangents_of_loads(name, where):
    mesh = models.line(MPI.COMM_SELF, 2, 3)
    q = fl.NodalFrames(mesh, degree=2)
    measure = ufl.dx(mesh, degree=4) if where == "dx" else ufl.ds(mesh)
    forms = LOADS[name](fem.Constant(mesh, (0.7, -0.4, 1.1)), measure, q)
    H, n = deformed(q), q.increment.x.array.size
    K = fem.assemble_matrix(forms.tangent).to_dense()
    numeric = np.empty((n, n))
    for j in range(n):
        sides = []
        for sign in (1, -1):
            q.function.x.array[:] = H
            h = np.zeros(n)
            h[j] = sign * 1e-5
            q.update(h)
            sides.append(fem.assemble_vector(forms.residual).array.copy())
        numeric[:, j] = (sides[0] - sides[1]) / 2e-5
    # a follower at a vertex is constant in the frame of its node
    assert (np.abs(K).max() > 1e-3) == (where == "dx" or name.startswith("dead"))
    np.testing.assert_allclose(K, numeric, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("name", LOADS)
def test_resultants_of_loads_at_a_vertex(name):
    """Forces and moments of the node at the end, along its frame."""
    mesh = models.line(MPI.COMM_SELF, 1, 3)
    q = fl.NodalFrames(mesh)
    x = q.function.function_space.tabulate_dof_coordinates()[:, 0]
    value = np.array([0.7, -0.4, 1.1])
    forms = LOADS[name](fem.Constant(mesh, value), ends(mesh, x.max()), q)
    deformed(q)
    residual = fem.assemble_vector(forms.residual).array.reshape(-1, 6)
    end = np.argmax(x)
    R = q.frames[end, 1:].T
    components = R.T @ value if name.startswith("dead") else value
    expected = np.zeros_like(residual)
    expected[end, slice(0, 3) if name.endswith("force") else slice(3, 6)] = -components
    np.testing.assert_allclose(residual, expected, atol=1e-14)


def test_loads_need_vectors():
    mesh = models.line(MPI.COMM_SELF, 1, 1)
    q = fl.NodalFrames(mesh)
    with pytest.raises(ValueError, match=r"expected force as a UFL vector of shape \(3,\)"):
        fl.extend.dead_force((0.0, 0.0, 1.0), ufl.dx(mesh), q)


def test_virtual_work_is_linear_in_the_variation():
    mesh = models.line(MPI.COMM_SELF, 1, 1)
    q = fl.NodalFrames(mesh)
    with pytest.raises(ValueError, match="linear in one variation of the coordinates"):
        fl.local_frame_forms(ufl.TestFunction(q.increment.function_space)[0] * ufl.dx(mesh), q)


# --- solvers --------------------------------------------------------------------------------------


def cantilever(carried: bool, axial: float = 1e4) -> tuple[fl.NodalFrames, fl.FrameProblem]:
    """Eight elements, a quarter of a circle by a moment at the end; EI = 1."""
    points = np.zeros((9, 3))
    points[:, 0] = np.linspace(0, 1, 9)
    cells = np.column_stack([np.arange(8), np.arange(1, 9)])
    mesh = own_mesh(points, cells, "interval", MPI.COMM_SELF)
    q = fl.NodalFrames(mesh)
    stretch, curvature = fl.elements.director_strains(q)
    strain = ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])
    C = ufl.diag(ufl.as_vector([axial, axial / 2, axial / 2, 1.0, 1.0, 1.0]))
    dx = ufl.dx(mesh, degree=1)
    energy = fl.extend.StrainEnergy(strain, lambda e: ufl.inner(e, C * e) / 2, dx)
    moment = fem.Constant(mesh, (0.0, 0.0, np.pi / 2))
    forms = [
        fl.local_frame_forms(energy if carried else energy.form(), q),
        fl.extend.dead_moment(moment, ends(mesh, 1.0), q),
    ]
    V = q.increment.function_space
    held = fem.locate_dofs_geometrical(V, lambda y: np.isclose(y[0], 0.0))
    return q, fl.FrameProblem(forms, q, [fem.dirichletbc(np.zeros(6), held, V)])


def by_snes(problem: fl.FrameProblem, line_search: str) -> PETSc.SNES:
    snes = problem.snes(line_search=line_search)
    snes.setTolerances(rtol=0.0, atol=1e-9, max_it=100)
    snes.solve(None, problem.x.x.petsc_vec)
    return snes


def test_options_overrule_the_solver():
    """Options of the user's prefix hold; the choice of the line search leaves none behind."""
    _, problem = cantilever(True)
    options = PETSc.Options("own_")
    options["snes_max_it"], options["snes_linesearch_type"] = 3, "cp"
    before = set(PETSc.Options().getAll())
    snes = problem.snes(prefix="own_")
    assert snes.getTolerances()[3] == 3
    assert set(PETSc.Options().getAll()) == before
    snes.solve(None, problem.x.x.petsc_vec)
    assert snes.getConvergedReason() == PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
    assert snes.getFunctionEvaluations() > 1 + snes.getIterationNumber()  # cp looks for a zero
    del options["snes_max_it"], options["snes_linesearch_type"]


@pytest.mark.parametrize("line_search", ["bt", "cp", "l2"])
@pytest.mark.parametrize("carried", [True, False])
def test_line_search_rejects_trial_points(carried, line_search):
    """A line search ends in the frames that full steps reach: no increment is applied twice."""
    q, problem = cantilever(carried, axial=20.0)
    assert by_snes(problem, "basic").getConvergedReason() > 0
    full = q.frames.copy()
    q, problem = cantilever(carried, axial=20.0)
    snes = by_snes(problem, line_search)
    assert snes.getConvergedReason() > 0
    assert snes.getFunctionEvaluations() > 1 + snes.getIterationNumber()
    np.testing.assert_allclose(q.frames, full, atol=1e-8)


def test_force_in_space_needs_its_tangent():
    """Residuals are along nodal frames: without −[Rᵀf]× Newton's method fails."""
    outcomes = []
    for complete in (True, False):
        q, problem = cantilever(True)
        mesh = q.function.function_space.mesh
        force = fem.Constant(mesh, (0.0, 3.0, 0.0))
        load = fl.extend.dead_force(force, ends(mesh, 1.0), q)
        if not complete:
            load.tangent = fl.extend.follower_force(force, ends(mesh, 1.0), q).tangent
        outcomes.append(by_snes(fl.FrameProblem([problem.forms[0], load], q, problem.bcs), "basic"))
    assert outcomes[0].getConvergedReason() > 0 and outcomes[0].getIterationNumber() <= 6
    assert outcomes[1].getConvergedReason() < 0


def test_next_load_step_starts_from_the_last():
    q, problem = cantilever(True)
    assert by_snes(problem, "basic").getIterationNumber() == 4
    reached = q.frames.copy()
    assert by_snes(problem, "basic").getIterationNumber() == 0
    assert np.array_equal(q.frames, reached)


def test_newton_solver_of_dolfinx_takes_the_same_iterations():
    nls = pytest.importorskip("dolfinx.nls.petsc")
    if not hasattr(nls, "NewtonSolver"):
        pytest.skip("no NewtonSolver in this DOLFINx")
    q, problem = cantilever(True)
    by_snes(problem, "basic")
    full = q.frames.copy()
    q, problem = cantilever(True)
    solver = nls.NewtonSolver(MPI.COMM_SELF, problem)
    solver.rtol, solver.atol = 1e-12, 1e-9
    solver.krylov_solver.setType("preonly")
    solver.krylov_solver.getPC().setType("lu")
    iterations, converged = solver.solve(problem.x)
    assert converged and iterations == 4
    np.testing.assert_allclose(q.frames, full, atol=1e-12)


def test_forms_of_other_frames_are_refused():
    (q, problem), (other, _) = cantilever(False), cantilever(False)
    with pytest.raises(ValueError, match="got forms of other frames"):
        fl.FrameProblem(problem.forms, other)
    with pytest.raises(ValueError, match="got an empty sequence"):
        fl.FrameProblem([], q)
    held = fem.dirichletbc(np.zeros(12), np.array([0], np.int32), q.function.function_space)
    with pytest.raises(ValueError, match=r"expected bcs on q\.increment"):
        fl.FrameProblem(problem.forms, q, [held])


# --- another field on the same mesh ---------------------------------------------------------------


def numeric_columns(residual: fem.Form, move, n: int) -> np.ndarray:
    """Central differences of an assembled vector in ``n`` unknowns."""
    sides = []
    for sign in (1, -1):
        columns = []
        for j in range(n):
            h = np.zeros(n)
            h[j] = sign * 1e-5
            move(h)
            columns.append(fem.assemble_vector(residual).array.copy())
        sides.append(np.array(columns).T)
    return (sides[0] - sides[1]) / 2e-5


def dense(form: fem.Form) -> np.ndarray:
    A = petsc.assemble_matrix(form)
    A.assemble()
    whole = A.convert("dense")
    return whole.getDenseArray().copy()  # a view of memory that ends with the matrix


@pytest.mark.parametrize("measure", [ufl.dx, ufl.ds])
def test_blocks_of_another_field(measure):
    mesh = models.line(MPI.COMM_SELF, 2, 3)
    q = fl.NodalFrames(mesh, degree=2)
    T = fem.Function(fem.functionspace(mesh, ("Lagrange", 1)))
    T.interpolate(lambda x: 1 + x[0] ** 2)
    x, d, τ = q.position, q.directors, ufl.TestFunction(T.function_space)
    over = measure(mesh, metadata={"quadrature_degree": 6})
    W = (T**2 * ufl.inner(x, d[0]) + ufl.inner(d[1], d[1]) * x[1] ** 2) * over
    heat = T**2 * τ * x[2] * d[0][1] * over + ufl.inner(ufl.grad(T), ufl.grad(τ)) * ufl.dx(mesh)
    forms = fl.local_frame_forms(W, q)
    H, values = deformed(q), T.x.array.copy()

    def move_field(h):
        T.x.array[:] = values + h

    def move_frames(h):
        q.function.x.array[:] = H
        q.update(h)

    columns = dense(fl.extend.derivative_in_field(W, q, T))
    rows = dense(fl.extend.derivative_in_frames(heat, q))
    assert min(np.abs(columns).max(), np.abs(rows).max()) > 1e-2
    numeric = numeric_columns(forms.residual, move_field, len(values))
    np.testing.assert_allclose(columns, numeric, rtol=1e-7, atol=1e-8)
    move_field(0.0)
    numeric = numeric_columns(fem.form(heat), move_frames, q.increment.x.array.size)
    np.testing.assert_allclose(rows, numeric, rtol=1e-7, atol=1e-8)


def test_fields_that_are_not_coupled():
    mesh = models.line(MPI.COMM_SELF, 1, 1)
    q = fl.NodalFrames(mesh)
    T = fem.Function(fem.functionspace(mesh, ("Lagrange", 1)))
    energy = ufl.inner(q.position, q.position) * ufl.dx(mesh)
    with pytest.raises(ValueError, match="the energy does not depend on"):
        fl.extend.derivative_in_field(energy, q, T)
    with pytest.raises(ValueError, match="the residual does not depend on"):
        fl.extend.derivative_in_frames(ufl.TestFunction(T.function_space) * ufl.dx(mesh), q)
    with pytest.raises(ValueError, match="one test function, got 0"):
        fl.extend.derivative_in_frames(energy, q)

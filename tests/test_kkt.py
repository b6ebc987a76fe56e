"""The saddle-point matrix of a scene: pattern without held unknowns, and derivatives."""

from petsc4py import PETSc

import numpy as np
import pytest
import scipy.sparse as sp

import fem_lie as fl
from demos.hemisphere import pinched, quarter
from fem_lie.solve.statics.follow import SceneEquilibrium
from tests.test_shells import loaded

SYMMETRIC = fl.extend.Method("cholesky", "cholmod"), fl.extend.Method("cholesky", "mumps")
INDEFINITE = SYMMETRIC[1:]


def stored(model: SceneEquilibrium) -> sp.csr_matrix:
    """A copy with the stored zeros."""
    indptr, columns, values = model.equations.system.kkt.matrix.getValuesCSR()
    return sp.csr_matrix((values, columns, indptr), copy=True)


def test_held_unknowns_have_unit_rows_and_no_columns():
    model = SceneEquilibrium(pinched(0.04, quarter(3), fl.elements.HellingerReissner()), "test_")
    A, held = stored(model), model.equations.system.held.ravel()
    rows = A[held]
    assert rows.nnz == held.sum()
    assert (rows.data == 1.0).all()
    assert A[:, held].nnz == held.sum()
    # each free unknown feels all those of the cells around it
    assert A[~held][:, ~held].nnz > 20 * (~held).sum()
    dense = A.toarray()
    assert np.abs(dense - dense.T).max() < 1e-12 * np.abs(dense).max()


@pytest.mark.parametrize("cells", [2, 12])
def test_an_indefinite_matrix_stays_with_the_solver_that_can(cells):
    """With little fill CHOLMOD would factorise it, and report no negative pivot."""
    model = SceneEquilibrium(
        pinched(0.04, quarter(cells), fl.elements.HellingerReissner()), "test_"
    )
    matrix = model.equations.system.kkt.matrix
    solver = fl.extend.DirectSolver(model.equations.system.kkt, "test_indefinite_", SYMMETRIC)
    A = stored(model)
    solver.factorise()
    assert solver._methods == SYMMETRIC
    matrix.shift(-2.0 * np.abs(A.diagonal()).max())
    solver.factorise()
    assert solver._methods == INDEFINITE
    solver.right_hand_side[:] = np.arange(1.0, len(solver.solution) + 1)
    solver.solve()
    indptr, columns, values = matrix.getValuesCSR()
    residual = sp.csr_matrix((values, columns, indptr)) @ solver.solution - solver.right_hand_side
    assert np.abs(residual).max() < 1e-8 * np.abs(solver.right_hand_side).max()


def test_options_that_are_given_come_before_those_of_a_package():
    options = PETSc.Options("test_given_")
    options["mat_umfpack_pivot_tolerance"] = 0.5
    with fl.extend.Method("lu", "umfpack").options("test_given_"):
        assert options.getReal("mat_umfpack_pivot_tolerance") == 0.5
        assert options.getString("mat_umfpack_strategy") == "SYMMETRIC"


@pytest.mark.parametrize("methods", [SYMMETRIC, INDEFINITE])
def test_a_matrix_that_is_not_finite_does_not_spoil_the_next(methods):
    """A step that diverged is halved; the packages themselves never recover from nan."""
    model = SceneEquilibrium(pinched(0.04, quarter(12), fl.elements.HellingerReissner()), "test_")
    solver = fl.extend.DirectSolver(model.equations.system.kkt, "test_finite_", methods)
    values = model.equations.system.kkt.csr[0]
    kept = values.copy()
    solver.right_hand_side[:] = 1.0
    solver.factorise()
    solver.solve()
    wanted = solver.solution.copy()
    values[:] = np.nan
    model.equations.system.kkt.matrix.stateIncrease()
    with pytest.raises(fl.extend.SingularMatrixError, match="finite"):
        solver.factorise()
    values[:] = kept
    model.equations.system.kkt.matrix.stateIncrease()
    solver.factorise()
    solver.solve()
    assert np.abs(solver.solution - wanted).max() < 1e-10 * np.abs(wanted).max()


@pytest.mark.parametrize("load", ["force", "pressure"])
def test_forces_that_are_known_make_the_same_matrix(load):
    """Elements do not evaluate their forces again."""
    scene = pinched(0.04, quarter(3), fl.elements.HellingerReissner())
    if load == "pressure":
        scene.add(fl.loads.SurfacePressure(scene.bodies[0], 10.0))
    model = SceneEquilibrium(scene, "test_")
    model.factorise(0.0)
    model.move(0.1 * model.solve(model.forces()[1]))
    model.forces()
    model.factorise(0.3)
    found, system = stored(model), model.equations.system
    zero = np.zeros((system.count, 6))
    state = model._H, zero, zero, model._multipliers, model._scale
    now, forces = fl.extend.TimeState(*state[:4]), system.workspace()
    system.residual(now, state[4], np.empty(system.size), forces)
    system.fill_matrix(now, forces, fl.extend.Plan(zero, state[4]))
    anew = stored(model)
    assert abs(found - anew).max() <= 1e-12 * abs(anew).max()


def test_tangent_of_a_shell_is_symmetric_and_the_derivative_of_the_residual():
    """In equilibrium; supports along fixed axes included."""
    scene = loaded()
    shell = scene.bodies[0]
    shell.roller("10", (1.0, 0.0, 1.0))
    model = SceneEquilibrium(scene, "")
    fl.stability.ArcLength().follow(model)
    model.factorise(1.0)
    matrix = model.equations.system.kkt.matrix[:, :]
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
    rng = np.random.default_rng(1)
    state, step = model.state(), 1e-5
    # an increment of free unknowns, by way of the solution
    held = model.equations.unknowns.held.ravel()
    dx = model.solve(np.where(held, 0.0, rng.normal(size=model.equations.unknowns.size)))
    dx /= np.abs(dx).max()
    residuals = []
    for sign in (1, -1):
        model.restore(state)
        model.move(sign * step * dx)
        internal, load = model.forces()
        residuals.append(internal - load)
    model.restore(state)
    w = dx.copy()
    model.equations.system.supports.rotate(model.state().frames, w.reshape(-1, 6))
    derivative = (residuals[0] - residuals[1]) / (2 * step)
    np.testing.assert_allclose(matrix @ w * ~held, derivative, atol=2e-6)

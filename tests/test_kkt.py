"""The matrix of a scene: what is held is not in its pattern, and the rest is the derivative."""

import numpy as np
import scipy.sparse as sp

import fem_lie as fl
from demos.hemisphere import pinched, quarter
from fem_lie.solve.follow import SceneEquilibrium
from fem_lie.solve.linear import INDEFINITE, SYMMETRIC, DirectSolver


def stored(model: SceneEquilibrium) -> sp.csr_matrix:
    """With the zeros that are stored."""
    indptr, columns, values = model.system.kkt.matrix.getValuesCSR()
    return sp.csr_matrix((values, columns, indptr))


def test_held_unknowns_have_unit_rows_and_no_columns():
    model = SceneEquilibrium(pinched(0.04, quarter(3), fl.HellingerReissner()), "test_")
    A, held = stored(model), model.system.held.ravel()
    rows = A[held]
    assert rows.nnz == held.sum()
    assert (rows.data == 1.0).all()
    assert A[:, held].nnz == held.sum()
    # each free unknown feels all those of the cells around it
    assert A[~held][:, ~held].nnz > 20 * (~held).sum()
    dense = A.toarray()
    assert np.abs(dense - dense.T).max() < 1e-12 * np.abs(dense).max()


def test_an_indefinite_matrix_stays_with_the_solver_that_can():
    # small ones are factorised by a method that does not mind
    model = SceneEquilibrium(pinched(0.04, quarter(12), fl.HellingerReissner()), "test_")
    matrix = model.system.kkt.matrix
    solver = DirectSolver(matrix, "test_indefinite_", SYMMETRIC)
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

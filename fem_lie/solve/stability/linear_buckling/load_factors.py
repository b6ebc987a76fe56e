"""Load factors of linear buckling: eigenvalues of a pencil of stiffness and geometric stiffness."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp
from slepc4py import SLEPc

from fem_lie._arrays import Array
from fem_lie.linear.spectra.slepc import padded, solve_factorised, to_petsc

_TOLERANCE = 1e-10
_TRUE = 1e-4  # relative difference of an eigenvalue from the quotient of its vector
_TRIES = 4  # each asks for twice as many: those of round-off come with them


def lowest_positive(
    K: sp.csr_matrix, B: sp.csr_matrix, G: sp.csr_matrix, count: int, prefix: str
) -> tuple[Array, Array]:
    """Lowest positive λ with ``(K + λ G) φ + Bᵀ μ = 0``, ``B φ = 0``, and φ, (k, n).

    There may be less of them than ``count``.
    """
    if not G.count_nonzero():
        return np.empty(0), np.empty((0, K.shape[0]))
    n = K.shape[0]
    wanted, most = 2 * count + 4, n - B.shape[0]
    inverse, vectors = _largest(K, B, G, min(wanted, most), prefix)
    for _ in range(_TRIES):
        if len(inverse) >= count or wanted >= most:
            break
        wanted *= 2
        inverse, vectors = _largest(K, B, G, min(wanted, most), prefix)
    order = np.argsort(-inverse)[:count]
    return np.asarray(1.0 / inverse[order]), vectors[order]


def _largest(
    K: sp.csr_matrix, B: sp.csr_matrix, G: sp.csr_matrix, wanted: int, prefix: str
) -> tuple[Array, Array]:
    """Largest positive ``1/λ`` of ``−G φ = (1/λ) K φ``."""
    n, solver = K.shape[0], SLEPc.EPS().create(PETSc.COMM_SELF)
    size = float(np.mean(np.abs(K.diagonal())))
    bordered = sp.bmat([[K, size * B.T], [size * B, None]], format="csr") if B.shape[0] else K
    solver.setOperators(to_petsc(padded(-G, B)), to_petsc(bordered))
    types = SLEPc.EPS.ProblemType
    solver.setProblemType(types.GNHEP if B.shape[0] else types.GHEP)
    solver.setOptionsPrefix(prefix)
    # of the largest in size, members in tension would have all in a structure with many of them
    solver.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
    solver.setDimensions(wanted)
    solver.setTolerances(_TOLERANCE, 500)
    solve_factorised(solver, prefix)
    values, vectors = _pairs(solver, n, bordered.shape[0])
    # constraints bring zeros that are defective, of which round-off makes numbers of either sign
    energy = np.einsum("kn,kn->k", vectors, vectors @ K)
    by_loads = -np.einsum("kn,kn->k", vectors, vectors @ G)
    true = np.abs(by_loads - values * energy) <= _TRUE * values * energy
    return values[true], vectors[true]


def _pairs(solver: Any, n: int, size: int) -> tuple[Array, Array]:
    """Converged pairs with a positive eigenvalue."""
    real, imaginary = (PETSc.Vec().createSeq(size) for _ in range(2))
    values, vectors = [], []
    for k in range(solver.getConverged()):
        values.append(solver.getEigenpair(k, real, imaginary).real)
        vectors.append(real.array[:n].copy())
    given = np.array(values)
    kept = given > 1e-10 * np.abs(given).max(initial=0.0)
    return given[kept], np.array(vectors).reshape(-1, n)[kept]

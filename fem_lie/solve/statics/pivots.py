"""How many negative pivots the tangent of a scene has, of what constraints leave free."""

from __future__ import annotations

from typing import TYPE_CHECKING

import scipy.sparse as sp

from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.pivots import inertia, negative_determinant

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations

_SOFT = 1e-6  # give of constraints, over that of the stiffest spring

UNKNOWN = -1
"""Number of negative pivots of a matrix that cannot be factorised."""


def negative_pivots(equations: Equations, solver: DirectSolver) -> int:
    """Negative eigenvalues of the tangent that was factorised last, of what constraints leave free.

    For loads without potential: 1 if their number is odd, 0 if it is even. It is −1 if the matrix
    cannot be factorised.
    """
    unknowns = equations.unknowns
    m, n, redundant = unknowns.m, 6 * unknowns.moving, unknowns.m > 0 and unknowns.may_be_redundant
    try:
        found = None if redundant else solver.negative_pivots()
        if found is None or not unknowns.has_potential:
            A = tangent(equations)
            if redundant:
                A = _softened(A, n)
            if not unknowns.has_potential:
                return int(negative_determinant(A) != bool(m % 2))
            found = inertia((0.5 * (A + A.T)).tocsr())[0]
    except SingularMatrixError:
        return UNKNOWN
    return max(0, found - m)


def tangent(equations: Equations) -> sp.csr_matrix:
    """The matrix as it is now, in rows and columns of one dimension."""
    units = sp.diags(equations.matrix.units)
    return (units @ tangent_csr(equations) @ units).tocsr()


def tangent_csr(equations: Equations) -> sp.csr_matrix:
    """A copy of the matrix as it is now, in the unknowns' own units."""
    return equations.matrix.whole


def _softened(A: sp.csr_matrix, n: int) -> sp.csr_matrix:
    """With constraints after row ``n`` that give way a little, so that redundant ones count, too.

    The rows have the inertia of springs beside ``K``: as many negative pivots as rows.
    """
    stiffest = float(abs(A[:n, :n]).max()) or 1.0
    rows = A[n:, :n]
    give = _SOFT / stiffest * rows.multiply(rows).sum(axis=1).A1
    return sp.bmat([[A[:n, :n], A[:n, n:]], [rows, -sp.diags(give)]], format="csr")

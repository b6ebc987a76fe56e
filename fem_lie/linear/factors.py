"""Sparse factors for compiled loops, without Python between them and a solution.

A step of a small scene takes some tens of microseconds, and a call of a library from Python for
each solution would be a good part of that. Either PETSc's own function is called by its address,
with the factors that :class:`~fem_lie.linear.direct.DirectSolver` keeps, or SuperLU's factors are
solved with by a few lines of our own.
"""

from __future__ import annotations

import ctypes
import logging
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.linear.equilibrated import (
    ACCURATE,
    Equilibrated,
    InaccurateSolutionError,
    SingularMatrixError,
)

if TYPE_CHECKING:
    from fem_lie.linear.saddle_point import KKT

_log = logging.getLogger(__name__)

ONE, TWO = np.uint64(1), np.uint64(2)


Triangle: TypeAlias = tuple[Array, Indices, Indices]
"""Values, row indices and column pointers."""

PlainFactors: TypeAlias = tuple[Array, Array, Indices, Indices, Array, Triangle, Triangle]
"""Of :class:`Factors`, for compiled functions."""


_TRIANGLES, _INSIDE = ("lower", "upper"), ("values", "indices", "pointers")


class Factors(NamedTuple):
    """``(A_left A A_right)ᵀ = Pᵣᵀ L U P_cᵀ``, both factors by columns, without the diagonal.

    Attributes:
        left: Diagonal of ``A_left``, by which the equations are equilibrated, shape (n,); likewise
            ``right``.
        row: Permutation ``Pᵣ``, shape (n,).
        column: Permutation ``P_c``.
        diagonal: Inverse of that of ``U``.
        lower: ``L``.
        upper: ``U``.
    """

    left: Array
    right: Array
    row: Indices
    column: Indices
    diagonal: Array
    lower: Triangle
    upper: Triangle

    @property
    def plain(self) -> PlainFactors:
        """As compiled functions are quicker to call with."""
        return (*self,)

    def arrays(self) -> dict[str, Array]:
        """All there is, by names, for a checkpoint."""
        found: dict[str, Any] = {}
        for name, value in self._asdict().items():
            if name in _TRIANGLES:
                inside = zip(_INSIDE, value, strict=True)
                found |= {f"factors.{name}.{what}": array for what, array in inside}
            else:
                found[f"factors.{name}"] = value
        return found

    @classmethod
    def of(cls, kept: Mapping[str, Array]) -> Factors | None:
        """Those of which :meth:`arrays` are in a checkpoint, if there are any."""
        if "factors.left" not in kept:
            return None
        given: dict[str, Any] = {}
        for name in cls._fields:
            if name in _TRIANGLES:
                given[name] = tuple(kept[f"factors.{name}.{what}"] for what in _INSIDE)
            else:
                given[name] = kept[f"factors.{name}"]
        return cls(**given)


def factorise(kkt: KKT) -> Factors:
    """Factors of the matrix as it is now.

    Raises:
        SingularMatrixError: It has none, or none that solve with it.
    """
    own = Equilibrated(kkt)
    own.take()
    n = len(own.left)
    transposed = sp.csc_matrix(own.csr, shape=(n, n))
    known = np.ones(n)
    b, (y, x, r) = transposed.T @ known, np.empty((3, n))
    for pivoting in ({"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.01}, {}):
        try:
            lu = spla.splu(transposed, **pivoting)
        except RuntimeError as error:
            raise SingularMatrixError("the matrix is singular") from error
        factors = _unpacked(lu, own)
        solve(factors.plain, b / own.left, y, x)
        left = own.backward_error(b, x / own.right, r)
        if left <= ACCURATE:
            return factors
        _log.info("SuperLU: residual %.1e", left)
    raise InaccurateSolutionError(f"the matrix is nearly singular: a residual of {left:.1e}")


def _unpacked(lu: spla.SuperLU, own: Equilibrated) -> Factors:
    L, U = lu.L, lu.U
    diagonal: Array = np.ones(len(own.left))
    lower = _strict(L.data, L.indices, L.indptr, diagonal)
    upper = _strict(U.data, U.indices, U.indptr, diagonal)
    row, column = lu.perm_r.astype(np.int64), lu.perm_c.astype(np.int64)
    return Factors(own.left, own.right, row, column, np.reciprocal(diagonal), lower, upper)


@compiled
def _strict(values: Array, indices: Indices, pointers: Indices, diagonal: Array) -> Triangle:
    """A triangle by columns without its diagonal, which is written into ``diagonal``."""
    n = diagonal.shape[0]
    kept, rows = np.empty(values.shape[0]), np.empty(values.shape[0], dtype=np.int64)
    first, at = np.zeros(n + 1, dtype=np.int64), 0
    for j in range(n):
        for k in range(pointers[j], pointers[j + 1]):
            if indices[k] == j:
                diagonal[j] = values[k]
            else:
                kept[at], rows[at] = values[k], indices[k]
                at += 1
        first[j + 1] = at
    return kept[:at], rows[:at], first


@inlined
def _along(values: Array, indices: Indices, y: Array, first: np.uint64, end: np.uint64) -> float:
    """Product of a row of a triangle with ``y``: two sums, for each waits for its last term."""
    even, odd, k = 0.0, 0.0, first
    while k + ONE < end:
        even += values[k] * y[np.uint64(indices[k])]
        odd += values[k + ONE] * y[np.uint64(indices[k + ONE])]
        k += TWO
    if k < end:
        even += values[k] * y[np.uint64(indices[k])]
    return even + odd


@compiled
def solve(factors: PlainFactors, b: Array, y: Array, x: Array) -> None:
    """``x = A⁻¹ b``; ``y`` is work, all of shape (n,).

    Indices are unsigned, for what may be negative is asked for its sign at each use.
    """
    left, right, row, column, diagonal, lower, upper = factors
    values, indices, pointers = upper
    n = np.uint64(b.shape[0])
    for j in range(n):
        y[np.uint64(column[j])] = left[j] * b[j]
    for j in range(n):
        first, end = np.uint64(pointers[j]), np.uint64(pointers[j + ONE])
        y[j] = (y[j] - _along(values, indices, y, first, end)) * diagonal[j]
    values, indices, pointers = lower
    for j in range(n):
        i = n - ONE - j
        y[i] -= _along(values, indices, y, np.uint64(pointers[i]), np.uint64(pointers[i + ONE]))
    for j in range(n):
        x[j] = right[j] * y[np.uint64(row[j])]


# --- by the function of a library -----------------------------------------------------------------

PlainSolution: TypeAlias = tuple[Indices, Array, Array, Array, Array]
"""A :class:`Solution` at the door from Python."""


class Solution(NamedTuple):
    """Solves with factors that PETSc keeps.

    Attributes:
        call: Addresses of the function, of what it solves with, and of its vectors ``b`` and ``x``,
            shape (4,).
        left: By which the equations are multiplied, shape (n,).
        right: By which the solution is.
        b: What is in the vector of that name.
        x: Likewise.
    """

    call: Indices
    left: Array
    right: Array
    b: Array
    x: Array

    @property
    def plain(self) -> PlainSolution:
        """As compiled functions are quicker to call with."""
        return (*self,)

    @classmethod
    def none(cls) -> Solution:
        """Which solves nothing: :func:`solve_by_call` says so."""
        return cls(np.zeros(4, dtype=np.int64), *np.empty((4, 0)))


def addresses(ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> Indices:
    """What is called to solve, see :attr:`Solution.call`.

    Without anything around the factors they are solved with at once.
    """
    pc = ksp.getPC()
    direct = ksp.getType() == PETSc.KSP.Type.PREONLY
    direct &= pc.getType() in (PETSc.PC.Type.LU, PETSc.PC.Type.CHOLESKY)
    name, holder = ("MatSolve", pc.getFactorMatrix()) if direct else ("KSPSolve", ksp)
    found = _address(name), holder.handle, b.handle, x.handle
    return np.array(found, dtype=np.int64)


@cache
def _address(name: str) -> int | None:
    """Of a function of PETSc's."""
    function = getattr(ctypes.CDLL(PETSc.__file__), name)
    return ctypes.cast(function, ctypes.c_void_p).value


@intrinsic
def _call(typing_context: Any, function: Any, holder: Any, b: Any, x: Any) -> Any:
    """Call ``int function(holder, b, x)``, all of them addresses."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(number, [place] * 3).as_pointer()
        given = [builder.inttoptr(argument, place) for argument in arguments[1:]]
        return builder.call(builder.inttoptr(arguments[0], kind), given)

    return types.int32(*[types.int64] * 4), generate


@compiled
def solve_by_call(solution: PlainSolution, r: Array, dx: Array) -> bool:
    """Solve for ``r`` into ``dx``, shape (n,); returns whether that could be done."""
    call, left, right, b, x = solution
    if call[0] == 0:
        return False
    for k in range(r.shape[0]):
        b[k] = r[k] * left[k]
    if _call(call[0], call[1], call[2], call[3]) != 0:
        return False
    for k in range(r.shape[0]):
        dx[k] = x[k] * right[k]
    return True

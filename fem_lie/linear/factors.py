"""Sparse factors for compiled loops that solve without calling Python.

A step of a small scene takes some tens of microseconds; calling a library from Python for each
solution would be a considerable part of it. Compiled loops either call PETSc's function by its
address, with the factors of :class:`~fem_lie.linear.direct.DirectSolver`, or solve with SuperLU's
factors by compiled code.
"""

from __future__ import annotations

import ctypes
import logging
from collections.abc import Iterable, Mapping
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
from fem_lie._jit import compiled
from fem_lie.linear.equilibrated import (
    ACCURATE,
    Equilibrated,
    InaccurateSolutionError,
    SingularMatrixError,
)
from fem_lie.linear.redundancy import IdleFilter, PlainIdleFilter, remove_idle
from fem_lie.linear.triangles import Triangle, Triangles, substitute

if TYPE_CHECKING:
    from fem_lie.linear.saddle_point import KKT

_log = logging.getLogger(__name__)

PlainFactors: TypeAlias = tuple[
    Array, Array, Indices, Indices, Array, Triangle, Triangle, PlainIdleFilter
]
""":class:`Factors` as a plain tuple, for compiled functions."""


_TRIANGLES, _INSIDE = ("lower", "upper"), ("values", "indices", "pointers")


class Factors(NamedTuple):
    """``(A_left A A_right)ᵀ = Pᵣᵀ L U P_cᵀ``, both factors by columns, without the diagonal.

    Attributes:
        left: Diagonal of ``A_left``, which equilibrates the equations, shape (n,); ``right``
            likewise.
        row: Permutation ``Pᵣ``, shape (n,).
        column: Permutation ``P_c``.
        diagonal: Inverse of the diagonal of ``U``.
        lower: ``L``.
        upper: ``U``.
        idle: What removes multipliers without force from solutions.
    """

    left: Array
    right: Array
    row: Indices
    column: Indices
    diagonal: Array
    lower: Triangle
    upper: Triangle
    idle: IdleFilter

    @classmethod
    def none(cls) -> Factors:
        """No factors, where others solve the equations."""
        number = np.empty(0)
        return cls(number, number, *Triangles.none(), IdleFilter.none())

    @property
    def plain(self) -> PlainFactors:
        """Plain tuple of the fields, which makes calls of compiled functions faster."""
        return (*self[:-1], (*self.idle,))

    def arrays(self) -> dict[str, Array]:
        """All arrays by name, for a checkpoint."""
        return _named("factors", self[:-1], self._fields) | _named(
            "factors.idle", self.idle, self.idle._fields
        )

    @classmethod
    def of(cls, kept: Mapping[str, Array]) -> Factors | None:
        """Factors from the :meth:`arrays` of a checkpoint, or ``None``."""
        if "factors.left" not in kept:
            return None
        idle = IdleFilter(**_taken("factors.idle", kept, IdleFilter._fields))
        return cls(**_taken("factors", kept, cls._fields[:-1]), idle=idle)


def _named(prefix: str, values: Iterable[Any], fields: Iterable[str]) -> dict[str, Array]:
    """Arrays of a record, and those of its triangles, by name."""
    found: dict[str, Any] = {}
    for name, value in zip(fields, values, strict=False):
        if name in _TRIANGLES:
            inside = zip(_INSIDE, value, strict=True)
            found |= {f"{prefix}.{name}.{what}": array for what, array in inside}
        else:
            found[f"{prefix}.{name}"] = value
    return found


def _taken(prefix: str, kept: Mapping[str, Array], fields: Iterable[str]) -> dict[str, Any]:
    """Values of a record from the arrays of :func:`_named`."""
    return {
        name: tuple(kept[f"{prefix}.{name}.{what}"] for what in _INSIDE)
        if name in _TRIANGLES
        else kept[f"{prefix}.{name}"]
        for name in fields
    }


def factorise(kkt: KKT) -> Factors:
    """Factors of the current matrix.

    Raises:
        SingularMatrixError: There are none, or none that solve accurately.
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
        factors = Factors(own.left, own.right, *Triangles.of(lu), IdleFilter.none())
        solve(factors.plain, b / own.left, y, x)
        left = own.backward_error(b, x / own.right, r).of_terms
        if left <= ACCURATE:
            return factors._replace(idle=own.idle_filter())
        _log.info("SuperLU: residual %.1e", left)
    raise InaccurateSolutionError(f"the matrix is nearly singular: a residual of {left:.1e}")


@compiled
def solve(factors: PlainFactors, b: Array, y: Array, x: Array) -> None:
    """``x = A⁻¹ b``; ``y`` is workspace, all of shape (n,).

    Indices are unsigned: the compiler would check signed ones at each use.
    """
    left, right, row, column, diagonal, lower, upper, idle = factors
    n = np.uint64(b.shape[0])
    for j in range(n):
        y[np.uint64(column[j])] = left[j] * b[j]
    substitute(diagonal, lower, upper, y, n)
    for j in range(n):
        x[j] = right[j] * y[np.uint64(row[j])]
    remove_idle(idle, x)


# --- by the function of a library -----------------------------------------------------------------

PlainSolution: TypeAlias = tuple[Indices, Array, Array, Array, Array]
"""A :class:`Solution` as a plain tuple."""


class Solution(NamedTuple):
    """Solution with factors that PETSc owns.

    Attributes:
        call: Addresses of the function, of its solver, and of its vectors ``b`` and ``x``, shape
            (4,).
        left: Factors of the equations, shape (n,).
        right: Factors of the solution, shape (n,).
        b: Values of the vector ``b``.
        x: Values of the vector ``x``.
    """

    call: Indices
    left: Array
    right: Array
    b: Array
    x: Array

    @property
    def plain(self) -> PlainSolution:
        """Plain tuple of the fields, which makes calls of compiled functions faster."""
        return (*self,)

    @classmethod
    def none(cls) -> Solution:
        """No solution: :func:`solve_by_call` returns false."""
        return cls(np.zeros(4, dtype=np.int64), *np.empty((4, 0)))


def addresses(ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> Indices:
    """Addresses of :attr:`Solution.call`.

    Bare factors are called directly, without the preconditioner around them.
    """
    pc = ksp.getPC()
    direct = ksp.getType() == PETSc.KSP.Type.PREONLY
    direct &= pc.getType() in (PETSc.PC.Type.LU, PETSc.PC.Type.CHOLESKY)
    name, holder = ("MatSolve", pc.getFactorMatrix()) if direct else ("KSPSolve", ksp)
    found = _address(name), holder.handle, b.handle, x.handle
    return np.array(found, dtype=np.int64)


@cache
def _address(name: str) -> int | None:
    """Address of a function of PETSc."""
    function = getattr(ctypes.CDLL(PETSc.__file__), name)
    return ctypes.cast(function, ctypes.c_void_p).value


@intrinsic
def _call(typing_context: Any, function: Any, holder: Any, b: Any, x: Any) -> Any:
    """Call ``int function(holder, b, x)``, all of them addresses."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(number, [pointer] * 3).as_pointer()
        given = [builder.inttoptr(argument, pointer) for argument in arguments[1:]]
        return builder.call(builder.inttoptr(arguments[0], kind), given)

    return types.int32(*[types.int64] * 4), generate


@compiled
def solve_by_call(solution: PlainSolution, r: Array, dx: Array) -> bool:
    """Solve for ``r`` into ``dx``, shape (n,); returns whether it succeeded."""
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

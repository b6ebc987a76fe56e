"""Elimination of chains as a preconditioner of PETSc; a package factorises the rest.

Of a divided scene, each rank eliminates the chains of its part. All ranks together factorise the
sum of what is left.
"""

from __future__ import annotations

import logging
from typing import Protocol

from petsc4py import PETSc

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.linear.condensed.blocks import backward, factorise, forward, scatter
from fem_lie.linear.condensed.elimination import Numbers, Pattern, pairs_left, plan_of
from fem_lie.ranks.divided_matrix import DividedMatrix

_log = logging.getLogger(__name__)


class Values(Protocol):
    """The equilibrated matrix, see :class:`~fem_lie.linear.equilibrated.Equilibrated`."""

    csr: tuple[Array, Numbers, Numbers]
    left: Array


class SingularBlockError(ArithmeticError):
    """The block of an eliminated node is singular."""


class Condensed:
    """Exact preconditioner of PETSc: compiled elimination of chains, a package for the rest."""

    def __init__(self, kkt: Pattern, own: Values, package: str) -> None:
        """Plan the elimination.

        Args:
            kkt: The matrix.
            own: Its equilibrated copy, which is factorised.
            package: PETSc's name of the package for the rest.
        """
        self._kkt, self._own, self._package = kkt, own, package
        self._made: tuple[int, float] | None = None
        self._plan, self._held = plan_of(kkt), kkt.unit_rows
        self._left = pairs_left(self._plan)
        self._store = np.empty(self._plan.start[-1])
        self._schur = np.empty(self._left.start[-1])
        self._ksp: PETSc.KSP | None = None
        self._gather()
        self._empty = not kkt.shared.any(len(self._rest) > 0)
        total, left = int((~self._held).sum()), len(self._rest)
        _log.info("%d of %d unknowns are left when chains are eliminated", left, total)

    def _gather(self) -> None:
        """Build the remaining matrix, and find the sources of its entries."""
        plan, (_, columns, pointers) = self._plan, self._own.csr
        n, total = len(plan.sizes), len(self._held)
        stays = ~self._held
        stays[: 6 * n] &= np.repeat(plan.position < 0, 6)
        self._rest = rest = np.flatnonzero(stays)
        number = np.full(total, -1)
        number[rest] = np.arange(len(rest))
        lengths = np.diff(pointers)[rest]
        rows, ends = np.repeat(np.arange(len(rest)), lengths), np.cumsum(lengths)
        begins = np.repeat(pointers[rest] - (ends - lengths), lengths)
        at = np.arange(len(begins)) + begins
        inside = number[columns[at]] >= 0
        self._taken = at[inside]
        of_matrix = rows[inside] * len(rest) + number[columns[self._taken]]
        of_chains = self._keys_of_blocks(number, len(rest))
        keys, which = np.unique(np.concatenate([of_matrix, of_chains]), return_inverse=True)
        self._of_matrix, self._of_chains = np.split(which, [len(of_matrix)])
        row, column = np.divmod(keys, max(len(rest), 1))
        first = np.searchsorted(row, np.arange(len(rest) + 1)).astype(PETSc.IntType)
        self._data = np.zeros(len(keys))
        entries = self._data, column.astype(PETSc.IntType), first
        self._sum = DividedMatrix(entries, self._kkt.shared, rest)

    def _keys_of_blocks(self, number: Indices, count: int) -> Indices:
        """Row times ``count`` plus column of all entries of the blocks that elimination makes."""
        plan, left = self._plan, self._left
        i = np.repeat(np.arange(len(plan.sizes)), np.diff(left.pointers))
        j = left.indices
        rows, columns = plan.sizes[i].astype(np.int64), plan.sizes[j].astype(np.int64)
        block = np.repeat(np.arange(len(i)), rows * columns)
        r, c = np.divmod(np.arange(left.start[-1]) - left.start[:-1][block], columns[block])
        row = number[6 * i[block] + plan.free[i[block], r]]
        column = number[6 * j[block] + plan.free[j[block], c]]
        return np.asarray(row * count + column)

    def setUp(self, pc: PETSc.PC) -> None:
        """Factorise the current matrix.

        Raises:
            SingularBlockError: The block of a node is singular.
            PETSc.Error: The remaining matrix is singular.
        """
        with self._kkt.shared.errors(SingularBlockError):
            self._eliminate()
        if self._empty:
            return
        self._data[:] = 0.0
        self._data[self._of_matrix] = self._own.csr[0][self._taken]
        self._data[self._of_chains] += self._schur
        self._sum.take()
        if self._ksp is None:
            self._ksp = PETSc.KSP().create(self._kkt.shared.comm)
            self._ksp.setType(PETSc.KSP.Type.PREONLY)
            self._ksp.getPC().setType(PETSc.PC.Type.LU)
            self._ksp.getPC().setFactorSolverType(self._package)
        self._ksp.setOperators(self._sum.matrix)
        self._ksp.setUp()

    @property
    def factorising(self) -> PETSc.PC | None:
        """Preconditioner with the factors of the rest, or ``None``."""
        return None if self._ksp is None else self._ksp.getPC()

    def _eliminate(self) -> None:
        """Factorise the chains, unless only constraints have changed, which do not affect them."""
        if not len(self._plan.order):
            return
        first = 6 * self._plan.order[0] + self._plan.free[self._plan.order[0], 0]
        present = self._kkt.filled, float(self._own.left[first])
        if self._made == present:
            return
        self._made = None
        scatter(self._plan, *self._own.csr, self._store)
        failed = factorise(self._plan, self._left, self._store, self._schur)
        if failed >= 0:
            raise SingularBlockError(f"the block of node {failed} is singular")
        self._made = present

    def apply(self, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve."""
        y, shared = x.array, self._kkt.shared
        y[:] = b.array_r
        of_nodes = y[: 6 * len(shared.owned)].reshape(-1, 6)
        if shared.several:
            of_nodes[~shared.owned] = 0.0  # what chains add to copies is summed
        forward(self._plan, self._store, y)
        shared.sum(of_nodes)
        if self._ksp is not None:
            self._sum.solve(self._ksp, y, y)
        backward(self._plan, self._store, y)

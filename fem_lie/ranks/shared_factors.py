"""Factors of one matrix on all ranks, and what the solution on subdomains took."""

from __future__ import annotations

import logging
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.ranks.together import first, meet, several


class Subdomains(NamedTuple):
    """Of a run or a search for equilibrium, one subdomain on each rank.

    Attributes:
        number: Of subdomains.
        interface: Unknowns that several of them have.
        made: How often matrix and preconditioner were made, also for a new border alone.
        solutions: Systems of equations solved.
        iterations: Of the Krylov method in all of these.
    """

    number: int
    interface: int
    made: int
    solutions: int
    iterations: int

    @property
    def per_solution(self) -> float:
        """Iterations of a solution, in the mean."""
        return self.iterations / max(self.solutions, 1)


FROM = 20_000
"""Unknowns from which on factors are shared, unless PETSc's option ``shared_from`` says another."""

_FROM = "shared_from"

_log = logging.getLogger(__name__)


def shared(size: int, prefix: str, *, spreads: bool = True) -> bool:
    """Whether all ranks factorise a matrix together; what is small each of them does by itself.

    Args:
        size: Unknowns.
        prefix: Of PETSc's options.
        spreads: Whether that takes less time than what each would do; with the option
            ``shared_from`` size alone decides.
    """
    if not several():
        return False
    options = PETSc.Options(prefix)
    if options.hasName(_FROM):
        found = size >= int(options.getInt(_FROM))
    else:
        found = spreads and size >= FROM
    if first():
        why = "small, " if spreads else ""
        how = "factors shared by" if found else f"{why}the same factors on each of"
        _log.info("%d unknowns: %s %d ranks", size, how, MPI.COMM_WORLD.size)
    return found


class SharedMatrix:
    """Rows of a matrix by ranks, as equal in number as can be; all methods are called on all.

    Attributes:
        matrix: PETSc's, on all ranks.
    """

    def __init__(self, csr: tuple[Array, Indices, Indices]) -> None:
        """Take this rank's rows of values, columns, row pointers; :meth:`take` reads them anew."""
        world = MPI.COMM_WORLD
        # what nobody uses any more on any rank can only be freed by all together
        PETSc.garbage_cleanup(PETSc.COMM_WORLD)
        self._values, columns, pointers = csr
        n = len(pointers) - 1
        bounds = np.linspace(0, n, world.size + 1).astype(np.int64)
        self._counts = np.diff(bounds)
        self._rows = slice(int(bounds[world.rank]), int(bounds[world.rank + 1]))
        own = pointers[self._rows.start : self._rows.stop + 1]
        self._inside = slice(int(own[0]), int(own[-1]))
        self._pattern = own - own[0], columns[self._inside]
        sizes = (len(own) - 1, n)
        self.matrix = PETSc.Mat().createAIJ(
            (sizes, sizes), csr=(*self._pattern, self._values[self._inside]), comm=PETSc.COMM_WORLD
        )
        self._b, self._x = self.matrix.createVecs()

    def take(self) -> None:
        """Take the values as they are now.

        Raises:
            RanksError: The ranks are not at the same place, or have other values.
        """
        meet("a factorisation", self._values)
        self.matrix.setValuesCSR(*self._pattern, self._values[self._inside])
        self.matrix.assemble()

    def solve(self, ksp: PETSc.KSP, b: Array, x: Array) -> None:
        """Solve ``A x = b``: ``b`` of this rank's rows is read, all of ``x`` is set, alike on all.

        Raises:
            RanksError: The ranks are not at the same place, or have other right-hand sides.
        """
        meet("a solution", b)
        self._b.array[:] = b[self._rows]
        ksp.solve(self._b, self._x)
        MPI.COMM_WORLD.Allgatherv(np.asarray(self._x.array), (x, self._counts))

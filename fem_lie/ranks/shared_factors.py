"""Factors of one matrix on all ranks, and statistics of solutions on subdomains."""

from __future__ import annotations

import logging
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.ranks.together import first, meet, several


class Subdomains(NamedTuple):
    """Statistics of a run or an equilibrium on subdomains, one per rank.

    Attributes:
        number: Number of subdomains.
        interface: Number of unknowns that several of them have.
        made: Number of matrices with preconditioner, also for new constraints only.
        solutions: Number of linear systems solved.
        iterations: Number of Krylov iterations in all of these.
    """

    number: int
    interface: int
    made: int
    solutions: int
    iterations: int

    @property
    def per_solution(self) -> float:
        """Mean number of iterations of a solution."""
        return self.iterations / max(self.solutions, 1)


FROM = 20_000
"""Unknowns from which factors are shared, unless PETSc's option ``shared_from`` is set."""

_FROM = "shared_from"

_log = logging.getLogger(__name__)


def shared(size: int, prefix: str, *, spreads: bool = True) -> bool:
    """Whether all ranks factorise a matrix together; each rank factorises small ones by itself.

    Args:
        size: Number of unknowns.
        prefix: Prefix of PETSc's options.
        spreads: Whether this is faster than one factorisation per rank; with the option
            ``shared_from`` only the size counts.
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
    """Matrix distributed by rows, as evenly as possible; all methods are collective.

    Attributes:
        matrix: The PETSc matrix on all ranks.
    """

    def __init__(self, csr: tuple[Array, Indices, Indices]) -> None:
        """Take this rank's rows of values, columns, row pointers; :meth:`take` updates values.

        Raises:
            RanksError: The ranks are at different points, or have matrices of different size.
        """
        world = MPI.COMM_WORLD
        # what follows is collective, and would wait forever for a rank that is elsewhere
        meet("a new matrix", np.array([len(csr[2]), len(csr[1])], dtype=np.float64))
        # objects without references on any rank are freed by all ranks together
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
        """Copy the current values.

        Raises:
            RanksError: The ranks are at different points, or have different values.
        """
        meet("a factorisation", self._values)
        self.matrix.setValuesCSR(*self._pattern, self._values[self._inside])
        self.matrix.assemble()

    def solve(self, ksp: PETSc.KSP, b: Array, x: Array) -> None:
        """Solve ``A x = b``: reads this rank's rows of ``b``, and sets all of ``x`` on all ranks.

        Raises:
            RanksError: The ranks are at different points, or have different right-hand sides.
        """
        meet("a solution", b)
        self._b.array[:] = b[self._rows]
        ksp.solve(self._b, self._x)
        MPI.COMM_WORLD.Allgatherv(np.asarray(self._x.array), (x, self._counts))

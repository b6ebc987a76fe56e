"""Factorisation methods, and the packages that implement them."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from petsc4py import PETSc

from fem_lie.linear.condensed.preconditioner import Condensed
from fem_lie.linear.condensed.schur import SchurComplement, dense_rows_of
from fem_lie.linear.domains.interface import Interface
from fem_lie.linear.equilibrated import ACCURATE, Equilibrated

if TYPE_CHECKING:
    from fem_lie.linear.saddle_point import KKT


@dataclass(frozen=True)
class Method:
    """A factorisation and the package that does it.

    Attributes:
        kind: PETSc's name, ``lu`` or ``cholesky``.
        package: PETSc's name of the package.
        spreads: Whether several ranks factorise large matrices together.
        together: Whether all ranks solve together by its own means, each with the matrix of its
            part of a scene.
        accurate: See :data:`~.equilibrated.ACCURATE`.
        takes_low_rank: Whether it costs less with low-rank parts outside of the pattern.
        defaults: PETSc options that hold while it factorises, unless they are given.
    """

    kind: str
    package: str
    spreads: ClassVar[bool] = True
    together: ClassVar[bool] = False
    accurate: ClassVar[float] = ACCURATE
    takes_low_rank: ClassVar[bool] = False
    defaults: ClassVar[Mapping[str, int]] = {}

    @property
    def symmetric(self) -> bool:
        """Whether it reads only one triangle of the matrix."""
        return self.kind == "cholesky"

    def fits(self, kkt: KKT, own: Equilibrated) -> bool:
        """Whether it can factorise these values.

        Args:
            kkt: The matrix.
            own: Its equilibrated copy.
        """
        return not self.symmetric or own.is_symmetric()

    def negative_pivots(self, pc: PETSc.PC) -> int | None:
        """Negative pivots of the last factorisation; ``None`` if unknown.

        Args:
            pc: Preconditioner of PETSc.
        """
        if pc.getType() != PETSc.PC.Type.CHOLESKY:
            return None
        if pc.getFactorSolverType() != "mumps":
            return 0  # other Cholesky factors exist for positive definite matrices only
        return int(pc.getFactorMatrix().getMumpsInfog(NEGATIVE))

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """Set up ``pc`` to factorise the equilibrated copy ``own`` of ``kkt``.

        Args:
            pc: Preconditioner of PETSc.
            kkt: The matrix.
            own: Its equilibrated copy.
        """
        pc.setType(self.kind)
        pc.setFactorSolverType(self.package)

    @contextmanager
    def options(self, prefix: str) -> Iterator[None]:
        """Context in which defaults are options that are not given otherwise.

        They are :attr:`defaults` and those of the package, :data:`DEFAULTS`. PETSc would warn at
        the end of a script of options of a package that was not used.

        Args:
            prefix: Prefix of PETSc's options.
        """
        known = PETSc.Options(prefix)
        defaults = {**DEFAULTS.get(self.package, {}), **self.defaults}
        added = {name: value for name, value in defaults.items() if name not in known}
        for name, value in added.items():
            known[name] = value
        try:
            yield
        finally:
            for name in added:
                known.delValue(name)

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """Preconditioner within ``pc`` that has the factors of the package, or ``None``.

        Args:
            pc: Preconditioner of PETSc.
        """
        return pc


class Alone(Method):
    """A method that is faster on one rank than MUMPS on several, as there is little fill."""

    spreads: ClassVar[bool] = False


class ByMinimumDegree(Method):
    """MUMPS with a minimum-degree ordering, found in a tenth of the time of a dissection.

    The ordering detects dense rows, as of multipliers.
    """

    defaults: ClassVar[Mapping[str, int]] = {"mat_mumps_icntl_7": 6}


class ByChains(Alone):
    """Elimination of chains of nodes first, see :mod:`fem_lie.linear.condensed`."""

    together: ClassVar[bool] = True

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """Set up ``pc`` to factorise the equilibrated copy ``own`` of ``kkt``."""
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(Condensed(kkt, own, self.package))

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """Preconditioner within ``pc`` that has the factors of the package, or ``None``."""
        return pc.getPythonContext().factorising


class BySchurComplement(Alone):
    """Cholesky factors and a dense Schur complement, see :mod:`fem_lie.linear.condensed.schur`."""

    takes_low_rank: ClassVar[bool] = True

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """Set up ``pc`` to factorise the equilibrated copy ``own`` of ``kkt``."""
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(SchurComplement(kkt, own, self.package))

    @property
    def symmetric(self) -> bool:
        """Whether it reads only one triangle: no, its last rows may be unsymmetric."""
        return False

    def fits(self, kkt: KKT, own: Equilibrated) -> bool:
        """Whether it can factorise these values."""
        return dense_rows_of(own, 6 * (len(kkt.indptr) - 1)) is not None

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """Preconditioner within ``pc`` that has the factors of the package, or ``None``."""
        return pc.getPythonContext().factorising

    def negative_pivots(self, pc: PETSc.PC) -> int | None:
        """Negative pivots of the last factorisation; ``None`` if unknown."""
        return pc.getPythonContext().negative_pivots()


class Domains(Alone):
    """One subdomain per rank and a solver for the interface, see :mod:`fem_lie.linear.domains`.

    ``kind`` and ``package`` are a name of :data:`~fem_lie.linear.domains.interface.WAYS`.
    """

    together: ClassVar[bool] = True
    accurate: ClassVar[float] = 1e-6

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """Set up ``pc`` to factorise the equilibrated copy ``own`` of ``kkt``."""
        if kkt.part is None:
            kkt.share_among_ranks()
        assert kkt.part is not None
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(Interface(kkt.part, own, pc.getOptionsPrefix() or "", self.kind))

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """``None``: subdomains report a lack of memory themselves."""
        return None


DEFAULTS: dict[str, dict[str, object]] = {
    # no warning of indefinite matrices, which it would factorise as L D Lᵀ without fill
    "cholmod": {"mat_cholmod_print": 0, "mat_cholmod_factor": "supernodal"},
    # zeros on the diagonal from joints make umfpack treat nets as unsymmetric; with its own
    # tolerance of 0.1 it departs from their order for larger pivots, and doubles the fill
    "umfpack": {"mat_umfpack_strategy": "SYMMETRIC", "mat_umfpack_pivot_tolerance": 0.01},
}
"""Default PETSc options of packages."""

RESCUES: tuple[Method, ...] = (Method("lu", "mumps"), Method("lu", "superlu"))
"""Methods that follow those of a scene if their solutions are not accurate."""

ON_RANKS = ("mumps",)
"""Packages that factorise on several ranks together."""

NEGATIVE = 12
"""MUMPS' INFOG of the number of negative pivots."""

_FACTORS = PETSc.PC.Type.LU, PETSc.PC.Type.CHOLESKY
_NO_MEMORY = 55  # PETSc's number of the error
_STATUS = 1  # MUMPS' INFOG of what went wrong
_MUMPS_MEMORY = {-5, -7, -8, -9, -11, -13, -14, -15, -19}  # too little, or not available
_TEXTS = {"umfpack": "umfpack_", "cholmod": r"CHOLMOD .* with status -[23]\b"}
"""PETSc's messages if a package lacks memory: UMFPACK factorises singular matrices as well, so its
other errors are those of its arguments; statuses of CHOLMOD are out of memory and too large.
"""

DIAGNOSIS = Method("lu", "mumps")
"""Hint about failures of a package without a message of its own: KLU."""


def free_unused_memory() -> None:
    """Return memory to the system that numpy and others have freed, if the C library can.

    Large arrays are allocated from the system, and not from what is free within the process: as
    the factors of a package.
    """
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)


def lacks_memory(factorising: PETSc.PC | None, error: Exception | None) -> bool:
    """Whether a factorisation failed for lack of memory.

    Args:
        factorising: Preconditioner with the factors; PETSc raises no error for MUMPS.
        error: The error that was raised, or ``None``.
    """
    if isinstance(error, MemoryError) or getattr(error, "ierr", None) == _NO_MEMORY:
        return True
    if factorising is None or factorising.getType() not in _FACTORS:
        return False
    package = factorising.getFactorSolverType()
    if package == "mumps":
        return int(factorising.getFactorMatrix().getMumpsInfog(_STATUS)) in _MUMPS_MEMORY
    if error is not None:
        return package in _TEXTS and re.search(_TEXTS[package], str(error)) is not None
    return bool(factorising.getFailedReason() == PETSc.PC.FailedReason.FACTOR_OUTMEMORY)

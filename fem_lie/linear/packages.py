"""Factorisations and the packages that do them, and which are tried one after the other."""

from __future__ import annotations

import re
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
    """A factorisation, and the package that does it.

    Attributes:
        kind: PETSc's name, ``lu`` or ``cholesky``.
        package: PETSc's name of the package.
        spreads: Whether several ranks factorise what is large together.
        together: Whether all ranks solve together by its own means.
        accurate: See :data:`~.equilibrated.ACCURATE`.
        takes_low_rank: Whether it costs less where parts of low rank are not in the pattern.
    """

    kind: str
    package: str
    spreads: ClassVar[bool] = True
    together: ClassVar[bool] = False
    accurate: ClassVar[float] = ACCURATE
    takes_low_rank: ClassVar[bool] = False

    @property
    def symmetric(self) -> bool:
        """Whether it reads one half of the matrix alone."""
        return self.kind == "cholesky"

    def fits(self, kkt: KKT, own: Equilibrated) -> bool:
        """Whether it can factorise these values."""
        return not self.symmetric or own.is_symmetric()

    def negative_pivots(self, pc: PETSc.PC) -> int | None:
        """Those of the last factorisation; ``None`` if nobody knows."""
        if pc.getType() != PETSc.PC.Type.CHOLESKY:
            return None
        if pc.getFactorSolverType() != "mumps":
            return 0  # others exist for positive definite matrices only
        return int(pc.getFactorMatrix().getMumpsInfog(NEGATIVE))

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """Make it what ``pc`` does with the equilibrated copy ``own`` of ``kkt``."""
        pc.setType(self.kind)
        pc.setFactorSolverType(self.package)

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """What of ``pc`` has the factors of the package, if there are any."""
        return pc


class Alone(Method):
    """One that takes a rank less time by itself than MUMPS on several, as there is little fill."""

    spreads: ClassVar[bool] = False


class ByChains(Alone):
    """Chains of nodes are eliminated first, see :mod:`fem_lie.linear.condensed`."""

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """See the base class."""
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(Condensed(kkt, own, self.package))

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """See the base class."""
        return pc.getPythonContext().factorising


class BySchurComplement(Alone):
    """All but a narrow border is positive definite, see :mod:`fem_lie.linear.condensed.schur`."""

    takes_low_rank: ClassVar[bool] = True

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """See the base class."""
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(SchurComplement(kkt, own, self.package))

    @property
    def symmetric(self) -> bool:
        """See the base class: the border need not be."""
        return False

    def fits(self, kkt: KKT, own: Equilibrated) -> bool:
        """See the base class."""
        return dense_rows_of(own, 6 * (len(kkt.indptr) - 1)) is not None

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """See the base class."""
        return pc.getPythonContext().factorising

    def negative_pivots(self, pc: PETSc.PC) -> int | None:
        """See the base class."""
        return pc.getPythonContext().negative_pivots()


class Domains(Alone):
    """Each rank has a subdomain, whose interface is solved for; see :mod:`fem_lie.linear.domains`.

    ``kind`` and ``package`` are a name of :data:`~fem_lie.linear.domains.interface.WAYS`.
    """

    together: ClassVar[bool] = True
    accurate: ClassVar[float] = 1e-6

    def put(self, pc: PETSc.PC, kkt: KKT, own: Equilibrated) -> None:
        """See the base class."""
        if kkt.part is None:
            kkt.share_among_ranks()
        assert kkt.part is not None
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(Interface(kkt.part, own, pc.getOptionsPrefix() or "", self.kind))

    def factorising(self, pc: PETSc.PC) -> PETSc.PC | None:
        """See the base class; subdomains say themselves what they lack."""
        return None


DEFAULTS: dict[str, dict[str, object]] = {
    # indefinite matrices are no news; without fill it would factorise them as L D Lᵀ, unnoticed
    "cholmod": {"mat_cholmod_print": 0, "mat_cholmod_factor": "supernodal"},
    # joints leave zeros on the diagonal, for which umfpack takes nets for unsymmetric; with its own
    # tolerance of 0.1 it leaves their order for pivots that are larger, and twice as much fill
    "umfpack": {"mat_umfpack_strategy": "SYMMETRIC", "mat_umfpack_pivot_tolerance": 0.01},
}
"""PETSc's options of packages, unless they are given."""

RESCUES: tuple[Method, ...] = (Method("lu", "mumps"), Method("lu", "superlu"))
"""What comes after the methods of a scene where their solutions are not accurate."""

ON_RANKS = ("mumps",)
"""Packages that factorise on several ranks together."""

NEGATIVE = 12
"""MUMPS' INFOG of the number of negative pivots."""

_FACTORS = PETSc.PC.Type.LU, PETSc.PC.Type.CHOLESKY
_NO_MEMORY = 55  # PETSc's number of the error
_STATUS = 1  # MUMPS' INFOG of what went wrong
_MUMPS_MEMORY = {-5, -7, -8, -9, -11, -13, -14, -15, -19}  # too little, or not to be had
_TEXTS = {"umfpack": "umfpack_", "cholmod": r"CHOLMOD .* with status -[23]\b"}
"""What PETSc says where a package lacks memory: umfpack factorises singular matrices, too, and
other errors are those of its arguments; statuses of cholmod are out of memory and too large."""

DIAGNOSIS = Method("lu", "mumps")
"""What says why a package failed that does not say it itself: KLU."""


def lacks_memory(factorising: PETSc.PC | None, error: Exception | None) -> bool:
    """Whether a factorisation failed for want of memory.

    Args:
        factorising: Has the factors; PETSc itself raises nothing for MUMPS.
        error: What was raised, if anything.
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

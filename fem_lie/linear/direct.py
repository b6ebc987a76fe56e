"""Direct solution with a stored factorisation, by PETSc."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from time import process_time
from typing import TYPE_CHECKING, Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array
from fem_lie._compat import errors_of_callbacks
from fem_lie._state import part_of
from fem_lie.linear.choice import SMALL, Choice, SkewPart, Solutions, choose
from fem_lie.linear.equilibrated import (
    BackwardError,
    Equilibrated,
    InaccurateSolutionError,
    SingularMatrixError,
)
from fem_lie.linear.factors import Solution, addresses
from fem_lie.linear.low_rank import Columns
from fem_lie.linear.packages import (
    DIAGNOSIS,
    ON_RANKS,
    RESCUES,
    Method,
    free_unused_memory,
    lacks_memory,
)
from fem_lie.ranks.divided_matrix import DividedMatrix
from fem_lie.ranks.shared_factors import FROM, SharedMatrix, Subdomains, shared

if TYPE_CHECKING:
    from fem_lie.linear.redundancy import IdleMultipliers
    from fem_lie.linear.saddle_point import KKT

_log = logging.getLogger(__name__)


class ConvergenceError(RuntimeError):
    """An iteration did not converge; the message says where, how far it came, and what to try.

    Attributes:
        result: Results up to there, or ``None``.
    """

    def __init__(self, message: str, result: Any = None) -> None:
        """Store the results with the message."""
        super().__init__(message)
        self.result = result


_LONG, _FAR = 0.1, 4.0
"""Seconds, and ratio to the expected seconds, beyond which another method is tried."""

MOST_REFINED = 3
"""Largest number of refinements of a solution before another method is tried."""


class DirectSolver:
    """Factorise once, solve many times.

    The matrix is equilibrated with the length, mass and time of the scene, and the first solution
    with each factorisation is checked. If its residual is larger than round-off, it is refined up
    to :data:`MOST_REFINED` times, and later solutions with these factors as often. If that does not
    help, the next method is tried.

    On several ranks MUMPS factorises the sum of the matrices of all parts of a divided scene, see
    :mod:`fem_lie.ranks.divided_matrix`, after each rank has eliminated the chains of its part. If
    the scene is not divided it factorises large matrices on all ranks, see
    :mod:`fem_lie.ranks.shared_factors`; each rank fills the matrix and has the solution.

    Any other direct solver of PETSc can be chosen at run time with
    ``-<prefix>pc_factor_mat_solver_type``.

    Attributes:
        factorisations: Number of factorisations, without ``refreshes`` for new constraints only.
        right_hand_side: Right-hand side of :meth:`solve`; ``solution``: its result.
        columns: Solutions for the low-rank correction of the matrix.
    """

    def __init__(
        self,
        kkt: KKT,
        prefix: str,
        methods: Sequence[Method] = (),
        *,
        solutions: Solutions = Solutions.MANY,
        skew_part: SkewPart = SkewPart.KEPT,
    ) -> None:
        """Store the matrix without factorising it.

        Args:
            kkt: The matrix; its values change between factorisations.
            prefix: Prefix of the PETSc options.
            methods: Methods in the order in which they are tried; default: those of
                :func:`~.choice.choose`.
            solutions: Number of solutions per factorisation.
            skew_part: What happens to the skew-symmetric part of the matrix.
        """
        self._kkt, self._prefix = kkt, prefix
        # whatever the package, as that depends on the number of ranks and results must not
        self._drops = skew_part == SkewPart.DROPPED_IF_SMALL and kkt.size > SMALL
        choice = Choice(tuple(methods)) if methods else choose(kkt, prefix, solutions)
        self._methods, self._expected = choice
        self._own = Equilibrated(kkt)
        first = self._methods[0]
        size, self._divided = len(kkt.units), kkt.shared.several
        several = not first.together and not self._divided
        self._shares = several and shared(size, prefix, spreads=first.spreads)
        self._rescues = RESCUES
        if self._shares or self._divided:
            if self._shares or methods:
                kinds = dict.fromkeys(method.kind for method in self._methods)
                self._methods = tuple(Method(kind, "mumps") for kind in kinds)
            self._rescues = tuple(method for method in RESCUES if method.package in ON_RANKS)
        others = (each for each in self._rescues if each not in self._methods)
        self._order = (*self._methods, *others)
        self._take_over()
        self._ksp = self._solver(self._methods[0])
        self.factorisations = self.refreshes = 0
        self._idle: IdleMultipliers | None = None
        self.columns = Columns()
        self._checked, self._refines, self._iterable = False, 0, False
        self._by_call: Solution | None = None
        self.right_hand_side, self.solution = np.zeros(size), np.zeros(size)

    def take_low_rank(self) -> None:
        """Treat the low-rank part separately from the next matrix on, if a method supports it."""
        self._kkt.splits = self._methods[0].takes_low_rank

    def _take_over(self) -> None:
        """Copy the current matrix, for which there are no solvers yet."""
        self._local = self._own.matrix
        self._scaled, self._found, self._left = np.zeros((3, len(self._own.left)))
        self._b, self._x, self._r = (
            PETSc.Vec().createWithArray(array, comm=PETSc.COMM_SELF)
            for array in (self._scaled, self._found, self._left)
        )
        self._change = self._local.createVecRight()
        self._shared: SharedMatrix | DividedMatrix | None = None
        self._solvers: dict[Method, PETSc.KSP] = {}

    def _of_all_ranks(self, method: Method) -> SharedMatrix | DividedMatrix | None:
        """Matrix of all ranks that a method factorises, or ``None`` if it is that of this rank."""
        if method.together or not (self._shares or self._divided):
            return None
        if self._shared is None and self._shares:
            self._shared = SharedMatrix(self._own.csr)
        elif self._shared is None:
            self._shared = DividedMatrix(self._own.csr, self._kkt.shared)
        return self._shared

    def _matrix(self, method: Method) -> PETSc.Mat:
        """Matrix that a method factorises."""
        found = self._of_all_ranks(method)
        return self._local if found is None else found.matrix

    def factorise(self) -> None:
        """Factorise the current matrix.

        Raises:
            SingularMatrixError: It cannot be factorised.
            MemoryError: There is not enough memory for the factors.
        """
        # packages that met NaN or infinity fail on all later matrices
        self._own.take()
        if self._kkt.shared.any(self._own.matrix is not self._local):
            self._take_over()
        if self._drops:
            self._own.drop_skew_part()
        if self._shared is not None:
            self._shared.take()
        self._idle = self._own.idle()
        if not self.factorisations and self._kkt.size > FROM:
            free_unused_memory()
        self._set_up()
        self.factorisations += 1

    def _set_up(self) -> None:
        """Factorise by the first method that fits the values and succeeds."""
        self._checked, self._refines, self._iterable, self._by_call = False, 0, False, None
        self.columns.forget()
        failure: Exception | None = None
        for tried, method in enumerate(self._methods):
            if not method.fits(self._kkt, self._own):
                continue
            expected, self._expected = self._expected, None
            # some systems take as long to read the clock as to solve a small scene
            began = 0.0 if expected is None else process_time()
            failure = self._failure(method)
            if failure is None:
                # a method that failed would fail again, and each failure costs a factorisation
                self._methods, self._ksp = self._methods[tried:], self._solver(method)
                if expected is not None:
                    self._notice(process_time() - began, expected)
                return
            self._expected = expected
        if failure is None:  # none of them fits
            self._methods = self._rescues
            self._set_up()
            return
        if self._methods[-1].package == "klu":
            failure = self._failure(DIAGNOSIS) or failure
        if isinstance(failure, MemoryError):
            raise failure
        raise SingularMatrixError("the matrix is singular") from failure

    def _notice(self, seconds: float, expected: float) -> None:
        """Log the time of the first factorisation; try another method next if it is too long."""
        package, others = self._methods[0].package, self._methods[1:]
        _log.info("%s: %.2g s of processor for the first factors", package, seconds)
        if others and seconds > max(_LONG, _FAR * expected):
            _log.info("that is far above %.2g s, so from now on %s", expected, others[0].package)
            self._methods = others
            self._set_up()

    def _failure(self, method: Method) -> Exception | None:
        """Factorise by a method; return the reason of a failure, or ``None``."""
        ksp, matrix, raised = self._solver(method), self._matrix(method), None
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, method.symmetric)
        ksp.setOperators(matrix)
        try:
            with method.options(self._prefix), errors_of_callbacks():
                ksp.setUp()
        except (PETSc.Error, ArithmeticError, MemoryError) as error:
            raised = error
        failure: Exception | None = raised
        factorising = method.factorising(ksp.getPC())
        if failure is None and factorising is not None and factorising.getFailedReason():
            # PETSc raises no error for a zero pivot in MUMPS
            failure = ArithmeticError("the matrix has a zero pivot")
        if lacks_memory(factorising, raised):
            failure = MemoryError(
                f"not enough memory to factorise the matrix of {len(self._own.left)} unknowns by "
                f"{method.package}: give the process more, or the scene fewer elements"
            )
            failure.__cause__ = raised
        if failure is not None:
            _log.info("%s cannot factorise the matrix: %s", method, failure)
            # a failed factorisation is not used again
            del self._solvers[method]
        return failure

    def refresh(self) -> None:
        """Factorise because the constraints have changed; errors as :meth:`factorise`."""
        self.factorise()
        self.factorisations -= 1
        self.refreshes += 1

    def saved_state(self) -> dict[str, Array]:
        """State for a checkpoint: methods, refinements and counts."""
        tried = self._order.index(self._methods[0])
        own: dict[str, Any] = {
            "method": np.array([tried, self._refines, self._iterable, self._checked]),
            "counts": np.array([self.factorisations, self.refreshes]),
        }
        return own | {f"columns.{name}": part for name, part in self.columns.saved_state().items()}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Factorise the current matrix and solve as when :meth:`saved_state` was called.

        Args:
            kept: State that was copied before.

        Raises:
            SingularMatrixError: It cannot be factorised.
            MemoryError: There is not enough memory for the factors.
        """
        tried, refines, iterable, checked = (int(x) for x in kept["method"])
        self._methods, self._expected = self._order[tried:], None
        self.factorise()
        self._refines, self._iterable, self._checked = refines, bool(iterable), bool(checked)
        self.factorisations, self.refreshes = (int(x) for x in kept["counts"])
        self.columns.restore(part_of(kept, "columns"))

    def _solver(self, method: Method) -> PETSc.KSP:
        """PETSc's solver for a method, created when it is first needed."""
        if method not in self._solvers:
            matrix = self._matrix(method)
            ksp = PETSc.KSP().create(matrix.comm)
            ksp.setOptionsPrefix(self._prefix)
            ksp.setOperators(matrix)
            ksp.setType(PETSc.KSP.Type.PREONLY)
            method.put(ksp.getPC(), self._kkt, self._own)
            with method.options(self._prefix):
                ksp.setFromOptions()
            self._solvers[method] = ksp
        return self._solvers[method]

    @property
    def subdomains(self) -> Subdomains | None:
        """Statistics of subdomains, or ``None``."""
        return None if self._kkt.part is None else self._kkt.part.statistics

    def negative_pivots(self) -> int | None:
        """Negative pivots of the last factorisation; ``None`` if the matrix is not symmetric."""
        found = self._methods[0].negative_pivots(self._ksp.getPC())
        return None if found is None else found - self._own.rank

    def times(self, x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Product of the factorised matrix with ``x``, shape (n,).

        Args:
            x: Vector, shape (n,).
        """
        own, n = self._own, len(x)
        given, product = self._local.createVecs()
        given.set(0.0)
        given.array[:n] = x / own.right[:n]
        self._local.mult(given, product)
        found = np.asarray(product.array / own.left, dtype=np.float64)[:n]
        if own.part is not None:
            found += own.part.times(x)
        self._kkt.shared.sum(found[: self._kkt.held.size].reshape(-1, 6))
        return found

    def solve(self) -> None:
        """Solve with the last factorisation and the low-rank correction of the matrix.

        Raises:
            InaccurateSolutionError: No method reaches :data:`~.equilibrated.ACCURATE`.
        """
        self._solve_by(self._solve_for)

    def correct(self) -> None:
        """:meth:`solve` for a correction of an iteration, refined only if it is not iterable.

        Raises:
            InaccurateSolutionError: No method reaches :data:`~.equilibrated.ACCURATE`.
        """
        self._solve_by(self._solve_roughly if self._iterable else self._solve_for)

    def _solve_by(self, solve: Callable[[Array, Array], None]) -> None:
        solve(self.right_hand_side, self.solution)
        if self._kkt.correction is not None:
            self.columns.correct(self._kkt.correction, self._solve_for, self.solution)

    def _solve_for(self, b: Array, x: Array) -> None:
        """Solve with the last factorisation, into ``x``."""
        self._solve_roughly(b, x, self._refines)

    def _solve_roughly(self, b: Array, x: Array, refinements: int = 0) -> None:
        """Solve with the last factorisation and some refinements, into ``x``."""
        n = len(b)
        np.multiply(b, self._own.left[:n], self._scaled[:n])
        self._solve_scaled(self._b, self._x)
        for _ in range(refinements):
            self._refine()
        if not self._checked:
            self._check()
        if self._idle is not None:
            multipliers = self._found[n - len(self._kkt.measure) : n]
            multipliers[:] = self._idle.remove(multipliers)
        np.multiply(self._found[:n], self._own.right[:n], x)

    def _solve_scaled(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve the equilibrated equations with the last factors."""
        matrix = self._of_all_ranks(self._methods[0])
        with errors_of_callbacks():
            if matrix is None:
                self._ksp.solve(b, x)
            else:
                matrix.solve(self._ksp, b.array, x.array)

    @property
    def by_call(self) -> Solution:
        """:meth:`correct` with the last factorisation for compiled loops.

        It is unavailable before the first solution, which is checked, and if corrections are
        refined or the matrix has a low-rank correction.
        """
        if self._kkt.correction is not None:
            return Solution.none()
        if self._by_call is None:
            alone = not self._shares and not self._divided
            kept = self._checked and self._idle is None and alone
            if (self._refines and not self._iterable) or not kept:
                return Solution.none()
            call = addresses(self._ksp, self._b, self._x)
            scales = self._own.left, self._own.right
            self._by_call = Solution(call, *scales, self._scaled, self._found)
        return self._by_call

    def _check(self) -> None:
        """Check the accuracy of a solution."""
        error = self._refined()
        listed = (*self._methods, *(each for each in self._rescues if each not in self._methods))
        others = (each for each in listed[1:] if each.fits(self._kkt, self._own))
        while error > self._methods[0].accurate:
            _log.info("%s: residual %.1e", self._methods[0].package, error)
            method = next(others, None)
            if method is None:
                raise InaccurateSolutionError(
                    f"no solver reached an accurate solution: the residual is {error:.1e} of its "
                    "terms; the constraints or the stiffness may be nearly singular here"
                )
            self._methods = (method,)
            self._set_up()
            self._solve_scaled(self._b, self._x)
            error = self._refined()
        if self._refines:
            times, package = self._refines, self._methods[0].package
            _log.info("solutions by %s are refined %d times each", package, times)
        self._checked = True

    def _refined(self) -> float:
        """Refine a solution as often as necessary; return its error."""
        found = self._error()
        self._iterable, error = found.iterable, found.of_terms
        while error > self._methods[0].accurate and self._refines < MOST_REFINED:
            self._refine()
            error = self._error().of_terms
            self._refines += 1
        return error

    def _error(self) -> BackwardError:
        return self._own.backward_error(self._scaled, self._found, self._left)

    def _refine(self) -> None:
        """Solve for the residual once."""
        self._error()
        self._solve_scaled(self._r, self._change)
        self._found += self._change.array

"""Steps of a scene that is divided among ranks: what compiled steps ask of all ranks together.

Each rank makes the steps of its part, see :mod:`fem_lie.solve.conserving.step.ranks`. All ranks
factorise and solve the sum of their matrices, and add up residuals at the nodes that they share.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit.call_back import CalledBack
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors
from fem_lie.solve.conserving.step.records import (
    ERROR,
    LARGEST,
    SOLVE,
    SUM,
    TOTAL,
    TURNINGS,
    Model,
    Solution,
    Step,
)
from fem_lie.system.equations import Equations


class AllRanks:
    """Callbacks of compiled steps; all of them are collective.

    Attributes:
        solver: Solver of all ranks together.
    """

    def __init__(self, equations: Equations, model: Model, this: Step, prefix: str) -> None:
        """Set up on all ranks together, without computing anything.

        Args:
            equations: Equations of the part of this rank.
            model: Constant arrays of the part.
            this: The step.
            prefix: Prefix of PETSc's options.
        """
        self._shared, self._addresses, self._this = equations.shared, model.addresses, this
        self._matrix, self._prefix, self._factor = equations.matrix, prefix, 1.0
        self.solver = DirectSolver(equations.matrix, prefix)
        actions = {
            SUM: self._sum,
            TURNINGS: self._sum_turnings,
            LARGEST: self._find_largest,
            TOTAL: self._add_up,
            SOLVE: self._solve,
        }
        self._callbacks = {at: CalledBack(act, self._failed) for at, act in actions.items()}
        for at, callback in self._callbacks.items():
            self._addresses[at] = callback.address

    def factorise(self) -> Factors:
        """Factorise the sum of the matrices of all ranks; this rank has no factors of its own.

        Raises:
            SingularMatrixError: It is singular; on all ranks.
        """
        self.solver.factorise()
        return Factors.none()

    def use(self, solver: DirectSolver | None, factor: float = 1.0) -> None:
        """Solve with another solver from now on.

        Args:
            solver: The solver, with or without factors; ``None``: a new one without.
            factor: Factor of its solutions.
        """
        self.solver = DirectSolver(self._matrix, self._prefix) if solver is None else solver
        self._factor = factor

    def solution(self, r: Array) -> Array:
        """Solution with the present factors, without the factor of :meth:`use`.

        Args:
            r: Right-hand side, the sum of all ranks at shared nodes, shape (size,).
        """
        self.solver.right_hand_side[:] = r
        self.solver.solve()
        return self.solver.solution

    def check(self) -> None:
        """Raise the error of a callback, if there was one."""
        for callback in self._callbacks.values():
            callback.check()

    def _failed(self) -> None:
        self._addresses[ERROR] = 1

    def _sum(self) -> None:
        self._sum_nodes(Solution(*self._this.r).residual)

    def _sum_turnings(self) -> None:
        for forces in self._this.turnings[0]:
            self._sum_nodes(forces)

    def _sum_nodes(self, forces: Array) -> None:
        """Sum of the forces of all ranks on the nodes, the first of (≥ 6 n,)."""
        self._shared.sum(forces[: 6 * len(self._shared.owned)].reshape(-1, 6))

    def _find_largest(self) -> None:
        common = self._this.common
        common[0] = self._shared.largest(float(common[0]))

    def _add_up(self) -> None:
        common = self._this.common
        common[:] = self._shared.total(common)

    def _solve(self) -> None:
        work = Solution(*self._this.r).work
        try:
            work[:] = self._factor * self.solution(work)
        except SingularMatrixError:
            work[:] = float("nan")  # the step fails

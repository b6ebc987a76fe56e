"""Factorisations of the iteration matrix for several step sizes, used for other steps as well.

The matrix is about ``m M + K`` with ``m ∝ 1/h²``. Without stiffness the matrix of another step is
the same up to a factor, so that any stored factorisation serves any step. With stiffness the
eigenvalues of one matrix relative to the other lie between 1 and the ratio of the two ``m``; with
the best scale factor for that interval the iteration contracts by ``|1 − f|/(1 + f)``, a third for
a step √2 times as large or small. To the policy this looks like the cost of an old matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.factors import Solution

Kept = TypeVar("Kept")

MOST = 4
"""Number of step sizes whose factorisations are stored at the same time."""

REACH = 2.1
"""Largest ratio of two ``m`` for which the matrix of a stiff scene serves the other step."""


@dataclass(eq=False)
class _Slot(Generic[Kept]):
    kept: Kept
    mass: float
    scale: Array
    age: int


class Levels(Generic[Kept]):
    """Selection among factorisations for several step sizes.

    Attributes:
        rigid: Whether no body of the scene is elastic.
        factor: Factor of a solution for the current step.
        count: Number of factorisations.
    """

    def __init__(self, *, rigid: bool) -> None:
        """Start without factorisations; ``rigid``: whether no body of the scene is elastic."""
        self.rigid = rigid
        self._slots: list[_Slot[Kept]] = []
        self._now: _Slot[Kept] | None = None
        self._wanted, self.count = 1.0, 0
        self.factor = 1.0

    @property
    def present(self) -> Kept | None:
        """The factorisation that serves the current step, or ``None``."""
        return None if self._now is None else self._now.kept

    @property
    def mass(self) -> float:
        """``m`` of the factorisation that serves the current step."""
        assert self._now is not None
        return self._now.mass

    def use(self, mass: float) -> None:
        """Select for a step with ``m = mass``."""
        self._wanted = mass
        near = [slot for slot in self._slots if _near(slot.mass, mass)]
        reach = np.inf if self.rigid else REACH
        if self.rigid:  # all are equally good: the newest
            near = self._slots
        near = near or [s for s in self._slots if 1 / reach < s.mass / mass < reach]
        self._now = max(near, key=lambda slot: slot.age) if near else None
        if self._now is not None:
            f = self._now.mass / mass
            self.factor = f if self.rigid else 2.0 * f / (1.0 + f)

    def scale(self) -> Array:
        """Scale factors of the constraints for residuals."""
        assert self._now is not None
        return np.asarray(self._now.scale / self.factor)

    def release(self) -> Kept | None:
        """Delete the factorisation that the next one replaces: of this level, or the oldest."""
        old = [slot for slot in self._slots if _near(slot.mass, self._wanted)]
        if not old and len(self._slots) == MOST:
            old = [min(self._slots, key=lambda slot: slot.age)]
        if not old:
            return None
        self._slots = [other for other in self._slots if other is not old[0]]
        return old[0].kept

    def keep(self, kept: Kept, scale: Array) -> None:
        """Store a factorisation for this step; its constraints are times ``scale``."""
        self.count += 1
        self._now, self.factor = _Slot(kept, self._wanted, scale.copy(), self.count), 1.0
        self._slots.append(self._now)


class StoredFactors(DirectSolver):
    """Solver with stored factorisations for several step sizes.

    Attributes:
        levels: The selection among them.
    """

    def __init__(self, like: DirectSolver, *, rigid: bool) -> None:
        """Start without factorisations.

        Args:
            like: A solver for the same matrix.
            rigid: Whether no body of the scene is elastic.
        """
        self._args = like._kkt, like._prefix, like._methods
        super().__init__(*self._args)
        self.levels = Levels[DirectSolver](rigid=rigid)

    @property
    def usable(self) -> bool:
        """Whether a factorisation serves the current step."""
        return self.levels.present is not None

    def keep(self, scale: Array) -> None:
        """Factorise the current matrix, with constraints times ``scale``, for this step.

        Raises:
            SingularMatrixError: It cannot be factorised.
        """
        solver = self.levels.release() or DirectSolver(*self._args)
        solver.factorise()
        self.factorisations += 1
        self.levels.keep(solver, scale)

    def solve(self) -> None:
        """Solve with the selected factorisation, not yet scaled by ``levels.factor``."""
        self._solve_with(DirectSolver.solve)

    def correct(self) -> None:
        """Correction with the selected factorisation, not yet scaled."""
        self._solve_with(DirectSolver.correct)

    def _solve_with(self, solve: Callable[[DirectSolver], None]) -> None:
        solver = self.levels.present
        assert solver is not None
        solver.right_hand_side[:] = self.right_hand_side
        solve(solver)
        self.solution[:] = solver.solution

    @property
    def by_call(self) -> Solution:
        """:meth:`correct` with the last factorisation for compiled loops, not yet scaled."""
        solver = self.levels.present
        return Solution.none() if solver is None else solver.by_call

    def times(self, x: Array) -> Array:
        """Product of the selected matrix with ``x``."""
        assert self.levels.present is not None
        return self.levels.present.times(x)

    def forget(self) -> None:
        """Delete all factorisations."""
        self.levels = Levels[DirectSolver](rigid=self.levels.rigid)

    def saved_state(self) -> dict[str, Array]:
        """Number of factorisations; the factors themselves are not in checkpoints."""
        return {"made": np.array(self.factorisations)}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state of :meth:`saved_state`, without factorisations."""
        self.forget()
        self.factorisations = int(kept["made"])


def _near(a: float, b: float) -> bool:
    """Whether two step sizes, given by their ``m``, are on the same level."""
    return bool(abs(np.log2(a / b)) < 0.1)

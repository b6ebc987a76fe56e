"""Domain of explicit steps.

Forces of joints with other domains are constant over a whole step, as those on domains of
energy-momentum steps, so that what one side gains the other one loses, whatever the schemes are.
They add inertia to nodes and no stiffness: steps that are stable for this domain on its own remain
so (tests/test_mixed_steps.py has a wave at 0.8 of the largest).
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import ChangingArrays, attributes, put_back, saved
from fem_lie.bodies.balances import BY_LOADS, BY_REACTIONS, WORK
from fem_lie.lie.node_types import push_all_forward
from fem_lie.solve.explicit import nodes
from fem_lie.solve.explicit.explicit import Explicit, ExplicitRun, stable_masses
from fem_lie.solve.motion.integrator import refuse
from fem_lie.system.equations import Equations

_ARRAYS = "H", "p", "r", "reaction", "progress", "balance"
_OTHERS = "equations_state", "_joints"
"""State that a step changes: arrays that stay the same objects, and all else."""


class ExplicitDomain(ExplicitRun):
    """Domain with explicit steps, see :class:`~fem_lie.solve.multirate.domain.Domain`."""

    STATE = attributes("h", "_decay")

    def __init__(
        self, scheme: Explicit, equations: Equations, whole: float, count: int, rows: Indices
    ) -> None:
        """Set up without computing anything.

        Args:
            scheme: The scheme.
            equations: Equations of the bodies and their connections.
            whole: Size of a whole step.
            count: Number of steps in it.
            rows: Indices of moving nodes among those of the scene.

        Raises:
            ValueError: Steps are not stable, or contacts have friction.
        """
        friction = any(term.path for term in equations.arrays.terms)
        refuse("MultiRate", {"friction of contacts in explicit steps": friction}, "Explicit")
        super().__init__(equations, whole / count, *stable_masses(equations, whole, count))
        self.count, self.rows = count, rows
        self._lasting = equations.arrays.conservative.copy()
        self._changing_state = ChangingArrays(self, _ARRAYS)
        self.begin()

    def begin(self) -> None:
        """Save the current state: whole steps start from it until the next call."""
        if self._convects_axes:
            self._convect_axes()
        self._before, self._first = self._changing_state.saved_state(), self.index
        self._others = saved(self, _OTHERS)

    def go_back(self) -> None:
        """Restore the saved state."""
        self._changing_state.restore(self._before)
        put_back(self, _OTHERS, self._others)

    def go(self, forces: Array, start: float) -> bool:
        """Make a whole step from the saved state; return whether all numbers are finite."""
        self.go_back()
        acting = forces[self.rows]
        # of a potential: their work is added here, exactly
        self.equations.arrays.conservative[:] = self._lasting + acting
        self.equations.prescribed(start).act()
        self.began = start - self._first * self.h
        self._begin(start)
        last = self._first + self.count
        while self.index < last:
            if not self._go_towards(last):
                return False
        self._account_for(acting)
        return True

    def _account_for(self, acting: Array) -> None:
        """Add the work and the impulses of constant forces over a whole step to the balance."""
        total, on = self.balance.total, np.flatnonzero(acting.any(axis=(1, 2)))
        acting, before, now = acting[on], self.before[on], self.now[on]
        total[WORK] += np.sum(acting * (now - before))
        if self.balance.looks[0]:
            return  # impulses are those of all dead loads
        moments = np.cross(0.5 * (before + now), acting)
        resultant = np.concatenate([acting[:, 0].sum(axis=0), moments.sum(axis=(0, 1))])
        total[BY_LOADS:BY_REACTIONS] += self.count * self.h * resultant

    def resize_whole(self, size: float) -> None:
        """Set the state as the start of a whole step of another size."""
        ratio = size / (self.count * self.h)
        self.h *= ratio
        self._decay **= ratio

    # --- the current state ---

    @property
    def now(self) -> Array:
        """Frames of the current state, (n, 4, 3)."""
        return self.H[: self._n]

    @property
    def before(self) -> Array:
        """Frames of the saved state, (n, 4, 3)."""
        return self._before["H"][: self._n]

    @property
    def rates(self) -> Array:
        """Rates of (x, d₁, d₂, d₃), (n, 4, 3)."""
        found = np.empty((self._n, 4, 3))
        push_all_forward(self.masses.kinds, self.H, self.twists, found)
        return found

    @property
    def twists(self) -> Array:
        """Velocities along the axes of the nodes, (n, 6)."""
        nodes.twists((*self.masses,), self.H, self.p, self.v)
        return self.v

    @property
    def so_far(self) -> Array:
        """Energy balance and impulses up to the current state, (15,)."""
        return self.balance.so_far

    @property
    def stored(self) -> float:
        """Stored energy of cells and contacts."""
        return float(self.equations.report(self.H, self.twists).elastic)

    @property
    def matrices(self) -> int:
        """Number of matrices factorised."""
        return 0

"""Steps in which contacts push: by Newton's method, as stiffness comes and goes within a step.

Forces of contacts are found in Python, see :mod:`fem_lie.solve.conserving.between.pushes`, and with
them each iteration has a matrix of its own. A step that begins apart and is predicted to end apart
is made by the compiled loop; if it ends in contact all the same, it is made again.
"""

from __future__ import annotations

import numpy as np

from fem_lie.forms.abilities import Ends
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import solve
from fem_lie.solve.conserving.between.any_node import span_from_python
from fem_lie.solve.conserving.run_state import RunState
from fem_lie.solve.conserving.step import acceptance, corrections, nodes
from fem_lie.solve.conserving.step.balance import packed_residual
from fem_lie.solve.conserving.step.dissipation import LEAK
from fem_lie.solve.conserving.step.records import Span, solution_of

_NOISE = {1e-15: 1, 1e-9: 8}
"""Increments, in lengths of the model, that are round-off after so many that fell no more."""
_FALLS = 0.8
"""Increments above this part of one before are no progress."""
_TURNS = 3
"""Increments that fell no more, after which half of a correction is made."""
_MOST = 0.05
"""Increments of one iteration, in lengths of the model: beyond, a contact is another one."""


class Touching(RunState):
    """How steps are made in which something pushes."""

    def _pushes_ahead(self) -> bool:
        """Whether anything pushes at the start of the step or at its end as it is now."""
        self._push()
        return bool(self.this.pushed.any())

    def _push(self) -> None:
        # cells take back by themselves what round-off has brought in
        leak = 0.0 if len(self.s.W) else float(self.s.lag[LEAK])
        s, this, along = self.s, self.this, Span(*self.this.rows)
        rows = along.delta, along.mean, along.end, along.middle
        span_from_python(self._kinds, s.H, this.step, rows)
        ends = Ends(s.H, along.end, along.mean, along.delta)
        self._pushes.set(ends, leak, this.pushed)

    def _part(self) -> None:
        """Nothing pushes."""
        self.this.pushed[:] = 0.0
        self._pushes.energy = 0.0

    def _touch(self, limit: int) -> bool:
        """Make the step that has begun, with pushes; whether it converges."""
        counters, numbers, packed, this = self.counters, self.numbers, self._packed, self.this
        tables, least, stalls = (packed.model, packed.state, packed.step), np.inf, 0
        x, work = solution_of(this.r).x, solution_of(this.r).work
        # accelerations of an impact are none of the step after it
        this.step[:] -= self.size**2 * self.s.trend
        numbers[corrections.EXCESS] = np.inf
        for iteration in range(1, limit + 1):
            self._push()
            packed_residual(*tables)
            # the matrix is to be that of the step as it is
            counters[corrections.ITERATION] = 2
            try:
                self._factorise()
            except SingularMatrixError:
                break
            assert self._factors is not None
            solve(self._factors.plain, solution_of(this.r).residual, work, x)
            increment = corrections.size_of(self.model.measure, x)
            numbers[corrections.INCREMENT] = increment
            counters[corrections.TOTAL] += 1
            # from where they last fell: what falls slowly, but steadily, is no round-off
            stalls, least = (0, increment) if increment <= _FALLS * least else (stalls + 1, least)
            settled = (increment < size and stalls >= wait for size, wait in _NOISE.items())
            if increment == 0.0 or any(settled):
                if not self._keep_apart(self.s.H, Span(*this.rows).end):
                    return False
                self._accept_touching(iteration)
                return True
            if not np.isfinite(increment):
                break
            # contacts that stick and slip in turns are met half-way
            x *= min(1.0 if stalls < _TURNS else 0.5, _MOST / max(increment, _MOST))
            nodes.packed_correct(*tables)
        return False

    def _accept_touching(self, iterations: int) -> None:
        counters, packed, pushes = self.counters, self._packed, self._pushes
        acceptance.packed_accept(packed.model, packed.state, packed.step)
        pushes.accept(self.s.H)
        counters[corrections.STEPS] += 1
        counters[corrections.LAST] = iterations
        counters[corrections.ITERATION] = counters[corrections.ASKED] = 0
        self.numbers[corrections.EXCESS] = np.inf

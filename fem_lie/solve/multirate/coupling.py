"""Lagrange multipliers between bodies of different step sizes, by an accelerated fixed point."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import Stateful, attributes
from fem_lie.solve.convergence import constraint_scaling
from fem_lie.solve.multirate.domain import Domain, joined, rows_of
from fem_lie.system.equations import Equations


class Mixed:
    """Anderson acceleration of the fixed point ``x = F(x)``."""

    def __init__(self, depth: int) -> None:
        """Start without guesses.

        Args:
            depth: Number of earlier guesses used.
        """
        self._depth = depth
        self._given: list[Array] = []
        self._found: list[Array] = []

    def next(self, given: Array, found: Array) -> Array:
        """Next guess after ``given``, for which ``F`` gave ``found``, both (k,).

        It is the linear combination of earlier guesses with the smallest residual.
        """
        self._given, self._found = (
            [*kept, new][-self._depth - 1 :]
            for kept, new in ((self._given, given), (self._found, found))
        )
        if len(self._given) < 2:
            return found
        left = found - given
        made = np.diff(np.array(self._found), axis=0).T
        change = made - np.diff(np.array(self._given), axis=0).T
        share = np.linalg.lstsq(change, left, rcond=1e-12)[0]
        return np.asarray(found - made @ share)


_FIRST, _TRIED = 1e-10, 1e-8
"""Displacement, over the length of the model, with which the response to multipliers is computed:
of all mass at first, then that of the joints."""
_SETTLED, _FALLS = 1e-12, 0.5
"""Violations, over the length of the model, that are round-off if their ratio exceeds the second
number."""
_FINE = 5e-15
_DEPTH = 6
"""Number of earlier tries for the next one."""
_UPDATED = 12
"""Number of tries of a step after which the response is recomputed."""
_IN_VAIN = 2 * _UPDATED
"""Number of tries without halving violations after which a step has failed."""


class Coupling(Stateful):
    """Keeps joints between domains closed at the ends of whole steps.

    Attributes:
        multipliers: Lagrange multipliers of the last whole step, and of the one before, (2, m).
        gap: Constraint violations, (m,).
        response: Derivative of the constraints at the end of a whole step by the multipliers, (m,
            m).
        unit: Value of each multiplier with a small effect, (m,).
        tries: Number of tried whole steps.
        found: Number of times that the response was computed.
    """

    STATE = attributes("multipliers", "gap", "response", "unit", "made", "tries", "found")

    def __init__(self, between: Equations, whole: Equations, domains: tuple[Domain, ...]) -> None:
        """Set up without computing anything.

        Args:
            between: Equations of all bodies and the joints between domains.
            whole: Equations of the scene.
            domains: Domains, which contain all moving nodes.
        """
        unknowns, n, m = between.unknowns, whole.unknowns.moving, between.unknowns.m
        pairs = between.arrays.pairs_of_all
        self._joints = between.arrays.joints if pairs is None else pairs.joints
        self._domains, self._kinds = domains, between.arrays.kinds
        self._length, joined_nodes = unknowns.length, np.unique(between.matrix.incidences.nodes)
        self._at, self._ground = rows_of(between, whole), between.start.frames[n:]
        self._touched = self._at[joined_nodes]
        self.multipliers, self.gap = np.zeros((2, m)), np.zeros(m)
        self.response, self.made = np.zeros((m, m)), 0
        self.measure = constraint_scaling(unknowns)
        self.tries, self.found, self.left = 0, 0, np.inf
        self._start = 0.0
        self._mass = float(between.arrays.inertia.blocks[:, 0, 0].sum())
        self._angular, self.unit = unknowns.angular, np.empty(m)
        self._guess_unit(domains[0].h * domains[0].count)
        self._moved, self._forces = np.zeros((n, 4, 3)), np.zeros((n, 4, 3))
        self._change = np.zeros(m)

    def resize(self, size: float) -> None:
        """Change the size of whole steps, and scale the response to multipliers."""
        for domain in self._domains:
            domain.resize_whole(size)
        self.found = self.made = 0
        self._guess_unit(size)

    def _guess_unit(self, size: float) -> None:
        """Value of each multiplier with a small effect in a whole step, if all mass moves."""
        force = self._mass * self._length / size**2
        self.unit[:] = _FIRST * np.where(self._angular, force * self._length, force)

    def step(self, start: float, most: int) -> bool:
        """Make a whole step of all domains; return whether the joints could be kept closed.

        If not, the state is that at its start.

        Args:
            start: Time at its start.
            most: Largest number of tries.
        """
        self._start = start
        for domain in self._domains:
            domain.begin()
        made = self._close(most)
        if not made:
            for domain in self._domains:
                domain.go_back()
        return made

    def _close(self, most: int) -> bool:
        """Repeat whole steps until the joints are closed at their end; return whether they are."""
        for domain in self._domains:
            self._moved[domain.rows] = domain.h * domain.count * domain.rates[: len(domain.rows)]
        λ = (
            2.0 * self.multipliers[0] - self.multipliers[1]
            if self.made > 1
            else self.multipliers[0].copy()
        )
        if not self.found and len(λ) and not self._find_response(λ):
            return False
        previous, learnt = np.inf, Mixed(_DEPTH)
        least, since = np.inf, 0
        for attempt in range(1, most + 1):
            given = self._moved[self._touched]
            wrong = self._try(λ)
            if wrong is None:
                return False
            self.left = float(np.abs(wrong * self.measure).max(initial=0.0))
            at_round_off = self.left <= _SETTLED and self.left > _FALLS * previous
            if at_round_off or self.left <= _FINE:
                self._accept(λ, wrong)
                return True
            least, since = (self.left, 0) if self.left < 0.5 * least else (least, since + 1)
            if since == _IN_VAIN:
                return False
            if attempt % _UPDATED == 0:
                if not self._find_response(λ):
                    return False
                learnt = Mixed(_DEPTH)
                continue
            found = λ - np.linalg.solve(self.response, wrong), self._moved[self._touched]
            λ, self._moved[self._touched] = self._mix(learnt, (λ, given), found)
            previous = self.left
        return False

    def _mix(
        self, learnt: Mixed, given: tuple[Array, Array], found: tuple[Array, Array]
    ) -> tuple[Array, Array]:
        """Multipliers, and motion of the nodes with joints, for the next try."""
        m, length = len(self.unit), self._length
        before, after = (
            np.concatenate([λ / self.unit * _TRIED, moved.ravel() / length])
            for λ, moved in (given, found)
        )
        mixed = learnt.next(before, after)
        return np.asarray(mixed[:m] * self.unit / _TRIED), length * mixed[m:].reshape(-1, 4, 3)

    def _try(self, λ: Array) -> Array | None:
        """Violations at the end of a whole step with multipliers ``λ``, if it converges."""
        H = np.empty((len(self._at) + len(self._ground), 4, 3))
        H[len(self._at) :] = self._ground
        whole = np.empty_like(self._moved)
        for domain in self._domains:
            whole[domain.rows] = domain.before
        H[: len(self._at)] = whole[self._at]
        out, forces = (self._change, np.empty_like(self._forces)), self._forces
        joined(self._kinds, H, self._moved[self._at], self._joints, λ, (out[0], out[1]))
        forces[self._at] = out[1]
        for domain in self._domains:
            if not domain.go(forces, self._start):
                return None
            self._moved[domain.rows] = domain.now - domain.before
        self.tries += 1
        joined(self._kinds, H, self._moved[self._at], self._joints, λ, (out[0], out[1]))
        return np.asarray(self.gap + self._change)

    def _find_response(self, λ: Array) -> bool:
        """Compute the response by a step for each multiplier.

        Return whether all steps converged.
        """
        first, columns = self._try(λ), []
        for c, size in enumerate(self.unit):
            tried = λ.copy()
            tried[c] += size
            wrong = self._try(tried)
            if first is None or wrong is None:
                return False
            columns.append((wrong - first) / size)
        response = np.column_stack(columns)
        moved = np.abs(response * self.measure[:, np.newaxis]).max(axis=0)
        if not (np.isfinite(moved) & (moved > 0.0)).all():
            return False
        self.response[:], self.found = response, self.found + 1
        self.unit[:] = _TRIED / moved
        return True

    def _accept(self, λ: Array, wrong: Array) -> None:
        self.multipliers[1], self.multipliers[0], self.gap[:] = self.multipliers[0], λ, wrong
        self.made += 1

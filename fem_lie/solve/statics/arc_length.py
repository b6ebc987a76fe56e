"""Load-capped arc length: load control where a structure is stiff, arc length where it is soft.

The unknowns are the increment of a step and the load factor λ; a step ends on the requested load,
or at a distance Δs from its start, whichever comes first::

    min(λ_cap − λ, Δs − |Δu|) = 0            |Δu| = rms of the nodal translations of the step

Elastic statics does not need exact equilibrium between the requested loads: intermediate steps end
when the increments are small against the step, and only the requested states are polished. With
linearised stress updates this takes a dozen linear solutions for shells that bend through half
their radius.

λ is eliminated as by Riks (Int. J. Solids Struct. 15 (1979) 529), with the constraint linearised at
each iterate.

The forward direction is determined by the twists of the last step, in the nodes' own axes: the end
of a beam that is rolled up moves in circles, and its displacements in two steps may have any angle,
while its twist is constant. A path that goes down along earlier states is abandoned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, Protocol, TypeAlias

import numpy as np

from fem_lie._arrays import Array, numbers
from fem_lie.bodies.model import FoldedElementError
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.joints.connection import LostBranchError
from fem_lie.linear.direct import ConvergenceError
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.progress_bars import load_bar
from fem_lie.solve.refactorisation import Refactorisation

_AGAINST = 0.9  # cosine between the twists of a step and of a reversed one

_KNOWN = 3  # successive steps along known states

_NEAR = 0.05  # over the distance from the turning point of the path


Dot: TypeAlias = Callable[[Array, Array], float]
"""Inner product of two arrays with a row for each node."""


def plain_dot(a: Array, b: Array) -> float:
    """Inner product of two arrays of one shape."""
    return float(np.sum(a * b))


class Passed:
    """Earlier states of a path, and whether it passes them again.

    Beyond a limit point a path goes down, too, and where it snaps back most nodes move back; but it
    departs from the way up. A step runs back if its end lies on the chord of an earlier upward step
    at this load factor, relative to the turning point of the path, and its twists are opposite to
    those of that step.
    """

    def __init__(self, positions: Array, dot: Dot = plain_dot) -> None:
        """Start with positions (n, 3) at load factor 0.

        Args:
            positions: The positions.
            dot: Inner product of two arrays with a row for each node.
        """
        self._dot = dot
        self._factors, self._positions = [0.0], [positions]
        self._twists: list[Array] = []
        self._count = 0

    def again(self, factor: float, positions: Array, twist: Array) -> bool:
        """Add the end of a step; return whether it and the previous one ran back."""
        factors = np.array(self._factors)
        back = factor < factors[-1] and self._against(factor, positions, twist, factors)
        self._count = self._count + 1 if back else 0
        self._factors.append(factor)
        self._positions.append(positions)
        self._twists.append(twist)
        return self._count >= _KNOWN

    def _against(self, factor: float, positions: Array, twist: Array, factors: Array) -> bool:
        """Whether a step to this state is opposite to an earlier upward one."""
        near = _NEAR * rms(positions - self._positions[int(factors.argmax())], self._dot)
        upwards = (factors[:-1] <= factor) & (factor < factors[1:])
        for k in np.flatnonzero(upwards):
            chord = self._positions[k + 1] - self._positions[k]
            part = (factor - factors[k]) / (factors[k + 1] - factors[k])
            close = rms(self._positions[k] + part * chord - positions, self._dot) < near
            if close and cosine(twist, self._twists[k], self._dot) < -_AGAINST:
                return True
        return False


def cosine(a: Array, b: Array, dot: Dot) -> float:
    """Cosine of the angle between two arrays with a row for each node."""
    return dot(a, b) / sqrt(dot(a, a) * dot(b, b))


def rms(u: Array, dot: Dot) -> float:
    """Root mean square of vectors at nodes, shape (n, 3)."""
    one = np.ones(len(u))
    return sqrt(dot(u, u) / dot(one, one))


_SHOWN = 1e-2  # translations over rotations × diameter from which on they measure rotations
_ON_THE_SPOT = 1e-9  # translations over rotations × diameter: less is round-off
_FARTHEST = 4  # lengths of the step: an iteration that goes farther has diverged
_AHEAD = 0.4  # least cosine between the twists of two steps


class Equilibrium(Protocol):
    """Structure whose equilibrium is computed; vectors contain its free unknowns.

    Attributes:
        diameter: Diagonal of the bounding box of the unloaded structure.
    """

    diameter: float

    def dot(self, a: Array, b: Array) -> float:
        """Inner product of two arrays with a row for each node.

        Args:
            a: First array, shape (n, k).
            b: Second array, of the same shape.
        """
        return plain_dot(a, b)

    def maximum(self, values: Array) -> float:
        """Largest magnitude of a vector.

        Args:
            values: Components of the vector.
        """
        return float(np.abs(values).max(initial=0.0))

    def forces(self) -> tuple[Array, Array]:
        """Internal forces, and external ones at λ = 1, in the current state."""
        ...

    def factorise(self, factor: float) -> None:
        """Assemble and factorise the tangent stiffness at a load factor, with updated stress.

        Args:
            factor: The load factor.
        """
        ...

    def solve(self, b: Array) -> Array:
        """Solve with the last tangent stiffness.

        Args:
            b: Right-hand side.
        """
        ...

    def negative_pivots(self) -> int:
        """Negative eigenvalues of the last tangent stiffness, restricted to the constraints."""
        ...

    def move(self, dx: Array) -> None:
        """Update the stress linearly by ``dx``, then the state.

        Args:
            dx: Increments of the free unknowns.
        """
        ...

    def positions(self) -> Array:
        """Positions of the nodes, shape (n, 3)."""
        ...

    def translations(self, dx: Array) -> Array:
        """Displacements of the nodes due to ``dx``, shape (n, 3), global components.

        Args:
            dx: Increments of the free unknowns.
        """
        ...

    def twists(self, dx: Array) -> Array:
        """Twists of the nodes due to ``dx``, (n, 6), in their own axes, rotations × diameter.

        Args:
            dx: Increments of the free unknowns.
        """
        ...

    def check_rotations(self, factor: float) -> None:
        """Raise an error if the current state is not valid.

        Args:
            factor: Load factor of the state, for the message.

        Raises:
            FoldedElementError: An element rotates too far.
            LostBranchError: A joint rotates too far in the step.
        """
        ...

    def check_passage(self, before: Any) -> None:
        """Raise ``PassedThroughError`` if surfaces passed through each other since a state.

        Args:
            before: State at the start of the step, from :meth:`state`.
        """
        ...

    def rotation_hint(self) -> str:
        """Hint on rotations in the current state that may prevent convergence."""
        ...

    def state(self) -> Any:
        """A copy of the current state."""
        ...

    def restore(self, state: Any) -> None:
        """Restore a copied state.

        Args:
            state: State that :meth:`state` returned.
        """
        ...


@dataclass
class Path:
    """Record of the accepted steps.

    Attributes:
        factors: Load factor of each accepted step.
        states: State at each requested load.
        negative: Number of negative eigenvalues of the tangent stiffness there.
        iterations: Linear solutions of each accepted step.
        failed_iterations: Linear solutions of failed steps.
        failed_steps: Number of failed steps.
    """

    factors: list[float] = field(default_factory=list)
    states: list[Any] = field(default_factory=list)
    negative: list[int] = field(default_factory=list)
    iterations: list[int] = field(default_factory=list)
    failed_iterations: int = 0
    failed_steps: int = 0

    @property
    def total_iterations(self) -> int:
        """Number of all linear solutions."""
        return sum(self.iterations) + self.failed_iterations


@dataclass(frozen=True)
class ArcLength:
    """Options of the load-capped arc length.

    Attributes:
        first_step: Length of the first step, rms translation over the model's diameter.
        tolerance: At a requested load, largest residual over the largest load, or increment over
            the length of the step, whichever is reached first.
        loose: Increment over the length of the step at which intermediate steps end.
        max_iterations: Largest number of iterations of a step.
        good_iterations: Steps that take more iterations shorten the next one.
        smallest_step: Length of a step, as ``first_step``, below which the analysis fails.
    """

    first_step: float = 0.07
    tolerance: float = 1e-8
    loose: float = 0.01
    max_iterations: int = 12
    good_iterations: int = 5
    smallest_step: float = 1e-6

    def follow(
        self, model: Equilibrium, levels: Sequence[float] = (1.0,), begin: float = 0.0
    ) -> Path:
        """Follow the path from the current state through the requested load factors.

        Args:
            model: The structure; it is left in the last state.
            levels: Increasing positive load factors.
            begin: Load factor of the current state.

        Raises:
            ValueError: The levels do not increase.
            ConvergenceError: Steps became too small; its ``result`` is the path so far.
        """
        return _Follower(self, model, begin).run(increasing(levels))


def increasing(levels: Sequence[float]) -> list[float]:
    """Check requested load factors.

    Raises:
        ValueError: There are none, or they are not positive, finite and increasing.
        TypeError: They are not numbers.
    """
    factors = numbers(levels, "levels")
    wanted = factors.ndim == 1 and len(factors) > 0 and bool(np.isfinite(factors).all())
    if not wanted or not (np.diff(factors, prepend=0.0) > 0).all():
        raise ValueError(f"the load factors must be positive and increase, got {levels}")
    return [float(factor) for factor in factors]


class _Follower(Iterated):
    """One analysis: the current load factor and step length."""

    def __init__(self, options: ArcLength, model: Equilibrium, begin: float) -> None:
        self._options, self._model = options, model
        self._factor, self._length = begin, options.first_step * model.diameter
        self._twist: Array | None = None  # of the last step
        self._moved: Array
        self._cap, self._next, self._first, self._count = begin, begin, True, 0
        self._origin, self._residual, self._load, self._dx = np.zeros((4, 0))
        self._path, self._refused = Path(), ""
        self._passed = Passed(model.positions(), model.dot)

    def run(self, levels: Sequence[float]) -> Path:
        with load_bar(levels[-1]) as show:
            for cap in levels:
                while self._factor < cap:
                    self._step(cap)
                    show(self._factor)
                self._path.states.append(self._model.state())
                self._path.negative.append(self._model.negative_pivots())
        return self._path

    def _step(self, cap: float) -> None:
        model, before, factor = self._model, self._model.state(), self._factor
        origin = model.positions()
        done, count = self._found(cap, origin, before)
        twist = model.twists(self._moved) if done else None
        # several states are at this distance: one is behind, others are on other paths
        if twist is not None and self._goes_ahead(twist):
            self._go_on(cap, origin, twist, count)
            return
        model.restore(before)
        self._factor = factor
        self._halve(count)

    def _goes_ahead(self, twist: Array) -> bool:
        """Whether the twists of a step are near those of the last one."""
        return self._twist is None or cosine(twist, self._twist, self._model.dot) > _AHEAD

    def _found(self, cap: float, origin: Array, before: Any) -> tuple[bool, int]:
        """Whether an equilibrium at the end of a step was found, and the iterations."""
        model, self._cap, self._origin, self._count = self._model, cap, origin, 0
        try:
            done = iterate(self, self._options.max_iterations).converged
            if done:
                model.check_rotations(self._factor)
                model.check_passage(before)
        except (FoldedElementError, LostBranchError, PassedThroughError) as error:
            done, self._refused = False, f" The step was refused: {error}."
        return done, self._count

    def _halve(self, count: int) -> None:
        """Continue with a shorter step."""
        self._length /= 2
        self._path.failed_steps += 1
        self._path.failed_iterations += count
        if self._length < self._options.smallest_step * self._model.diameter:
            raise ConvergenceError(
                f"no equilibrium beyond load factor {self._factor:g}: steps of "
                f"{2 * self._length:.1e} still fail.{self._refused or self._model.rotation_hint()}",
                self._path,
            )

    def _go_on(self, cap: float, origin: Array, twist: Array, count: int) -> None:
        """Continue from the new equilibrium with a suitable step."""
        path, here = self._path, self._model.positions()
        self._refused, self._twist = "", twist
        path.factors.append(self._factor)
        path.iterations.append(count)
        self._length *= min(2.0, max(0.5, sqrt(self._options.good_iterations / count)))
        if self._factor == cap:
            self._length = min(self._length, 3 * rms(here - origin, self._model.dot))
        if self._passed.again(self._factor, here, twist):
            raise ConvergenceError(
                f"the path runs back from load factor {max(path.factors):g} to "
                f"{self._factor:g}, along earlier states",
                path,
            )

    # --- one iteration, see :class:`~fem_lie.solve.iteration.Iterated` ---

    def evaluate(self, iteration: int) -> bool:
        """Evaluate forces; return whether the requested load is reached in equilibrium."""
        self._first = iteration == 1
        internal, self._load = self._model.forces()
        self._residual = internal - self._factor * self._load
        bound = self._options.tolerance * self._cap * self._model.maximum(self._load)
        balanced = self._factor == self._cap and self._model.maximum(self._residual) <= bound
        return not self._first and balanced

    def refactorise(self, update: Refactorisation) -> None:
        """Assemble and factorise the tangent stiffness."""
        self._count += 1
        self._model.factorise(self._factor)

    def correct(self) -> float:
        """Solve for an increment and a load factor; return the size of the translations."""
        model = self._model
        x_r, x_f = -model.solve(self._residual), model.solve(self._load)
        wanted, remaining = self._change(x_r, x_f), self._cap - self._factor
        change = min(wanted, remaining)
        self._dx = x_r + change * x_f
        # not by addition: it must be the requested load to the last digit
        self._next = self._cap if wanted >= remaining else self._factor + change
        return rms(model.translations(self._dx), model.dot)

    def judge(self, size: float) -> Verdict:
        """Verdict on an increment; it has diverged if it leaves the neighbourhood of the step."""
        options = self._options
        if not size <= _FARTHEST * self._length:
            return Verdict.DIVERGED
        self._moved = self._dx if self._first else self._moved + self._dx
        # residuals of slender structures may have a larger round-off than the tolerance
        enough = options.tolerance if self._next == self._cap else options.loose
        small = size < enough * self._length and self._turned(self._dx, enough)
        return Verdict.CONVERGED if small and not self._first else Verdict.GOES_ON

    def apply(self, verdict: Verdict) -> None:
        """Apply the increment and the load factor."""
        self._factor = self._next
        self._model.move(self._dx)

    def _turned(self, dx: Array, enough: float) -> bool:
        """Whether the rotations of an increment are small, if translations do not measure them."""
        model = self._model
        now, step = (rms(model.twists(h)[:, 3:], model.dot) for h in (dx, self._moved))
        shown = self._length >= _SHOWN * model.diameter * step
        return shown or now < enough * step

    def _change(self, x_r: Array, x_f: Array) -> float:
        """Change of the load factor for which the step has its length; nan if there is none."""
        model, length = self._model, self._length
        u_f = model.translations(x_f)
        if self._first:
            moves, turns = rms(u_f, model.dot), rms(model.twists(x_f)[:, 3:], model.dot)
            if moves <= _ON_THE_SPOT * turns:  # false for nan
                what = "turns nodes on the spot" if turns else "moves nothing"
                raise ConvergenceError(
                    f"the load {what}, and an arc length measures translations: use load steps "
                    "(fl.statics)",
                    self._path,
                )
            forward = self._twist is None or model.dot(model.twists(x_f), self._twist) >= 0
            return (1.0 if forward else -1.0) * length / moves
        now = model.positions() - self._origin
        distance, one = rms(now, model.dot), np.ones(len(now))
        if distance == 0.0:
            return np.nan
        gradient = np.asarray(now / (distance * model.dot(one, one)), dtype=np.float64)
        u_r = model.translations(x_r)
        slope = model.dot(gradient, u_f)
        if slope == 0.0:
            return np.nan
        return (length - distance - model.dot(gradient, u_r)) / slope

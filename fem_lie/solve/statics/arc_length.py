"""Load-capped arc length: load control where a structure is stiff, arc length where it is soft.

Unknown are the increment of a step and the load factor λ; a step ends on the wanted load, or at a
distance Δs from its beginning, whichever comes first::

    min(λ_cap − λ, Δs − |Δu|) = 0            |Δu| = rms of the nodal translations of the step

Elastic statics does not need equilibrium between the wanted loads: those states are left when the
increments are small against the step, and only the wanted ones are polished. With the stress
carried as an iterate that takes a dozen linear solutions for shells that bend through half their
radius.

The elimination of λ is that of Riks (Int. J. Solids Struct. 15 (1979) 529), with the constraint
linearised at each iterate.

Which way is forward is told by the twists of the last step, in the nodes' own axes: the end of a
beam that is rolled up goes round in circles, and its displacements of two steps may have any angle,
while its twist stays what it is. A path that goes down along states it has passed is given up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import sqrt
from typing import Any, Protocol

import numpy as np

from fem_lie._arrays import Array, numbers
from fem_lie.bodies.turning import FoldedElementError
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.joints.connection import LostBranchError
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.solve.progress_bars import load_bar
from fem_lie.solve.statics.passed import Passed, cosine, rms

_SHOWN = 1e-2  # translations over rotations × diameter that show how far rotations are
_ON_THE_SPOT = 1e-9  # translations over rotations × diameter: less are round-off
_AHEAD = 0.4  # cosine between the twists of two steps: never less


class Equilibrium(Protocol):
    """What a structure offers for the search of its equilibrium; vectors hold its free unknowns.

    Attributes:
        diameter: Diagonal of the box around the unloaded structure.
    """

    diameter: float

    def forces(self) -> tuple[Array, Array]:
        """Internal forces, and external ones at λ = 1, in the present state."""
        ...

    def factorise(self, factor: float) -> None:
        """Make the tangent at load factor ``factor``, with the carried stress, ready to solve."""
        ...

    def solve(self, b: Array) -> Array:
        """Solve with the last tangent."""
        ...

    def negative_pivots(self) -> int:
        """Negative eigenvalues of the last tangent on what constraints leave free."""
        ...

    def move(self, dx: Array) -> None:
        """Carry the stress on by ``dx``, then the state."""
        ...

    def positions(self) -> Array:
        """Positions of the nodes, shape (n, 3)."""
        ...

    def translations(self, dx: Array) -> Array:
        """Velocities of the nodes that ``dx`` means, shape (n, 3), components in space."""
        ...

    def twists(self, dx: Array) -> Array:
        """Twists of the nodes that ``dx`` means, (n, 6), in their own axes, turns × diameter."""
        ...

    def check_turns(self, factor: float) -> None:
        """Refuse the present state if it is none of the structure.

        Raises:
            FoldedElementError: An element rotates too far.
            LostBranchError: A joint rotates too far in the step.
        """
        ...

    def check_passage(self, before: Any) -> None:
        """Raise ``PassedThroughError`` if surfaces went through each other since a copied state."""
        ...

    def turn_hint(self) -> str:
        """What to say of the present state, if that may be why it does not go on."""
        ...

    def state(self) -> Any:
        """A copy of the present state."""
        ...

    def restore(self, state: Any) -> None:
        """Return to a copied state."""
        ...


@dataclass
class Path:
    """What was done.

    Attributes:
        factors: Load factor of each accepted step.
        states: State at each wanted load.
        negative: Negative eigenvalues of the tangent there.
        iterations: Linear solutions of each accepted step.
        failed_iterations: Those of steps that were given up.
        failed_steps: Their number.
    """

    factors: list[float] = field(default_factory=list)
    states: list[Any] = field(default_factory=list)
    negative: list[int] = field(default_factory=list)
    iterations: list[int] = field(default_factory=list)
    failed_iterations: int = 0
    failed_steps: int = 0

    @property
    def total_iterations(self) -> int:
        """Linear solutions in all."""
        return sum(self.iterations) + self.failed_iterations


@dataclass(frozen=True)
class ArcLength:
    """Options of the load-capped arc length.

    Attributes:
        first_step: Length of the first step, rms translation over the model's diameter.
        tolerance: At a wanted load, largest residual over the largest load, or increment over the
            length of the step, whichever is reached first.
        loose: Increment over the length of the step, at which steps between are left.
        max_iterations: More are a failure of the step.
        good_iterations: Steps that take more make the next one shorter.
        smallest_step: Length of a step, as ``first_step``, that is given up.
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
        """Go from the present state through the wanted load factors.

        Args:
            model: The structure; it is left in the last state.
            levels: Increasing positive load factors.
            begin: Load factor of the present state.

        Raises:
            ValueError: The levels do not increase.
            ConvergenceError: Steps became too small; its ``result`` is the path so far.
        """
        return _Follower(self, model, begin).run(increasing(levels))


def increasing(levels: Sequence[float]) -> list[float]:
    """Load factors at which states are wanted.

    Raises:
        ValueError: There are none, or they are not positive, finite and increasing.
        TypeError: They are no numbers.
    """
    factors = numbers(levels, "levels")
    wanted = factors.ndim == 1 and len(factors) > 0 and bool(np.isfinite(factors).all())
    if not wanted or not (np.diff(factors, prepend=0.0) > 0).all():
        raise ValueError(f"the load factors must be positive and increase, got {levels}")
    return [float(factor) for factor in factors]


class _Follower:
    """One run: the present load factor and step length."""

    def __init__(self, options: ArcLength, model: Equilibrium, begin: float) -> None:
        self._options, self._model = options, model
        self._factor, self._length = begin, options.first_step * model.diameter
        self._twist: Array | None = None  # of the last step
        self._moved: Array
        self._path, self._refused = Path(), ""
        self._passed = Passed(model.positions())

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
        # a step has its length at two states and more: one is behind, others on other paths
        if twist is not None and (self._twist is None or cosine(twist, self._twist) > _AHEAD):
            self._go_on(cap, origin, twist, count)
            return
        model.restore(before)
        self._factor = factor
        self._halve(count)

    def _found(self, cap: float, origin: Array, before: Any) -> tuple[bool, int]:
        """Whether there is equilibrium at the end of a step, and iterations."""
        model, count, done = self._model, 0, False
        try:
            while not done and count < self._options.max_iterations:
                internal, load = model.forces()
                residual = internal - self._factor * load
                done = count > 0 and self._balanced(residual, load, cap)
                if not done:
                    count += 1
                    done = self._iterate(residual, load, cap, origin, first=count == 1)
            if done:
                model.check_turns(self._factor)
                model.check_passage(before)
        except (FoldedElementError, LostBranchError, PassedThroughError) as error:
            done, self._refused = False, f" The step was refused: {error}."
        except (_Lost, SingularMatrixError):
            done = False
        return done, count

    def _halve(self, count: int) -> None:
        """Go on with a shorter step."""
        self._length /= 2
        self._path.failed_steps += 1
        self._path.failed_iterations += count
        if self._length < self._options.smallest_step * self._model.diameter:
            raise ConvergenceError(
                f"no equilibrium beyond load factor {self._factor:g}: steps of "
                f"{2 * self._length:.1e} still fail.{self._refused or self._model.turn_hint()}",
                self._path,
            )

    def _go_on(self, cap: float, origin: Array, twist: Array, count: int) -> None:
        """From the equilibrium that was found, with a step that suits it."""
        path, here = self._path, self._model.positions()
        self._refused, self._twist = "", twist
        path.factors.append(self._factor)
        path.iterations.append(count)
        self._length *= min(2.0, max(0.5, sqrt(self._options.good_iterations / count)))
        if self._factor == cap:
            self._length = min(self._length, 3 * rms(here - origin))
        if self._passed.again(self._factor, here, twist):
            raise ConvergenceError(
                f"the path runs back from load factor {max(path.factors):g} to "
                f"{self._factor:g}, along states that it has passed",
                path,
            )

    def _balanced(self, residual: Array, load: Array, cap: float) -> bool:
        """Whether the wanted load is reached, and in equilibrium."""
        bound = self._options.tolerance * cap * float(np.abs(load).max())
        return self._factor == cap and float(np.abs(residual).max()) <= bound

    def _iterate(
        self, residual: Array, load: Array, cap: float, origin: Array, first: bool
    ) -> bool:
        """One linear solution; whether its increment says that the step has arrived."""
        model, options = self._model, self._options
        model.factorise(self._factor)
        x_r, x_f = -model.solve(residual), model.solve(load)
        wanted, room = self._change(x_r, x_f, origin, first), cap - self._factor
        change = min(wanted, room)
        dx = x_r + change * x_f
        moved = rms(model.translations(dx))
        if not np.isfinite(moved) or moved > 4 * self._length:
            raise _Lost
        # not by addition: it must be the wanted load to the last digit
        self._factor = cap if wanted >= room else self._factor + change
        model.move(dx)
        self._moved = dx if first else self._moved + dx
        # residuals of slender structures may have more round-off than the tolerance allows
        enough = options.tolerance if self._factor == cap else options.loose
        return not first and moved < enough * self._length and self._turned(dx, enough)

    def _turned(self, dx: Array, enough: float) -> bool:
        """Whether the rotations of an increment are small, where translations do not show them."""
        now, step = (rms(self._model.twists(h)[:, 3:]) for h in (dx, self._moved))
        shown = self._length >= _SHOWN * self._model.diameter * step
        return shown or now < enough * step

    def _change(self, x_r: Array, x_f: Array, origin: Array, first: bool) -> float:
        """Change of the load factor that puts the step's end at its length."""
        model, length = self._model, self._length
        u_f = model.translations(x_f)
        if first:
            moves, turns = rms(u_f), rms(model.twists(x_f)[:, 3:])
            if moves <= _ON_THE_SPOT * turns:  # not if they are no numbers
                what = "turns nodes on the spot" if turns else "moves nothing"
                raise ConvergenceError(
                    f"the load {what}, and an arc length measures translations: use load steps "
                    "(fl.statics)",
                    self._path,
                )
            forward = self._twist is None or float(np.sum(model.twists(x_f) * self._twist)) >= 0
            return (1.0 if forward else -1.0) * length / moves
        now = model.positions() - origin
        distance = rms(now)
        if distance == 0.0:
            raise _Lost
        gradient = now / (distance * len(now))
        u_r = model.translations(x_r)
        slope = float(np.sum(gradient * u_f))
        if slope == 0.0:
            raise _Lost
        return (length - distance - float(np.sum(gradient * u_r))) / slope


class _Lost(Exception):
    """The iteration left the neighbourhood of its step."""

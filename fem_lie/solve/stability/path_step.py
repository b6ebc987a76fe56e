"""From one polished state of equilibrium to another: predictor, corrector, tangent, inertia.

The predictor goes along the tangent ``(K⁻¹f, 1)`` of the state before; the corrector solves
equilibrium and the control, linearised at each iterate, with the stress carried along (E. Riks,
Int. J. Solids Struct. 15 (1979) 529; M. A. Crisfield, Comput. Struct. 13 (1981) 55). The
factorisation at the new state gives its tangent, its number of negative pivots and the next
predictor: a step costs one factorisation for each of its iterations.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.turning import FoldedElementError
from fem_lie.joints.connection import LostBranchError
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.results.path import Station
from fem_lie.solve.stability.controls import Arc, Control
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.statics.arc_length import ArcLength

_SIDEWAYS = 4.0  # lengths of the step: an iteration that goes farther is lost
_SEARCH = 0.05  # shorter steps are those of a search, not of a path


class LostError(ArithmeticError):
    """The iteration did not arrive.

    Attributes:
        iterations: Linear solutions in vain.
    """

    def __init__(self, iterations: int) -> None:
        """Keep the count."""
        super().__init__(f"no convergence in {iterations} iterations")
        self.iterations = iterations


class FoldedStepError(LostError):
    """An element folds at the end of a step."""

    def __init__(self, iterations: int, what: str) -> None:
        """Keep what folds."""
        super().__init__(iterations)
        self.what = what


class Walker:
    """Steps of a model.

    Attributes:
        model: What is loaded.
        options: Tolerance and largest number of iterations.
        iterations: Linear solutions in all, failed steps included.
    """

    def __init__(self, model: StableEquilibrium, options: ArcLength, load: float) -> None:
        """Start counting.

        Args:
            model: What is loaded.
            options: Tolerance and largest number of iterations.
            load: A load factor that matters: residuals are measured by it where it is larger.
        """
        self.model, self.options, self.load = model, options, load
        self.iterations = 0
        self._mode: Array | None = None
        self._last_load: Array | None = None

    def start(self, factor: float, sign: float) -> Station:
        """The present state of the model, which is in equilibrium at this factor."""
        return self._station(factor, sign, 0, None, probe=False)

    def step(
        self,
        origin: Station,
        control: Control,
        length: float,
        arc: Arc,
        *,
        begin: Station | None = None,
        probe: bool = False,
    ) -> Station:
        """The state at a distance from another one.

        Args:
            origin: From where the distance is measured.
            control: How.
            length: The distance.
            arc: Which way is forward, and how far is too far.
            begin: A state near the wanted one to begin with; default: predict it from ``origin``.
            probe: Whether the smallest eigenvalue is wanted.

        Raises:
            LostError: No convergence, or a joint rotates too far.
            FoldedStepError: An element does.
        """
        model, first = self.model, begin is None
        near = origin if begin is None else begin
        model.restore(near.state)
        self._factor, count, done = near.factor, 0, False
        try:
            while not done and count < self.options.max_iterations:
                if first:
                    change = length * control.rate(origin.velocity, origin.sign)
                    if not np.isfinite(change):
                        raise LostError(0)
                    dx, first = change * origin.response, False
                else:
                    dx, change, done = self._correction(origin, control, length)
                    if done:
                        break
                    count += 1
                moved = arc.norm(model.translations(dx), 0.0)
                if not np.isfinite(moved) or moved > _SIDEWAYS * max(abs(length), _SEARCH):
                    raise LostError(count)
                model.move(dx)
                self._factor += change
                done = count > 0 and moved < self.options.tolerance
            if not done:
                raise LostError(count)
            model.check_turns(self._factor)
            return self._station(self._factor, origin.sign, count, (origin, arc), probe)
        except (SingularMatrixError, LostBranchError):
            raise LostError(count) from None
        except FoldedElementError as error:
            raise FoldedStepError(count, str(error)) from None
        finally:
            self.iterations += count + 1

    def _correction(
        self, origin: Station, control: Control, length: float
    ) -> tuple[Array, float, bool]:
        """One linear solution, or whether none is needed."""
        model = self.model
        internal, load = model.forces()
        self._last_load = load
        residual = internal - self._factor * load
        moved, changed = model.positions() - origin.places, self._factor - origin.factor
        rest = length - control.distance(moved, changed)
        bound = max(abs(self._factor), self.load) * float(np.abs(load).max())
        balanced = float(np.abs(residual).max()) <= self.options.tolerance * bound
        if balanced and abs(rest) <= self.options.tolerance:
            return residual, 0.0, True
        model.factorise(self._factor)
        x_r, x_f = -model.solve(residual), model.solve(load)
        u_r, u_f = model.translations(x_r), model.translations(x_f)
        slope = control.slope(moved, changed, u_f, 1.0)
        if slope == 0.0:
            raise LostError(0)
        change = (rest - control.slope(moved, changed, u_r, 0.0)) / slope
        return x_r + change * x_f, change, False

    def _station(
        self,
        factor: float,
        sign: float,
        count: int,
        way: tuple[Station, Arc] | None,
        probe: bool,
    ) -> Station:
        model = self.model
        if way is None or self._last_load is None:
            _, self._last_load = model.forces()
        model.factorise(factor)
        response = model.solve(self._last_load)
        velocity, places = model.translations(response), model.positions()
        if way is not None:
            before, arc = way
            along = arc.inner(places - before.places, factor - before.factor, velocity, 1.0)
            sign = 1.0 if along >= 0.0 else -1.0
        return Station(
            factor=factor,
            state=model.state(),
            places=places,
            velocity=velocity,
            response=response,
            sign=sign,
            negative=model.negative_pivots(),
            iterations=count + 1,
            test=self._smallest() if probe else np.nan,
        )

    def _smallest(self) -> float:
        """Smallest eigenvalue of the tangent that was factorised last, by inverse iteration."""
        repeats = 12 if self._mode is None else 3
        value, self._mode = self.model.inverse_iteration(self._mode, repeats)
        return value

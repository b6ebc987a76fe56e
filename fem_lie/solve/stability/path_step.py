"""Step from one polished equilibrium state to another: predictor, corrector, tangent, inertia.

The predictor moves along the tangent ``(K⁻¹f, 1)`` of the previous state; the corrector solves
equilibrium and the control, linearised at each iterate, with linearised stress updates (E. Riks,
Int. J. Solids Struct. 15 (1979) 529; M. A. Crisfield, Comput. Struct. 13 (1981) 55). The
factorisation at the new state gives its tangent, its number of negative pivots and the next
predictor: a step costs one factorisation for each of its iterations.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.model import FoldedElementError
from fem_lie.joints.connection import LostBranchError
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.results.path import Station
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.path_options import Arc, Control
from fem_lie.solve.statics.arc_length import ArcLength

_SIDEWAYS = 4.0  # lengths of the step: an iteration that goes farther has diverged
_SEARCH = 0.05  # shorter steps belong to a search, not to a path


class LostError(ArithmeticError):
    """The iteration did not converge.

    Attributes:
        iterations: Number of linear solutions.
    """

    def __init__(self, iterations: int) -> None:
        """Store the number of iterations."""
        super().__init__(f"no convergence in {iterations} iterations")
        self.iterations = iterations


class FoldedStepError(LostError):
    """An element folds at the end of a step."""

    def __init__(self, iterations: int, what: str) -> None:
        """Store the name of the folded element."""
        super().__init__(iterations)
        self.what = what


class _Step(Iterated):
    """The iteration of one step.

    Attributes:
        factor: Current load factor.
        count: Number of linear solutions.
        load: External forces at the factor 1, as last evaluated.
    """

    def __init__(
        self,
        model: StableEquilibrium,
        options: ArcLength,
        least: float,
        to: tuple[Station, Control, float, Arc],
        factor: float,
    ) -> None:
        self._model, self._options, self._least, self.factor = model, options, least, factor
        self._origin, self._control, self._length, self._arc = to
        self.count, self._change = 0, 0.0
        self.load: Array | None = None
        self._residual, self._dx, self._moved = np.zeros((3, 0))
        self._changed, self._rest = 0.0, 0.0

    def predict(self) -> None:
        """Move along the tangent at the origin.

        Raises:
            LostError: The tangent does not reach the distance.
        """
        origin = self._origin
        self._change = self._length * self._control.rate(origin.velocity, origin.sign)
        if not np.isfinite(self._change):
            raise LostError(0)
        self._dx = self._change * origin.response
        if self.judge(self._size()) == Verdict.DIVERGED:
            raise LostError(0)
        self.apply(Verdict.GOES_ON)

    def evaluate(self, iteration: int) -> bool:
        """Evaluate forces and distance; return whether both are those of the end of the step."""
        model, origin, tolerance = self._model, self._origin, self._options.tolerance
        internal, load = model.forces()
        self.load, self._residual = load, internal - self.factor * load
        self._moved = model.positions() - origin.positions
        self._changed = self.factor - origin.factor
        self._rest = self._length - self._control.distance(self._moved, self._changed)
        bound = max(abs(self.factor), self._least) * model.maximum(load)
        balanced = model.maximum(self._residual) <= tolerance * bound
        return balanced and abs(self._rest) <= tolerance

    def refactorise(self, update: Refactorisation) -> None:
        self._model.factorise(self.factor)

    def correct(self) -> float:
        """Solve for an increment and a change of the load factor; infinite if there is none."""
        assert self.load is not None
        model, at = self._model, (self._moved, self._changed)
        x_r, x_f = -model.solve(self._residual), model.solve(self.load)
        u_r, u_f = model.translations(x_r), model.translations(x_f)
        slope = self._control.slope(*at, u_f, 1.0)
        if slope == 0.0:
            return np.inf
        self._change = (self._rest - self._control.slope(*at, u_r, 0.0)) / slope
        self._dx = x_r + self._change * x_f
        self.count += 1
        return self._size()

    def _size(self) -> float:
        return float(self._arc.norm(self._model.translations(self._dx), 0.0))

    def judge(self, size: float) -> Verdict:
        if not size <= _SIDEWAYS * max(abs(self._length), _SEARCH):
            return Verdict.DIVERGED
        small = self.count > 0 and size < self._options.tolerance
        return Verdict.CONVERGED if small else Verdict.GOES_ON

    def apply(self, verdict: Verdict) -> None:
        self._model.move(self._dx)
        self.factor += self._change


class Walker:
    """Computes steps of a model.

    Attributes:
        model: The loaded scene.
        options: Tolerance and largest number of iterations.
        iterations: Number of all linear solutions, failed steps included.
    """

    def __init__(self, model: StableEquilibrium, options: ArcLength, load: float) -> None:
        """Start with zero iterations.

        Args:
            model: The loaded scene.
            options: Tolerance and largest number of iterations.
            load: A reference load factor: residuals are relative to it if it is larger than the
                current one.
        """
        self.model, self.options, self.load = model, options, load
        self.iterations = 0
        self._mode: Array | None = None
        self._last_load: Array | None = None

    def start(self, factor: float, sign: float) -> Station:
        """The current state of the model, which is in equilibrium at this factor."""
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
            origin: State from which the distance is measured.
            control: Measure of the distance.
            length: The distance.
            arc: Metric that determines the forward direction and the largest distance.
            begin: Initial guess; default: predict it from ``origin``.
            probe: Whether the smallest eigenvalue is needed.

        Raises:
            LostError: No convergence, or a joint rotates too far.
            FoldedStepError: An element rotates too far.
        """
        model, near = self.model, origin if begin is None else begin
        model.restore(near.state)
        step = _Step(model, self.options, self.load, (origin, control, length, arc), near.factor)
        try:
            if begin is None:
                step.predict()
            if not iterate(step, self.options.max_iterations).converged:
                raise LostError(step.count)
            model.check_rotations(step.factor)
            if step.load is not None:
                self._last_load = step.load
            return self._station(step.factor, origin.sign, step.count, (origin, arc), probe)
        except (SingularMatrixError, LostBranchError):
            raise LostError(step.count) from None
        except FoldedElementError as error:
            raise FoldedStepError(step.count, str(error)) from None
        finally:
            self.iterations += step.count + 1

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
        velocity, positions = model.translations(response), model.positions()
        if way is not None:
            before, arc = way
            along = arc.inner(positions - before.positions, factor - before.factor, velocity, 1.0)
            sign = 1.0 if along >= 0.0 else -1.0
        return Station(
            factor=factor,
            state=model.state(),
            positions=positions,
            velocity=velocity,
            response=response,
            sign=sign,
            negative=model.negative_pivots(),
            iterations=count + 1,
            test=self._smallest() if probe else np.nan,
        )

    def _smallest(self) -> float:
        """Smallest eigenvalue of the last factorised tangent stiffness, by inverse iteration."""
        repeats = 12 if self._mode is None else 3
        value, self._mode = self.model.inverse_iteration(self._mode, repeats)
        return value

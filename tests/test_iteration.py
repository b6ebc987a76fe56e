"""The one iteration: how it ends, and that all equations with the same law end alike."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl


class Root(fl.extend.Iterated):
    """The root of ``x³ = 8``."""

    def __init__(self, start, criterion, slope=None):
        self.x, self._criterion, self._slope = start, criterion, slope
        self.made = 0

    @property
    def missing(self):
        return self._slope is None

    def evaluate(self, iteration):
        self._residual = self.x**3 - 8.0
        return self._residual == 0.0

    def refactorise(self, update):
        assert update == fl.extend.Refactorisation.ALL
        self._slope, self.made = 3.0 * self.x**2, self.made + 1
        if self._slope == 0.0:
            raise fl.extend.SingularMatrixError("no slope")

    def correct(self):
        self._change = -self._residual / self._slope
        return abs(self._change)

    def judge(self, size):
        return self._criterion.judge(size)

    def apply(self, verdict):
        self.x += self._change


def linear(tolerance=1e-12):
    return fl.extend.LinearRate(lambda _: tolerance, 1.0, 1e-14)


@pytest.mark.parametrize("refactorisations", [fl.extend.NEWTON, fl.extend.FROZEN])
def test_a_frozen_matrix_arrives_where_newton_does(refactorisations):
    root = Root(2.3, linear())
    ended = fl.extend.iterate(root, 60, refactorisations)
    assert ended.converged
    assert abs(root.x - 2.0) < 1e-12
    assert root.made == (1 if refactorisations is fl.extend.FROZEN else ended.iterations)
    assert (ended.iterations > 8) == (refactorisations is fl.extend.FROZEN)


def test_what_is_left_after_quadratic_convergence_is_below_the_tolerance():
    root = Root(2.3, fl.extend.QuadraticRate(1e-10, 1e3))
    ended = fl.extend.iterate(root, 20)
    assert ended.verdict == fl.extend.Verdict.CONVERGED
    assert abs(root.x - 2.0) < 1e-10
    assert ended.size > 1e-10  # the last correction itself is not


@pytest.mark.parametrize(
    ("start", "slope", "limit", "verdict"),
    [
        (2.3, None, 1, fl.extend.Verdict.GOES_ON),
        (0.0, None, 9, fl.extend.Verdict.SINGULAR),
        (2.3, 0.5, 9, fl.extend.Verdict.DIVERGED),
        (2.0, None, 9, fl.extend.Verdict.CONVERGED),  # without a correction
    ],
)
def test_how_an_iteration_ends(start, slope, limit, verdict):
    ended = fl.extend.iterate(Root(start, linear(), slope), limit, fl.extend.FROZEN)
    assert ended.verdict == verdict
    assert ended.converged == (verdict == fl.extend.Verdict.CONVERGED)
    assert (ended.iterations == 0) == (start == 2.0)


def swinging(history):
    """A pendulum of two rigid bars under a constant force, which may be called a function of time.

    Of loads that are, the compiled loops of steps know nothing.
    """
    scene = fl.Scene(gravity=(0, 0, -9.81))
    upper = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0.5, 0, 0)))
    lower = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(1.5, 0, 0)))
    scene.add(fl.joints.Spherical(upper.point("centre"), fl.ground(), at=(0, 0, 0)))
    scene.add(fl.joints.Spherical(upper.point("centre"), lower.point("centre"), at=(1, 0, 0)))
    scene.add(fl.PointLoad(lower.point("centre"), force=(0, 0, 1.0), history=history))
    return scene


@pytest.mark.parametrize(
    "scheme", [fl.schemes.Variational(), fl.GeneralisedAlpha(), fl.EnergyMomentum()]
)
def test_compiled_loops_iterate_as_python_does(scheme):
    plan = {"duration": 0.5, "step": 2e-3, "progress": False}
    compiled, called = (scheme.run(swinging(history), **plan) for history in (None, lambda _: 1.0))
    np.testing.assert_allclose(called.frames, compiled.frames, rtol=0, atol=1e-11)
    assert abs(int(called.iterations[-1]) - int(compiled.iterations[-1])) <= 2

"""Dynamics with meshes and step sizes adapted to the errors in space and time.

A scene is a function of its mesh, as for :func:`~fem_lie.adaptivity.adapt`::

    found = fl.adaptivity.adapt_motion(rope, mesh, duration=0.01, every=2e-4, tolerance=0.05,
    size=1e-3) print(found)                           # how the tolerance is split between space and
    time found.times, found.kinetic, found.position("rope.end"), found.segments[-1].result

At given intervals a new mesh is generated from the coarse one, by the estimated stress error, and
the state is transferred to it. A segment whose error exceeds the tolerance is repeated on a mesh
that is refined where the error was.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, instance, number, positive, whole
from fem_lie.adaptivity.estimates.estimate import Estimated
from fem_lie.adaptivity.estimates.recovery import fields_of
from fem_lie.adaptivity.following.segments import AdaptedMotion, MotionSegment, steps_of
from fem_lie.adaptivity.following.transfer import Transferred, transfer
from fem_lie.adaptivity.loop import named_body
from fem_lie.adaptivity.refinement import Onto, Refinable, Sizes, check_refinable, order_of
from fem_lie.linear.direct import ConvergenceError
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.results.history import Result
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.alpha.generalised_alpha import GeneralisedAlpha
from fem_lie.solve.motion.integrator import Integrator
from fem_lie.solve.step_control import AdaptiveStep

_log = logging.getLogger("fem_lie")

_AIM = 0.75  # target error over the allowed error
_LOOKS = 6  # states of a segment whose error is estimated
_TRIES = 6  # meshes for one segment


def adapt_motion(
    build: Callable[[Refinable], Scene],
    mesh: Refinable,
    *,
    duration: float,
    every: float,
    tolerance: float,
    size: float,
    body: str | None = None,
    scheme: Integrator | None = None,
    space_fraction: float = 0.5,
    ahead: float = 0.0,
    least: float = 0.0,
    most: int = 200_000,
    onto: Onto | None = None,
) -> AdaptedMotion[Refinable]:
    """Integrate with adaptive meshes and step sizes, by a tolerance split between space and time.

    With the tolerance τ, ``τ² = s τ² + (1 − s) τ²``: the stress error in the energy norm is at most
    ``√s τ`` times the largest norm of the stress so far. The error of positions, the sum of the
    errors of all steps without damping, is at most ``√(1 − s) τ`` times the size of the motion.

    Args:
        build: Creates a scene with a beam, cable or shell on the given mesh.
        mesh: The coarsest mesh: lines, cells of first degree, or smooth patches.
        duration: End time.
        every: Time between two changes of the mesh.
        tolerance: τ.
        size: Reference length of position errors: the amplitude of a wave, the length of a
            pendulum.
        body: Name of the beam, cable or shell on the mesh; default: the only one in the scene.
        scheme: Scheme with variable step size; default: ``GeneralisedAlpha()``.
        space_fraction: s, above 0 and below 1.
        ahead: Distance around small elements in which others are as small: how far the feature that
            needs them moves between two changes. If it is too small, segments are repeated.
        least: Reference norm of the stress, the root of twice an elastic energy, as long as the
            stress is smaller: smaller stresses need no fine mesh.
        most: Largest number of elements.
        onto: Projects new points onto the exact line or surface.

    Raises:
        ValueError: An argument is wrong, the mesh cannot be refined, or the scene has no beam,
            cable or shell on it; before anything is solved.
        ConvergenceError: The tolerance needs more elements, or a step failed; its ``result`` is the
            :class:`AdaptedMotion` up to there, if there is any.
    """
    _check(build, mesh, scheme, onto)
    for value, what in ((duration, "duration"), (every, "every"), (size, "size")):
        positive(value, what)
    positive(tolerance, "tolerance")
    whole(most, "most")
    if not 0.0 < number(space_fraction, "share") < 1.0:
        raise ValueError(f"space_fraction must be above 0 and below 1, got {space_fraction!r}")
    if not number(ahead, "ahead") >= 0.0:
        raise ValueError(f"ahead must not be negative, got {ahead!r}")
    if not number(least, "least") >= 0.0:
        raise ValueError(f"least must not be negative, got {least!r}")
    check_refinable(mesh, onto)
    allowed = sqrt(space_fraction) * tolerance, sqrt(1.0 - space_fraction) * tolerance
    scheme = GeneralisedAlpha() if scheme is None else scheme
    steps = AdaptiveStep(allowed[1] * size / duration, first=min(1e-2 * every, 1e-3 * duration))
    segments: list[MotionSegment[Refinable]] = []
    now, time, scale, work = mesh, 0.0, float(least), 0

    def found() -> AdaptedMotion[Refinable]:
        return AdaptedMotion(tuple(segments), tolerance, *allowed, work)

    while time < duration * (1.0 - 1e-12):
        span = min(every, duration - time)
        coarse: list[Refinable] = []
        for _ in range(_TRIES):
            if len(now.cells) > most:
                raise ConvergenceError(
                    f"at time {time:g} the tolerance needs {len(now.cells)} elements, more than "
                    f"{most}",
                    found() if segments else None,
                )
            scene, change = _begun(build, now, body, segments[-1] if segments else None)
            result = _run(scheme, scene, span, steps, found if segments else None)
            work += len(now.cells) * steps_of(result)
            look = _look(result, named_body(scene, body, now), scene)
            most_stress = max(scale, look.stress)
            error = look.error / most_stress if most_stress > 0.0 else 0.0
            if error <= allowed[0]:
                break
            _log.info("time %g: error %.2g with %d elements: again", time, error, len(now.cells))
            coarse.append(now)
            aim = _AIM * allowed[0] * most_stress
            sizes = Sizes.of(now, look.squares.max(axis=0), aim, look.order)
            now = sizes.other_mesh(mesh, coarse, onto=onto)
        else:
            raise ConvergenceError(
                f"at time {time:g} the error in space is {error:.2g} after {_TRIES} meshes, above "
                f"{allowed[0]:.2g}",
                found() if segments else None,
            )
        scale = most_stress
        segments.append(MotionSegment(time, now, scene, result, error, change))
        time += span
        steps = _going_on(steps, result, span)
        sizes = Sizes.of(now, look.squares[-1], _AIM * allowed[0] * scale, look.order)
        now = sizes.mesh(mesh, ahead=ahead, onto=onto)
    return found()


class _Look(NamedTuple):
    """Errors of elements in some states of a segment.

    Attributes:
        squares: Squared errors, shape (k, m).
        error: Largest error of the body.
        stress: Largest norm of its stress.
        order: Order of convergence of the error in the size of elements.
    """

    squares: Array
    error: float
    stress: float
    order: int


def _look(result: Result, body: Estimated, scene: Scene) -> _Look:
    last = len(result.times) - 1
    steps = np.unique(np.linspace(min(1, last), last, _LOOKS).round().astype(np.int64))
    fields = fields_of(result, body, scene, [int(step) for step in steps])
    squares = np.array([each.energy(each.missing) for each in fields])
    energies = [float(each.energy(each.own).sum()) for each in fields]
    error = sqrt(squares.sum(axis=1).max())
    return _Look(squares, error, sqrt(max(energies)), order_of(body))


def _begun(
    build: Callable[[Refinable], Scene],
    mesh: Refinable,
    body: str | None,
    last: MotionSegment[Refinable] | None,
) -> tuple[Scene, Transferred | None]:
    """The scene on a mesh, at the end of the last segment."""
    scene = build(mesh)
    require_scene(scene)
    named_body(scene, body, mesh)
    return scene, transfer(last.result, last.scene, scene) if last else None


def _run(
    scheme: Integrator,
    scene: Scene,
    span: float,
    steps: AdaptiveStep,
    before: Callable[[], object] | None,
) -> Result:
    try:
        return scheme.run(scene, duration=span, step=steps, progress=False)
    except ConvergenceError as error:
        began = scene.began.time
        raise ConvergenceError(
            f"after time {began:g}: {error}", before() if before else None
        ) from None


def _going_on(steps: AdaptiveStep, result: Result, span: float) -> AdaptiveStep:
    """The same tolerance, with the last step size as first one."""
    assert result.steps is not None
    first = min(float(np.median(result.steps.sizes[-3:])), 0.1 * span)
    return AdaptiveStep(steps.tolerance, first=first, largest=span)


def _check(build: object, mesh: object, scheme: object, onto: object) -> None:
    instance(build, Callable, "build", "a function from a mesh to a Scene")
    instance(mesh, LineMesh | SurfaceMesh | SplineMesh, "mesh", "a Line-, Surface- or SplineMesh")
    instance(scheme, Integrator | None, "scheme", "a scheme such as GeneralisedAlpha, or None")
    instance(onto, Callable | None, "onto", "a function of a position, or None")

"""Statics in one call: load steps or the load-capped arc length, chosen automatically."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy.typing as npt

from fem_lie._arrays import instance, whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.ranks.together import all_stay
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.starting import starting_from
from fem_lie.solve.statics.arc_length import ArcLength
from fem_lie.solve.statics.follow import beyond, followed, in_proportion
from fem_lie.solve.statics.load_steps import LoadSteps, Newton
from fem_lie.solve.statics.unstable import (
    FreeRigidMotions,
    FreeStartError,
    SingularStartError,
    warn_if_unstable,
)

_MANY = 10  # number of load steps if full steps and the arc length fail

_log = logging.getLogger(__name__)


def statics(
    scene: Scene,
    *,
    levels: Sequence[float] = (1.0,),
    spin: npt.ArrayLike = (0.0, 0.0, 0.0),
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
    load_steps: int | None = None,
    newton: Newton | None = None,
    petsc_options_prefix: str = "fem_lie_statics_",
    start: StaticResult | Result | None = None,
) -> StaticResult:
    """Equilibrium under the loads, reached from the unloaded configuration or from another state.

    Loads without history grow in proportion to the load factor, 1 at the full loads; histories,
    drives and prescribed motions are evaluated at the load factor. Steps are divided so that no
    prescribed frame rotates by more than 45° and no driven angle by more than 90° in one of them.
    Springs have their full preload in every state of the result.

    The method is chosen by the scene. Scenes with shells use the load-capped arc length
    (:func:`~fem_lie.solve.statics.follow.follow_loads`). Others go from one level to the next in
    one step, which for beams takes the fewest solutions if it converges, and otherwise use the arc
    length. If that fails, too, there are load steps; failed steps are halved, later ones grow
    again. If ``load_steps`` are given they are tried first, then the arc length. Load steps are the
    only method where the arc length is impossible, because not all loads are in proportion to the
    load factor or with ``spin`` or plain Newton, or useless, because there are tension-only bodies.

    A warning (:class:`~fem_lie.solve.statics.unstable.UnstableEquilibriumWarning`) is issued if an
    equilibrium is unstable, or was reached past a maximum of the load.

    With ``spin`` it is the equilibrium in a steadily rotating frame, with all centrifugal forces;
    frames are those at the time when the two frames coincide. Clamps, ground and prescribed motions
    then belong to the rotating frame, like a hub. Centrifugal forces grow with the load factor, the
    angular velocity with its square root. Mass damping (``Damping.mass``) acts as drag.

    From ``start`` on, Newton's method goes to equilibrium at the first of the load factors. If it
    fails, forces that are out of balance at the start are removed part by part. Load steps follow.

    Args:
        scene: The scene.
        levels: Increasing positive load factors of the requested states; load steps also return
            intermediate states.
        spin: Angular velocity of that frame, global components, rad per time.
        about: A point on the axis of rotation.
        load_steps: Number of equal steps to begin with; default: see above.
        newton: Options of load steps; plain Newton excludes other methods.
        petsc_options_prefix: Prefix for the choice of the linear solver.
        start: Result of statics, of a path or of a motion of the same bodies, whose last state is
            the start instead of the unloaded configuration: to find equilibria that are far from
            it, or one of several. Loads, supports and joints may be others; drives without a
            function hold their coordinates.

    Raises:
        ValueError: Invalid scene or options; a start of other bodies, meshes or elements; no
            inertia, or gravity or forces fixed in space that
            are not parallel to the axis, with ``spin``.
        ConvergenceError: The smallest step failed, or nothing resists a rigid motion of some body;
            its ``result`` holds the states before.
    """
    if start is not None:
        instance(start, StaticResult | Result, "start", "a result of statics, a path or dynamics")
        scene = starting_from(scene, start)
    options = StaticOptions(load_steps, newton, petsc_options_prefix)
    result = equilibrium(scene, levels, Rotation.of(spin, about), options)
    warn_if_unstable(result)
    return result


class StaticOptions(NamedTuple):
    """Options of :func:`statics`, where they are explained.

    Attributes:
        load_steps: Number of equal steps to begin with.
        newton: Options of load steps.
        prefix: Prefix for the choice of the linear solver.
    """

    load_steps: int | None = None
    newton: Newton | None = None
    prefix: str = "fem_lie_statics_"


@all_stay("statics")
def equilibrium(
    scene: Scene,
    levels: Sequence[float],
    rotation: Rotation,
    options: StaticOptions,
    free: FreeRigidMotions = FreeRigidMotions.REFUSED,
) -> StaticResult:
    """Equilibrium as of :func:`statics`, also one in which rigid motions are free.

    Args:
        scene: The scene.
        levels: Load factors.
        rotation: Steady rotation of the frame in which there is equilibrium.
        options: Options.
        free: What becomes of an equilibrium with free rigid motions.
    """
    load_steps, newton, prefix = options
    instance(newton, Newton | None, "newton", "options of fl.schemes.Newton or None")
    chosen = Newton() if newton is None else newton
    steps = 1 if load_steps is None else whole(load_steps, "load_steps")
    levels = beyond(scene, levels)
    rotation.check(scene)
    _warn_of_compressed_cables(scene)

    def stepped(count: int, smallest: float) -> StaticResult:
        search = LoadSteps(scene, rotation, chosen, prefix, free)
        return search.run(levels, levels[-1] / count, smallest)

    along = partial(followed, scene, levels, ArcLength(), prefix, free)
    asked = partial(stepped, steps, chosen.smallest_step)
    roads: list[Callable[[], StaticResult]]
    tension_only = any(body.model.tension_only for body in scene.bodies)
    has_friction = any(contact.has_friction for contact in scene.contacts)
    if (
        scene.began.state is not None
        or tension_only
        or has_friction
        or not chosen.linearised_stress
        or rotation
        or not in_proportion(scene)
    ):
        roads = [asked]
    elif load_steps is not None:
        roads = [asked, along]
    else:
        at_once, halved = (
            partial(stepped, 1, levels[-1]),
            partial(stepped, _MANY, chosen.smallest_step),
        )
        shells = any(body.model.separates_director for body in scene.bodies)
        roads = [along, halved] if shells else [at_once, along, halved]
    return _first_that_arrives(roads)


def _warn_of_compressed_cables(scene: Scene) -> None:
    """Log cables that are compressed at the start: they arch upwards, or are not found at all."""
    short = [body.label for body in scene.bodies if body.model.laid_short]
    if short and scene.began.state is None:
        _log.warning(
            "laid along a line shorter than their length, and so compressed at the start: %s. "
            "Statics may find an arch, or nothing: lay a cable along a line that is longer than it "
            "by a hundredth, or let it resist tension only, by slack=1e-5 of its formulation, "
            "or another strain well below that of the hanging cable",
            ", ".join(short),
        )


def _first_that_arrives(roads: Sequence[Callable[[], StaticResult]]) -> StaticResult:
    """Try one method after the other; failed attempts are counted.

    Raises:
        ConvergenceError: All fail; its ``result`` is that of the longest path.
    """
    errors: list[ConvergenceError] = []
    for road in roads:
        try:
            found = road()
        except SingularStartError:
            raise
        except ConvergenceError as error:
            errors.append(error)
            _log.info("%s Now another way.", error)
        else:
            vain = sum(error.result.total_iterations for error in errors)
            return replace(found, failed_iterations=found.failed_iterations + vain)
    if len(errors) == 1:
        raise errors[0]
    for cause in errors:
        if isinstance(cause, FreeStartError):
            raise cause  # the other messages tell how it showed
    farthest = max(errors, key=lambda error: error.result.factors.max(initial=0.0))
    tries = " ".join(f"({k}) {error}" for k, error in enumerate(errors, 1))
    raise ConvergenceError(f"{len(errors)} methods were tried: {tries}", farthest.result)

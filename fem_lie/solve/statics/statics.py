"""Statics in one call: load steps or a path along the loads, whichever is better."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy.typing as npt

from fem_lie._arrays import instance, whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.statics.arc_length import ArcLength
from fem_lie.solve.statics.follow import beyond, followed, in_proportion
from fem_lie.solve.statics.load_steps import LoadSteps, Newton
from fem_lie.solve.statics.unstable import SingularStartError, warn_if_unstable

_MANY = 10  # load steps where those to whole levels and the arc length fail

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
) -> StaticResult:
    """Equilibrium under the loads, reached from the unloaded configuration.

    Loads without history grow in proportion to the load factor, 1 at the full loads; histories,
    drives and prescribed motions are evaluated at the load factor. Steps are divided so that no
    prescribed frame rotates by more than 45° and no driven angle by more than 90° in one of them.
    Springs have their whole preload in every state of the result.

    How it gets there is chosen by what was measured. Scenes with shells are followed by the
    load-capped arc length (:func:`~fem_lie.solve.statics.follow.follow_loads`). Others go from one
    level to the next at once, which on beams takes the fewest solutions wherever it converges, and
    by the arc length where it does not. Where that fails, too, there are load steps; one that
    fails is halved, later ones grow back. Where ``load_steps`` are given they come first, and the
    arc length if they fail. Where it is impossible, because not all loads are in proportion to the
    load factor or with ``spin`` or plain Newton, or of no use, because there are bodies that go
    slack, there are load steps alone.

    Of an equilibrium that is unstable, or was reached past a maximum of the load, a warning
    (:class:`~fem_lie.solve.statics.unstable.UnstableEquilibriumWarning`) says so.

    With ``spin`` it is equilibrium in a frame that turns steadily, with all centrifugal forces;
    frames are those of the instant at which the two frames coincide. Clamps, ground and prescribed
    motions then belong to the turning frame: they are the hub. Centrifugal forces grow with the
    load factor, the angular velocity with its root. Damping in space (``Damping.mass``) drags.

    Args:
        scene: What there is.
        levels: Increasing positive load factors at which states are wanted; load steps also keep
            the states between.
        spin: Angular velocity of that frame, global components, rad per time.
        about: A place on the axis of rotation.
        load_steps: Number of equal steps to begin with; default: as said above.
        newton: Options of load steps; with plain Newton there is no other way.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Raises:
        ValueError: Bad scene or options; no inertia, or gravity or forces fixed in space that are
            not parallel to the axis, with ``spin``.
        ConvergenceError: The smallest step failed, or nothing resists a rigid motion of some body;
            its ``result`` holds the states before.
    """
    instance(newton, Newton | None, "newton", "options of fl.schemes.Newton or None")
    options = Newton() if newton is None else newton
    steps = 1 if load_steps is None else whole(load_steps, "load_steps")
    levels = beyond(scene, levels)
    rotation = Rotation.of(spin, about)
    rotation.check(scene)

    def stepped(count: int, smallest: float) -> StaticResult:
        search = LoadSteps(scene, rotation, options, petsc_options_prefix)
        return search.run(levels, levels[-1] / count, smallest)

    along = partial(followed, scene, levels, ArcLength(), petsc_options_prefix)
    asked = partial(stepped, steps, options.smallest_step)
    roads: list[Callable[[], StaticResult]]
    slackens = any(body.slackens for body in scene.bodies)
    has_friction = any(contact.has_friction for contact in scene.contacts)
    if (
        slackens
        or has_friction
        or not options.carried_stress
        or rotation
        or not in_proportion(scene)
    ):
        roads = [asked]
    elif load_steps is not None:
        roads = [asked, along]
    else:
        at_once, halved = (
            partial(stepped, 1, levels[-1]),
            partial(stepped, _MANY, options.smallest_step),
        )
        shells = any(body.uncoupled for body in scene.bodies)
        roads = [along, halved] if shells else [at_once, along, halved]
    result = _first_that_arrives(roads)
    warn_if_unstable(result)
    return result


def _first_that_arrives(roads: Sequence[Callable[[], StaticResult]]) -> StaticResult:
    """Try one road after the other; what was in vain is counted.

    Raises:
        ConvergenceError: None arrives; its ``result`` is the longest.
    """
    errors: list[ConvergenceError] = []
    for road in roads:
        try:
            found = road()
        except ConvergenceError as error:
            errors.append(error)
            if isinstance(error, SingularStartError):
                break
            _log.info("%s Now another way.", error)
        else:
            vain = sum(error.result.total_iterations for error in errors)
            return replace(found, failed_iterations=found.failed_iterations + vain)
    if len(errors) == 1:
        raise errors[0]
    farthest = max(errors, key=lambda error: error.result.factors.max(initial=0.0))
    tries = " ".join(f"({k}) {error}" for k, error in enumerate(errors, 1))
    raise ConvergenceError(f"{len(errors)} ways were tried: {tries}", farthest.result)

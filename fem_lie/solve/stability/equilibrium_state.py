"""Equations of small motions about any equilibrium, and the equilibrium itself.

With ``H exp(h)`` near the equilibrium ``H`` the linear equations are, without any further
assumption on the scene (:func:`fem_lie.system.small_motions.linearised`)::

    M ḧ + (C + M ad(v)) ḣ + (∂r/∂h + C ad(v)) h + Bᵀ δλ = f,    B h = 0

with ``v`` the local velocities of the steady rotation. The stiffness includes the geometric
stiffness of stress, loads and joints, and centrifugal softening; the damping includes the Coriolis
terms.
"""

from __future__ import annotations

from fem_lie._arrays import instance
from fem_lie.joints.joint import RedundantConstraints
from fem_lie.linear.direct import ConvergenceError
from fem_lie.parts.part_scene import ScenePart
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.gathering import of_part
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.statics.load_steps import Newton
from fem_lie.solve.statics.statics import StaticOptions, equilibrium
from fem_lie.solve.statics.unstable import FreeRigidMotions, warn_if_unstable
from fem_lie.system.equations import Equations
from fem_lie.system.small_motions import SmallMotions


def small_motions(
    scene: Scene,
    at: StaticResult | None,
    rotation: Rotation,
    load_steps: int = 1,
    part: ScenePart | None = None,
) -> tuple[Equations, SmallMotions]:
    """Equations of a scene, linearised about an equilibrium.

    Args:
        scene: The scene.
        at: The equilibrium, with its rotation; ``None``: the initial configuration if it is one,
            or else the result of :func:`~fem_lie.solve.statics.statics.statics`.
        rotation: Steady rotation of the frame in which there is equilibrium.
        load_steps: For statics.
        part: What this rank has of the scene, if it is divided.

    Raises:
        ValueError: Invalid scene or options, or no inertia.
        ConvergenceError: There is no equilibrium.
    """
    rotation.check(scene)
    instance(at, StaticResult | None, "at", "a result of fl.statics or None")
    if at is not None:
        if rotation:
            raise ValueError("the rotation is that of at=...; do not give spin, too")
        rotation = at.steady_rotation
    equations = Equations(scene, dynamics=True, part=part)
    if scene.redundant is not RedundantConstraints.REFUSE:
        raise ValueError("vibrations need constraints without redundant ones")
    if any(joint.velocity_definitions() for joint in scene.joints):
        raise ValueError("vibrations need position constraints, got a velocity constraint")
    state = equations.small_motions(rotation)
    if at is None and not state.balanced():
        at = _equilibrium(scene, rotation, load_steps)
    if at is not None:
        state.move(of_part(at.frames, at.info, part, equations.unknowns.bodies))
    return equations, state


def _equilibrium(scene: Scene, rotation: Rotation, load_steps: int) -> StaticResult:
    """Equilibrium by statics, down to round-off if possible.

    Soft directions are sensitive to the forces that an error of 1e-10 lengths causes along stiff
    axes.

    Raises:
        ConvergenceError: There is none; the message says how to get one.
    """

    def found(newton: Newton | None) -> StaticResult:
        options = StaticOptions(load_steps, newton)
        result = equilibrium(scene, (1.0,), rotation, options, FreeRigidMotions.ALLOWED)
        warn_if_unstable(result)
        return result

    try:
        return found(Newton(tolerance=1e-12))
    except ConvergenceError:
        pass
    try:
        return found(None)
    except ConvergenceError as error:
        raise ConvergenceError(
            "vibrations are about an equilibrium: the configuration in which the bodies were "
            "created is none under these loads, and fl.statics finds none from there. Create the "
            "bodies where they are at rest (a pendulum where it hangs), or let a damped motion "
            "come to rest and continue from its end with fl.adaptivity.transfer, or give "
            f"at=fl.statics(...) of the scene in smaller load steps. Statics says: {error}",
            error.result,
        ) from None

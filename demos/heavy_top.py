"""A heavy top at 150 rad/s: one iteration matrix for the whole run, and the choice of the group.

O. Brüls & A. Cardona, J. Comput. Nonlinear Dyn. 5 (2010) 031002; O. Brüls, A. Cardona & M. Arnold,
Mech. Mach. Theory 48 (2012) 121. Mass 15 kg, J = diag(0.234375, 0.46875, 0.234375) kg m2 about the
centre of mass, which is 1 m from the fixed point along e2; the body's frame is at the centre of
mass, a spherical joint holds it at the origin. It starts upright on +Y with the angular velocity
(0, 150, -4.61538) rad/s in its own axes; gravity acts along -Z.

In fixed axes everything turns with 150 rad/s, and an iteration matrix is of use for a few steps. In
the body's axes mass, joint and the large part of the spin are constant: one matrix lasts.

How far a step is from the truth depends on the group on which it is made,

    SE(3)      H <- H exp(d), velocity (inv(R) dx/dt, omega)     a screw motion in each step
    R3xSO3     x <- x + u, R <- R exp(theta), velocity (dx/dt, omega)

The errors of a step are h^3 times second derivatives of the velocities. The centre of mass moves
slowly in space, 4.6 m/s in a circle of precession: dx/dt has small derivatives. The body's axes
turn with 150 rad/s under it, and the same velocity in components along them, inv(R) dx/dt, has a
second derivative of 150^2 times its size. That is the price of SE(3) for a body whose
centre of mass moves by little while it spins by much; a body that turns with an axis far away, like
a blade on a hub, has a constant velocity in its own axes and is better off on SE(3). Errors of the
position (largest at the reference times, m), radius 0.9, 0.2 s:

    step [s]                   1e-3     5e-4     2.5e-4   1.25e-4
    SE3, exponential           2.2e-2   5.4e-3   1.4e-3   3.4e-4
    SE3, Cayley                5.9e-3   1.5e-3   3.7e-4   9.3e-5
    R3xSO3, exponential        1.7e-3   4.2e-4   1.1e-4   2.6e-5
    R3xSO3, Cayley             2.0e-3   5.1e-4   1.3e-4   3.2e-5

(with the Cayley map the angle about the spin axis lags: 2 atan(theta/2) per step instead of theta.)
Without --group both are run, with steps down to an eighth, and compared in a diagram.

Reference: Euler's equations about the fixed point with a quaternion, ten digits, confirmed by a
formulation with the centre of mass and constraints.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, one_of, run
from records import of_motion
from reference.tables import rotations, table

import fem_lie as fl
from fem_lie import lie

# time, centre of mass, unit quaternion (w, x, y, z) of the body's axes
REFERENCE = table("heavy_top")
MAPS = {"exponential": fl.lie.Parametrisation.EXPONENTIAL, "cayley": fl.lie.Parametrisation.CAYLEY}


def top(group: fl.lie.Group) -> fl.Scene:
    """A body on its tip."""
    scene, inertia = fl.Scene(gravity=(0, 0, -9.81)), (0.234375, 0.46875, 0.234375)
    body = scene.add(fl.RigidBody(15.0, inertia, (0, 1, 0), name="top").set_group(group))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("centre"), at=(0, 0, 0), name="tip"))
    body.add_velocity(omega=(0, 150, -4.61538), about=(0, 0, 0))
    return scene


def main(
    group: str = "R3xSO3",
    step: float = 1e-3,
    duration: float = 0.2,
    radius: float = 0.9,
    parametrisation: str = "exponential",
    pictures: bool = True,
) -> dict[str, Any]:
    one_of("group", group, fl.lie.Group.__members__)
    one_of("parametrisation", parametrisation, MAPS)
    scene = top(fl.lie.Group[group])
    result, inertial = (
        fl.GeneralisedAlpha(
            radius=radius,
            policy=fl.schemes.IterationLimit(4),
            parametrisation=MAPS[parametrisation],
            matrix_frame=components,
        ).run(scene, duration=duration, step=step)
        for components in (fl.schemes.MatrixFrame.LOCAL, fl.schemes.MatrixFrame.INERTIAL)
    )
    steps = len(result.times) - 1
    position, rotation = errors(result)
    if pictures:
        file = in_results("heavy_top.png")
        result.picture(file, trace=["top.centre"], title="Heavy top, 150 rad/s")
    return {
        "group": group,
        "parametrisation": parametrisation,
        "step": step,
        "steps": steps,
        "position_error": position,
        "rotation_error": rotation,
        "force_error": force_error(scene, result, step),
        "energy_error": result.energy_error,
        **of_motion(result, steps),
        "factorisations": result.factorisations,
        **{f"{name}_inertial": value for name, value in of_motion(inertial, steps).items()},
        "factorisations_inertial": inertial.factorisations,
    }


def both_groups(pictures: bool = True, **options: Any) -> dict[str, Any]:
    """The record of R3xSO3, and that of SE3 under ``SE3_…``."""
    apart = main("R3xSO3", pictures=pictures, **options)
    screws = main("SE3", pictures=False, **options)
    return apart | {f"SE3_{name}": value for name, value in screws.items()}


def errors(result: fl.Result) -> tuple[float, float]:
    """Largest distance (m) and angle (rad) from the reference, at its times within the run."""
    rows = [result.index(time) for time in REFERENCE[:, 0]]
    met = np.abs(result.times[rows] - REFERENCE[:, 0]) <= 1e-9
    if not met.any():
        raise ValueError("no reference time is met: wanted a step that divides 0.05 s")
    H, exact = result.frames[rows, 0][met], REFERENCE[met]
    R = np.einsum("tji,tjk->tik", rotations(exact[:, 4:]), lie.rotation(H))
    angle = np.linalg.norm(lie.so3_log(R), axis=1)
    return float(np.linalg.norm(H[:, 0] - exact[:, 1:4], axis=1).max()), float(angle.max())


def force_error(scene: fl.Scene, result: fl.Result, step: float) -> float:
    """Joint force against m (g - a) of the computed path, relative; from the first step on."""
    x = result.position("top.centre")
    a = (x[2:] - 2 * x[1:-1] + x[:-2]) / step**2
    exact = 15.0 * (np.array([0, 0, -9.81]) - a)
    force = result.joint_force("tip", axes="global")[1:-1, :3]
    return float(np.abs(force - exact).max() / np.abs(exact).max())


if __name__ == "__main__":
    run(main, without={"group": both_groups}, show=True)

"""A thin disc rolls without slip on a plane, leans over, and runs round in loops.

A coin that rolls upright fast enough stays upright: faster than sqrt(g r / 3). Slower, it falls
over, turning ever faster. The disc here is given a tilt, a spin about its axis and a yaw, and
rolls on a plane that binds the velocity of its lowest point: three numbers, of which one follows
from a constraint of positions (the disc stays on the plane) and two are bound as velocities.
Described in the frame of the disc these two depend on the point of contact alone.

The force in the contact does no work, so the energy must stay. Reference: the angular momentum
about the moving contact point, r c x (a - g) m = dL/dt, with the acceleration a of the centre from
rolling, solved for the angular acceleration and integrated to 1e-12 (Runge-Kutta of eighth order).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from scipy.integrate import solve_ivp

import fem_lie as fl
from fem_lie import lie

MASS, RADIUS, GRAVITY = 1.0, 0.3, 9.81
INERTIA = MASS * RADIUS**2 * np.array([0.25, 0.25, 0.5])
UP = np.array([0.0, 0.0, 1.0])


def start(tilt: float, spin: float, yaw: float) -> tuple[Any, Any, Any, Any]:
    """Centre, axes as columns (the third is the disc's), its velocity, angular velocity."""
    axis = np.array([0, -np.cos(tilt), np.sin(tilt)])
    along = np.array([1.0, 0, 0])
    R = np.column_stack([along, np.cross(axis, along), axis])
    lever = -lowest(axis)
    omega = spin * axis + yaw * UP
    return RADIUS * UP * lever[2] / RADIUS, R, np.cross(omega, lever), omega


def lowest(axis: Any) -> Any:
    """From the centre to the point of contact."""
    down = -(UP - (UP @ axis) * axis)
    return RADIUS * down / np.linalg.norm(down)


def reference(tilt: float, spin: float, yaw: float, times: Any) -> Any:
    """Positions of the centre by the equations of one rigid disc, shape (T, 3)."""
    x, R, _, omega = start(tilt, spin, yaw)

    def rate(t: float, state: Any) -> Any:
        R, w = state[3:12].reshape(3, 3), state[12:]
        axis, J = R[:, 2], R @ np.diag(INERTIA) @ R.T
        c, daxis = lowest(axis), np.cross(w, R[:, 2])
        up = UP - (UP @ axis) * axis
        change = -(UP @ daxis) * axis - (UP @ axis) * daxis
        size = np.linalg.norm(up)
        dc = -RADIUS * (change / size - up * (up @ change) / size**3)
        # centre: v = -w x c, a = -dw x c - w x dc; moments: J dw + w x J w = c x m (a + g UP)
        C = lie.hat(c)
        known = np.cross(c, MASS * (GRAVITY * UP - np.cross(w, dc))) - np.cross(w, J @ w)
        # c x (-dw x c) = c x (c x dw)
        dw = np.linalg.solve(J - MASS * C @ C, known)
        return np.concatenate([-np.cross(w, c), (lie.hat(w) @ R).ravel(), dw])

    first = np.concatenate([x, R.ravel(), omega])
    run = solve_ivp(rate, (0, times[-1]), first, "DOP853", times, rtol=1e-12, atol=1e-13)
    return run.y[:3].T


def disc(
    tilt: float, spin: float, yaw: float
) -> tuple[fl.Scene, fl.RigidBody, fl.joints.RollingDisc]:
    """The scene, its body and its contact."""
    scene = fl.Scene(gravity=-GRAVITY * UP)
    x, R, velocity, omega = start(tilt, spin, yaw)
    body = scene.add(fl.RigidBody(MASS, INERTIA, x, R, name="disc"))
    body.add_velocity(omega=omega, about=x)
    body.add_velocity(velocity)
    contact = scene.add(
        fl.joints.RollingDisc(fl.ground(), body.point("centre"), axis=R[:, 2], radius=RADIUS)
    )
    return scene, body, contact


def main(
    tilt: float = 20.0,
    spin: float = 12.0,
    yaw: float = 1.0,
    step: float = 1e-3,
    duration: float = 2.0,
    pictures: bool = True,
) -> dict[str, Any]:
    """Tilt in degrees, spin about the disc's axis and yaw about the vertical in rad/s."""
    lean = np.radians(tilt)
    scene, body, contact = disc(lean, spin, yaw)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    result = scheme.run(scene, duration=duration, step=step)
    exact = reference(lean, spin, yaw, result.times)
    path = result.position(body.point("centre"))
    record = {
        "step": step,
        "position_error": float(np.linalg.norm(path - exact, axis=1).max()),
        "path_length": float(np.linalg.norm(np.diff(exact, axis=0), axis=1).sum()),
        "energy_error": result.energy_error,
        "violation": float(result.joint_violation(contact).max()),
        "contact_force": float(-result.joint_force(contact)[:, 2].max()),
        "iterations_per_step": float(result.iterations[-1] / (len(result.times) - 1)),
        "seconds": result.seconds,
    }
    if pictures:
        file = in_results("rolling_disc.png")
        result.picture(file, trace=["disc.centre"], title="Disc rolling without slip")
    return record


if __name__ == "__main__":
    run(main, show=True)

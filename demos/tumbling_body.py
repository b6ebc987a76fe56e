"""A rigid body in free flight under pulsating loads, and one that turns over, against tables.

The equations are those of free_rigid_body.py.

--case paper. C. Liu & H. Hu, Chin. J. Theor. Appl. Mech. 53 (2021) 213, section 4.2: J = (3783.42,
3776.16, 2630.94) with products of inertia 352.9 (12), 484.74 (13), 469.74 (23) kg m2, v = (10, 10,
10) m/s, omega = (10, 10, 10) rad/s; force 50|sin 10t|, 52|sin(10t + pi/3)|, 50|sin(10t + pi/2)| kN
and a moment of the same numbers in kN m. The paper gives neither mass nor frames. Here the mass is
1000 kg, the force is fixed in space, the moment turns with the body, and the products are positive
off-diagonal entries of J. Reference: DOP853 to 11 digits, restarted at every kink of |sin|.

--case dzhanibekov. J = diag(1, 2, 3) kg m2, omega = (0.01, 2, 0.01) rad/s: turning about the middle
axis is unstable, and the body turns over every eleven seconds. Reference: DOP853 to 9 digits.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sin
from typing import Any

import numpy as np
from command_line import one_of, run
from diagrams import COLOURS, diagram
from free_rigid_body import angles
from reference.tables import rotations, table

import fem_lie as fl


def pulsating() -> fl.Scene:
    """The body of the paper."""
    tensor = [[3783.42, 352.9, 484.74], [352.9, 3776.16, 469.74], [484.74, 469.74, 2630.94]]
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1000.0, tensor, name="body"))
    body.add_velocity((10, 10, 10))
    body.add_velocity(omega=(10, 10, 10), about=body.point("centre"))
    for axis, (size, phase) in enumerate(((50e3, 0.0), (52e3, pi / 3), (50e3, pi / 2))):
        load, pulse = size * np.eye(3)[axis], pulse_of(phase)
        scene.add(fl.PointLoad(body.point("centre"), force=load, history=pulse))
        scene.add(fl.PointLoad(body.point("centre"), moment=load, following=True, history=pulse))
    return scene


def pulse_of(phase: float) -> Callable[[float], float]:
    return lambda t: abs(sin(10.0 * t + phase))


def tumbling() -> fl.Scene:
    """The body that turns over."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 2, 3), name="body"))
    body.add_velocity(omega=(0.01, 2, 0.01), about=body.point("centre"))
    return scene


CASES = {
    "paper": (pulsating, "pulsating_body", 1.0),
    "dzhanibekov": (tumbling, "tumbling_body", 50.0),
}


def main(
    case: str = "dzhanibekov",
    step: float = 1e-3,
    duration: float | None = None,
    radius: float = 0.8,
    pictures: bool = True,
) -> dict[str, Any]:
    one_of("case", case, CASES)
    make, name, whole = CASES[case]
    # turning about the middle axis is unstable: it multiplies what the iteration leaves
    scheme = fl.GeneralisedAlpha(radius=radius, tolerance=1e-11)
    result = scheme.run(make(), duration=duration or whole, step=step)
    exact = table(name)
    exact = exact[exact[:, 0] < result.times[-1] + 0.5 * step]
    rows, R = [result.index(t) for t in exact[:, 0]], result.rotation(0)
    turning = result.velocities[rows, 0, 3:] - exact[:, 5:8]
    if pictures:
        draw(case, result, exact)
    record: dict[str, Any] = {
        "case": case,
        "step": step,
        "radius": radius,
        "rotation_error": float(angles(R[rows], rotations(exact[:, 1:5])).max(initial=0.0)),
        "angular_velocity_error": float(np.linalg.norm(turning, axis=1).max(initial=0.0)),
        "microseconds_per_step": 1e6 * result.seconds / (len(result.times) - 1),
    }
    if case == "dzhanibekov":  # no load
        record["energy_error"] = result.energy_error
        record["angular_momentum_error"] = result.angular_momentum_error
    else:
        speed = np.einsum("tij,tj->ti", R, result.velocities[:, 0, :3])[rows] - exact[:, 8:11]
        position = result.position(0)[rows] - exact[:, 11:]
        record["velocity_error"] = float(np.linalg.norm(speed, axis=1).max())
        record["position_error"] = float(np.linalg.norm(position, axis=1).max())
    return record


def draw(case: str, result: fl.Result, exact: np.ndarray) -> None:
    """Angular velocity in the body's axes over time, and the reference."""
    with diagram(f"tumbling_body_{case}.png") as axes:
        for k in range(3):
            turning = result.velocities[:, 0, 3 + k]
            axes.plot(result.times, turning, color=COLOURS[k], label=f"ω{k + 1}")
            axes.plot(exact[:, 0], exact[:, 5 + k], "o", color=COLOURS[k], markersize=4)
        title = f"{case}; dots: reference"
        axes.set(xlabel="t [s]", ylabel="angular velocity [rad/s]", title=title)


if __name__ == "__main__":
    run(main, show=True)

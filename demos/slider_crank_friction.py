"""A spatial slider-crank whose slider has Coulomb friction under the forces of its rail.

The mechanism is that of demos/slider_crank.py with a flywheel on the crank and a rod without mass:
a drive without a function keeps the distance of its ends. The rail carries the weight of the slider
and what the rod pushes across it, which changes with the motion; friction is μ tanh(s/s₀) times the
norm of both, with the speed s. The flywheel carries the mechanism through the points where the
slider turns back.

Reference: one equation for the angle φ of the crank. With the slider at x(φ) and the force S |d| in
the rod, whose vector d = (-x, y, z) points to the crank,

    J φ'' = S x dx/dφ + M(φ),    m x'' = -S x - μ tanh(x'/s₀) |(S y, S z - m g)|.

The second equation gives S for each state; solve_ivp integrates the first.
"""

from __future__ import annotations

from math import cos, hypot, sin, sqrt, tanh
from typing import Any

import numpy as np
from command_line import in_results, run
from scipy.integrate import solve_ivp

import fem_lie as fl

PIVOT, CRANK_END, SLIDER = np.array([[0, 0.1, 0.12], [0, 0.1, 0.2], [0.2, 0, 0]])
ROD, FLYWHEEL, MASS, SPEED = 0.3, 0.02, 2.0, 6.0
INERTIA, TORQUE, WEIGHT = FLYWHEEL + 0.12 * 0.04**2, 0.12 * 9.81 * 0.04, MASS * 9.81
FRICTION, SLOW = 0.2, 0.02
"""Coefficient of friction, and stiction speed, m/s."""


def mechanism() -> tuple[fl.Scene, fl.joints.Revolute]:
    """The scene, and the hinge of the crank."""
    scene, ground = fl.Scene(gravity=(0, 0, -9.81)), fl.ground()
    crank = scene.add(fl.RigidBody(0.12, (FLYWHEEL, 0.01, 0.01), 0.5 * (PIVOT + CRANK_END)))
    slider = scene.add(fl.RigidBody(MASS, (1e-3, 1e-3, 1e-3), SLIDER))
    crank.add_velocity(omega=(SPEED, 0, 0), about=PIVOT)
    slider.add_velocity((0.04 * SPEED, 0, 0))
    axle, centre = crank.point("centre"), slider.point("centre")
    hinge = scene.add(fl.joints.Revolute(ground, axle, at=PIVOT, axis=(1, 0, 0)))
    rail = scene.add(fl.joints.Prismatic(ground, centre, axis=(1, 0, 0), name="rail"))
    rod = scene.add(fl.joints.Distance(crank.point(CRANK_END), centre))
    scene.add(fl.joints.Drive(rod.length))
    scene.add(fl.joints.JointFriction(rail, FRICTION, stiction_speed=SLOW, name="friction"))
    return scene, hinge


def rates(_: float, state: Any) -> tuple[float, float]:
    """Rate and acceleration of the crank."""
    angle, rate = state
    y, z = 0.1 - 0.08 * sin(angle), 0.12 + 0.08 * cos(angle)
    x = sqrt(ROD**2 - y**2 - z**2)
    dx = 0.08 * (0.1 * cos(angle) + 0.12 * sin(angle)) / x
    ddx = (0.08 * (0.12 * cos(angle) - 0.1 * sin(angle)) - dx**2) / x
    pull, moment = 0.0, TORQUE * sin(angle)
    inertial, per_pull = MASS * (dx * moment / INERTIA + ddx * rate**2), 1 + MASS * dx**2 / INERTIA
    for _ in range(40):  # friction depends on the force of the rod
        friction = FRICTION * tanh(dx * rate / SLOW) * hypot(pull * y, pull * z - WEIGHT)
        pull = -(inertial + friction) / (x * per_pull)
    return rate, (moment + pull * x * dx) / INERTIA


def main(step: float = 5e-4, duration: float = 2.0, pictures: bool = True) -> dict[str, Any]:
    """Largest errors of the angle and of the energy balance, and range of the normal force."""
    scene, hinge = mechanism()
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=duration, step=step, save_every=10)
    exact = solve_ivp(rates, (0, duration), (0, SPEED), "DOP853", result.times, rtol=1e-10)
    error = float(np.abs(result.coordinate(hinge) - exact.y[0]).max())
    normal = np.sort(np.linalg.norm(result.joint_force("rail")[:, :2], axis=1))[[0, -1]].tolist()
    if pictures:
        result.picture(in_results("slider_crank_friction.png"), title="Slider-crank with friction")
    return {"error": error, "balance": result.energy_error, "normal": normal}


if __name__ == "__main__":
    run(main, show=True)

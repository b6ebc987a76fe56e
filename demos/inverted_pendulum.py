"""An inverted pendulum on a cart is balanced by a sampled PID controller.

The controller samples the angle every 20 ms and sets the force on the cart, which is constant until
the next sample. Its memory, the sum of the angles and the last angle, is in checkpoints. The cart
is free to drift.

Reference: linear theory. Between samples the equations of motion with a constant force have an
exact solution (matrix exponential).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from scipy.linalg import expm

import fem_lie as fl

CART, POLE, LENGTH, INERTIA, GRAVITY, PERIOD, TILT = 1.0, 0.2, 0.3, 0.006, 9.81, 0.02, 1e-3
GAIN, INTEGRAL, RATE = 40.0, 60.0, 4.0


def force(angle: float, memory: Any) -> tuple[float, list[float]]:
    """Force of the controller, and its memory: integral of the angle, last angle."""
    total = memory[0] + PERIOD * angle
    return GAIN * angle + INTEGRAL * total + RATE / PERIOD * (angle - memory[1]), [total, angle]


def pendulum() -> fl.Scene:
    """Cart on a rail along x, and a pole hinged to it that leans to x."""
    turn = fl.lie.so3_exp([0.0, TILT, 0.0])
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    cart = scene.add(fl.RigidBody(CART, (0.01, 0.01, 0.01)))
    pole = scene.add(fl.RigidBody(POLE, (INERTIA, INERTIA, 1e-4), LENGTH * turn[:, 2], turn))
    middle, centre = cart.point("centre"), pole.point("centre")
    scene.add(fl.joints.Prismatic(fl.ground(), middle, axis=(1, 0, 0)))
    hinge = scene.add(fl.joints.Revolute(middle, centre, at=(0, 0, 0), axis=(0, 1, 0)))
    drive = scene.add(fl.PointLoad(middle, force=(1, 0, 0)))
    angle = fl.schemes.Sensor("angle", lambda state: TILT + state.coordinate(hinge))
    pid = fl.schemes.Controller(
        lambda state, memory: force(angle.quantity(state), memory), [drive], PERIOD, (0.0, TILT)
    )
    scene.add(angle)
    scene.add(pid)
    return scene


def reference(samples: int) -> np.ndarray:
    """Angle at the samples by linear theory."""
    mass = np.array([[CART + POLE, POLE * LENGTH], [POLE * LENGTH, INERTIA + POLE * LENGTH**2]])
    matrix = np.zeros((5, 5))  # of x, angle, their rates, and the constant force
    matrix[:2, 2:4] = np.eye(2)
    matrix[2:4, 1] = np.linalg.solve(mass, [0.0, POLE * GRAVITY * LENGTH])
    matrix[2:4, 4] = np.linalg.solve(mass, [1.0, 0.0])
    over, state, memory, found = expm(PERIOD * matrix), TILT * np.eye(5)[1], [0.0, TILT], []
    for _ in range(samples):
        found.append(state[1])
        state[4], memory = force(state[1], memory)
        state = over @ state
    return np.array(found)


def main(step: float = 1e-3, samples: int = 150, pictures: bool = True) -> dict[str, Any]:
    """Angles over ``samples`` periods, over the initial one."""
    scheme, duration = fl.GeneralisedAlpha(radius=0.9), PERIOD * samples
    result = scheme.run(pendulum(), duration=duration, step=step, save_every=20)
    every = round(PERIOD / step)
    angle, exact = result.sensor("angle")[:-1:every], reference(samples)
    if pictures:
        result.picture(in_results("inverted_pendulum.png"), title="Inverted pendulum on a cart")
    angles, error = angle[::10] / TILT, float(np.abs(angle - exact).max() / TILT)
    return {"angles": angles.tolist(), "error": error, "seconds": result.seconds}


if __name__ == "__main__":
    run(main, show=True)

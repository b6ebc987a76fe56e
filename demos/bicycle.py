"""A bicycle without a rider's hands steers itself upright between two speeds.

Four rigid bodies, rear frame with rider, fork, two wheels, three revolute joints, and two discs
that roll without slip. Upright motion is steady at any speed. After a small push it decays between
4.292 m/s, below which the bicycle weaves with a growing amplitude, and 6.024 m/s, above which it
capsizes slowly. No damping does this: gyroscopic moments and the trail of the fork couple lean
and steer, and the constraints of rolling are not holonomic.

Reference: the benchmark of Meijaard, Papadopoulos, Ruina & Schwab, Linearized dynamics equations
for the balance and steer of a bicycle, Proc. R. Soc. A 463 (2007), its table 1 for the bicycle, and
its roots at 5 m/s. Rates here are those of a sum of exponentials that is fitted to the steer angle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram
from scipy.optimize import least_squares

import fem_lie as fl

BASE, TRAIL, TILT, GRAVITY = 1.02, 0.08, np.pi / 10, 9.81
REAR, FRONT = 0.3, 0.35  # radii of the wheels
WEAVE, CAPSIZE = complex(-0.77534188219585, 4.46486771378823), -0.32286642900409  # at 5 m/s
FRAME = [[9.2, 0, -2.4], [0, 11, 0], [-2.4, 0, 2.8]]
FORK = [[0.05892, 0, 0.00756], [0, 0.06, 0], [0.00756, 0, 0.00708]]
PUSH = 1.0  # N, on the frame for 0.1 s


def bicycle(speed: float) -> tuple[fl.Scene, fl.joints.Revolute]:
    """The scene, x forwards and z up, and the joint of the steer angle."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    frame = scene.add(fl.RigidBody(85.0, FRAME, position=(0.3, 0, 0.9), name="frame"))
    fork = scene.add(fl.RigidBody(4.0, FORK, position=(0.9, 0, 0.7), name="fork"))
    for holder, x, radius, mass, inertia in (
        (frame, 0.0, REAR, 2.0, (0.0603, 0.12, 0.0603)),
        (fork, BASE, FRONT, 3.0, (0.1405, 0.28, 0.1405)),
    ):
        hub = (x, 0, radius)
        wheel = scene.add(fl.RigidBody(mass, inertia, position=hub))
        holder.add_velocity((speed, 0, 0))
        wheel.add_velocity((speed, 0, 0), omega=(0, speed / radius, 0), about=hub)
        a, b, across = holder.point("centre"), wheel.point("centre"), (0, 1, 0)
        scene.add(fl.joints.Revolute(a, b, at=hub, axis=across))
        scene.add(fl.joints.RollingDisc(fl.ground(), b, radius=radius, axis=across))
    axis = np.array([-np.sin(TILT), 0, np.cos(TILT)])
    at, a, b = (BASE + TRAIL, 0, 0) + 0.8 * axis, frame.point("centre"), fork.point("centre")
    steer = scene.add(fl.joints.Revolute(a, b, at=at, axis=axis, name="steer"))
    pulse = {"force": (0, PUSH, 0), "history": lambda t: np.sin(10 * np.pi * t) ** 2 * (t < 0.1)}
    scene.add(fl.PointLoad(frame.point("centre"), **pulse))
    return scene, steer


def roots(times: np.ndarray, angle: np.ndarray) -> tuple[complex, float]:
    """Root of the weave in the upper half-plane, and of the capsize, fitted to an angle."""

    def misfit(rates: np.ndarray) -> np.ndarray:
        growth, frequency, capsize = rates
        wave = np.exp(complex(growth, frequency) * times)
        basis = np.column_stack([wave.real, wave.imag, np.exp(capsize * times)])
        return basis @ np.linalg.lstsq(basis, angle, rcond=None)[0] / abs(angle).max() - scaled

    scaled = angle / abs(angle).max()
    growth, frequency, capsize = least_squares(misfit, (0.0, 4.0, 0.0), xtol=1e-14, ftol=1e-14).x
    return complex(growth, frequency), capsize


def main(
    speed: float = 5.0, duration: float = 4.0, step: float = 1e-3, pictures: bool = True
) -> dict[str, Any]:
    """Rates of weave and capsize; at 5 m/s their errors against the benchmark, too."""
    scene, steer = bicycle(speed)
    # by default iterations end at 2e-8 of a length, 3e-4 of such small angles
    scheme = fl.GeneralisedAlpha(tolerance=1e-10)
    result = scheme.run(scene, duration=duration, step=step)
    times, angle = result.times, result.coordinate(steer)
    later = times > 1.2  # the fourth root, -14 per second, has decayed
    weave, capsize = roots(times[later], angle[later])
    if pictures:
        with diagram("bicycle.png") as axes:
            axes.plot(times, np.degrees(angle), color=COLOURS[0])
            axes.set(xlabel="time in s", ylabel="steer angle in degrees", title="After a push")
    found = {"weave": weave.real, "weave_frequency": weave.imag, "capsize": capsize}
    if speed == 5.0:
        found["weave_error"] = abs(weave - WEAVE) / abs(WEAVE)
        found["capsize_error"] = abs(capsize / CAPSIZE - 1)
    return found | {"energy_error": result.energy_error}


if __name__ == "__main__":
    run(main, show=True)

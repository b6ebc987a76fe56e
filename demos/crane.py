"""A crane moves a load on a heavy flexible cable: flatness gives the force, feedback removes sway.

A trolley of mass m runs on a rail. A load of mass M hangs from it on a cable of length L and mass
rho L. A force on the trolley is set every 20 ms. *Feed-forward*: small motions of the cable are a
series in the derivatives of the motion y(t) of the load (N. Petit & P. Rouchon, SIAM J. Control
Optim. 40 (2001) 475),

    w(z, t) = sum c_k(z) y^(2k)(t),    (T c_k')' = rho c_(k-1),    T(z) = g (M + rho z),

z upwards from the load, whose equation of motion is T c_k' = M c_(k-1) at z = 0; the force follows
from the momentum. So the load arrives at rest. *Feedback*: the load is pulled aside and let go; a
controller compares position and rate of the trolley, and the sway of the load, with those planned.

Reference: linear theory, 400 elements of a string, exact between samples (matrix exponential).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import diagram
from reference.crane import Control, Crane

import fem_lie as fl

CRANE = Crane(trolley=100.0, load=50.0, line=2.0, length=10.0)
WAY, TIME, PERIOD, PULL = 0.2, 8.0, 0.02, 1.0
GAINS = np.array([150.0, 250.0, -200.0])  # of the trolley's position and rate, and of the sway


def crane(control: Control, pull: float, cells: int) -> tuple[fl.Scene, fl.StaticResult]:
    """Trolley, cable and load, and where they hang while the load is pulled."""
    section = fl.Section.from_stiffness([1e7, 1e6, 1e6, 1e-2, 1e-2, 1e-2], mass=CRANE.line)
    scene, low = fl.Scene(gravity=(0, 0, -CRANE.gravity)), (0, 0, -CRANE.length)
    trolley, load = (CRANE.trolley, 3 * (1.0,)), (CRANE.load, 3 * (1e-2,), low)
    centre, end = (scene.add(fl.RigidBody(*body)).point("centre") for body in (trolley, load))
    line = scene.add(fl.Beam.straight((0, 0, 0), low, section, cells=cells, name="cable"))
    scene.add(fl.joints.Universal(centre, line.point("start"), axis=(0, 1, 0), second=(1, 0, 0)))
    scene.add(fl.joints.RigidLink(line.point("end"), end))
    held = scene.with_loads(fl.PointLoad(end, force=(pull, 0, 0)))
    held.add(fl.Clamp(centre))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), centre, axis=(1, 0, 0)))
    drive = scene.add(fl.PointLoad(centre, force=(1, 0, 0)))

    def update(state: fl.schemes.State, _: np.ndarray) -> tuple[float, list[float]]:
        x, load = state.position(centre)[0], state.position(end)[0]
        return control(state.time, np.array([x, state.rate(rail), load - x])), []

    scene.add(fl.schemes.Controller(update, [drive], PERIOD))
    scene.add(fl.schemes.Sensor("load", lambda state: state.position(end)[0]))
    return scene, fl.statics(held)


def main(
    cells: int = 20, step: float = 5e-3, duration: float = 16.0, pictures: bool = True
) -> dict[str, Any]:
    every, samples, scheme = round(PERIOD / step), round(duration / PERIOD), fl.GeneralisedAlpha()
    cases = {"undisturbed": (0.0, 0.0), "pulled": (PULL, 0.0), "feedback": (PULL, 1.0)}
    record, found = {}, {}
    for name, (pull, on) in cases.items():
        control = Control(CRANE, WAY, TIME, on * GAINS)
        scene, start = crane(control, pull, cells)
        result = scheme.run(scene, duration=duration, step=step, save_every=every, start=start)
        found[name] = result.sensor("load")[:-1:every]
        error = found[name] - CRANE.motion(pull, control, PERIOD, samples)
        record[f"{name}_error"] = float(np.abs(error).max() / WAY)
        record[f"{name}_left"] = float(np.ptp(found[name][-150:]) / WAY)
    if pictures:
        with diagram("crane.png") as axes:
            axes.plot(PERIOD * np.arange(samples), np.transpose([*found.values()]), label=[*found])
            axes.set(xlabel="time [s]", ylabel="position of the load [m]", title="Crane")
            axes.legend()
    return record


if __name__ == "__main__":
    run(main, show=True)

"""Double four-bar mechanism: ten seconds through postures in which it may change its branch.

IFToMM benchmark A02 with N = 2. Three bars stand upright on hinges at x = 0, 1, 2 m, two bars join
their tops; all are 1 m and 1 kg, thin. Gravity acts along -y; the top of the first bar, B0, starts
with 1 m/s along x. The upright bars stay parallel and the mechanism is one pendulum,
3 theta" = -3.5 g cos(theta) (reference: that, to ten digits).

Where all bars lie flat, twice per turn or swing, the constraints lose rank: each loop could go over
to its crossed branch, and the joint forces there are not unique. Only the velocity says how it goes
on. A step that ends near the flat posture, at an angle of d from it, has an iteration matrix with
an eigenvalue of d^2, so round-off counts as 1/d^2: an iteration that is to converge to 1e-10 may
find no end there with hinges. --tolerance is 1e-8 for that reason; what that leaves adds up, so
steps below 2e-3 want less of it.

Two ways to write it: five hinges for each loop of bars, of which six constraints too many in all
(Redundant.MINIMUM_NORM; they are planar), or at one end of each upper bar a pin, a point that stays
in two planes of the next upright bar (InPlane), with nothing redundant but in the flat posture.
The conserving scheme takes the second only. It iterates to round-off, which there is what the last
digits of the posture make of it: it asks for that when its increments fall no more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from extrapolation import extrapolated
from reference.tables import table

import fem_lie as fl

REFERENCE = table("double_four_bar")
INERTIA, HALF = (1e-9, 1.0 / 12.0, 1.0 / 12.0), np.array([0.5, 0.0, 0.0])
Scheme = fl.GeneralisedAlpha | fl.EnergyMomentum
Step = float | fl.schemes.AdaptiveStep
Found = tuple[fl.Result, np.ndarray, dict[str, Any]]


def mechanism(angle: float = np.pi / 2, speed: float = 1.0, pins: bool = False) -> fl.Scene:
    """The scene at an angle of the upright bars from x, which turn backwards with ``speed``."""
    redundant = fl.joints.RedundantConstraints["REFUSE" if pins else "MINIMUM_NORM"]
    scene = fl.Scene(gravity=(0, -9.81, 0), redundant=redundant)
    along, z = np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    axes = np.column_stack([along, np.cross(z, along), z])
    upright = []
    for k in range(3):
        foot = np.array([k, 0.0, 0.0])
        bar = scene.add(fl.RigidBody(1.0, INERTIA, foot + 0.5 * along, axes, name=f"bar {k}"))
        bar.add_velocity(omega=-speed * z, about=foot)
        upright.append(bar.point("centre"))
        scene.add(fl.joints.Revolute(fl.ground(), upright[k], at=foot, axis=z))
    for k in range(2):
        position = np.array([k + 0.5, 0.0, 0.0]) + along
        bar = scene.add(fl.RigidBody(1.0, INERTIA, position, name=f"top {k}"))
        bar.add_velocity(np.cross(-speed * z, along))
        left, right, top = position - HALF, position + HALF, bar.point("centre")
        scene.add(fl.joints.Revolute(upright[k], top, at=left, axis=z))
        if pins:
            for normal in np.eye(3)[:2]:
                scene.add(fl.joints.InPlane(upright[k + 1], top, at=right, axis=normal))
        else:
            scene.add(fl.joints.Revolute(top, upright[k + 1], at=right, axis=z))
    return scene


def parallel(result: fl.Result) -> float:
    """Largest angle between two of the upright bars: round-off on the regular branch."""
    axes = [result.rotation(f"bar {k}.centre")[:, :2, 0] for k in range(3)]
    cross = [a[:, 0] * axes[0][:, 1] - a[:, 1] * axes[0][:, 0] for a in axes[1:]]
    dot = [(a * axes[0]).sum(axis=1) for a in axes[1:]]
    return float(np.abs(np.arctan2(cross, dot)).max())


def attempt(scheme: Scheme, scene: fl.Scene, duration: float, step: Step) -> Found:
    """One run, as far as it comes: what is found, the path of a corner, and how good they are."""
    try:
        result = scheme.run(scene, duration=duration, step=step)
    except fl.ConvergenceError as error:
        result = error.result
    rows = REFERENCE[REFERENCE[:, 0] <= result.times[-1] * (1 + 1e-12)]
    path = 2.0 * result.resampled(rows[:, 0]).position("bar 0.centre")[:, :2]
    numbers = {
        "end": float(result.times[-1]),
        "error": float(np.abs(path - rows[:, 1:3]).max()),
        "angle_between": parallel(result),
        "energy_error": result.energy_error,
    }
    return result, path, numbers


def main(
    step: float = 4e-3,
    runs: int = 2,
    duration: float = 10.0,
    tolerance: float = 1e-8,
    pictures: bool = True,
) -> dict[str, Any]:
    """``runs``: constant steps of step, step/2 and so on; each must divide 0.5 s."""
    alpha, conserving = fl.GeneralisedAlpha(radius=0.9, tolerance=tolerance), fl.EnergyMomentum()
    variable = fl.schemes.AdaptiveStep(1e-3, largest=0.02)
    found = [attempt(alpha, mechanism(), duration, step / 2**k) for k in range(runs)]
    shared = min(len(path) for _, path, _ in found)
    limit = extrapolated([path[:shared] for _, path, _ in found])
    if pictures:
        found[-1][0].picture(in_results("double_four_bar.png"), title="Double four-bar mechanism")
    return {
        "hinges": found[-1][2],
        "pins": attempt(alpha, mechanism(pins=True), duration, step)[2],
        "variable": attempt(alpha, mechanism(), duration, variable)[2],
        "conserving": attempt(conserving, mechanism(pins=True), duration, step)[2],
        "step": step,
        "errors": [numbers["error"] for _, _, numbers in found],
        "extrapolated": float(np.abs(limit - REFERENCE[:shared, 1:3]).max()),
    }


if __name__ == "__main__":
    run(main, show=True)

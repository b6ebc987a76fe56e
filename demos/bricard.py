"""Bricard's mechanism: six hinges in a loop that could not move if their axes were not special.

IFToMM benchmark A04. Five bars of 1 m and 1 kg, square section 0.1 m, and the ground form a closed
loop with six revolute joints, along edges of a cube. Counting says that it cannot move: 5 x 6
coordinates, 6 x 5 constraints. One of these follows from the others because of the geometry, so
there is one degree of freedom, and one joint force that the motion does not decide.

fem_lie refuses such a scene unless it may choose the smallest of all possible joint forces:
Scene(redundant=fl.joints.RedundantConstraints.MINIMUM_NORM). The mechanism falls under gravity
along -y from rest and comes back. Reference: maximal coordinates with least squares, 8 digits
early, 7 at the end. Runs with --step, half of it and so on are extrapolated.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from command_line import in_results, run
from extrapolation import largest_errors, order
from reference.tables import table

import fem_lie as fl

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], float)
AXES = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0]], float)
REFERENCE = table("bricard")
EVERY = 0.25
"""Time between two rows of the reference."""


def mechanism(redundant: fl.joints.RedundantConstraints) -> tuple[fl.Scene, fl.RigidBody]:
    """The scene, and the bar from P2 to P3."""
    scene = fl.Scene(gravity=(0, -9.81, 0), redundant=redundant)
    along, across = 0.1**2 / 6, (1.0 + 0.1**2) / 12
    bars = []
    for start, end in pairwise(POINTS):
        inertia = np.where(end - start != 0, along, across)
        bars.append(scene.add(fl.RigidBody(1.0, inertia, 0.5 * (start + end))))
    sides = [fl.ground(), *(bar.point("centre") for bar in bars), fl.ground()]
    for k, (a, b) in enumerate(pairwise(sides)):
        scene.add(fl.joints.Revolute(a, b, at=POINTS[k], axis=AXES[k], name=f"hinge {k}"))
    return scene, bars[2]


def refusal(step: float) -> str:
    """What is said of the scene by default."""
    try:
        fl.GeneralisedAlpha().run(
            mechanism(fl.joints.RedundantConstraints.REFUSE)[0], duration=step, step=step
        )
    except ValueError as error:
        return str(error)
    return ""


def main(
    step: float = 1e-3, runs: int = 2, duration: float = 10.0, pictures: bool = True
) -> dict[str, Any]:
    """``runs``: with step, step/2 and so on; each must divide 0.25 s."""
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    corner = POINTS[3] - 0.5 * (POINTS[2] + POINTS[3])
    results = []
    for h in (step / 2**k for k in range(runs)):
        scene, bar = mechanism(fl.joints.RedundantConstraints.MINIMUM_NORM)
        result = scheme.run(scene, duration=duration, step=h, save_every=round(EVERY / h))
        path = result.position(bar.point("centre")) + result.rotation(bar.point("centre")) @ corner
        results.append(path[1:])
    reference = REFERENCE[1 : len(result.times), 1:]
    errors, limit = largest_errors(results, reference)
    forces = np.abs(result.joint_forces[:, :, :3]).max(axis=(0, 2))
    steps = round(duration / h)
    record = {
        "step": step,
        "refusal": refusal(step),
        "order": order(results),
        "position_errors": errors.max(axis=1).tolist(),
        "extrapolated": float(limit.max()),
        "energy_error": result.energy_error,
        "violation": float(result.joint_violations.max()),
        "largest_force": float(forces.max()),
        "iterations_per_step": float(result.iterations[-1] / steps),
        "matrices_per_step": result.factorisations / steps,
        "seconds": result.seconds,
    }
    if pictures:
        file = in_results("bricard.png")
        result.picture(file, title="Bricard's mechanism")
    return record


if __name__ == "__main__":
    run(main, show=True)

"""What joint forces of least norm cost: a table of docs/measured/joints.md.

    python3 -m benchmarks.minimum_norm [bodies ...]

Chains of rigid bodies on hinges about the same axis, which fall from the horizontal, 50 steps.
Nothing is redundant in them: what is measured is the price of the choice alone. Seconds are those
of the processor, setup included, machine code made before.
"""

from __future__ import annotations

import sys
from time import process_time

import numpy as np

import fem_lie as fl

STEPS, STEP = 50, 1e-3


def chain(bodies: int, redundant: fl.joints.RedundantConstraints) -> fl.Scene:
    """Bodies of 1 kg and 1 m along x, hinged about z to each other and to the ground."""
    scene = fl.Scene(gravity=(0, -9.81, 0), redundant=redundant)
    last = fl.ground()
    for k in range(bodies):
        body = scene.add(fl.RigidBody(1.0, (0.01, 0.1, 0.1), (k + 0.5, 0, 0)))
        scene.add(fl.joints.Revolute(last, body.point("centre"), at=(k, 0, 0), axis=(0, 0, 1)))
        last = body.point("centre")
    return scene


def row(bodies: int, redundant: fl.joints.RedundantConstraints) -> tuple[str, np.ndarray]:
    """A row of the table, and the joint forces."""
    scene = chain(bodies, redundant)
    begin = process_time()
    result = fl.GeneralisedAlpha().run(scene, duration=STEPS * STEP, step=STEP, progress=False)
    seconds = process_time() - begin
    each = result.iterations[-1] / STEPS
    line = (
        f"| {bodies} | `{redundant.name}` | {seconds:.2f} | {result.factorisations} | {each:.1f} |"
    )
    return line, result.joint_forces


def main(sizes: tuple[int, ...] = (100, 200, 400)) -> None:
    for redundant in fl.joints.RedundantConstraints:  # machine code
        row(3, redundant)
    print("| bodies | redundant | s | factorisations | iterations per step |")
    print("|---" * 5 + "|")
    for bodies in sizes:
        (refused, expected), (least, found) = (
            row(bodies, kind) for kind in fl.joints.RedundantConstraints
        )
        gap = np.abs(found - expected).max() / np.abs(expected).max()
        print(refused, f"{least} joint forces: {gap:.0e} apart", sep="\n", flush=True)


if __name__ == "__main__":
    main(tuple(map(int, sys.argv[1:])) or (100, 200, 400))

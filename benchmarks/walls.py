"""Walls of bricks, at rest and struck by a ball: speed of what rests, energy, time per step.

    tools/run python3 -m benchmarks.walls --rows 3 5 10
    tools/run python3 -m benchmarks.walls --stack 10 --steps 2000

A wall has as many rows as bricks in each, in running bond with half bricks at the ends. Bricks
next to each other do not touch, and friction is 0.5, without restitution. Printed are the contacts,
the largest residual of the cones, the largest velocity after the wall has stood for a while, the
largest growth of energy in a step, relative to the energy, and milliseconds of the processor per
step. Then a ball meets the wall. ``--stack`` puts that many cubes upon each other instead.
"""

from __future__ import annotations

import argparse
from time import process_time

import numpy as np

import fem_lie as fl

BRICK, DENSITY, GRAVITY, FRICTION, STEP = (0.2, 0.1, 0.1), 1500.0, 9.81, 0.5, 5e-3
RADIUS, MASS, SPEED = 0.15, 20.0, 5.0

Box = tuple[fl.contact.Box, tuple[float, float], int]


def brick(scene: fl.Scene, length: float, x: float, row: int) -> Box:
    """A brick with its ends along the wall, and its row."""
    edges = length, *BRICK[1:]
    mass = DENSITY * float(np.prod(edges))
    body = scene.add(fl.RigidBody.box(mass, edges, (x, 0, (row + 0.5) * BRICK[2])))
    box = fl.contact.Box(body.point("centre"), edges)
    return box, (x - 0.5 * length, x + 0.5 * length), row


def wall(rows: int, struck: bool = False) -> fl.Scene:
    """A wall on a floor; a ball may fly towards its middle."""
    scene, law = fl.Scene(gravity=(0, 0, -GRAVITY)), fl.contact.Impact(FRICTION)
    floor, length, bricks = fl.contact.Plane(fl.ground(), (0, 0, 1)), BRICK[0], []
    for row in range(rows):
        if row % 2 == 0:
            bricks += [brick(scene, length, (k + 0.5) * length, row) for k in range(rows)]
        else:
            bricks += [brick(scene, length, k * length, row) for k in range(1, rows)]
            ends = 0.25 * length, (rows - 0.25) * length
            bricks += [brick(scene, 0.5 * length, x, row) for x in ends]
    for box, (left, right), row in bricks:
        if row == 0:
            scene.add(fl.contact.Contact(box, floor, law))
        for other, (start, end), above in bricks:
            if above == row + 1 and min(right, end) - max(left, start) > 0.01 * length:
                scene.add(fl.contact.Contact(box, other, law))
    if struck:
        place = 0.5 * rows * length, -0.3, 0.6 * rows * BRICK[2]
        body = scene.add(fl.RigidBody.ball(MASS, RADIUS, place))
        body.add_velocity((0, SPEED, 0))
        ball = fl.contact.Sphere(body.point("centre"), RADIUS)
        for surface in (*(box for box, _, _ in bricks), floor):
            scene.add(fl.contact.Contact(ball, surface, law))
    return scene


def stack(cubes: int) -> fl.Scene:
    """Cubes upon each other on a floor."""
    scene, law, size = fl.Scene(gravity=(0, 0, -GRAVITY)), fl.contact.Impact(FRICTION), BRICK[0]
    below: fl.contact.Plane | fl.contact.Box = fl.contact.Plane(fl.ground(), (0, 0, 1))
    for k in range(cubes):
        body = scene.add(fl.RigidBody.box(DENSITY * size**3, (size,) * 3, (0, 0, (k + 0.5) * size)))
        cube = fl.contact.Box(body.point("centre"), (size,) * 3)
        scene.add(fl.contact.Contact(cube, below, law))
        below = cube
    return scene


def measured(scene: fl.Scene, steps: int) -> str:
    """A row of the table."""
    scheme = fl.GeneralisedAlpha(radius=0.8)
    scheme.run(scene, duration=STEP, step=STEP, progress=False)  # what is compiled is there then
    before = process_time()
    try:
        result = scheme.run(scene, duration=steps * STEP, step=STEP, progress=False)
    except fl.ConvergenceError as failure:
        return f"fails: {failure}"
    seconds, solved = process_time() - before, result.contacts
    assert solved is not None
    energy = np.asarray(result.kinetic + result.potential)
    growth = np.diff(energy).max() / np.abs(energy).max()
    return (
        f"{solved.contacts.max():.0f} contacts, residual {solved.cone_residual.max():.1e}, "
        f"velocity at the end {np.abs(result.velocities[-1]).max():.1e}, "
        f"growth of energy {growth:.1e}, {1e3 * seconds / steps:.1f} ms per step"
    )


def main() -> None:
    """Print the rows of each size."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rows", type=int, nargs="+", default=[3, 5, 10], metavar="N")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--stack", type=int, metavar="N", help="cubes instead of walls")
    given = parser.parse_args()
    if given.stack:
        print(f"{given.stack} cubes: {measured(stack(given.stack), given.steps)}", flush=True)
        return
    for rows in given.rows:
        for struck in (False, True):
            name = "struck" if struck else "at rest"
            print(f"{rows} rows, {name}: {measured(wall(rows, struck), given.steps)}", flush=True)


if __name__ == "__main__":
    main()

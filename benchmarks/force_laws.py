"""What force laws of users cost in a step: Python and compiled against a built-in spring, in turns.

    RUN benchmarks/force_laws.py [--rounds 9] [--steps 20000]

A body oscillates on a rail: by a Spring, by the same law as a Python function with given
derivatives, and compiled. So that the law itself counts, there is nothing else in the scene.
Microseconds per step are processor time, the least of all rounds, of which a run of a tenth of the
steps is taken away. Targets: 3 times of a spring for Python, 1.1 times for compiled laws.

Events are measured as well: a body that rests on a stop (Limit), with microseconds per step.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from time import thread_time

import numpy as np

import fem_lie as fl

STIFFNESS, DAMPING, STEP = 50.0, 0.02, 1e-3


@fl.loads.compiled_law
def compiled(t: float, q: float, rate: float) -> float:
    """The law of the spring."""
    return 50.0 * q + 0.02 * rate


def body() -> tuple[fl.Scene, fl.joints.Coordinate]:
    """A body on a rail with an initial velocity, without gravity."""
    scene = fl.Scene()
    mass = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), position=(1.0, 0.0, 0.0)))
    mass.add_velocity((1.0, 0.0, 0.0))
    rail = fl.joints.Prismatic(fl.ground(), mass.point("centre"), axis=(1, 0, 0))
    return scene, scene.add(rail).displacement


def spring() -> fl.Scene:
    """The built-in spring."""
    scene, q = body()
    scene.add(fl.joints.Spring(q, STIFFNESS, DAMPING))
    return scene


def python() -> fl.Scene:
    """The law as a Python function."""
    scene, q = body()
    law = fl.loads.ForceLaw(
        q,
        lambda t, q, rate: STIFFNESS * q + DAMPING * rate,
        derivatives=lambda t, q, rate: (STIFFNESS, DAMPING),
    )
    scene.add(law)
    return scene


def compiled_law() -> fl.Scene:
    """The law compiled."""
    scene, q = body()
    scene.add(fl.loads.ForceLaw(q, compiled))
    return scene


def at_rest() -> fl.Scene:
    """A body that is pressed on a stop, where it rests after the first step."""
    scene, q = body()
    scene.bodies[0].add_velocity((-1.0, 0.0, 0.0))
    scene.gravity = (1.0, 0.0, 0.0)
    scene.add(fl.joints.Limit(q, upper=0.0))
    return scene


CASES: dict[str, Callable[[], fl.Scene]] = {
    "spring": spring,
    "law in Python": python,
    "compiled law": compiled_law,
    "at rest on a stop": at_rest,
}


def seconds(make: Callable[[], fl.Scene], steps: int) -> float:
    """Processor time of a run."""
    scene, scheme = make(), fl.GeneralisedAlpha(radius=0.8)
    start = thread_time()
    scheme.run(scene, duration=steps * STEP, step=STEP, save_every=steps, progress=False)
    return thread_time() - start


def main(rounds: int, steps: int) -> None:
    """Print microseconds per step of all cases, and over those of the spring."""
    found = np.empty((rounds, len(CASES)))
    for make in CASES.values():
        seconds(make, 10)
    for turn in range(rounds):
        order = list(enumerate(CASES.values()))
        for k, make in order if turn % 2 == 0 else reversed(order):
            found[turn, k] = seconds(make, steps) - seconds(make, steps // 10)
    least = found.min(axis=0) / (0.9 * steps) * 1e6
    print("case                 µs/step   over the spring")
    for name, each in zip(CASES, least, strict=True):
        print(f"{name:20} {each:8.2f} {each / least[0]:10.2f}")


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--steps", type=int, default=20_000)
    given = parser.parse_args()
    main(given.rounds, given.steps)

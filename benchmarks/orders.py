"""Observed orders of schemes: configuration, velocity and joint forces, as steps are halved.

Two scenes: two rigid bodies on revolute joints under gravity, and a soft beam that turns, flies and
bends. Each is run with steps of three sizes; the order is the binary logarithm of the ratio of the
last two changes, of all nodes and components. Momentum and angular momentum are those of the beam.

Asynchronous steps are those of the net with two short edges of asynchronous.py: once all equal, and
once each cell with its own, in parts of 0.4 … 0.025 of the largest; of these the order is the slope
of a line through the errors against explicit steps of an eighth, for the changes are not smooth.

    python -m benchmarks.orders
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from benchmarks.asynchronous import net
from fem_lie.solve.motion.integrator import Integrator

SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))
TOLD = ("frames", "velocities", "joint_forces")


class Plan(NamedTuple):
    """A scheme, the order that is wanted, and numbers of steps for both scenes."""

    scheme: Integrator
    wanted: int
    pendulum: tuple[int, ...]
    beam: tuple[int, ...]


PLANS = {
    "`Variational`": Plan(fl.schemes.Variational(), 2, (64, 128, 256), (64, 128, 256)),
    "`EnergyMomentum`": Plan(fl.EnergyMomentum(), 2, (64, 128, 256), (64, 128, 256)),
    "`Composed`, five stages": Plan(fl.schemes.Composed(), 4, (32, 64, 128), (16, 32, 64)),
    "`Composed`, nine stages": Plan(
        fl.schemes.Composed(composition=fl.schemes.NineStages()), 4, (16, 32, 64), (8, 16, 32)
    ),
    "`Composed`, triple jump": Plan(
        fl.schemes.Composed(composition=fl.schemes.TripleJump()), 4, (64, 128, 256), (32, 64, 128)
    ),
    "`Composed`, `Variational`, five stages": Plan(
        fl.schemes.Composed(fl.schemes.Variational()), 4, (32, 64, 128), (32, 64, 128)
    ),
    "`Composed`, `Variational`, triple jump": Plan(
        fl.schemes.Composed(fl.schemes.Variational(), fl.schemes.TripleJump()),
        4,
        (64, 128, 256),
        (128, 256, 512),
    ),
    "`Explicit`": Plan(fl.Explicit(), 2, (128, 256, 512), (256, 512, 1024)),
}


def pendulum() -> fl.Scene:
    """Two rigid bodies under gravity, the axis of the second tilted."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one = scene.add(fl.RigidBody(1.0, (2e-3, 5e-3, 6e-3), position=(0.2, 0, 0)))
    two = scene.add(fl.RigidBody(0.7, (1e-3, 3e-3, 3e-3), position=(0.5, 0, 0)))
    scene.add(fl.joints.Revolute(fl.ground(), one.point("centre"), at=(0, 0, 0), axis=(0, 1, 0)))
    scene.add(
        fl.joints.Revolute(
            one.point("centre"), two.point("centre"), at=(0.4, 0, 0), axis=(0, 1, 0.5)
        )
    )
    return scene


def flying() -> fl.Scene:
    """A soft beam that turns, flies and bends."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), SOFT, cells=3))
    beam.add_velocity(omega=(3, 1, -8), about=(0.2, 0, 0))
    beam.velocities[:, 2] += 4.0 * beam.frames[:, 0, 0]
    return scene


def orders(
    scheme: Integrator, scene: Callable[[], fl.Scene], duration: float, numbers: tuple[int, ...]
) -> tuple[list[float], fl.Result]:
    """Of what is reported at the end, and the run with the smallest steps."""
    ends = [
        scheme.run(scene(), duration=duration, step=duration / n, save_every=n) for n in numbers
    ]
    found = []
    for name in TOLD:
        if getattr(ends[0], name)[-1].size:
            far, near = (
                np.abs(getattr(a, name)[-1] - getattr(b, name)[-1]).max() for a, b in pairwise(ends)
            )
            found.append(float(np.log2(far / near)))
    return found, ends[-1]


def equal_steps() -> tuple[list[float], fl.Result]:
    """Of asynchronous ones that are all alike: orders, and the run with the smallest."""
    duration = 32 * fl.Explicit().stable_step(_net())
    return orders(fl.schemes.Asynchronous(), _net, duration, (64, 128, 256))


def own_steps(duration: float = 0.02) -> list[float]:
    """Of cells with steps of their own: slopes."""
    parts = 0.4 * 0.5 ** np.arange(5)
    runs = [
        fl.schemes.Asynchronous(part).run(
            _net(), duration=duration, step=duration / 2, save_every=2
        )
        for part in parts
    ]
    fine = duration / np.ceil(8 * duration / fl.Explicit().stable_step(_net()))
    exact = fl.Explicit().run(_net(), duration=duration, step=fine, save_every=10**6)
    found = []
    for name in TOLD[:2]:
        errors = [np.abs(getattr(run, name)[-1] - getattr(exact, name)[-1]).max() for run in runs]
        found.append(float(np.polyfit(np.log(parts), np.log(errors), 1)[0]))
    return found


def _net() -> fl.Scene:
    return net(4, 2)


def main() -> None:
    """A table."""
    print("| scheme | wanted | pendulum: frames, velocities, joint forces | beam: frames, ", end="")
    print("velocities | momentum, angular momentum |\n|---|---|---|---|---|")
    for name, plan in PLANS.items():
        held, _ = orders(plan.scheme, pendulum, 0.4, plan.pendulum)
        free, end = orders(plan.scheme, flying, 0.01, plan.beam)
        reported = (", ".join(f"{order:.2f}" for order in found) for found in (held, free))
        exact = f"{end.momentum_error:.1e}, {end.angular_momentum_error:.1e}"
        print(f"| {name} | {plan.wanted} | " + " | ".join(reported) + f" | {exact} |", flush=True)
    alike, end = equal_steps()
    exact = f"{end.momentum_error:.1e}, {end.angular_momentum_error:.1e}"
    print(f"| `Asynchronous`, equal steps, net | 2 | | {alike[0]:.2f}, {alike[1]:.2f} | {exact} |")
    apart = own_steps()
    print(f"| `Asynchronous`, own steps, net | ≥ 1 | | {apart[0]:.2f}, {apart[1]:.2f} | |")


if __name__ == "__main__":
    main()

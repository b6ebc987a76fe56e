"""Matrices that the variational scheme makes as slender beams and a shell rotate, by the step.

    python -m benchmarks.rotating_beams

Free bodies of steel, 1 m long, rotate by 0.7 or 1.5 degrees in a step of 1 or 0.5 ms, 200 and 400
steps: a beam of 10 elements about an axis across it or tumbling, and a shell of 8 x 2 elements
about the axis about which it bends. Then the spin-up of J. C. Simo & L. Vu-Quoc (J. Appl. Mech. 53
(1986) 855), as in demos/spin_up.py, 16 elements, 20 s, up to 1.7 and 3.4 degrees in a step.
"""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

import numpy as np

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
SPIN, RISE = 6.0, 15.0


def beam(omega: tuple[float, float, float]) -> fl.Scene:
    """A free beam with an angular velocity."""
    section = fl.Section.rectangle(0.02, 0.03, STEEL)
    scene = fl.Scene()
    body = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=10))
    body.add_velocity(omega=omega, about=(0.3, 0, 0))
    return scene


def shell(speed: float) -> fl.Scene:
    """A free shell that rotates about the axis about which it bends."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, 0.2 * b, 0.0]), (8, 2))
    section = fl.ShellSection.layer(0.01, STEEL)
    body = scene.add(fl.Shell(mesh, section))
    body.add_velocity(omega=(0, speed, 0), about=(0.3, 0, 0))
    return scene


def angle(time: float) -> float:
    """Angle of the hub of the spin-up."""
    if time > RISE:
        return SPIN * (time - RISE / 2)
    wave = 2 * np.pi / RISE
    return float(SPIN / RISE * (time**2 / 2 + (np.cos(wave * time) - 1) / wave**2))


def spin_up() -> fl.Scene:
    """A beam on a hub that is spun up."""
    section = fl.Section.from_stiffness(
        [2.8e7, 1e7, 1e7, 1.4e4, 1.4e4, 1.4e4], mass=1.2, rotary=(6e-4, 6e-4)
    )
    scene = fl.Scene()
    body = scene.add(fl.Beam.straight((0, 0, 0), (10, 0, 0), section, cells=16))

    def hub(time: float) -> np.ndarray:
        turn = fl.lie.frame(np.zeros(3), fl.lie.so3_exp([0.0, 0.0, angle(time)]))
        return fl.lie.se3_compose(turn, body.frames[0])

    scene.add(fl.PrescribedMotion(body.point("start"), hub))
    return scene


RUNS: dict[str, tuple[Callable[[], fl.Scene], float, float]] = {
    "beam, 0.7 degrees": (lambda: beam((0, 0, 12)), 1e-3, 0.2),
    "beam that tumbles, 0.7 degrees": (lambda: beam((0, 2, 12)), 1e-3, 0.2),
    "beam, 1.5 degrees": (lambda: beam((0, 0, 52)), 5e-4, 0.2),
    "shell, 0.7 degrees": (lambda: shell(12), 1e-3, 0.2),
    "spin-up, 1.7 degrees": (spin_up, 5e-3, 20.0),
    "spin-up, 3.4 degrees": (spin_up, 1e-2, 20.0),
}


def main() -> dict[str, fl.Result]:
    """Print matrices, iterations, steps that were divided, and seconds of the processor."""
    found = {}
    for name, (make, step, duration) in RUNS.items():
        scheme, plan = fl.schemes.Variational(), {"step": step, "progress": False}
        scheme.run(make(), duration=3 * step, **plan)
        before = process_time()
        result = scheme.run(make(), duration=duration, save_every=100, **plan)
        seconds = process_time() - before
        print(
            f"{name}: {result.factorisations} matrices, {result.total_iterations} iterations, "
            f"{result.divided} steps divided, {seconds:.2f} s, last node at "
            f"{np.array2string(result.frames[-1, -1, 0], precision=10)}",
            flush=True,
        )
        found[name] = result
    return found


if __name__ == "__main__":
    main()

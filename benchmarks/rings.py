"""What rings on a rope do to energy and momenta in conserving steps.

    python -m benchmarks.rings

A ring on a free body or thread is thrown along a free rope of 20 elements at 2.2 m/s, 0.1 s with
steps of 5e-4 s, without and with friction.
"""

from __future__ import annotations

import time

import numpy as np

import fem_lie as fl

THREAD = fl.Section.circle(1e-3, fl.Material(E=1e9, nu=0.3, density=1000.0))
CELLS = 20


def place(s: float) -> tuple[float, float, float]:
    return (s, 0.05 * np.sin(3.0 * s), 0.02 * s * s)


def rope(kind: str) -> fl.Net | fl.Cable | fl.Beam:
    """The same curve as places, places and slopes, frames."""
    if kind == "net":
        points = [place(s) for s in np.linspace(0, 1, CELLS + 1)]
        return fl.Net(points, [range(CELLS + 1)], THREAD)
    return (fl.Cable if kind == "cable" else fl.Beam).curve(place, THREAD, cells=CELLS)


def free(kind: str, ring: str, friction: float = 0.0) -> fl.Scene:
    """A free rope, and a free body or thread with a ring on it that is thrown along it."""
    scene, one, at = fl.Scene(), rope(kind), np.array(place(0.52))
    scene.add(one)
    if ring == "body":
        other = scene.add(fl.RigidBody(0.01, 1e-5 * np.eye(3), at - [0, 0, 0.03]))
        rings = fl.Rings([other.centre], at=[at])
    else:
        other = scene.add(fl.Net([at, at - [0, 0, 0.2], at - [0, 0, 0.4]], [[0, 1, 2]], THREAD))
        rings = fl.Rings([other.node(0)])
    other.move((2.0, 0, -1.0))
    scene.add(fl.Contact(fl.Rope(one), rings, fl.Penalty(1e4, friction=friction)))
    return scene


def main(
    duration: float = 0.1, step: float = 5e-4
) -> dict[tuple[str, str, float], dict[str, float]]:
    """Errors, loss and cost, for each rope, what the ring is on, and friction."""
    found = {}
    for kind in ("net", "cable", "beam"):
        for ring in ("body", "place"):
            for friction in (0.0, 0.3):
                scene = free(kind, ring, friction)
                start = time.process_time()
                result = fl.EnergyMomentum().run(
                    scene, duration=duration, step=step, progress=False
                )
                lost = result.balance[:, 1]
                found[kind, ring, friction] = {
                    "balance": result.balance_error,
                    "momentum": result.momentum_error,
                    "angular momentum": result.angular_momentum_error,
                    "least loss in a step": float(np.diff(lost).min()),
                    "lost": float(lost[-1] / result.kinetic[0]),
                    "iterations": float(result.iterations[-1] * step / duration),
                    "ms": 1e3 * (time.process_time() - start) * step / duration,
                }
    return found


if __name__ == "__main__":
    for case, row in main().items():
        print(*case, {name: float(f"{value:.2g}") for name, value in row.items()}, flush=True)

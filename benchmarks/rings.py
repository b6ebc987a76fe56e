"""Rings on a rope: friction against the formula of capstans, energy and momenta in motion.

    python -m benchmarks.rings [--capstan]

*Capstan.* A beam is pulled through rings on an arc, each of which bends it by a part of the angle,
through load steps; its other end is held by a force of 1 N. From ring to ring its tension grows
``exp(μφ)`` times, if that part is small. Tension is that of the last two elements that slide
through, on the average, for a rope of elements pulls a little more or less where it is in them.

*Motion.* A ring on a free body or cable is thrown along a free rope of 20 elements at 2.2 m/s,
0.1 s with steps of 5e-4 s, without and with friction.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import fem_lie as fl

CABLE = fl.Section.circle(1e-3, fl.Material(E=1e9, nu=0.3, density=1000.0))
CELLS = 20


def position(s: float) -> tuple[float, float, float]:
    return (s, 0.05 * np.sin(3.0 * s), 0.02 * s * s)


def rope(kind: str) -> fl.Net | fl.Cable | fl.Beam:
    """The same curve as positions, positions and slopes, frames."""
    if kind == "net":
        points = [position(s) for s in np.linspace(0, 1, CELLS + 1)]
        return fl.Net(points, [range(CELLS + 1)], CABLE)
    return (fl.Cable if kind == "cable" else fl.Beam).curve(position, CABLE, cells=CELLS)


def free(kind: str, ring: str, friction: float = 0.0) -> fl.Scene:
    """A free rope, and a free body or cable with a ring on it that is thrown along it."""
    scene, one, at = fl.Scene(), rope(kind), np.array(position(0.52))
    scene.add(one)
    if ring == "body":
        other = scene.add(fl.RigidBody(0.01, 1e-5 * np.eye(3), at - [0, 0, 0.03]))
        rings = fl.contact.Rings([other.point("centre")], at=[at])
    else:
        other = scene.add(fl.Net([at, at - [0, 0, 0.2], at - [0, 0, 0.4]], [[0, 1, 2]], CABLE))
        rings = fl.contact.Rings([other.point(0)])
    other.add_velocity((2.0, 0, -1.0))
    scene.add(
        fl.contact.Contact(fl.contact.Rope(one), rings, fl.contact.Penalty(1e4, friction=friction))
    )
    return scene


RADIUS, EXTENSION, BENDING, SOFT = 0.1, 1e4, 1e-4, 1e4  # m, N, N m^2, N/m
TAIL, SLIDES, STEPS = 3, 4, 20  # elements of both tails, that slide through, load steps


def arc(angle: float, cells: int) -> fl.Beam:
    """Straight tails at both ends of an arc."""
    element = angle * RADIUS / cells
    tail = TAIL * element
    length = angle * RADIUS + 2 * tail

    def position(s: float) -> tuple[float, float, float]:
        along = s * length - tail
        turned = min(max(along / RADIUS, 0.0), angle)
        beyond, c, n = along - turned * RADIUS, np.cos(turned), np.sin(turned)
        return RADIUS * c - beyond * n, RADIUS * n + beyond * c, 0.0

    stiffness = [EXTENSION, EXTENSION / 3, EXTENSION / 3, BENDING, BENDING, BENDING]
    element_law = fl.elements.GeodesicBeam(bending_flexibility=False)
    section = fl.Section.from_stiffness(stiffness)
    return fl.Beam.curve(position, section, cells=cells + 2 * TAIL, formulation=element_law)


def capstan(degrees: float, rings: int, cells: int, friction: float) -> dict[str, float]:
    """Tension over that of the end that is held, and angle between both.

    Args:
        degrees: By which the rope is bent in all.
        rings: That bend it.
        cells: Elements from ring to ring, an even number.
        friction: Coefficient.
    """
    angle = np.radians(degrees)
    rope, scene = arc(angle, cells * rings), fl.Scene()
    scene.add(rope)
    start, slides = rope.frames[-1], SLIDES * angle * RADIUS / (cells * rings)

    def pulled(part: float) -> np.ndarray:
        return start + part * slides * np.array([start[1], *np.zeros((3, 3))])

    motion = scene.add(fl.PrescribedMotion(rope.point("end"), pulled))
    scene.add(fl.PointLoad(rope.point("start"), force=-rope.frames[0, 1]))
    at = rope.frames[TAIL + cells // 2 + cells * np.arange(rings), 0]
    law = fl.contact.Penalty(SOFT, friction=friction)
    scene.add(
        fl.contact.Contact(
            fl.contact.Rope(rope), fl.contact.Rings([fl.ground()] * rings, at=at), law
        )
    )
    result = fl.statics(scene, load_steps=STEPS)
    force = result.reaction(motion)[STEPS // 2 :, :3]
    tension = np.linalg.norm(force, axis=1) / result.factors[STEPS // 2 :]
    seen = force.mean(axis=0)
    turned = np.arctan2(seen @ rope.frames[0, 2], seen @ rope.frames[0, 1])
    turned += 2 * np.pi * np.round((angle - turned) / (2 * np.pi))
    return {
        "ratio": float(tension.mean()),
        "least": float(tension.min()),
        "most": float(tension.max()),
        "angle": float(np.degrees(turned)),
        "error": float(tension.mean() / np.exp(friction * turned) - 1.0),
        "iterations": float(result.iterations[-1] / STEPS),
    }


CAPSTANS = [(90, 2, 8), (90, 4, 8), (180, 4, 8), (180, 8, 8), (180, 16, 4), (360, 32, 4)]
"""Degrees, rings, elements from each to the next."""


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


def shown(row: dict[str, float], digits: int) -> dict[str, float]:
    """Few digits."""
    return {name: float(f"{value:.{digits}g}") for name, value in row.items()}


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--capstan", action="store_true", help="friction alone")
    for friction in (0.1, 0.3):
        for given in CAPSTANS:
            print(*given, friction, shown(capstan(*given, friction), 4), flush=True)
    if not parser.parse_args().capstan:
        for case, row in main().items():
            print(*case, shown(row, 2), flush=True)

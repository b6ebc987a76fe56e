"""A net catches a ball, and its rope closes it.

A hexagonal net of threads without torsion has masses at its corners and flies towards a fixed rigid
ball. A rope runs through rings at the points of its edge; both ends of it are pulled after the
ball is wrapped, and the edge is drawn together. Threads and rope are discrete cables, which touch
the ball with balls about their nodes, by penalty; rings hold the rope by springs without length
that slide along it, without friction.

Steps are those of the energy-momentum scheme. Until the rope is pulled nothing acts from outside
but the ball, which holds by its reaction: energy is that of the start, and momenta are what the
reaction has taken. --rings is the number of hexagons of threads about the middle, --cells that of
elements between knots.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from command_line import run

import fem_lie as fl

SIZE, BALL, SPEED, PULL = 1.0, 0.3, 10.0, 20.0
THREAD = fl.Section.circle(1e-3, fl.Material(E=1e8, nu=0.3, density=1000.0))


def corner(k: float) -> np.ndarray:
    """Of the unit hexagon; in between along its edges."""
    ends = np.exp(1j * np.pi / 3 * np.array([np.floor(k), np.floor(k) + 1]))
    place = ends[0] + (k - np.floor(k)) * (ends[1] - ends[0])
    return np.array([place.real, place.imag])


def hexagons(rings: int, cells: int) -> tuple[np.ndarray, list[list[int]], list[int]]:
    """Places in a plane, threads, and knots along the edge."""
    knots = {(0, 0): np.zeros(2)}
    knots |= {(r, k): r / rings * corner(k / r) for r in range(1, rings + 1) for k in range(6 * r)}
    number = {key: n for n, key in enumerate(knots)}
    places: list[Any] = list(knots.values())

    def thread(path: list[tuple[int, int]]) -> list[int]:
        found = [number[path[0]]]
        for one, other in pairwise(path):
            a, b = knots[one], knots[other]
            for part in range(1, cells):
                places.append(a + part / cells * (b - a))
                found.append(len(places) - 1)
            found.append(number[other])
        return found

    threads = [thread([(r, k % (6 * r)) for k in range(6 * r + 1)]) for r in range(1, rings + 1)]
    threads += [thread([(r, k * r) for r in range(rings + 1)]) for k in range(6)]
    return np.array(places), threads, [number[rings, k] for k in range(6 * rings)]


def capture(rings: int, cells: int, start: float) -> tuple[fl.Scene, int]:
    """A net with masses and a rope in its edge, whose ends are pulled from ``start`` on."""
    flat, threads, edge = hexagons(rings, cells)
    places = np.column_stack([SIZE * flat, np.full(len(flat), BALL + 0.01)])
    scene = fl.Scene()
    net = scene.add(fl.Net(places, threads, THREAD, name="net"))
    path = places[[*threads[rings - 1]]]
    rope = scene.add(fl.Net(path, [range(len(path))], THREAD, name="rope"))
    for body in (net, rope):
        body.move((0.0, 0.0, -SPEED))
    for k in range(6):
        mass = scene.add(fl.RigidBody(0.02, np.full(3, 1e-6), places[edge[k * rings]]))
        mass.move((0.0, 0.0, -SPEED))
        scene.add(fl.Spherical(net.node(edge[k * rings]), mass.centre))
    k = 2.0 * THREAD.stiffness[0, 0] * rings * cells / SIZE
    inner = [net.node(node) for node in edge[1:]]
    scene.add(fl.Contact(fl.Rope(rope), fl.Rings(inner), fl.Penalty(k), name="rings"))
    every = [fl.Point(body, n) for body in (net, rope) for n in range(len(body.frames))]
    ball = fl.Sphere(fl.ground(), BALL)
    scene.add(fl.Contact(fl.Vertices(every, 1e-3), ball, fl.Penalty(2e2), name="net-ball"))
    pull = fl.Table((0.0, start, start + 0.01), (0.0, 0.0, PULL))
    for node in (0, len(path) - 1):
        scene.add(fl.PointLoad(rope.node(node), force=(0.5, 0.0, -1.0), history=pull))
    return scene, len(net.elements) + len(rope.elements)


def main(rings: int = 3, cells: int = 6, step: float = 2e-4, time: float = 0.08) -> dict[str, Any]:
    start = 0.6 * time
    scene, elements = capture(rings, cells, start)
    result = fl.EnergyMomentum().run(scene, duration=time, step=step, progress=False)
    free = result.times <= start
    energy = result.total_energy[free]
    return {
        "elements": elements,
        "steps": len(result.times) - 1,
        "energy_error": float(np.abs(energy / energy[0] - 1.0).max()),
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
        "balance_error": result.balance_error,
        "touching": int(fl.contact_forces(result, scene.contacts[1]).touching[-1]),
        "milliseconds_per_step": 1e3 * result.seconds / (len(result.times) - 1),
        "iterations_per_step": float(result.iterations[-1]) / (len(result.times) - 1),
    }


if __name__ == "__main__":
    run(main, show=True)

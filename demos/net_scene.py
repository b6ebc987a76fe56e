"""The net of net_capture.py, its rope, and the ball."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

import fem_lie as fl

SIZE, BALL, SPEED, PULL = 1.0, 0.3, 10.0, 10.0
CABLE = fl.Section.circle(1e-3, fl.Material(E=1e8, nu=0.3, density=1000.0))


LAID = fl.elements.DiscreteCable(natural=True)
"""Cables are naturally as they are laid: straight ones about hexagons would spring open."""


def corner(k: float) -> np.ndarray:
    """Of the unit hexagon; in between along its edges."""
    ends = np.exp(1j * np.pi / 3 * np.array([np.floor(k), np.floor(k) + 1]))
    position = ends[0] + (k - np.floor(k)) * (ends[1] - ends[0])
    return np.array([position.real, position.imag])


def hexagons(rings: int, cells: int) -> tuple[np.ndarray, list[list[int]], list[int]]:
    """Positions in a plane, cables, and knots along the edge."""
    knots = {(0, 0): np.zeros(2)}
    knots |= {(r, k): r / rings * corner(k / r) for r in range(1, rings + 1) for k in range(6 * r)}
    number = {key: n for n, key in enumerate(knots)}
    positions: list[Any] = list(knots.values())

    def cable(path: list[tuple[int, int]]) -> list[int]:
        found = [number[path[0]]]
        for one, other in pairwise(path):
            a, b = knots[one], knots[other]
            for part in range(1, cells):
                positions.append(a + part / cells * (b - a))
                found.append(len(positions) - 1)
            found.append(number[other])
        return found

    cables = [cable([(r, k % (6 * r)) for k in range(6 * r + 1)]) for r in range(1, rings + 1)]
    cables += [cable([(r, k * r) for r in range(rings + 1)]) for k in range(6)]
    return np.array(positions), cables, [number[rings, k] for k in range(6 * rings)]


def capture(rings: int, cells: int, start: float) -> tuple[fl.Scene, int]:
    """A net with masses and a rope in its edge, whose tied ends are pulled from ``start`` on."""
    flat, cables, edge = hexagons(rings, cells)
    positions = np.column_stack([SIZE * flat, np.full(len(flat), BALL + 0.01)])
    scene = fl.Scene()
    net = scene.add(fl.Net(positions, cables, CABLE, formulation=LAID, name="net"))
    path = rope_path(positions, cables[rings - 1][:-cells], cells)
    own = [range(len(path))]
    rope = scene.add(fl.Net(path, own, CABLE, formulation=LAID, name="rope"))
    for body in (net, rope):
        body.add_velocity((0.0, 0.0, -SPEED))
    ends = [
        *(net.point(edge[k * rings]) for k in range(6)),
        rope.point(0),
        rope.point(len(path) - 1),
    ]
    masses = []
    for point in ends[:-1]:
        mass = scene.add(fl.RigidBody(0.02, np.full(3, 1e-6), point.position))
        mass.add_velocity((0.0, 0.0, -SPEED))
        masses.append(mass)
    for point, mass in zip(ends, [*masses, masses[-1]], strict=True):
        scene.add(fl.joints.Spherical(point, mass.point("centre")))
    k = 2.0 * CABLE.stiffness[0, 0] * rings * cells / SIZE
    knots = fl.contact.Rings([net.point(node) for node in edge])
    scene.add(fl.contact.Contact(fl.contact.Rope(rope), knots, fl.contact.Penalty(k), name="rings"))
    every = [fl.extend.Point(body, n) for body in (net, rope) for n in range(len(body.frames))]
    ball = fl.contact.Sphere(fl.ground(), BALL)
    scene.add(
        fl.contact.Contact(
            fl.contact.Vertices(every, 1e-3), ball, fl.contact.Penalty(2e2), name="net-ball"
        )
    )
    pull = fl.loads.PiecewiseLinear((0.0, start, start + 0.01), (0.0, 0.0, PULL))
    scene.add(fl.PointLoad(masses[-1].point("centre"), force=(0.0, 0.0, -1.0), history=pull))
    return scene, len(net.model.elements) + len(rope.model.elements)


def rope_path(positions: np.ndarray, along: list[int], cells: int) -> np.ndarray:
    """From where both ends are tied along the edge and back, in even parts."""
    first, last = positions[along[0]], positions[along[-1]]
    tied = 0.5 * (first + last)
    tied[:2] *= 1.0 + 0.3 / np.linalg.norm(tied[:2])
    parts = np.arange(1, cells)[:, np.newaxis] / cells
    there = np.vstack([[tied], tied + parts * (first - tied)])
    back = np.vstack([last + parts * (tied - last), [tied]])
    return np.vstack([there, positions[along], back])


def mouth(result: fl.Result, rings: int, cells: int) -> tuple[float, float]:
    """How far the edge is from the axis, over the ball's radius, and above its lowest point."""
    _, _, edge = hexagons(rings, cells)
    positions = result.frames[-1, result.info.body("net").nodes[edge], 0]
    wide = np.hypot(positions[:, 0], positions[:, 1]).max() / BALL
    return float(wide), float(positions[:, 2].max() + BALL)

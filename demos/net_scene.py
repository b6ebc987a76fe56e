"""The net of net_capture.py, its rope and winch, and the ball."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from net_contacts import BALL, THREAD, add_contacts, rope_path

import fem_lie as fl

SIZE, SPEED, TAB, BOOM, SIDE = 1.0, 5.0, 0.06, 0.3, 0.02
"""Radius and speed of the net, lengths of tabs and of the boom, offset of both ends of the rope."""

CABLE = fl.Section.circle(THREAD, fl.Material(E=6.25e6, nu=0.3, density=62.5))
"""A light braid."""

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


def capture(
    rings: int, cells: int, start: float, closing: float = 0.34, travel: float = 1.55
) -> tuple[fl.Scene, int]:
    """A net with masses that flies to a free ball, and a rope whose winch pulls from ``start``."""
    flat, cables, edge = hexagons(rings, cells)
    positions = np.column_stack([SIZE * flat, np.full(len(flat), BALL + THREAD + 0.01)])
    rim = positions[edge]
    eyes = rim + TAB * rim / np.hypot(*rim.T[:2])[:, np.newaxis] * [1.0, 1.0, 0.0]
    middle = cables[rings - 1][-1 - cells // 2]
    along = (eyes[0] - eyes[-1]) / np.linalg.norm(eyes[0] - eyes[-1])
    at, side = 0.5 * (eyes[0] + eyes[-1]), SIDE * along
    away = np.array([along[1], -along[0], 0.0])
    path = rope_path(
        [at + BOOM * away + side, at + side, *eyes, at - side, at + BOOM * away - side],
        SIZE / rings / cells,
    )
    scene, count = fl.Scene(), len(edge)
    net = scene.add(fl.Net(positions, cables, CABLE, formulation=LAID, name="net"))
    ties = [[k, count + k] for k in range(count)]
    tabs = scene.add(fl.Net(np.vstack([rim, eyes]), ties, CABLE, formulation=LAID, name="tabs"))
    rope = scene.add(fl.Net(path, [range(len(path))], CABLE, formulation=LAID, name="rope"))
    winch = scene.add(fl.RigidBody(0.02, np.full(3, 2e-5), at, name="winch"))
    hook = scene.add(fl.RigidBody(0.01, np.full(3, 1e-5), at + BOOM * away, name="hook"))
    tied = [(net.point(node), tabs.point(k)) for k, node in enumerate(edge)]
    tied += [(rope.point(k), hook.point(path[k])) for k in (0, len(path) - 1)]
    tied += [(net.point(middle), winch.point(positions[middle]))]
    for k in range(6):
        mass = scene.add(fl.RigidBody(0.02, np.full(3, 1e-6), rim[k * rings]))
        tied.append((net.point(edge[k * rings]), mass.point("centre")))
    for pair in tied:
        scene.add(fl.joints.Spherical(*pair))
    for body in scene.bodies:
        body.add_velocity((0.0, 0.0, -SPEED))
    ball = scene.add(fl.RigidBody(2.0, np.full(3, 0.8 * BALL**2), name="ball"))
    centre, k = winch.point("centre"), 2.0 * CABLE.stiffness[0, 0] * rings * cells / SIZE
    held = [*(tabs.point(count + k) for k in range(count)), centre, centre]
    through = fl.contact.Rings(held, at=[*eyes, at + side, at - side])
    scene.add(fl.contact.Contact(fl.contact.Rope(rope), through, fl.contact.Penalty(k)))
    add_contacts(scene, net, rope, ball)
    boom = scene.add(fl.joints.Prismatic(centre, hook.point("centre"), axis=away, at=at))

    def drive(t: float) -> float:
        s = min(max((t - start) / closing, 0.0), 1.0)
        return travel * (s - math.sin(2.0 * math.pi * s) / (2.0 * math.pi))

    scene.add(fl.joints.Drive(boom.displacement, drive))
    return scene, len(net.model.elements) + len(rope.model.elements)

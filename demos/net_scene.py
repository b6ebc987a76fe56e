"""The net of net_capture.py, its rope, the ball, and what they look like."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from command_line import in_results
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

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


VIEW = np.array([[1.0, 0.0], [0.35, 0.3], [0.0, 1.0]])
"""Oblique: x to the right, z upwards, y away."""


def motion(result: fl.Result, scene: fl.Scene, name: str) -> None:
    """Six times, from the start to the end."""
    figure = Figure(figsize=(13.0, 8.0), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True).ravel()
    net, rope, *masses = scene.bodies
    assert isinstance(net, fl.Net)
    assert isinstance(rope, fl.Net)
    for panel, part in zip(panels, np.linspace(0.0, 1.0, 6), strict=True):
        row = result.index(part * result.times[-1])
        places, nodes = result.frames[row, :, 0] @ VIEW, result.info.body
        panel.add_patch(Circle((0.0, 0.0), BALL, color="#dddddd"))
        for body, colour, width in ((net, "#0072B2", 0.7), (rope, "#D55E00", 1.4)):
            threads = list(places[nodes(body.name).nodes[body.elements]])
            panel.add_collection(LineCollection(threads, colors=colour, linewidths=width))
        at = np.array([places[nodes(mass.name).nodes[0]] for mass in masses])
        panel.plot(*at.T, "ko", ms=4)
        panel.set(title=f"t = {1e3 * result.times[row]:.0f} ms", aspect="equal")
    figure.savefig(in_results(f"{name}.png"), dpi=110)

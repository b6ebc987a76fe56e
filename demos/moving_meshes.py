"""A motion whose mesh follows it, a wave in a rod, and what is compared and drawn of it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import pi, sin, sqrt
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import fem_lie as fl

PLAIN = fl.elements.GeodesicBeam(bending_flexibility=False)

# --- a wave in a rod ---

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
BAR = fl.Section.circle(0.01, STEEL)
LENGTH, LASTS, STRAIN = 20.0, 1e-4, 1e-4
SPEED, STIFFNESS = sqrt(STEEL.E / STEEL.density), float(BAR.stiffness[0, 0])
FORCE, PUSHED = STIFFNESS * STRAIN, 0.5 * STRAIN * LASTS * SPEED


def push(time: float) -> float:
    """One smooth push."""
    return sin(pi * time / LASTS) ** 2 if 0.0 < time < LASTS else 0.0


def rod(mesh: fl.mesh.LineMesh) -> fl.Scene:
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, BAR, formulation=PLAIN, name="line"))
    scene.add(fl.PointLoad(beam.point("start"), force=(FORCE, 0, 0), history=push))
    return scene


# --- runs and pictures ---


@dataclass(frozen=True)
class Motion:
    """What is solved, how often meshes change, and a uniform run of about the same error."""

    build: Any
    length: float
    cells: int
    duration: float
    every: float
    size: float
    ahead: float
    uniform: tuple[int, int]


MOTIONS = {
    "wave": Motion(rod, LENGTH, 20, 2.4e-3, 4e-5, PUSHED, 0.32, (750, 1400)),
}


def line(motion: Motion, cells: int) -> fl.mesh.LineMesh:
    return fl.mesh.straight_line((0, 0, 0), (motion.length, 0, 0), cells)


def uniform(motion: Motion, cells: int, steps: int, duration: float) -> tuple[fl.Scene, fl.Result]:
    scene = motion.build(line(motion, cells))
    scheme, step = fl.GeneralisedAlpha(), duration / steps
    return scene, scheme.run(scene, duration=duration, step=step, save_every=steps)


def strains(scene: fl.Scene, result: fl.Result, positions: Any) -> Any:
    """Axial strain of the elements at positions along the line, at the end, (k,)."""
    (body,) = scene.bodies
    assert isinstance(body, fl.Beam)
    frames = result.frames[-1][result.info.body(body.name).nodes]
    start, end = body.model.elements[:, :2].T
    d = fl.lie.se3_relative(frames[start], frames[end]) / body.model.lengths[:, np.newaxis]
    edges = np.sort(body.frames[:, 0, 0])
    order = np.argsort(body.frames[start, 0, 0])
    which = order[np.clip(np.searchsorted(edges, positions) - 1, 0, len(order) - 1)]
    return d[which, 0] - 1.0


def draw(found: fl.adaptivity.AdaptedMotion[fl.mesh.LineMesh], path: str) -> None:
    """Elements over time, the smaller the darker."""
    boxes, sizes = [], []
    for part in found.segments:
        x = np.sort(part.mesh.points[:, 0])
        low, high = part.begin, part.begin + part.result.times[-1]
        boxes += [[(a, low), (b, low), (b, high), (a, high)] for a, b in pairwise(x)]
        sizes += list(np.diff(x))
    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    drawn = PolyCollection(boxes, array=np.log10(sizes), cmap="viridis", linewidths=0)
    axes.add_collection(drawn)
    axes.autoscale_view()
    axes.set(xlabel="position along the line, m", ylabel="time, s")
    figure.colorbar(drawn, label="size of elements, log₁₀ m")
    figure.savefig(path, dpi=150)
    plt.close(figure)

"""A bistable strip: a shallow clamped arch that snaps from one shape without load to another.

The strip is made in the shape z = h/2 (1 - cos(2 pi x/L)), so that it is free of stress there, and
pushed down at its middle. J. Qiu, J. H. Lang & A. H. Slocum (J. Microelectromech. Syst. 13 (2004)
137) superpose the buckling modes of a straight clamped strip. With Q = h/t, the deflection D over h
and the force F over EI h/L^3,

    F1 = (3/2) pi^4 Q^2 D (D - 3/2 + r)(D - 3/2 - r),  r^2 = 1/4 - 4/(3 Q^2):  no other mode,
    F2 = 4.18 pi^4 - 2.18 pi^4 D:  with the second mode, in which the middle turns,
    F3 = 8 pi^4 - 6 pi^4 D:        with the third one, if the middle is kept from turning.

The force follows F1 until it meets the line of a mode. If the middle may not turn (two parallel
strips that are joined there) it falls on F3 below zero and comes back to F1: without a force the
strip stays where it is, near D = 2, if Q > 2.31.

Seen by the tangent, both places where a line of a mode is met are bifurcations: `fl.branch` enters
the path of the mode at the first, which is unstable, and leaves it at the second onto the stable
one. A strip whose middle may turn leaves F1 much earlier, with a lopsided mode, and comes back to
it just below zero: it is bistable by a hair.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

import fem_lie as fl
from fem_lie.pictures.units import Units

RESULTS = Path(__file__).parents[1] / "results"
MATERIAL = fl.Material(3e9, 0.35, 1000.0)
LENGTH, THICKNESS, WIDTH = 0.1, 5e-4, 5e-3
BENDING = MATERIAL.E * WIDTH * THICKNESS**3 / 12
UNITS = Units()


def first_mode(q: float, d: float) -> float:
    """F1."""
    r = np.sqrt(0.25 - 4 / (3 * q**2))
    return float(1.5 * np.pi**4 * q**2 * d * (d - 1.5 + r) * (d - 1.5 - r))


def second_mode(d: float) -> float:
    """F2."""
    return float((4.18 - 2.18 * d) * np.pi**4)


def third_mode(d: float) -> float:
    """F3."""
    return float((8.0 - 6.0 * d) * np.pi**4)


def theory(q: float) -> dict[str, float]:
    """Largest and smallest force of a strip whose middle does not turn, and where it rests."""
    gap = lambda d: first_mode(q, d) - third_mode(d)  # noqa: E731
    top, bottom = brentq(gap, 0.0, 0.5), brentq(gap, 1.5, 2.2)
    turning = brentq(lambda d: first_mode(q, d) - second_mode(d), 0.0, 0.3)
    return {
        "top": third_mode(top),
        "bottom": third_mode(bottom),
        "rest": 1.5 + float(np.sqrt(0.25 - 4 / (3 * q**2))),
        "turning": second_mode(turning),
    }


def strip(q: float, elements: int, *, guided: bool) -> tuple[fl.Scene, fl.Point, float]:
    """The strip, or half of it if its middle is guided; its middle; and h.

    At load factor 1 the force on the whole strip is 1000 EI h/L^3.
    """
    h, part = q * THICKNESS, 0.5 if guided else 1.0

    def place(s: float) -> tuple[float, float, float]:
        x = part * s
        return LENGTH * x, 0.0, 0.5 * h * (1.0 - np.cos(2 * np.pi * x))

    section = fl.Section.rectangle(WIDTH, THICKNESS, MATERIAL)
    count = elements // 2 if guided else elements
    scene = fl.Scene()
    beam = scene.add(fl.Beam.curve(place, section, cells=count, up=(0, 0, 1), name="strip"))
    scene.add(fl.Clamp(beam.start))
    if guided:
        # a pin on the middle stays upright
        for name, lever in (("middle", 0.0), ("pin", h)):
            at = beam.end.position + np.array([0.0, 0.0, lever])
            scene.add(fl.InPlane(fl.ground(), beam.end, at=at, axis=(1, 0, 0), name=name))
    else:
        scene.add(fl.Clamp(beam.end))
    middle = beam.node(elements // 2)
    scene.add(fl.PointLoad(middle, force=(0, 0, -part * 1000 * BENDING * h / LENGTH**3)))
    return scene, middle, h


class Push:
    """The strip pushed down: its path up to where it turns aside, and from there to where it rests.

    Attributes:
        paths: Before, aside, and after, with the deflection D that was observed.
    """

    def __init__(self, q: float, elements: int, *, guided: bool) -> None:
        """Follow all three."""
        scene, middle, h = strip(q, elements, guided=guided)

        def down(state: fl.PathState) -> float:
            return float(-state.displacement(middle)[2] / h)

        observe = {"D": down}
        before = fl.follow_path(scene, fl.PathEnds(critical_points=1), observe=observe)
        aside = fl.follow_path(
            scene,
            fl.PathEnds(critical_points=1),
            start=fl.branch(scene, before.critical[0]),
            observe=observe,
        )
        after = fl.follow_path(scene, start=fl.branch(scene, aside.critical[0]), observe=observe)
        self.paths = before, aside, after

    @property
    def top(self) -> float:
        """Largest force before it snaps."""
        return 1000 * self.paths[0].critical[0].factor

    @property
    def bottom(self) -> float:
        """Smallest force, where it comes back to a symmetric shape."""
        return 1000 * self.paths[1].critical[0].factor

    @property
    def rest(self) -> float:
        """Deflection over h at which it stays without a force."""
        after = self.paths[2]
        return float(np.interp(0.0, after.factors, after.observed["D"]))


def main(q: float = 6.0, elements: int = 40, pictures: bool = True) -> dict[str, Any]:
    if not q > 2.31:
        raise ValueError(f"a strip with Q = h/t ≤ 2.31 is not bistable, got {q}")
    if elements < 4 or elements % 2:
        raise ValueError(f"elements must be even, for a node in the middle, got {elements}")
    reference = theory(q)
    guided, free = (Push(q, elements, guided=choice) for choice in (True, False))
    paths = guided.paths + free.paths
    record: dict[str, Any] = {
        "q": q,
        "elements": elements,
        "top": guided.top,
        "bottom": guided.bottom,
        "rest": guided.rest,
        "stable_at_rest": bool(guided.paths[2].stable.all()),
        "turning": free.top,
        "turning_bottom": free.bottom,
        "negative_pivots": [p.negative_pivots for path in paths for p in path.critical],
        "load_steps": sum(int((path.iterations > 0).sum()) - 1 for path in paths),
        "rejected_steps": sum(path.failed_steps for path in paths),
        "iterations": sum(path.total_iterations for path in paths),
        "seconds": sum(path.seconds for path in paths),
    }
    for name, value in reference.items():
        record[f"{name}_deviation"] = record[name] / value - 1.0
    for name, push in (("middle guided", guided), ("middle free", free)):
        print(name)
        for path in push.paths:
            for found in path.critical:
                print(f"  D = {path.observed['D'][found.index]:.3f}: {found}")
    print("           F largest    smallest    D at rest   F largest, smallest if free")
    line = "{top:9.2f}   {bottom:9.2f}    {rest:.4f}      {turning:9.2f}  "
    print("path       " + line.format(**record) + f"{free.bottom:9.2f}")
    print("theory     " + line.format(**reference) + f"{second_mode(reference['rest']):9.2f}")
    print("it stays there: {stable_at_rest}".format(**record))
    print(
        "{iterations} linear solutions in {load_steps} steps, {rejected_steps} rejected, "
        "{seconds:.2f} s".format(**record)
    )
    if pictures:
        draw(q, guided, free)
    return record


def draw(q: float, guided: Push, free: Push) -> None:
    """The diagram, with the lines of the theory, and the guided half moving."""
    RESULTS.mkdir(exist_ok=True)
    diagram, moving = RESULTS / "bistable_strip.png", RESULTS / "bistable_strip.gif"
    d = np.linspace(0.0, 2.0, 41)
    first, third = (np.array([f(x) for x in d]) for f in (lambda x: first_mode(q, x), third_mode))
    force = np.where(d < 1.0, np.minimum(first, third), np.maximum(first, third))
    paths = [*free.paths[1::-1], *free.paths[2:], *guided.paths]
    paths[0].plot_path(
        "D",
        diagram,
        label="deflection over h",
        load=(1000.0, "force over EI h/L³"),
        others=[(path, path.observed["D"]) for path in paths[1:]],
        reference=(d, force, "Qiu, Lang & Slocum 2004"),
        units=UNITS,
    )
    paths[0].animate(moving, title="Bistable strip", units=UNITS)
    print(f"pictures: {diagram}, {moving}")


if __name__ == "__main__":
    from command_line import run

    run(main)

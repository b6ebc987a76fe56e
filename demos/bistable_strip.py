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

Seen by the tangent, both positions where a line of a mode is met are bifurcations:
`fl.stability.switch_branch` enters the path of the mode at the first, which is unstable, and leaves
it at the second onto the stable one. A strip whose middle may turn leaves F1 much earlier, with a
lopsided mode, and comes back to
it just below zero: it is bistable by a hair.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from records import of_path
from reference.bistable_strip import force, theory

import fem_lie as fl

MATERIAL = fl.Material(3e9, 0.35, 1000.0)
LENGTH, THICKNESS, WIDTH = 0.1, 5e-4, 5e-3
BENDING = MATERIAL.E * WIDTH * THICKNESS**3 / 12
UNITS = fl.post.Units()
Paths = tuple[fl.stability.EquilibriumPath, ...]


def strip(q: float, elements: int, *, guided: bool) -> tuple[fl.Scene, fl.extend.Point, float]:
    """The strip, or half of it if its middle is guided; its middle; and h.

    At load factor 1 the force on the whole strip is 1000 EI h/L^3.
    """
    h, part = q * THICKNESS, 0.5 if guided else 1.0

    def position(s: float) -> tuple[float, float, float]:
        x = part * s
        return LENGTH * x, 0.0, 0.5 * h * (1.0 - np.cos(2 * np.pi * x))

    section = fl.Section.rectangle(WIDTH, THICKNESS, MATERIAL)
    count = elements // 2 if guided else elements
    scene = fl.Scene()
    beam = scene.add(fl.Beam.curve(position, section, cells=count, up=(0, 0, 1), name="strip"))
    scene.add(fl.Clamp(beam.point("start")))
    if guided:
        # a pin on the middle stays upright
        for name, lever in (("middle", 0.0), ("pin", h)):
            at = beam.point("end").position + np.array([0.0, 0.0, lever])
            scene.add(
                fl.joints.InPlane(fl.ground(), beam.point("end"), at=at, axis=(1, 0, 0), name=name)
            )
    else:
        scene.add(fl.Clamp(beam.point("end")))
    middle = beam.point(elements // 2)
    scene.add(fl.PointLoad(middle, force=(0, 0, -part * 1000 * BENDING * h / LENGTH**3)))
    return scene, middle, h


def push(q: float, elements: int, *, guided: bool) -> Paths:
    """Paths to where it turns aside, from there, and to where it rests; D is over h."""
    scene, middle, h = strip(q, elements, guided=guided)
    watched = {"D": lambda state: float(-state.displacement(middle)[2] / h)}
    first = fl.stability.PathEnds(critical_points=1)
    before = fl.follow_path(scene, first, observe=watched)
    turned = fl.stability.switch_branch(scene, before.critical[0])
    aside = fl.follow_path(scene, first, start=turned, observe=watched)
    back = fl.stability.switch_branch(scene, aside.critical[0])
    return before, aside, fl.follow_path(scene, start=back, observe=watched)


def main(q: float = 6.0, elements: int = 40, pictures: bool = True) -> dict[str, Any]:
    if not q > 2.31:
        raise ValueError(f"a strip with Q = h/t ≤ 2.31 is not bistable, got {q}")
    if elements < 4 or elements % 2:
        raise ValueError(f"elements must be even, for a node in the middle, got {elements}")
    guided, free = (push(q, elements, guided=choice) for choice in (True, False))
    found = {
        "top": 1000 * guided[0].critical[0].factor,
        "bottom": 1000 * guided[1].critical[0].factor,
        "rest": float(np.interp(0.0, guided[2].factors, guided[2].observed["D"])),
        "turning": 1000 * free[0].critical[0].factor,
    }
    if pictures:
        draw(q, guided, free)
    return {
        "q": q,
        "elements": elements,
        **found,
        **{f"{name}_deviation": found[name] / value - 1.0 for name, value in theory(q).items()},
        "stable_at_rest": bool(guided[2].stable.all()),
        "turning_bottom": 1000 * free[1].critical[0].factor,
        "negative_pivots": [p.negative_pivots for path in guided + free for p in path.critical],
        **of_path(*guided, *free),
    }


def draw(q: float, guided: Paths, free: Paths) -> None:
    """The diagram, with the lines of the theory, and the guided half moving."""
    d = np.linspace(0.0, 2.0, 41)
    free[1].plot_path(
        "D",
        in_results("bistable_strip.png"),
        label="deflection over h",
        load=(1000.0, "force over EI h/L³"),
        others=[(path, path.observed["D"]) for path in (free[0], free[2], *guided)],
        reference=(d, force(q, d), "Qiu, Lang & Slocum 2004"),
        units=UNITS,
    )
    free[1].animate(in_results("bistable_strip.gif"), title="Bistable strip", units=UNITS)


if __name__ == "__main__":
    run(main, show=True)

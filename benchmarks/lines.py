"""Every element along lines on two problems: orders and iterations from thick to slender.

- circle: a cantilever is rolled up to a full circle by a moment at its tip
- elastica: it is pushed across by a force P of its tip, P L²/EI = 4

Slenderness is L/t of a square section, so that EA L²/EI is twelve times its square. The error is
the distance of the tip from where a mesh twice as fine has it, over the length. The last column is
how far the tip of the finest mesh, of 64 elements, is from the closed form of a line without
stretch and shear: what thick ones deform otherwise. Iterations are those of Newton's method per
load step, in vain ones among them, the most of any mesh.

Elements without torsion have the moment by a body that holds the tangent of the tip; the discrete
cable has no tangents there, and is pushed only.

    python -m benchmarks.lines [--element NAME]
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from math import inf
from typing import Any, NamedTuple

import numpy as np

import fem_lie as fl
from demos.elastica import BENDING, FORCE, LENGTH, elastica
from fem_lie.mesh.curves import straight_line

CELLS = (8, 16, 32)
_EXACT = 1e-10  # over the length: what Newton's method leaves
SLENDERNESS = (1e1, 1e2, 1e3, 1e4)
TIP = (LENGTH, 0.0, 0.0)


class Line(NamedTuple):
    """An element, and what is known of it.

    Attributes:
        make: A body along the axis, of so many elements and a section.
        circle: Order of the first problem; ``None``: it has no tangent to be turned by; infinite:
            the tip is exact with any mesh.
        elastica: Order of the second one.
        steps: Load steps of the circle; the elastica has ten.
        thick: Whether it is rolled up at a slenderness of ten.
    """

    make: Callable[[int, fl.Section], Any]
    circle: float | None
    elastica: float
    steps: int = 10
    thick: bool = True


class Found(NamedTuple):
    """Place of the tip over the length, shape (3,), and iterations per load step."""

    tip: np.ndarray
    iterations: float


def section(slenderness: float) -> fl.Section:
    EA = 12 * slenderness**2 * BENDING / LENGTH**2
    return fl.Section.from_stiffness([EA, EA / 2, EA / 2, *[BENDING] * 3])


def beam(formulation: fl.elements.BeamFormulation) -> Callable[[int, fl.Section], fl.Beam]:
    body = fl.Rod if isinstance(formulation, fl.elements.DiscreteRod) else fl.Beam

    def make(cells: int, own: fl.Section) -> fl.Beam:
        return body.straight((0, 0, 0), TIP, own, cells=cells, formulation=formulation)

    return make


def cable(formulation: fl.elements.BeamFormulation) -> Callable[[int, fl.Section], fl.Cable]:
    def make(cells: int, own: fl.Section) -> fl.Cable:
        return fl.Cable(straight_line((0, 0, 0), TIP, cells), own, formulation=formulation)

    return make


def spline(cells: int, own: fl.Section) -> fl.SplineCable:
    """With a parameter that is not arc length."""
    u = np.linspace(1.0, 2.0, cells + 1)
    along, rate = (u**1.2 - 1) / (2**1.2 - 1), 1.2 * u**0.2 / (2**1.2 - 1)
    axis = np.array(TIP)
    return fl.SplineCable(u, np.outer(along, axis), np.outer(rate, axis), own)


def ancf(cells: int, own: fl.Section) -> fl.AncfBeam:
    return fl.AncfBeam.straight((0, 0, 0), TIP, own, cells=cells)


LINES = {
    "geodesic beam": Line(beam(fl.elements.GeodesicBeam()), inf, 4),
    "director beam, 1": Line(beam(fl.elements.DirectorBeam(1)), inf, 2),
    "director beam, 2": Line(beam(fl.elements.DirectorBeam(2)), 4, 4),
    "Kirchhoff rod": Line(beam(fl.elements.KirchhoffRod()), 4, 4),
    "discrete rod": Line(beam(fl.elements.DiscreteRod()), 2, 2),
    "cable": Line(cable(fl.elements.HermiteCable()), 4, 4),
    "spline": Line(spline, 4, 4),
    "discrete cable": Line(cable(fl.elements.DiscreteCable()), None, 2),
    "ANCF beam": Line(ancf, 4, 2, steps=16, thick=False),
}


def solved(scene: fl.Scene, end: fl.extend.Point, steps: int) -> Found:
    with warnings.catch_warnings():
        # what has no torsion turns out of its plane under a moment fixed in space, if it is let
        warnings.simplefilter("ignore", fl.stability.UnstableEquilibriumWarning)
        result = fl.statics(scene, load_steps=steps)
    total = result.total_iterations
    return Found(result.position(end)[-1] / LENGTH, float(total) / len(result.iterations))


def cantilever(line: Line, cells: int, slenderness: float) -> tuple[fl.Scene, Any]:
    body, scene = line.make(cells, section(slenderness)), fl.Scene()
    scene.add(body)
    if isinstance(body, fl.Beam):
        scene.add(fl.Clamp(body.point("start")))
    else:
        body.clamp(body.point("start"))
    return scene, body


def rolled_up(name: str, cells: int, slenderness: float) -> Found:
    """The tip is at the root in the end."""
    line, moment = LINES[name], (0, 0, 2 * np.pi * BENDING / LENGTH)
    scene, body = cantilever(line, cells, slenderness)
    point = body.point("end")
    if isinstance(body, fl.Cable | fl.SplineCable):
        tip = scene.add(fl.RigidBody(1.0, (1, 1, 1), position=TIP))
        tip.model.held[0, 3] = True  # about the tangent
        scene.add(fl.joints.Revolute(tip.point("centre"), body.point("end"), axis=(1, 0, 0)))
        point = tip.point("centre")
    scene.add(fl.PointLoad(point, moment=moment))
    return solved(scene, body.point("end"), line.steps)


def pushed(name: str, cells: int, slenderness: float) -> Found:
    """By a force across."""
    scene, body = cantilever(LINES[name], cells, slenderness)
    scene.add(fl.PointLoad(body.point("end"), (0, 0, FORCE)))
    return solved(scene, body.point("end"), 10)


PROBLEMS: dict[str, tuple[Callable[[str, int, float], Found], np.ndarray]] = {
    "circle": (rolled_up, np.zeros(3)),
    "elastica": (pushed, (TIP + elastica(FORCE)) / LENGTH),
}


class Study(NamedTuple):
    """Errors of the meshes, the order, most iterations per step, and the finest tip's distance."""

    errors: list[float]
    order: float
    iterations: float
    rest: float


def study(problem: str, name: str, slenderness: float, cells: tuple[int, ...] = CELLS) -> Study:
    """Run all meshes, each of which is twice as fine as the one before."""
    run, exact = PROBLEMS[problem]
    found = [run(name, n, slenderness) for n in (*cells, 2 * cells[-1])]
    tips = np.array([each.tip for each in found])
    errors = [float(gap) for gap in np.linalg.norm(np.diff(tips, axis=0), axis=1)]
    order = inf
    if errors[0] > _EXACT:
        order = float(np.log(errors[0] / errors[-1]) / np.log(cells[-1] / cells[0]))
    most = max(each.iterations for each in found)
    return Study(errors, order, most, float(np.linalg.norm(tips[-1] - exact)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--element", choices=LINES)
    options = parser.parse_args()
    for problem in PROBLEMS:
        print(f"{problem:18} L/t  " + "".join(f"{n:9}" for n in CELLS), " order  iterations  rest")
        for name in [options.element] if options.element else LINES:
            if problem == "circle" and LINES[name].circle is None:
                continue
            for slenderness in SLENDERNESS:
                try:
                    errors, order, iterations, rest = study(problem, name, slenderness)
                except fl.ConvergenceError as error:
                    print(f"{name:16} {slenderness:7.0e}  {error}"[:110], flush=True)
                    continue
                reported = "".join(f"{error:9.1e}" for error in errors)
                numbers = f"{order:6.2f} {iterations:8.1f} {rest:11.1e}"
                print(f"{name:16} {slenderness:7.0e}{reported} {numbers}", flush=True)


if __name__ == "__main__":
    main()

"""A cable hangs between two points: the elastic catenary.

Unstretched length L = 10 between (0, 0) and (8, 1), weight w = 10 per unstretched length, stiffness
EA = 1e4, no bending. The tension has the horizontal part H, which is constant, and at arc length s
the vertical one V - w s; over EA it is the strain (H. M. Irvine, Cable Structures (1981), 1.3):

    x(s) = H s/EA + H/w (arsinh(V/H) - arsinh((V - w s)/H))
    z(s) = (w s^2/2 - V s)/EA + (sqrt(H^2 + (V - w s)^2) - sqrt(H^2 + V^2))/w

and the two ends give H = 33.73586, V = 43.99520. The computed cable is laid along a parabola first
that is longer than it by a hundredth, so that it is taut. sag_error is the largest distance of a
node from its position on the catenary over the sag of that below the chord, iterations are those of
Newton's method for the whole load. Bending stiffness, which sections have, is EI = 1e-10 EA L^2.

The record has the error of the frequencies of hanging_cable.py, too.

The element can be chosen by --element:

- cable has positions and slopes, and is of fourth order,
- discrete has positions alone, with springs between its edges, and is of second order,
- spline is a parabola as long as it, cut at even steps of its parameter, which is not arc length;
  slack as the next, as nothing pulls it straight at the start,
- rod is Kirchhoff's, whose nodes have frames: laid like the cable, a hundredth too long, which a
  strain without stress takes back. Stretch varies along an element here, and is constant in it: of
  second order,
- ancf is a beam of positions and three slopes, without residual bending flexibility, which lets
  sections turn freely where there is hardly any bending stiffness. Its stress is linear in
  Green's strain, so that at strains of half a percent its limit is 9e-5 away,
- slack is as cable, but a weak spring where the strain is below 1e-4, instead of being pushed: it
  may be laid as one likes, and is laid straight between its ends here, a quarter too short. Without
  that it would be found in an arch, the catenary upside down, or not at all.
"""

from __future__ import annotations

from math import log2
from typing import Any

import hanging_cable
import numpy as np
from command_line import one_of, run
from diagrams import COLOURS, diagram
from reference.catenary import GRAVITY, LENGTH, RISE, SPAN, STRETCH, catenary, parabola, sag

import fem_lie as fl

LONGER = 1.01
Cable = fl.AncfBeam | fl.Cable | fl.SplineCable | fl.Rod
ELEMENTS: dict[str, fl.elements.BeamFormulation | fl.elements.AncfElement] = {
    "cable": fl.elements.HermiteCable(),
    "rod": fl.elements.KirchhoffRod(),
    "slack": fl.elements.HermiteCable(slack=1e-4),
    "discrete": fl.elements.DiscreteCable(),
    "spline": fl.elements.IsogeometricCable(slack=1e-4),
    "ancf": fl.elements.AncfElement(bending_flexibility=False),
}


def section(longer: float = 1.0) -> fl.Section:
    """Per length of a line that is so many times as long as the cable."""
    bending = 1e-10 * STRETCH * LENGTH**2
    return fl.Section.from_stiffness([longer * STRETCH] * 3 + [bending] * 3, mass=1.0 / longer)


def laid(element: str, elements: int) -> Cable:
    """The cable at the start."""
    made, own = ELEMENTS[element], section()
    if isinstance(made, fl.elements.IsogeometricCable):
        position, s = parabola(1.0), np.linspace(0, 1, elements + 1)
        rates = position(s + 0.5) - position(s - 0.5)  # exact on a parabola
        return fl.SplineCable(s, position(s), rates, own, formulation=made, name="cable")
    start = parabola(LONGER) if element != "slack" else lambda s: (SPAN * s, RISE * s, 0.0)
    mesh = fl.mesh.curve(start, elements)
    if isinstance(made, fl.elements.AncfElement):
        return fl.AncfBeam(mesh, own, length=LENGTH, formulation=made, name="cable")
    if isinstance(made, fl.elements.KirchhoffRod):
        return fl.Rod(mesh, section(LONGER), formulation=made, name="cable")
    return fl.Cable(mesh, own, length=LENGTH, formulation=made, name="cable")


def hang(element: str, elements: int) -> tuple[dict[str, Any], fl.StaticResult, Cable]:
    """Both ends held; a record of numbers, and the equilibrium."""
    scene = fl.Scene(gravity=(0, -GRAVITY, 0))
    cable = scene.add(laid(element, elements))
    s = np.concatenate([[0.0], np.cumsum(cable.model.line_quadrature().lengths.sum(axis=1))])
    if isinstance(cable, fl.Rod):
        s *= LENGTH / s[-1]
        scene.add(fl.loads.Eigenstrain(cable, (1 / LONGER - 1, 0, 0, 0, 0, 0)))
        cable.model.held[[0, -1], :3] = True
        cable.model.held[0, 3] = True  # it would turn about itself
    else:
        cable.pin(cable.point("start"), cable.point("end"))
    if isinstance(cable, fl.AncfBeam):
        cable.model.held[len(s), 2] = True  # likewise: its section's second axis stays in the plane
    result, (positions, H, V) = fl.statics(scene), catenary()
    error = np.linalg.norm(result.frames[-1][: len(s), 0, :2] - positions(s), axis=1).max()
    gap = np.linalg.norm(result.reactions[-1][0, :2] - (-H, V))
    record = {
        "element": element,
        "elements": elements,
        "sag_error": float(error / sag()),
        "force_error": float(gap / np.hypot(H, V)),
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
    }
    return record, result, cable


def main(element: str = "cable", elements: int = 32, pictures: bool = True) -> dict[str, Any]:
    one_of("element", element, ELEMENTS)
    record, result, cable = hang(element, elements)
    errors = [hang(element, count)[0]["sag_error"] for count in (8, 32)]
    record["order"] = log2(errors[0] / errors[1]) / 2
    if element in ("cable", "discrete"):  # EA = 1e7 is not strained enough for the others
        record |= hanging_cable.main(element, elements)
    if pictures:
        plot(cable.frames[:, 0], result.frames[-1][:, 0])
    return record


def plot(start: np.ndarray, found: np.ndarray) -> None:
    """The nodes as laid and as they hang, and the closed form."""
    with diagram("catenary.png") as axes:
        exact = catenary()[0](np.linspace(0, LENGTH, 200)).T
        axes.plot(*exact, color=COLOURS[0], label="elastic catenary")
        axes.plot(start[:, 0], start[:, 1], ".", color="0.6", label="as laid")
        axes.plot(found[:, 0], found[:, 1], "o", color=COLOURS[1], markersize=4, label="nodes")
        axes.set(xlabel="x", ylabel="z", title="Hanging cable", aspect="equal")


if __name__ == "__main__":
    run(main, show=True)

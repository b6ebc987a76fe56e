"""A cable hangs between two points: the elastic catenary; then it hangs from one, and swings.

Unstretched length L = 10 between (0, 0) and (8, 1), weight w = 10 per unstretched length, stiffness
EA = 1e4, no bending. The tension has the horizontal part H, which is constant, and at arc length s
the vertical one V - w s; over EA it is the strain (H. M. Irvine, Cable Structures (1981), 1.3):

    x(s) = H s/EA + H/w (arsinh(V/H) - arsinh((V - w s)/H))
    z(s) = (w s^2/2 - V s)/EA + (sqrt(H^2 + (V - w s)^2) - sqrt(H^2 + V^2))/w

and the two ends give H = 33.73586, V = 43.99520. The computed cable is laid along a parabola first
that is longer than it by a hundredth, so that it is taut. sag_error is the largest distance of a
node from its place on the catenary over the sag of that below the chord, iterations are those of
Newton's method for the whole load. Bending stiffness, which sections have, is EI = 1e-10 EA L^2.

Hung from one end, with a point mass M = w L/(10 g) at the other, it swings across with frequencies
of Bessel's functions of p = 2 omega sqrt(M/(rho g)) and q = 2 omega sqrt(M/(rho g) + L/g), if it
does not stretch (EA = 1e7 here): Y_2(p) J_0(q) = J_2(p) Y_0(q). frequency_error is that of the
first three. Without the mass the free end would have no tension, and turn against its bending
alone.

The element can be chosen by --element:

- cable has places and slopes, and is of fourth order,
- discrete has places alone, with springs between its edges, and is of second order,
- spline is a parabola as long as it, cut at even steps of its parameter, which is not arc length;
  slack as the next, as nothing pulls it straight at the start,
- rod is Kirchhoff's, whose nodes have frames: laid like the cable, a hundredth too long, which a
  strain without stress takes back. Stretch varies along an element here, and is constant in it: of
  second order,
- ancf is a beam of places and three slopes, without residual bending flexibility, which lets
  sections turn freely where there is hardly any bending stiffness. Its stress is linear in
  Green's strain, so that at strains of half a percent its limit is 9e-5 away,
- slack is as cable, but a weak spring where the strain is below 1e-4, instead of being pushed: it
  may be laid as one likes, and is laid straight between its ends here, a quarter too short. Without
  that it would be found in an arch, the catenary upside down, or not at all.
"""

from __future__ import annotations

from math import log2
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq, fsolve
from scipy.special import j0, jn, y0, yn

import fem_lie as fl
from fem_lie.mesh.curves import curve
from fem_lie.pictures.diagrams import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
LENGTH, SPAN, RISE, WEIGHT, STRETCH = 10.0, 8.0, 1.0, 10.0, 1e4
GRAVITY = 10.0  # a mass of one per length
LONGER = 1.01
Cable = fl.AncfBeam | fl.Cable | fl.SplineCable | fl.Rod
ELEMENTS: dict[str, fl.Formulation | fl.AncfElement] = {
    "cable": fl.HermiteCable(),
    "rod": fl.Kirchhoff(),
    "slack": fl.HermiteCable(slack=1e-4),
    "discrete": fl.DiscreteCable(),
    "spline": fl.IsogeometricCable(slack=1e-4),
    "ancf": fl.AncfElement(bending_flexibility=False),
}


def catenary(stiffness: float = STRETCH) -> tuple[Any, float, float]:
    """Places (k, 2) as a function of arc lengths, and both parts of the force at the start."""

    def places(s: Any, H: float, V: float) -> np.ndarray:
        down = V - WEIGHT * s
        x = H / WEIGHT * (np.arcsinh(V / H) - np.arcsinh(down / H)) + H * s / stiffness
        z = (np.hypot(H, down) - np.hypot(H, V)) / WEIGHT
        return np.stack([x, z + (0.5 * WEIGHT * s**2 - V * s) / stiffness], axis=-1)

    end = np.array([SPAN, RISE])
    H, V = fsolve(lambda f: places(LENGTH, *f) - end, (34.0, 44.0), xtol=1e-13)
    return (lambda s: places(s, H, V)), float(H), float(V)


def parabola(longer: float) -> Any:
    """Between the ends, so many times as long as the cable; a function of s from 0 to 1."""

    def place(depth: float, s: Any) -> np.ndarray:
        return np.stack([SPAN * s, RISE * s - 4 * depth * s * (1 - s), 0 * s], axis=-1)

    s = np.linspace(0, 1, 10001)

    def gap(depth: float) -> float:
        return float(
            np.linalg.norm(np.diff(place(depth, s), axis=0), axis=1).sum() - longer * LENGTH
        )

    depth = brentq(gap, 0.1, LENGTH)
    return lambda s: place(depth, np.asarray(s))


def section(stiffness: float, longer: float = 1.0) -> fl.Section:
    """Per length of a line that is so many times as long as the cable."""
    bending = 1e-10 * STRETCH * LENGTH**2
    return fl.Section.from_stiffness([longer * stiffness] * 3 + [bending] * 3, mass=1.0 / longer)


def laid(element: str, elements: int) -> Cable:
    """The cable at the start."""
    made, own = ELEMENTS[element], section(STRETCH)
    if isinstance(made, fl.IsogeometricCable):
        place, s = parabola(1.0), np.linspace(0, 1, elements + 1)
        rates = place(s + 0.5) - place(s - 0.5)  # exact on a parabola
        return fl.SplineCable(s, place(s), rates, own, formulation=made, name="cable")
    start = parabola(LONGER) if element != "slack" else lambda s: (SPAN * s, RISE * s, 0.0)
    mesh = curve(start, elements)
    if isinstance(made, fl.AncfElement):
        return fl.AncfBeam(mesh, own, length=LENGTH, formulation=made, name="cable")
    if isinstance(made, fl.Kirchhoff):
        return fl.Rod(mesh, section(STRETCH, LONGER), formulation=made, name="cable")
    return fl.Cable(mesh, own, length=LENGTH, formulation=made, name="cable")


def hang(element: str, elements: int) -> tuple[dict[str, Any], fl.StaticResult, Cable]:
    """Both ends held; a record of numbers, and the equilibrium."""
    cable = laid(element, elements)
    scene = fl.Scene(gravity=(0, -GRAVITY, 0))
    scene.add(cable)
    s = np.concatenate([[0.0], np.cumsum(cable.consistent_shares()[1].sum(axis=1))])
    if isinstance(cable, fl.Rod):
        s *= LENGTH / s[-1]
        scene.add(fl.Eigenstrain(cable, (1 / LONGER - 1, 0, 0, 0, 0, 0)))
        cable.held[[0, -1], :3] = True
        cable.held[0, 3] = True  # it would turn about itself
    else:
        cable.pin(cable.start, cable.end)
    result = fl.statics(scene)
    places, H, V = catenary()
    error = np.linalg.norm(result.frames[-1][: len(s), 0, :2] - places(s), axis=1).max()
    force = result.reactions[-1][0, :2]
    record = {
        "element": element,
        "elements": elements,
        "sag_error": float(error / sag()),
        "force_error": float(np.linalg.norm(force - (-H, V)) / np.hypot(H, V)),
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
    }
    return record, result, cable


def sag() -> float:
    """Largest depth of the catenary below its chord."""
    x, z = catenary()[0](np.linspace(0, LENGTH, 2001)).T
    return float((RISE / SPAN * x - z).max())


def exact_frequencies() -> np.ndarray:
    """The first three, rad per time, across the cable with its mass."""
    end, top = 0.1 * LENGTH / GRAVITY, 1.1 * LENGTH / GRAVITY

    def rest(omega: float) -> float:
        p, q = 2 * omega * np.sqrt([end, top])
        return float(yn(2, p) * j0(q) - jn(2, p) * y0(q))

    grid = np.linspace(0.1, 10.0, 500)
    signs = np.sign([rest(omega) for omega in grid])
    return np.array([brentq(rest, *grid[k : k + 2]) for k in np.flatnonzero(np.diff(signs))[:3]])


def swing(element: str, elements: int) -> float:
    """Error of the first three frequencies of the cable hung from one end."""
    made, own = ELEMENTS[element], section(1e7)
    mesh = curve(lambda s: (0.0, 0.0, -LENGTH * s), elements)
    cable = fl.Cable(mesh, own, formulation=made)
    mass = fl.RigidBody(0.1 * LENGTH, (1e-3,) * 3, position=(0, 0, -LENGTH))
    mass.held[0, 3:] = True
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    for body in (cable, mass):
        scene.add(body)
    scene.add(fl.Spherical(cable.end, mass.centre))
    cable.pin(cable.start)
    found = fl.vibrations(scene, 6, at=fl.statics(scene)).frequencies
    return float(np.abs(found / np.repeat(exact_frequencies(), 2) - 1).max())


def main(element: str = "cable", elements: int = 32, pictures: bool = True) -> dict[str, Any]:
    if element not in ELEMENTS:
        raise ValueError(f"element must be one of {', '.join(ELEMENTS)}, got {element}")
    print("elements  error of places  of force  iterations")
    errors = {}
    for count in sorted({4, 8, 16, 32, elements}):
        numbers, result, cable = hang(element, count)
        errors[count] = numbers["sag_error"]
        print(
            f"{count:8}  {errors[count]:15.1e}  {numbers['force_error']:8.1e}"
            f"  {numbers['iterations']:10} + {numbers['failed_iterations']} in vain"
        )
        if count == elements:
            record, chosen, shown = numbers, result, cable
    record["order"] = log2(errors[8] / errors[32]) / 2
    print(f"observed order from 8 to 32 elements: {record['order']:.2f}")
    if element in ("cable", "discrete"):  # EA = 1e7 is not strained enough for the others
        record["frequency_error"] = swing(element, elements)
        print(f"first three frequencies, hung from one end: error {record['frequency_error']:.1e}")
    if pictures:
        RESULTS.mkdir(exist_ok=True)
        path = RESULTS / "catenary.png"
        plot(shown.frames[:, 0], chosen.frames[-1][:, 0], path)
        print(f"picture: {path}")
    return record


def plot(start: np.ndarray, found: np.ndarray, path: Path) -> None:
    """The nodes as laid and as they hang, and the closed form."""
    figure = Figure(figsize=(6.0, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots()
    x, z = catenary()[0](np.linspace(0, LENGTH, 200)).T
    axes.plot(x, z, color=COLOURS[0], label="elastic catenary")
    axes.plot(start[:, 0], start[:, 1], ".", color="0.6", label="as laid")
    axes.plot(found[:, 0], found[:, 1], "o", color=COLOURS[1], markersize=4, label="nodes")
    axes.set(xlabel="x", ylabel="z", title="Hanging cable", aspect="equal")
    axes.legend(frameon=False)
    figure.savefig(path)


if __name__ == "__main__":
    from command_line import run

    run(main)

"""Beams of few elements whose axial force is large beside their bending stiffness.

    python -m benchmarks.coarse_beams [--cells 8 16 32] [--cases wire bar ...]

An element of length h resolves a boundary layer of length sqrt(EI/N) only if it is no longer than
that. Where it is longer, it must be wrong in the boundary layer alone: neither unstable nor
stretched. Each row gives the relative error of one quantity with each element.

- wire: steel, 1 mm thick, 0.6 m long, under 200 N, with a small force in the middle. Deflection
  (closed form of a tensioned beam) and first frequency (its characteristic equation).
- bar: steel, 20 mm square, 30 m long, clamped at one end, under its own weight. Position of the tip
  over the length, against 256 rod elements.
- pendulum: rubber (E = 0.7 MPa), 1.2 m long, falls from the horizontal for 0.8 s. Largest distance
  of the tip from that of 128 cable elements over the length.
- strip: on a hub that turns at 100 rad/s, clamped 0.05 m from the axis. First two frequencies,
  against 128 director elements of degree 2.
- blade: on a hub that turns at 20 rad/s, with 1000 kg at its end. First frequency, likewise.
- mast: a tube of 20 m held by two guys of 12 mm, all of the same elements, under a load that leans.
  Load factor of buckling, against 80 of these for each guy and the mast.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

import fem_lie as fl

STEEL = fl.Material(2e11, 0.3, 7850.0)
ELEMENTS: dict[str, fl.elements.BeamFormulation] = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director1": fl.elements.DirectorBeam(1),
    "director2": fl.elements.DirectorBeam(2),
    "rod": fl.elements.KirchhoffRod(),
}


def line(
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    section: fl.Section,
    cells: int,
    element: fl.elements.BeamFormulation,
    up: tuple[float, float, float] | None = None,
) -> fl.Beam:
    """A straight beam, or a rod where the element has no shear."""
    make = fl.Rod if isinstance(element, fl.elements.KirchhoffRod) else fl.Beam
    return make.straight(start, end, section, cells=cells, up=up, formulation=element)


def wire(cells: int, element: fl.elements.BeamFormulation) -> list[float]:
    """Errors of the deflection and of the first frequency."""
    radius, tension, length, force = 0.0005, 200.0, 0.6, 1e-3
    bending, mass = 2e11 * np.pi * radius**4 / 4, 7850.0 * np.pi * radius**2
    scene, hub = fl.Scene(), fl.RigidBody(1e-3, (1e-6,) * 3, position=(length, 0, 0))
    wire = scene.add(
        line((0, 0, 0), (length, 0, 0), fl.Section.circle(radius, STEEL), cells, element)
    )
    scene.add(hub)
    scene.add(fl.Clamp(wire.point("start")))
    scene.add(fl.joints.Prismatic(fl.ground(), hub.point("centre"), axis=(1, 0, 0)))
    scene.add(fl.joints.Fixed(hub.point("centre"), wire.point("end")))
    scene.add(fl.PointLoad(hub.point("centre"), (tension, 0, 0)))
    middle = wire.point((length / 2, 0, 0))
    scene.add(fl.PointLoad(middle, (0, 0, force)))
    result = fl.statics(scene)
    assert result.stable[-1], (cells, element)
    k, half = np.sqrt(tension / bending), length / 2
    exact = force / (2 * tension) * (half - 2 / k * np.tanh(k * half / 2))
    deflection = result.displacement(middle)[-1][2] / exact - 1

    def clamped(β: float) -> float:
        α = np.hypot(k, β)
        return float(β * np.sin(β * half) + α * np.tanh(α * half) * np.cos(β * half))

    β = brentq(clamped, 0.5 * np.pi / half, np.pi / half)
    exact = β * np.hypot(k, β) * np.sqrt(bending / mass)
    frequency = fl.vibrations(scene, 1, at=result).frequencies[0] / exact - 1
    return [deflection, frequency]


def heavy_bar(cells: int, element: fl.elements.BeamFormulation) -> np.ndarray:
    """Position of the tip, and the largest stretch of a chord."""
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(2.1e11, 0.3, 7800.0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    beam = scene.add(line((0, 0, 0), (30, 0, 0), section, cells, element))
    scene.add(fl.Clamp(beam.point("start")))
    result = fl.statics(scene)
    assert result.stable[-1], (cells, element)
    return np.asarray(result.position(beam.point("end"))[-1])


def bar(cells: int, element: fl.elements.BeamFormulation) -> list[float]:
    """Distance of the tip from the reference over the length."""
    return [float(np.linalg.norm(heavy_bar(cells, element) - reference(heavy_bar)) / 30)]


def rubber() -> fl.Section:
    """Of the pendulum of ANCF benchmarks, alike in all directions across, as cables are."""
    EA, EI, mass = 0.7e6 * 1.8e-3, 0.7e6 * 1.215e-8, 5540 * 1.8e-3
    return fl.Section.from_stiffness(
        [EA, EA / 2.6, EA / 2.6, EI, EI, EI], mass=mass, rotary=(5540 * 1.215e-8,) * 2
    )


def falling(cells: int, element: fl.elements.BeamFormulation | None) -> np.ndarray:
    """Positions of the tip in time; without an element those of a cable."""
    section, ends = rubber(), ((0.0, 0.0, 0.0), (1.2, 0.0, 0.0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    beam: fl.Beam | fl.Cable
    if element is None:
        beam = scene.add(fl.Cable.straight(*ends, section, cells=cells))
        beam.pin(beam.point("start"))
    else:
        beam = scene.add(line(*ends, section, cells, element, up=(0, 0, 1)))
        scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    scheme = fl.GeneralisedAlpha(radius=0.6)
    return np.asarray(scheme.run(scene, duration=0.8, step=1e-3).position(beam.point("end")))


def pendulum(cells: int, element: fl.elements.BeamFormulation) -> list[float]:
    """Largest distance of the tip over the length."""
    apart = falling(cells, element) - reference(falling)
    return [float(np.linalg.norm(apart, axis=1).max() / 1.2)]


def spinning(cells: int, element: fl.elements.BeamFormulation) -> np.ndarray:
    """First two frequencies of the strip across its plane of rotation."""
    section = fl.Section.rectangle(0.02, 0.001, fl.Material(7e10, 0.3, 2700.0))
    scene = fl.Scene()
    strip = scene.add(line((0.05, 0, 0), (1.05, 0, 0), section, cells, element, up=(0, 0, 1)))
    scene.add(fl.Clamp(strip.point("start")))
    return np.asarray(fl.vibrations(scene, 3, spin=(0, 0, 100.0)).frequencies[[0, 2]])


def strip(cells: int, element: fl.elements.BeamFormulation) -> list[float]:
    """Errors of the first two frequencies."""
    return list(spinning(cells, element) / reference(spinning) - 1)


def loaded_blade(cells: int, element: fl.elements.BeamFormulation) -> np.ndarray:
    """First frequency of the blade with its mass."""
    section, scene = fl.Section.rectangle(0.05, 0.005, fl.Material(2.1e11, 0.3, 7800.0)), fl.Scene()
    blade = scene.add(line((0.1, 0, 0), (1.1, 0, 0), section, cells, element, up=(0, 0, 1)))
    mass = scene.add(fl.RigidBody(1000.0, (1.0, 1.0, 1.0), position=(1.1, 0, 0)))
    scene.add(fl.Clamp(blade.point("start")))
    scene.add(fl.joints.RigidLink(blade.point("end"), mass.point("centre")))
    return np.asarray(fl.vibrations(scene, 1, spin=(0, 0, 20.0)).frequencies)


def blade(cells: int, element: fl.elements.BeamFormulation) -> list[float]:
    """Error of the first frequency."""
    return list(loaded_blade(cells, element) / reference(loaded_blade) - 1)


def guyed(cells: int, element: fl.elements.BeamFormulation) -> np.ndarray:
    """Lowest factor of a load of 8 kN down and 2 kN along x."""
    tube, rope = fl.Section.tube(0.075, 0.08, STEEL), fl.Section.circle(0.006, STEEL)
    scene = fl.Scene()
    mast = scene.add(line((0, 0, 0), (0, 0, 20), tube, cells, element))
    scene.add(
        fl.joints.Universal(fl.ground(), mast.point("start"), axis=(1, 0, 0), second=(0, 1, 0))
    )
    for side in (-8.0, 8.0):
        guy = scene.add(line((-12, side, 0), (0, 0, 20), rope, cells, element))
        scene.add(fl.Clamp(guy.point("start")))
        scene.add(fl.joints.Spherical(mast.point("end"), guy.point("end")))
    scene.add(fl.PointLoad(mast.point("end"), (2e3, 0, -8e3)))
    return np.asarray(fl.buckling(scene, 1).factors)


def mast(cells: int, element: fl.elements.BeamFormulation) -> list[float]:
    """Error of the load factor."""
    return list(guyed(cells, element) / reference(guyed) - 1)


_REFERENCES: dict[Callable[..., np.ndarray], np.ndarray] = {}


def reference(case: Callable[..., np.ndarray]) -> np.ndarray:
    """What many elements give: rods, and for the pendulum a cable."""
    if case not in _REFERENCES:
        _REFERENCES[case] = {
            heavy_bar: lambda: heavy_bar(256, fl.elements.KirchhoffRod()),
            falling: lambda: falling(128, None),
            spinning: lambda: spinning(128, fl.elements.DirectorBeam(2)),
            loaded_blade: lambda: loaded_blade(128, fl.elements.DirectorBeam(2)),
            guyed: lambda: guyed(80, fl.elements.DirectorBeam(2)),
        }[case]()
    return _REFERENCES[case]


CASES: dict[str, Callable[[int, fl.elements.BeamFormulation], list[float]]] = {
    case.__name__: case for case in (wire, bar, pendulum, strip, blade, mast)
}


def main() -> None:
    """A row for each case, element and mesh."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", nargs="+", type=int, default=[8, 16, 32])
    parser.add_argument("--cases", nargs="+", choices=list(CASES), default=list(CASES))
    parser.add_argument("--elements", nargs="+", choices=list(ELEMENTS), default=list(ELEMENTS))
    given = parser.parse_args()
    for name in given.cases:
        for element in given.elements:
            for cells in given.cells:
                try:
                    errors = CASES[name](cells, ELEMENTS[element])
                    found = "  ".join(f"{error:+.1e}" for error in errors)
                except (AssertionError, ValueError, fl.ConvergenceError) as error:
                    found = f"{type(error).__name__}: {str(error)[:90]}"
                print(f"{name:9s} {element:9s} {cells:3d} cells: {found}", flush=True)


if __name__ == "__main__":
    main()

"""What shell elements can do, as the tables of docs/measured/shells.md.

    python3 -m benchmarks.shells steps       hemispheres: largest load step, iterations, CPU seconds
    python3 -m benchmarks.shells thickness   quarter-circle strip: deflection over the exact one
    python3 -m benchmarks.shells bending     end moment to a quarter circle, over elements
    python3 -m benchmarks.shells shapes      aspect 1:100, 45 degrees of skew, random distortion

Each prints a table in Markdown.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from math import pi
from time import process_time

import numpy as np

import fem_lie as fl
from demos.cantilever_moment import LENGTH as ROLLED
from demos.cantilever_moment import STIFFNESS as ROLLED_STIFFNESS
from demos.hemisphere import CASES, RADIUS, pinched, quarter
from fem_lie.elements.shells.strains import shear

SMALL = 1e-6
HR, HW, MITC4 = (
    fl.elements.HellingerReissner(),
    fl.elements.HuWashizu(),
    fl.elements.DisplacementBased(),
)
PLUS, PLUS_MITC4 = (
    fl.elements.HellingerReissner(fl.elements.MITC4_PLUS),
    fl.elements.DisplacementBased(fl.elements.MITC4_PLUS),
)
ELEMENTS: dict[str, tuple[fl.elements.ShellFormulation, str]] = {
    "HR": (HR, "quadrilateral"),
    "HW": (HW, "quadrilateral"),
    "MITC4": (MITC4, "quadrilateral"),
    "HR, MITC4+": (PLUS, "quadrilateral"),
    "MITC4+": (PLUS_MITC4, "quadrilateral"),
    "MITC3+, HR": (HR, "triangle"),
}
Place = Callable[[float, float], Sequence[float]]


def row(*cells: str) -> None:
    """Of a table, at once."""
    print("| " + " | ".join(cells) + " |", flush=True)


def header(*cells: str) -> None:
    row(*cells)
    row(*("---" for _ in cells))


# --- load steps -----------------------------------------------------------------------------------


def steps(most: int = 40) -> None:
    """The largest of equal load steps with which Newton's method arrives, on both hemispheres."""
    plain = fl.elements.DisplacementBased(fl.elements.StrainMeasures(shear=shear))
    cases = ((0.04, 16), (0.01, 24))
    header(
        "element",
        "stress",
        *(f"t = {t}, {n}×{n}: steps, iterations, CPU seconds (errors, %)" for t, n in cases),
    )
    for name, formulation in {"displacement": plain, "MITC4": MITC4, "HR": HR, "HW": HW}.items():
        fl.statics(pinched(0.04, quarter(4), formulation), load_steps=20)  # compiles
        for carried in (False, True):
            cells = [largest_step(t, n, formulation, carried, most) for t, n in cases]
            row(name, "carried" if carried else "plain Newton", *cells)


def largest_step(
    thickness: float, mesh: int, formulation: fl.elements.ShellFormulation, carried: bool, most: int
) -> str:
    """Steps, iterations, seconds and errors."""
    for count in range(1, most + 1):
        scene, start = pinched(thickness, quarter(mesh), formulation), process_time()
        try:
            result = fl.statics(
                scene,
                load_steps=count,
                newton=fl.schemes.Newton(linearised_stress=carried, smallest_step=0.99 / count),
            )
        except fl.ConvergenceError:
            continue
        seconds = process_time() - start
        a = result.position("hemisphere.00")[-1, 0] - RADIUS
        b = RADIUS - result.position("hemisphere.10")[-1, 1]
        _, outward, inward = CASES[thickness]
        found = errors(a / outward, b / inward)
        return f"{count}, {result.iterations[-1]}, {seconds:.2f} ({found})"
    return f"more than {most}"


# --- thickness ------------------------------------------------------------------------------------


def thickness(cells: int = 16, radius: float = 10.0) -> None:
    """A quarter-circle strip under a small radial force at its end, over the curved beam."""
    slenderness = [1e1, 1e2, 1e3, 1e4, 1e5]
    header("element", "distortion", *(f"R/t = {s:.0e}" for s in slenderness))
    for name, (formulation, cell) in ELEMENTS.items():
        for distortion in (0.0, 0.3, 1.0):
            ratios = []
            for s in slenderness:
                t = radius / s
                found = strip_deflection(cells, radius, t, distortion, formulation, cell)
                ratios.append(f"{found / curved_beam(t, radius):.3f}")
            row(name, f"{distortion:g}", *ratios)


def curved_beam(t: float, radius: float) -> float:
    """Deflection under a radial unit force, with shear and stretch; E = 1e6, no contraction."""
    EI, EA, GA = 1e6 * t**3 / 12, 1e6 * t, 5 / 6 * 0.5e6 * t
    return pi / 4 * (radius**3 / EI + radius / EA + radius / GA)


def strip_deflection(
    cells: int,
    radius: float,
    t: float,
    distortion: float,
    formulation: fl.elements.ShellFormulation,
    cell: str,
) -> float:
    """The edges across the strip turn to and fro by ``distortion`` cells."""

    def position(a: float, b: float) -> list[float]:
        angle = (a + distortion / cells * np.sin(pi * a) * (2 * b - 1)) * pi / 2
        return [radius * np.sin(angle), b, radius * np.cos(angle)]

    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (cells, 1), cell=cell),
        fl.ShellSection.layer(t, fl.Material(1e6, 0.0, 1.0)),
        director=lambda x: np.array([x[0], 0.0, x[2]]) / np.hypot(x[0], x[2]),
        formulation=formulation,
        name="strip",
    )
    shell.clamp("a=0")
    # so small that it stays linear, whatever the thickness
    small = SMALL * radius / curved_beam(t, radius)
    result = solved(shell, fl.loads.EdgeLoad(shell, "a=1", force=(-small, 0, 0)))
    ends = [result.position(f"strip.{point}")[-1, 0] for point in ("10", "11")]
    return float(radius - np.mean(ends)) / small


def solved(shell: fl.Shell, load: fl.loads.EdgeLoad) -> fl.StaticResult:
    """Equilibrium of a shell under one load."""
    scene = fl.Scene()
    scene.add(shell)
    scene.add(load)
    return fl.follow_loads(scene)


# --- cylindrical bending --------------------------------------------------------------------------


def bending() -> None:
    """End moment to a quarter circle: error of the end's rotation, and of its position."""
    elements = {
        "decoupled bending": fl.elements.HellingerReissner(fl.elements.DECOUPLED),
        "full form": HR,
    }
    header("elements", *(f"{name}: rotation / position" for name in elements))
    for cells in (1, 2, 4, 8, 16):
        row(str(cells), *(rolled(cells, formulation) for formulation in elements.values()))


def rolled(cells: int, formulation: fl.elements.ShellFormulation) -> str:
    """Both errors: in rad, and over the length."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (ROLLED * a, b, 0.0), (cells, 1)),
        fl.ShellSection.layer(0.1, fl.Material(1.2e6, 0.0, 1.0)),
        formulation=formulation,
        name="strip",
    )
    shell.clamp("a=0")
    angle = pi / 2
    moment = angle * ROLLED_STIFFNESS / ROLLED
    try:
        result = solved(shell, fl.loads.EdgeLoad(shell, "a=1", moment=(0, -moment, 0)))
    except fl.ConvergenceError:
        return "does not arrive"
    director = result.rotation("strip.10")[-1, :, 2]
    turned = np.arctan2(-director[0], director[2]) - angle
    radius = ROLLED / angle
    position = result.position("strip.10")[-1] - [radius, 0.0, radius]
    return f"{abs(turned):.0e} / {np.linalg.norm(position) / ROLLED:.1e}"


# --- ill-shaped cells -----------------------------------------------------------------------------


def shapes() -> None:
    """The cantilever under end shear, flat, and the hemisphere, curved: errors in per cent."""
    flat = {
        "16×2": ((16, 2), strip_at(lambda a, b: (0.0, 0.0))),
        "16×160, aspect 1:100": ((16, 160), strip_at(lambda a, b: (0.0, 0.0))),
        "16×2, skew 45°": ((16, 2), strip_at(lambda a, b: (0.1 * (b - 0.5) * inside(a), 0.0))),
        "16×2, random": ((16, 2), strip_at(lambda a, b: noise(a, b, 16, 2))),
    }
    curved = {
        "hemisphere 16×16": sphere_at(lambda a, b: (0.0, 0.0)),
        "skewed by up to 27°": sphere_at(lambda a, b: (0.8 * a * (1 - a) * (2 * b - 1), 0.0)),
        "random": sphere_at(lambda a, b: noise(a, b, 16, 16)),
    }
    header("element", *flat, *curved)
    for name, (formulation, cell) in ELEMENTS.items():
        cells = [cantilever(*mesh, formulation, cell) for mesh in flat.values()]
        cells += [hemisphere(position, formulation, cell) for position in curved.values()]
        row(name, *cells)


def inside(a: float) -> float:
    """One but at the ends."""
    return float(1e-9 < a < 1 - 1e-9)


def noise(a: float, b: float, n: int, m: int) -> tuple[float, float]:
    """Up to 0.3 of a cell, the same at each call; along an edge on it."""
    rng = np.random.default_rng([round(a * n), round(b * m)])
    first, second = 0.3 * (2 * rng.random(2) - 1)
    return first / n * inside(a), second / m * inside(b)


def strip_at(shift: Callable[[float, float], tuple[float, float]]) -> Place:
    """A strip of 10 x 1 with shifted nodes."""

    def position(a: float, b: float) -> list[float]:
        da, db = shift(a, b)
        return [10 * (a + da), b + db, 0.0]

    return position


def sphere_at(shift: Callable[[float, float], tuple[float, float]]) -> Place:
    """The quarter of the hemisphere with shifted nodes."""

    def position(a: float, b: float) -> list[float]:
        da, db = shift(a, b)
        azimuth, height = (a + da) * pi / 2, (b + db) * np.radians(72)
        level = RADIUS * np.cos(height)
        return [level * np.cos(azimuth), level * np.sin(azimuth), RADIUS * np.sin(height)]

    return position


def cantilever(
    cells: tuple[int, int], position: Place, formulation: fl.elements.ShellFormulation, cell: str
) -> str:
    """Shortening and deflection under the full load of demos/cantilever_shear.py."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(position, cells, cell=cell),
        fl.ShellSection.layer(0.1, fl.Material(1.2e6, 0.0, 1.0)),
        formulation=formulation,
        name="strip",
    )
    shell.clamp("a=0")
    result = solved(shell, fl.loads.EdgeLoad(shell, "a=1", force=(0, 0, 4.0)))
    moved = result.position("strip.10")[-1] - [10.0, 0.0, 0.0]
    return errors(-moved[0] / 3.289678, moved[2] / 6.700108)


def hemisphere(position: Place, formulation: fl.elements.ShellFormulation, cell: str) -> str:
    """Deflections of demos/hemisphere.py, t = 0.04."""
    scene = pinched(0.04, fl.mesh.parametric_surface(position, (16, 16), cell=cell), formulation)
    result = fl.follow_loads(scene)
    _, outward, inward = CASES[0.04]
    a = result.position("hemisphere.00")[-1, 0] - RADIUS
    b = RADIUS - result.position("hemisphere.10")[-1, 1]
    return errors(a / outward, b / inward)


def errors(*ratios: float) -> str:
    """In per cent."""
    return " / ".join(f"{100 * (ratio - 1):+.1f}" for ratio in ratios)


TABLES = {"steps": steps, "thickness": thickness, "bending": bending, "shapes": shapes}


if __name__ == "__main__":
    wanted = sys.argv[1:] or list(TABLES)
    unknown = set(wanted) - set(TABLES)
    if unknown:
        sys.exit(f"tables are {', '.join(TABLES)}, got {', '.join(sorted(unknown))}")
    for table in wanted:
        TABLES[table]()
        print()

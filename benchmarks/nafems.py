"""Standard benchmarks of NAFEMS by the public interface, and their target values.

    RUN -m benchmarks.nafems [--only LE1 FV52] [--refined]

The National Agency for Finite Element Methods and Standards, *The Standard NAFEMS Benchmarks*
(TNSB, rev. 3, 1990): linear elasticity (LE) and free vibration (FV); *Selected Benchmarks for
Forced Vibration* (R0016, 1989): test 13. Targets are closed forms where the row says so;
those of LE are of fine meshes of other codes. Every scene has at most a few hundred
cells; with ``--refined`` cells are half as large.

Stresses are nodal means (``at``), as the targets are those of points.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import fem_lie as fl

STEEL = fl.Material(E=210e9, nu=0.3, density=7800.0)
PLATES = fl.Material(E=200e9, nu=0.3, density=8000.0)
"""Of vibrations."""
EDGES = "a=0", "a=1", "b=0", "b=1"


class Row(NamedTuple):
    """One value.

    Attributes:
        name: Test and quantity.
        value: What is computed.
        target: Published value.
    """

    name: str
    value: float
    target: float

    @property
    def error(self) -> float:
        """Relative to the target."""
        return self.value / self.target - 1.0


def scene_of(*items: object) -> fl.Scene:
    """A scene of bodies, loads and joints."""
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


def ellipses(a: float, b: float) -> tuple[float, float]:
    """Of the quarter membrane between two ellipses: ``a`` outwards, ``b`` from x to y."""
    angle = 0.5 * np.pi * b
    along, up = 2.0 + 1.25 * a, 1.0 + 1.75 * a
    return along * np.cos(angle), up * np.sin(angle)


# --- linear elasticity ----------------------------------------------------------------------------


def le1(refine: int) -> list[Row]:
    """Elliptic membrane: stress at the end of the long axis of the hole."""
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([*ellipses(a, b), 0.0]), (8 * refine, 16 * refine), degree=2
    )
    membrane = fl.Shell(mesh, fl.ShellSection.layer(0.1, STEEL), name="membrane")
    membrane.symmetry("b=0", normal=(0, 1, 0))
    membrane.symmetry("b=1", normal=(1, 0, 0))
    membrane.roller("a=1", normal=(0, 0, 1))

    def outward(x: np.ndarray) -> np.ndarray:
        normal = np.array([x[0] / 3.25**2, x[1] / 2.75**2, 0.0])
        return 10e6 * 0.1 * normal / np.linalg.norm(normal)

    result = fl.statics(scene_of(membrane, fl.loads.EdgeLoad(membrane, "a=1", force=outward)))
    stress = fl.post.resultants(result, membrane, along=(1, 0, 0))
    return [Row("LE1 σyy at D", stress.at(membrane.point("00"), "N22") / 0.1, 92.7e6)]


def le5(refine: int) -> list[Row]:
    """Z-section cantilever in torsion: axial stress at a flange, 2.5 m from the root."""
    n, length = 2 * refine, 10.0
    half = [(1.0 - k / n, 1.0) for k in range(n)] + [(0.0, 1.0 - k / n) for k in range(n)]
    profile = [*half, (0.0, 0.0), *((-y, -z) for y, z in reversed(half))]
    x, m = np.linspace(0.0, length, 8 * n + 1), len(profile)
    points = np.array([(s, y, z) for s in x for y, z in profile])
    corners = np.arange(m * (len(x) - 1)).reshape(-1, m)[:, :-1].ravel()[:, np.newaxis]
    cells = corners + np.array([0, 1, m, m + 1])
    mesh = fl.mesh.SurfaceMesh.from_cells(points, cells, "quadrilateral").named(
        curves={
            "root": lambda x: x[0] < 1e-6,
            "top": lambda x: (x[0] > length - 1e-6) & (x[2] > 1.0 - 1e-6),
            "bottom": lambda x: (x[0] > length - 1e-6) & (x[2] < -1.0 + 1e-6),
        }
    )
    beam = fl.Shell(mesh, fl.ShellSection.layer(0.1, STEEL), name="beam")
    beam.clamp("root")
    shear = [
        fl.loads.EdgeLoad(beam, curve, force=(0, sign * 0.6e6, 0))
        for curve, sign in (("top", 1), ("bottom", -1))
    ]
    result = fl.statics(scene_of(beam, *shear))
    stress = fl.post.resultants(result, beam, along=(1, 0, 0))
    return [Row("LE5 σxx at A", stress.at(beam.point((2.5, 1.0, 1.0)), "N11") / 0.1, -108e6)]


def le6(refine: int) -> list[Row]:
    """Skew plate of 30° under pressure: largest principal stress of the lower side."""
    thickness, n = 0.01, 16 * refine
    slanted, up = np.cos(np.radians(30)), np.sin(np.radians(30))
    mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a + b * slanted, b * up, 0.0]), (n, n))
    plate = fl.Shell(mesh, fl.ShellSection.layer(thickness, STEEL), name="plate")
    for edge in EDGES:
        plate.roller(edge, normal=(0, 0, 1))
    held = [
        fl.joints.InPlane(fl.ground(), plate.point(at), at=plate.point(at).position, axis=axis)
        for at, axis in (("00", (1, 0, 0)), ("00", (0, 1, 0)), ("10", (0, 1, 0)))
    ]
    result = fl.statics(scene_of(plate, *held, fl.AreaLoad(plate, force=(0, 0, -700.0))))
    stress = fl.post.resultants(result, plate, along=(1, 0, 0))
    centre = plate.point((0.5 + 0.5 * slanted, 0.5 * up, 0.0))
    largest = max(abs(stress.at(centre, name)) for name in ("M max", "M min"))
    return [Row("LE6 principal stress at E", 6.0 * largest / thickness**2, 0.802e6)]


def le10(refine: int) -> list[Row]:
    """Thick elliptic plate under pressure: stress at the hole, on the loaded side."""
    mesh = fl.mesh.parametric_volume(
        lambda a, b, c: (*ellipses(a, b), 0.6 * c), (6 * refine, 12 * refine, 2)
    )
    solid = fl.sections.SaintVenantKirchhoff(210e9, 0.3, 7800.0)
    plate = fl.Solid(mesh, solid, degree=2, name="plate")
    plate.roller("b=0", normal=(0, 1, 0))
    plate.roller("b=1", normal=(1, 0, 0))
    for normal in ((1, 0, 0), (0, 1, 0)):
        plate.roller("a=1", normal=normal)
    middle = [point for point in plate.points("a=1") if abs(point.position[2] - 0.3) < 1e-9]
    ring = [
        fl.joints.InPlane(fl.ground(), point, at=point.position, axis=(0, 0, 1)) for point in middle
    ]
    result = fl.statics(scene_of(plate, *ring, fl.loads.FacePressure(plate, "c=1", 1e6)))
    stress = fl.post.solid_stresses(result, plate)
    return [Row("LE10 σyy at D", stress.at(plate.point((2.0, 0.0, 0.6)), "yy"), -5.38e6)]


# --- free vibration -------------------------------------------------------------------------------


def square(refine: int, thickness: float = 0.05, angle: float = 90.0) -> fl.Shell:
    """Plate of 10 m by 10 m."""
    slanted, up = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    mesh = fl.mesh.parametric_surface(
        lambda a, b: 10.0 * np.array([a + b * slanted, b * up, 0.0]), (16 * refine, 16 * refine)
    )
    return fl.Shell(mesh, fl.ShellSection.layer(thickness, PLATES), name="plate")


def frequencies(test: str, body: fl.Body, rigid: int, targets: tuple[float, ...]) -> list[Row]:
    """The first frequencies above those of rigid motions, Hz."""
    found = fl.vibrations(scene_of(body), rigid + len(targets)).hertz[rigid:]
    named = enumerate(zip(found, targets, strict=True), rigid + 1)
    return [Row(f"{test} mode {k}, Hz", float(f), target) for k, (f, target) in named]


def fv12(refine: int) -> list[Row]:
    """Free thin plate; in the published test its motions in the plane are held."""
    return frequencies("FV12", square(refine), 6, (1.622, 2.360, 2.922, 4.233, 4.233, 7.416))


def fv15(refine: int) -> list[Row]:
    """Clamped thin rhombic plate, 45°."""
    plate = square(2 * refine, angle=45.0)
    for edge in EDGES:
        plate.clamp(edge)
    targets = 7.938, 12.835, 17.941, 19.133, 24.009, 27.922
    return frequencies("FV15", plate, 0, targets)


def fv16(refine: int) -> list[Row]:
    """Cantilevered thin plate."""
    plate = square(refine)
    plate.clamp("a=0")
    return frequencies("FV16", plate, 0, (0.421, 1.029, 2.582, 3.306, 3.753, 6.555))


def fv52(refine: int) -> list[Row]:
    """Solid plate, held across along the lower edges; its motions in the plane are free."""
    solid = fl.sections.SaintVenantKirchhoff(200e9, 0.3, 8000.0)
    cells = 8 * refine, 8 * refine, 2
    plate = fl.Solid.brick((10, 10, 1), solid, cells=cells, degree=2, name="plate")
    for edge in EDGES:
        plate.roller(f"{edge},c=0", normal=(0, 0, 1))
    targets = 45.897, 109.44, 109.44, 167.89, 193.59, 206.19, 206.19
    return frequencies("FV52", plate, 3, targets)


# --- forced vibration -----------------------------------------------------------------------------


def supported(refine: int) -> tuple[fl.Shell, fl.extend.Point]:
    """Simply supported quarter of a plate with Rayleigh damping, and the centre of the plate.

    2 % of critical damping in the first mode.
    """
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([5.0 * a, 5.0 * b, 0.0]), (8 * refine, 8 * refine)
    )
    layer = fl.ShellSection.layer(0.05, PLATES)
    rayleigh = fl.sections.Damping(mass=0.299, stiffness=1.339e-3)
    plate = fl.Shell(mesh, layer, damping=rayleigh, name="plate")
    for edge in ("a=0", "b=0"):
        plate.roller(edge, normal=(0, 0, 1))
    plate.symmetry("a=1", normal=(1, 0, 0))
    plate.symmetry("b=1", normal=(0, 1, 0))
    return plate, plate.point("11")


def forced_13(refine: int) -> list[Row]:
    """Thin plate under 100 N/m²: harmonic, at once, and at rest."""
    plate, centre = supported(refine)
    load = fl.AreaLoad(plate, force=(0, 0, 100.0))
    omega = 2.0 * np.pi * np.linspace(2.3, 2.45, 61)
    response = fl.post.frequency_response(scene_of(plate), load, omega)
    deflection = abs(response.displacement(centre)[:, 2])
    motion = fl.GeneralisedAlpha(radius=0.9).run(
        scene_of(plate, load), duration=0.3, step=2e-3, progress=False
    )
    history = motion.displacement(centre)[:, 2]
    rest = fl.statics(scene_of(plate, load)).displacement(centre)[-1, 2]
    return [
        Row("13H peak, m", float(deflection.max()), 45.42e-3),
        Row("13H frequency, Hz", float(response.hertz[deflection.argmax()]), 2.377),
        Row("13T peak, m", float(history.max()), 3.523e-3),
        Row("13T time of the peak, s", float(motion.times[history.argmax()]), 0.210),
        Row("13T at rest, m", float(rest), 1.817e-3),
    ]


TESTS: dict[str, Callable[[int], list[Row]]] = {
    "LE1": le1,
    "LE5": le5,
    "LE6": le6,
    "LE10": le10,
    "FV12": fv12,
    "FV15": fv15,
    "FV16": fv16,
    "FV52": fv52,
    "13": forced_13,
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=tuple(TESTS), default=tuple(TESTS))
    parser.add_argument("--refined", action="store_true")
    given = parser.parse_args()
    print("| test | computed | target | difference |\n|---|---|---|---|")
    for name in given.only:
        for row in TESTS[name](2 if given.refined else 1):
            print(f"| {row.name} | {row.value:.4g} | {row.target:.4g} | {100 * row.error:+.1f} % |")


if __name__ == "__main__":
    main()

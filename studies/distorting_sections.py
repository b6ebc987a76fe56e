"""Beams whose sections distort, against shells: vibrations, buckling, eccentric load, bent tube.

* A cantilever of 1 m with the section of a lipped channel, 200 by 60 by 20 mm, 2 mm thick:
  frequencies. Its first distortional mode has 104 Hz in an endless beam.
* The same with 3 mm, both ends held in plates of which one moves along the axis, under a
  compressive force: linear buckling, in half waves of the web.
* A box girder, 400 by 200 by 8 mm and 4 m long, both ends clamped, with a force at a corner of its
  middle: deflection of this corner and of the opposite one. Half of the load is a torque, half of
  which distorts the section.
* A tube of radius 1 m, 20 mm thick, in pure bending: moment at which it collapses, over that of
  L. G. Brazier (Proc. R. Soc. A 116 (1927) 104), ``(2 sqrt 2/9) pi E R t^2/sqrt(1 - nu^2)``.
* A round bar bent to a half circle: distance of its tip from that of the circle over its length.
  The element has no correction for large rotations within a cell.

Plain beams of the same sections are in the table, too.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

import fem_lie as fl
from demos.command_line import run

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
LIPPED = np.array([(0.06, -0.08), (0.06, -0.1), (0, -0.1), (0, 0.1), (0.06, 0.1), (0.06, 0.08)])
BOX = np.array([(-0.2, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.2, 0.1), (-0.2, -0.1)])
UP = (0.0, 0.0, 1.0)


def lipped_channel(thickness: float) -> fl.sections.SectionShape:
    """Shape with walls about the mid-lines of the lipped channel."""
    t = 0.5 * thickness
    half = [(0.06 + t, 0.1 + t), (0.06 + t, 0.08), (0.06 - t, 0.08), (0.06 - t, 0.1 - t)]
    upper = [(-t, 0.1 + t), *half, (t, 0.1 - t)]
    return fl.sections.SectionShape.polygon([*upper, *((y, -z) for y, z in reversed(upper))])


def shell(line: np.ndarray, thickness: float, length: float, along: int, size: float) -> fl.Shell:
    """Shell along the mid-lines of a section, with curves "root" and "end"."""
    pieces = []
    for a, b in pairwise(line):
        parts = np.linspace(0, 1, round(np.linalg.norm(b - a) / size), endpoint=False)
        pieces.append(a + parts[:, np.newaxis] * (b - a))
    around = np.concatenate(pieces)
    closed = bool(np.allclose(line[0], line[-1]))
    around = around if closed else np.vstack([around, line[-1:]])
    m = len(around)
    x = np.linspace(0, length, along + 1)
    points = np.column_stack([np.repeat(x, m), np.tile(around, (along + 1, 1))])
    edges = [(j, (j + 1) % m) for j in range(m if closed else m - 1)]
    cells = [
        (i * m + a, i * m + b, (i + 1) * m + a, (i + 1) * m + b)
        for i in range(along)
        for a, b in edges
    ]
    curves = {"root": edges, "end": [(along * m + a, along * m + b) for a, b in edges]}
    mesh = fl.mesh.SurfaceMesh.from_cells(points, cells, "quadrilateral", curves=curves)
    return fl.Shell(mesh, fl.ShellSection.layer(thickness, STEEL), name="shell")


def beam(section: fl.sections.Distortion | fl.Section, length: float, cells: int) -> Any:
    """Beam of either kind; sections that distort are held at the start as by a clamp."""
    ends = (0, 0, 0), (length, 0, 0)
    if isinstance(section, fl.Section):
        return fl.Beam.straight(*ends, section, cells=cells, up=UP, name="beam")
    found = fl.reduction.DistortingBeam.straight(*ends, section, cells=cells, up=UP, name="beam")
    found.hold_shape(found.point("start"))
    found.hold_warping(found.point("start"))
    return found


def clamped(body: Any) -> fl.Scene:
    """Scene of a body that is clamped at its start."""
    scene = fl.Scene()
    scene.add(body)
    if isinstance(body, fl.Shell):
        body.clamp("root")
    else:
        scene.add(fl.Clamp(body.point("start")))
    return scene


def frequencies(body: Any, count: int = 6) -> list[float]:
    return [float(f) for f in fl.vibrations(clamped(body), count).frequencies]


def buckling(body: Any, centroid: np.ndarray, length: float) -> float:
    """Smallest compressive force at which the body buckles between plates, N."""
    scene = clamped(body)
    if isinstance(body, fl.Shell):
        plate = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(length, *centroid), name="plate")
        end = scene.add(plate).point("centre")
        for point in body.points("end"):
            scene.add(fl.joints.RigidLink(end, point))
    else:
        end = body.point("end")
        if isinstance(body, fl.reduction.DistortingBeam):
            body.hold_shape(end)
            body.hold_warping(end)
    scene.add(fl.joints.Prismatic(fl.ground(), end, axis=(1, 0, 0)))
    scene.add(fl.PointLoad(end, force=(-1.0, 0, 0)))
    return float(fl.buckling(scene, 1).factors[0])


def corners(section: fl.sections.Distortion | None, cells: int) -> list[float]:
    """Deflections of the loaded corner of the box, and of the opposite one, by 1 kN, mm."""
    length, force = 4.0, (0.0, 0.0, -1e3)
    if section is None:
        body = shell(BOX, 0.008, length, cells, 0.025)
        scene = clamped(body)
        body.clamp("end")
        loaded, other = (body.point((length / 2, y, 0.1)) for y in (0.2, -0.2))
    else:
        body = beam(section, length, cells)
        scene = clamped(body)
        scene.add(fl.Clamp(body.point("end")))
        body.hold_shape(body.point("end"))
        body.hold_warping(body.point("end"))
        loaded, other = (body.section_point(cells // 2, y, 0.1) for y in (0.2, -0.2))
    scene.add(fl.PointLoad(loaded, force=force))
    result = fl.statics(scene)
    return [float(-1e3 * result.displacement(p)[-1, 2]) for p in (loaded, other)]


def plain_corners(section: fl.Section, cells: int) -> list[float]:
    """The same of a plain beam, whose section moves rigidly, mm."""
    body = beam(section, 4.0, cells)
    scene = clamped(body)
    scene.add(fl.Clamp(body.point("end")))
    middle = body.point(cells // 2)
    scene.add(fl.PointLoad(middle, force=(0, 0, -1e3), moment=(-200.0, 0, 0)))
    frame = fl.statics(scene).frames[-1, middle.node]
    return [float(-1e3 * (frame[0] + y * frame[2])[2]) for y in (0.2, -0.2)]


def collapse(cells: int) -> float:
    """Moment at which the tube collapses over that of Brazier."""
    tube = fl.sections.Distortion(fl.sections.SectionShape.tube(0.99, 1.01).mesh, STEEL, modes=2)
    body = fl.reduction.DistortingBeam.straight((0, 0, 0), (20, 0, 0), tube, cells=cells)
    moment = 2 * np.sqrt(2) / 9 * np.pi * STEEL.E * 0.02**2 / np.sqrt(1 - STEEL.nu**2)
    scene = clamped(body)
    scene.add(fl.PointLoad(body.point("end"), moment=(0, moment, 0)))
    path = fl.follow_path(scene, fl.stability.PathEnds(critical_points=1))
    return path.critical[0].factor


def half_circle(cells: int) -> float:
    """Error of the tip of a bar bent to a half circle over its length."""
    shape = fl.sections.SectionShape.circle(0.01)
    bar = fl.sections.Distortion(shape.mesh, STEEL, modes=1)
    body = fl.reduction.DistortingBeam.straight((0, 0, 0), (1, 0, 0), bar, cells=cells, up=UP)
    scene = clamped(body)
    moment = np.pi * bar.section.stiffness[4, 4]
    scene.add(fl.PointLoad(body.point("end"), moment=(0, -moment, 0)))
    tip = fl.statics(scene, load_steps=4).position(body.point("end"))[-1]
    return float(np.linalg.norm(tip - [0, 0, 2 / np.pi]))


def main(cells: int = 32, size: float = 0.01, pictures: bool = True) -> dict[str, Any]:
    """``cells`` of beams; ``size`` of cells of shells across the section."""
    record: dict[str, Any] = {}
    thin, thick = lipped_channel(0.002), lipped_channel(0.003)
    centroid = thick.warping(STEEL).properties.centroid
    record["frequencies"] = {"shells": frequencies(shell(LIPPED, 0.002, 1.0, 100, size))}
    record["buckling"] = {"shells": buckling(shell(LIPPED, 0.003, 1.0, 100, size), centroid, 1.0)}
    record["corners"] = {"shells": corners(None, 160)}
    for modes in (2, 3, 4):
        section = fl.sections.Distortion(thin.mesh, STEEL, modes=modes)
        record["frequencies"][f"{modes} modes"] = frequencies(beam(section, 1.0, cells))
        section = fl.sections.Distortion(thick.mesh, STEEL, modes=modes)
        record["buckling"][f"{modes} modes"] = buckling(beam(section, 1.0, cells), centroid, 1.0)
    record["frequencies"]["plain beam"] = frequencies(beam(thin.section(STEEL), 1.0, cells))
    record["buckling"]["plain beam"] = buckling(
        beam(thick.section(STEEL), 1.0, cells), centroid, 1.0
    )
    box = fl.sections.SectionShape.box(0.408, 0.208, 0.008)
    for modes in (1, 2, 3):
        section = fl.sections.Distortion(box.mesh, STEEL, modes=modes)
        record["corners"][f"{modes} modes"] = corners(section, 2 * cells)
    record["corners"]["plain beam"] = plain_corners(box.section(STEEL), 2 * cells)
    record["collapse"] = collapse(max(cells // 4, 4))
    record["half circle"] = half_circle(cells)
    record["half circle, twice the cells"] = half_circle(2 * cells)
    for name, rows in record.items():
        if not isinstance(rows, dict):
            print(f"{name}: {rows:.4f}")
            continue
        for of, values in rows.items():
            print(f"{name}, {of}: {np.array2string(np.array(values), precision=4)}")
    return record


if __name__ == "__main__":
    run(main)

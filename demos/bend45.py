"""A cantilever bent to an eighth of a circle is lifted by a force at its tip: the 45 degree bend.

K. J. Bathe & S. Bolourchi, IJNME 14 (1979) 961. Arc of radius 100 in the xy plane, clamped at the
origin where it runs along x, square section 1 x 1, E = 1e7 and no Poisson's ratio: EA = 1e7,
GA = 5e6, EI = GJ = 1e7/12. A force of 600 along z, fixed in space, bends and twists it by more than
half its length. The mesh, its clamp and its tip are named groups of meshes/bend45.geo, which gmsh
meshes here.

The reference is the solution of the differential equations of the same rod, by shooting, to nine
digits. (The often quoted 53.37 … 53.50 for the height of the tip are finite element solutions of
coarse meshes, some with other shear stiffnesses.)

Seven elements can be chosen, by --formulation:

- geodesic lies on the geodesic of SE(3) between its two frames: constant strain, no locking, of
  second order. In equilibrium the stress varies within an element, though, as a constant force in
  space has another moment arm and other components at each point. The energy of that variation is
  added to the element's flexibility (in a straight element 1/GA* = 1/GA + length^2 / (12 EI), R. H.
  MacNeal, Comput. Struct. 8 (1978) 175), which makes arcs exact for small deflections. For this
  section, as stiff in all directions, little is left at large ones, too.
- director1 has the strains of R3 x SO(3) in its middle, with the same curvature, and the
  flexibility of a straight element; its axis is a straight chord, and the error of that remains.
- director2 interpolates positions and directors by three nodes, with two points: of fourth order at
  the nodes, with twice the unknowns.

- rod has no shear: a cubic between two frames, of fourth order in bending, of second in torsion
  that varies along an element. Without shear the tip is 5e-5 from the reference.
- spline is such a rod along the cubic spline through the nodes, once continuously differentiable,
  with tangents and twist at its knots.
- discrete has positions, and edges that bend and twist against each other, of second order.
- ancf has positions and all three slopes, without rotations, and sections that deform. Bent, they
  become thinner: its limit differs by 1.7e-4, of the order of (thickness/radius)^2.

studies/elements_on_a_bend.py has a table of all of them, and of the geodesic element without the
flexibility ("plain").

Every cut carries the force at the tip, and its moment about the cut: so the clamp twists and bends
the root by T = 600 y and My = -600 x of the bent tip. Section forces are drawn over arc length.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from command_line import in_results, one_of, run
from records import components

import fem_lie as fl

HERE = Path(__file__).parent
REFERENCE = np.array([47.15043857, 15.68480053, 53.47485879])
FORCE = 600.0
UNITS = fl.post.Units(length="length", force="force")
Choice: TypeAlias = fl.elements.BeamFormulation | fl.elements.AncfElement | None
FORMULATIONS: dict[str, Choice] = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director1": fl.elements.DirectorBeam(1),
    "director2": fl.elements.DirectorBeam(2),
    "rod": fl.elements.KirchhoffRod(),
    "spline": None,
    "discrete": fl.elements.DiscreteRod(),
    "plain": fl.elements.GeodesicBeam(bending_flexibility=False),
    "ancf": fl.elements.AncfElement(),
}


def solve(
    elements: int, load_steps: int, formulation: Choice
) -> tuple[dict[str, Any], fl.StaticResult, fl.post.SectionForces | None]:
    """Load it; a record of numbers, the equilibrium states and the section forces of the last.

    Of sections that deform, and of edges, there are none.
    """
    mesh = fl.mesh.read_gmsh_lines(
        fl.mesh.run_gmsh_script(HERE.parent / "meshes" / "bend45.geo", {"cells": elements})
    )
    EA, GA, EI = 1e7, 5e6, 1e7 / 12
    square = 0.5 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])  # for the picture only
    section = fl.Section.from_stiffness([EA, GA, GA, EI, EI, EI], outline=square)
    scene = fl.Scene()
    beam: fl.AncfBeam | fl.Beam
    if isinstance(formulation, fl.elements.AncfElement):
        beam = scene.add(fl.AncfBeam(mesh, section, formulation=formulation, name="bend"))
        beam.clamp(beam.point("clamp"))
    elif formulation is None:
        points = mesh.points[np.argsort(np.linalg.norm(mesh.points, axis=1))]  # from the clamp on
        ends = {"clamp": np.array([0]), "tip": np.array([elements])}
        line = replace(fl.mesh.Spline.through(points).mesh(), named_points=ends)
        beam = scene.add(fl.Rod(line, section, name="bend"))
        scene.add(fl.Clamp(beam.point("clamp")))
    else:
        make = fl.Beam if formulation.bends else fl.Rod
        beam = scene.add(make(mesh, section, formulation=formulation, name="bend"))
        scene.add(fl.Clamp(beam.point("clamp")))
    scene.add(fl.PointLoad(beam.point("tip"), force=(0, 0, FORCE)))
    result = fl.statics(scene, load_steps=load_steps)
    tip = result.position(beam.point("tip"))[-1]
    record: dict[str, Any] = {
        "elements": elements,
        "load_steps": load_steps,
        **components("tip", tip),
        "tip_error": float(np.linalg.norm(tip - REFERENCE) / np.linalg.norm(REFERENCE)),
        "steps": len(result.factors),
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
    }
    if isinstance(beam, fl.AncfBeam) or not beam.model.formulation.bends:
        return record, result, None
    forces = fl.post.section_forces(result, beam, scene, states=[-1])
    for key, name in (("root_torque", "T"), ("root_moment", "My")):
        record[key] = float(forces.at(beam.point("clamp"), name)[-1])
    record["force_error"] = float(np.abs(forces.cut_forces - (0, 0, FORCE)).max() / FORCE)
    return record, result, forces


def main(
    elements: int = 8, load_steps: int = 3, formulation: str = "geodesic", pictures: bool = True
) -> dict[str, Any]:
    one_of("formulation", formulation, FORMULATIONS)
    record, result, forces = solve(elements, load_steps, FORMULATIONS[formulation])
    if pictures:
        file = in_results("bend45.png")
        result.picture(file, trace=["bend.tip"], title="45° bend", units=UNITS)
        if forces is not None:
            forces.plot(path=in_results("bend45_forces.png"), units=UNITS)
    return record


if __name__ == "__main__":
    run(main, show=True)

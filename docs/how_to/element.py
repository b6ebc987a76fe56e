"""A beam element of one's own: two nodes, interpolated directors, one point.

An element of beams is a ``BeamFormulation``: it gets frames as UFL expressions, and returns the
forms of an energy. Strains per length are differences to those of the unloaded frames; the energy
is ½ ε·Cε. Local frames, joints, loads, time schemes and results work with it as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl

import fem_lie as fl
from fem_lie.extend import CellData, LocalFrameForms, StrainEnergy, cellwise, present_values


@dataclass(frozen=True)
class PlainDirectors(fl.elements.BeamFormulation):
    """Simo's strains in the middle of two nodes, as they are."""

    degree: int = 1

    def forms(self, nodal: fl.NodalFrames, cells: CellData) -> LocalFrameForms:
        """Energy, forces and tangent."""
        mesh = nodal.function.function_space.mesh
        arc = cellwise(mesh, cells.lengths) / ufl.CellVolume(mesh)
        stretch, curvature = fl.elements.director_strains(nodal)
        strain = ufl.as_vector([*stretch, *curvature]) / arc
        stiffness = cellwise(mesh, cells.stiffness)
        energy = StrainEnergy(
            strain=strain - present_values(strain, mesh, 1) - cells.eigenstrain,
            law=lambda strain: 0.5 * ufl.inner(strain, stiffness * strain),
            dx=ufl.dx(mesh, degree=1),
            weight=arc,
        )
        return fl.local_frame_forms(energy, nodal)


def tip(cells: int) -> np.ndarray:
    """Of a cantilever that a moment bends by a quarter of a circle."""
    section = fl.Section.rectangle(0.1, 0.1, fl.Material(E=1e7, nu=0.0, density=1.0))
    beam = fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), section, cells=cells, formulation=PlainDirectors()
    )
    moment = np.pi / 2 * section.stiffness[5, 5]
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, moment)))
    return fl.statics(scene, load_steps=3).position(beam.point("end"))[-1]


exact = 2 / np.pi * np.array([1, 1, 0])
errors = [np.linalg.norm(tip(cells) - exact) for cells in (8, 16)]
order = np.log2(errors[0] / errors[1])
print(f"errors {errors[0]:.1e}, {errors[1]:.1e}: order {order:.2f}")

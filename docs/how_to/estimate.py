"""An error estimate of one's own: jumps of the bending moment between elements of a beam.

An element of one Gauss point has a constant moment ``M_h``. Where the true one is linear over an
element of length ℓ, ``M − M_h = M′ s``, and the energy of what is missing is ``M′²ℓ³/(12 EI)``.
The jump at a node between equal elements is ``J = ℓ M′``, hence ``η² = ℓ J²/(12 EI)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import fem_lie as fl
from fem_lie.extend import ElementErrors


@dataclass(frozen=True)
class MomentJumps(fl.adaptivity.ErrorEstimate):
    """Errors of beams whose elements follow one another along one line."""

    def estimators(self):
        """A function for each class of bodies: result, body, scene, states to errors of each."""
        return {fl.Beam: moment_jumps}


def moment_jumps(
    result: fl.StaticResult, beam: fl.Beam, scene: fl.Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Squares of errors and the energy norm of the stress, in each of these states."""
    found = fl.post.section_forces(result, beam, scene, states=steps)
    compliance = np.linalg.inv(beam.model.stiffness)
    errors = []
    for state in range(len(steps)):
        stress = found.at_points(state).mean(axis=1)
        inner = np.diff(stress[:, 3:], axis=0)
        both = np.concatenate([inner[:1], inner, inner[-1:]])
        jump = 0.5 * (both[:-1] + both[1:])
        squares = (
            np.einsum("mi,mij,mj->m", jump, compliance[:, 3:, 3:], jump) * beam.model.lengths / 12
        )
        energy = np.einsum("mi,mij,mj,m->", stress, compliance, stress, beam.model.lengths)
        errors.append(ElementErrors(squares, float(energy)))
    return errors


LENGTH, WIDTH, FORCE = 1.0, 0.02, 1.0
STEEL = fl.Material(2e11, 0.3, 7800.0)


def cantilever(lines: fl.mesh.LineMesh) -> fl.Scene:
    """A beam on any mesh, clamped at one end, with a small force on the other one."""
    scene = fl.Scene()
    section = fl.Section.rectangle(WIDTH, WIDTH, STEEL)
    element = fl.elements.GeodesicBeam(bending_flexibility=False)
    beam = scene.add(fl.Beam(lines, section, formulation=element))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0.0, 0.0, FORCE)))
    return scene


lines = fl.mesh.straight_line((0, 0, 0), (LENGTH, 0, 0), 8)
scene = cantilever(lines)
(beam,) = scene.bodies
error = fl.adaptivity.space_error(fl.statics(scene), beam, scene, estimate=MomentJumps())
bending = STEEL.E * WIDTH**4 / 12
exact = FORCE * LENGTH / 8 * np.sqrt(LENGTH / (12 * bending))
effectivity = error.effectivity(exact)
adapted = fl.adaptivity.adapt(cantilever, lines, tolerance=0.01, estimate=MomentJumps())
print(f"effectivity {effectivity:.6f}, {len(adapted.mesh.cells)} elements for 1 %")

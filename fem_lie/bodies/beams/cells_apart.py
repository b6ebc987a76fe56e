"""Some elements of a body along lines, each on nodes of its own, with weights."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.assembly import BeamAssembly, BeamData, Damping
from fem_lie.elements.beams.element import Formulation

if TYPE_CHECKING:
    import dolfinx


@dataclass(eq=False)
class ElementsApart:
    """See :class:`~fem_lie.bodies.beams.assembly.BeamData`."""

    frames: Array
    elements: Indices
    lengths: Array
    slopes: Array
    stiffness: Array
    density: Array
    formulation: Formulation
    damping: Damping = field(default_factory=Damping)
    has_mass: bool = False
    source: dolfinx.mesh.Mesh | None = None


def elements_apart(body: BeamData, elements: Indices, weights: Array) -> BeamAssembly:
    """Some elements, their energy times weights (s,); see :meth:`~.body.Body.cells_apart`."""
    nodes = body.elements[elements]
    apart = ElementsApart(
        frames=body.frames[nodes.ravel()],
        elements=np.arange(nodes.size).reshape(nodes.shape),
        lengths=body.lengths[elements],
        slopes=body.slopes[elements],
        stiffness=weights[:, np.newaxis, np.newaxis] * body.stiffness[elements],
        density=body.density[elements],
        formulation=body.formulation,
    )
    return BeamAssembly([apart])

"""Discrete cable: positions only, axial stiffness of edges, bending by springs between them.

With ``ε = |b − a|/ℓ − 1`` of an edge of unstretched length ``ℓ``::

    W = Σ ½ EA ε² ℓ + Σ ½ EI/ℓ (|κb| − κ₀)²

where the second sum is over successive edges (:mod:`fem_lie.elements.rods.bends`). Three unknowns
per node, and no direction across: for ropes and nets. Of second order. (Bergou et al., *ACM Trans.
Graph.* 27 (2008) 63, without twist.) Tension-only edges are as in
:mod:`fem_lie.elements.rods.cable`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl

from fem_lie._arrays import Array, positive
from fem_lie.elements.beams.element import BeamFormulation, CellData, cellwise
from fem_lie.elements.rods.cable import pull_back_vectors, push_forward_vectors
from fem_lie.elements.rods.cable_law import (
    check_section,
    stress_over_stiffness,
    stretch_energy,
)
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels.addresses import FrameMap
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.node_types import NodeType

# the axes of position nodes are unit vectors without forces or increments
_POSITIONS = FrameMap(None, pull_back_vectors, push_forward_vectors, None, values=12, unknowns=6)


@dataclass(frozen=True)
class DiscreteCable(BeamFormulation):
    """Edges between positions, with rotational springs between them.

    Attributes:
        natural: Whether the initial curvature is the natural one, in any direction; default:
            naturally straight.
        degree: One: there are no nodes inside.
        slack: As of :class:`~fem_lie.elements.HermiteCable`.

    Raises:
        ValueError: ``slack`` is not positive.
    """

    node_type = NodeType.POSITION
    viscous = False
    degree: int = 1
    natural: bool = False
    slack: float | None = None

    def __post_init__(self) -> None:
        """Raise ``ValueError`` if ``slack`` is not positive, ``TypeError`` if no number."""
        if self.slack is not None:
            positive(self.slack, "DiscreteCable: slack")

    @property
    def tension_only(self) -> bool:
        """Whether it is tension-only: with ``slack``."""
        return self.slack is not None

    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` for coupled axial strain and bending, or unequal bending stiffness.

        Args:
            stiffness: Section stiffness, shape (6, 6).
        """
        check_section(stiffness)

    def axial_strain(self, unloaded: Array, ends: Array, lengths: Array, along: Array) -> Array:
        """Axial force over ``EA``, constant in an edge, shape (m, p).

        Args:
            unloaded: Unloaded coordinates of both ends of the edges, shape (m, 2, 4, 3).
            ends: Coordinates of the ends, shape (m, 2, 4, 3).
            lengths: Unstretched lengths, shape (m,).
            along: Parameters in an edge from 0 to 1, shape (p,).
        """
        chords = np.linalg.norm(ends[:, 1, 0] - ends[:, 0, 0], axis=1)
        strain = stress_over_stiffness(chords / lengths - 1.0, self.slack)
        return np.repeat(strain[:, np.newaxis], len(along), axis=1)

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent of the axial strain of edges."""
        mesh = nodal.function.function_space.mesh
        length = cellwise(mesh, cells.lengths)
        EA = cellwise(mesh, cells.stiffness[:, 0, 0])
        chord = ufl.dot(ufl.grad(nodal.position), ufl.Jacobian(mesh)[:, 0])
        energy = StrainEnergy(
            strain=ufl.as_vector([ufl.sqrt(ufl.dot(chord, chord)) / length - 1]),
            law=lambda ε: EA * stretch_energy(ε[0], self.slack),
            dx=ufl.Measure("dx", mesh, metadata={"quadrature_degree": 0}),
            weight=length / ufl.CellVolume(mesh),
        )
        return LocalFrameForms(energy, nodal.function, nodal.increment, _POSITIONS)

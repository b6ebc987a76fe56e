"""Discrete rod: positions, and the rotation of each edge about itself.

With ``ε = |b − a|/ℓ − 1`` of an edge of unstretched length ``ℓ``::

    W = Σ ½ EA ε² ℓ + Σ ½ (z − z₀)·B (z − z₀)

where the second sum is over successive edges, for bending and torsion between them
(:mod:`fem_lie.elements.rods.corners`), and over both ends, where the first and the last edge meet
the frames of the end nodes. Nodes inside have four unknowns: position, and rotation of the edge
that follows. End nodes have frames, which clamps, drives and joints act on. Of second order.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import ufl

from fem_lie._arrays import Array, Indices, vector
from fem_lie._jit import compiled
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.elements.beams.element import BeamFormulation, CellData, cellwise
from fem_lie.elements.rods.corners import Corners
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.frames import NodalFrames, local_frame_forms
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.directors import rotate_onto
from fem_lie.lie.tuples import load_row, minus


@compiled
def edge_axes(coordinates: Array, a: Indices, b: Indices) -> Array:
    """Axes of edges between nodes, or of nodes themselves, as rows, shape (k, 3, 3).

    Args:
        coordinates: Nodal coordinates, shape (n, 4, 3).
        a: First nodes, whose axes are rotated onto the edges by the smallest rotation, shape (k,).
        b: Second nodes; equal to the first for the axes of the node, shape (k,).
    """
    out = np.empty((a.shape[0], 3, 3))
    for k in range(a.shape[0]):
        own, way = coordinates[a[k]].copy(), load_row(coordinates[a[k]], 1)
        if a[k] != b[k]:
            way = minus(load_row(coordinates[b[k]], 0), load_row(own, 0))
        rotate_onto(own, way)
        out[k] = own[1:]
    return out


_CENTRED = 1e-9  # relative, as sections that are meant to be held at their centre


@dataclass(frozen=True)
class DiscreteRod(BeamFormulation):
    """Edges between positions, with springs in bending and torsion between them.

    Attributes:
        natural: Unloaded ``(τ, κ₂, κ₃)``, 1/length; default: the initial ones.

    Raises:
        ValueError: ``natural`` is not three finite numbers.
    """

    degree: ClassVar[int] = 1  # type: ignore[misc]
    viscous: ClassVar[bool] = False
    bends: ClassVar[bool] = False
    natural: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        """Raise ``ValueError`` if the natural curvature is not three finite numbers."""
        if self.natural is not None:
            vector(self.natural, 3, "DiscreteRod: natural curvature")

    def attachment_frame(self, nodes: Sequence[int], ξ: float) -> AttachmentFrame:
        """Refuse points within edges, whose frame depends on both ends.

        Raises:
            ValueError: Always.
        """
        raise ValueError(f"{self} is held at its nodes, and not between them")

    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` if the section couples axial strain with bending or torsion.

        Args:
            stiffness: Section stiffness, shape (6, 6).
        """
        own = np.sqrt(stiffness[0, 0] * np.diag(stiffness)[3:])
        if (np.abs(stiffness[0, 3:]) > _CENTRED * own).any():
            raise ValueError(
                "a discrete rod is stretched along its centre: its section must not couple stretch "
                f"with bending or torsion, got the stiffness\n{stiffness}"
            )

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent of the axial strain of edges."""
        mesh = nodal.function.function_space.mesh
        length, EA = cellwise(mesh, cells.lengths), cellwise(mesh, cells.stiffness[:, 0, 0])
        chord = ufl.dot(ufl.grad(nodal.position), ufl.Jacobian(mesh)[:, 0])
        size = ufl.sqrt(ufl.dot(chord, chord))
        ends = nodal.frames[nodal.function.function_space.dofmap.list, 0]
        laid = cellwise(mesh, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))
        energy = StrainEnergy(
            strain=ufl.as_vector([(size - laid) / length - cells.eigenstrain[0]]),
            law=lambda ε: 0.5 * EA * ε[0] ** 2,
            dx=ufl.Measure("dx", mesh, metadata={"quadrature_degree": 0}),
            weight=length / ufl.CellVolume(mesh),
        )
        return local_frame_forms(energy, nodal)

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Half the mass of an edge at both ends; rotary inertia about the edge at its first node.

        Half of that of the last edge is at the frame of the last node.
        """
        nodes = nodal.function.function_space.dofmap.list
        weighted = cells.lengths[:, np.newaxis, np.newaxis] * cells.density
        G = np.zeros((len(nodes), 2, 4, 2, 4))
        for k in range(2):
            G[:, k, 0, k, 0] = 0.5 * weighted[:, 0, 0]
        share = np.where(np.isin(nodes[:, 1], nodes[:, 0]), 0.0, 0.5)[:, np.newaxis, np.newaxis]
        G[:, 0, 1:, 0, 1:] = (1.0 - share) * weighted[:, 1:, 1:]
        G[:, 1, 1:, 1, 1:] = share * weighted[:, 1:, 1:]
        return G


def corners(
    elements: Indices,
    lengths: Array,
    stiffness: Array,
    laid: Array,
    natural: Sequence[float] | None,
) -> Corners:
    """Springs between successive edges from one end to the other.

    The frame of the first node is that of its edge, too, so that twist of the first half of that
    edge belongs to the next spring.

    Args:
        elements: Ends of the edges, shape (m, 2).
        lengths: Unstretched lengths, shape (m,).
        stiffness: Section stiffness, shape (m, 6, 6).
        laid: Initial nodal coordinates, shape (n, 4, 3).
        natural: ``(τ, κ₂, κ₃)``, or ``None`` for the initial ones.
    """
    a, b = elements.T
    m = len(elements)
    nodes = np.stack(
        [np.concatenate([a[:1], a]), np.concatenate([a[:1], b]), np.concatenate([b, b[-1:]])],
        axis=1,
    )
    half = 0.5 * lengths
    before, after = np.concatenate([[0.0], half]), np.concatenate([half, [0.0]])
    first, last = np.arange(m + 1) == 0, np.arange(m + 1) == m
    bend = before + after
    twist = bend.copy()
    twist[1] += half[0]
    compliance = np.linalg.inv(stiffness[:, 3:, 3:])
    parts = before / bend, after / bend
    mean = np.zeros((m + 1, 3, 3))
    mean[1:] += parts[0][1:, np.newaxis, np.newaxis] * compliance
    mean[:-1] += parts[1][:-1, np.newaxis, np.newaxis] * compliance
    root = 1.0 / np.sqrt(np.stack([twist, bend, bend], axis=1))
    B = np.linalg.inv(mean) * root[:, :, np.newaxis] * root[:, np.newaxis]
    if natural is None:
        z = _laid(laid, nodes)
    else:
        size = np.hypot(natural[1], natural[2])
        angle = size * bend
        factor = np.where(angle > 0, 2 * np.tan(0.5 * angle) / np.where(angle > 0, size, 1.0), bend)
        z = np.stack([natural[0] * twist, natural[1] * factor, natural[2] * factor], axis=1)
    z[0, 0] = 0.0  # of its own frame it has no twist
    return Corners(nodes, np.stack([first, last], axis=1), B, z)


def _laid(coordinates: Array, nodes: Indices) -> Array:
    """Initial ``z`` of the springs, shape (b, 3)."""
    e, f = edge_axes(coordinates, *nodes[:, :2].T), edge_axes(coordinates, *nodes[:, 1:].T)
    Q = np.einsum("bia,bja->bij", e, f)
    X = 1 + Q[:, 0, 0]
    twist = np.arctan2(Q[:, 2, 1] - Q[:, 1, 2], Q[:, 1, 1] + Q[:, 2, 2])
    bends = (Q[:, 0, 2] - Q[:, 2, 0]) / X, (Q[:, 1, 0] - Q[:, 0, 1]) / X
    return np.stack([twist, *bends], axis=1)

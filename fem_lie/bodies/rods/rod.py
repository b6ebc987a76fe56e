"""Rods: bodies along lines with nodal frames, without shear."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any, ClassVar

import dolfinx
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.assembly import BeamAssembly
from fem_lie.bodies.beams.beam import Beam, BeamModel
from fem_lie.bodies.beams.sectioned import Sections
from fem_lie.bodies.model import NO_HOLDS, AxesUpdate, Holds
from fem_lie.elements.beams.centres import torsion_about_centres
from fem_lie.elements.beams.element import POINTS, WEIGHTS, BeamFormulation
from fem_lie.elements.rods.corners import Corners, CornerSprings
from fem_lie.elements.rods.discrete_rod import DiscreteRod, corners, edge_axes
from fem_lie.elements.rods.kirchhoff import KirchhoffRod, speeds_of_cubics
from fem_lie.forms.assembly import Assembly
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Twisted, Up

_log = logging.getLogger(__name__)
_STIFFER = 0.01  # in torsion, which is worth a warning
_UNEVEN = 1.8  # at 2 the speed of the cubic at the middle is zero


def _log_stiff_torsion(label: str, stiffness: Array) -> None:
    """Log how much stiffer a section is in torsion about its tension centre than it should be."""
    ratio = float(torsion_about_centres(stiffness).max(initial=1.0))
    if ratio > 1.0 + _STIFFER:
        _log.warning(
            "%s: the shear centre of its section is not its tension centre, about which a Rod "
            "twists: it is %.3g times as stiff in torsion as the section; take a Beam",
            label,
            ratio,
        )


class RodModel(BeamModel):
    """Model of a rod.

    Attributes:
        corner_springs: Rotational springs between its edges; ``None`` if elements have bending
            stiffness.
    """

    corner_springs: Corners | None = None

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly:
        """Assembly of all rods of one kind, with the springs between their edges."""
        assembly = BeamAssembly(models)
        starts = np.cumsum([0, *(len(model.frames) for model in models)])
        found = [
            model.corner_springs._replace(nodes=assembly.order[model.corner_springs.nodes + start])
            for model, start in zip(models, starts, strict=False)
            if model.corner_springs is not None
        ]
        if found:
            joined = Corners(*(np.concatenate(column) for column in zip(*found, strict=True)))
            assembly.further_terms.append(CornerSprings(joined, assembly.count))
        return assembly

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each element; ``None`` for edges, whose springs couple two of them."""
        return super().divisible_cells if self.corner_springs is None else None

    @property
    def separates_rotation(self) -> bool:
        """Whether statics moves its end frames by ``x + R u``: if it consists of edges."""
        return self.corner_springs is not None

    @property
    def edge_frames(self) -> Indices:
        """Nodes with a frame on an edge, and the other nodes: all edges but the first."""
        return super().edge_frames if self.corner_springs is None else self.elements[1:]

    def axes_update(self) -> AxesUpdate | None:
        """Function that rotates the frames of edges with them by the smallest rotation."""
        if self.corner_springs is None:
            return None
        inside, after = self.edge_frames.T

        def rotate_axes(coordinates: Array) -> None:
            coordinates[inside, 1:] = edge_axes(coordinates, inside, after)

        return rotate_axes

    def add_rigid_motion(self, translation: Array, spin: Array, about: Array) -> None:
        """Add a rigid motion; nodes between the ends rotate about their edges only.

        Args:
            translation: Velocity of translation, global components, shape (3,).
            spin: Angular velocity, global components, shape (3,), rad per time.
            about: Position at rest, shape (3,).
        """
        super().add_rigid_motion(translation, spin, about)
        if self.corner_springs is not None:
            self.velocities[self.elements[1:, 0], 4:] = 0.0

    def follow_cubics(self, slopes: Array | None) -> None:
        """Use the slopes of a spline, if given, instead of cubics with tangents only."""
        if slopes is None:
            return
        ends = self.frames[self.elements]
        mean, middle = slopes.mean(axis=1), speeds_of_cubics(ends, slopes, np.array([0.5]))[:, 0]
        if not (mean < _UNEVEN * middle).all():
            k = int((mean / np.maximum(middle, 1e-300)).argmax())
            raise ValueError(
                f"{self.label}: cell {k} of the spline is {mean[k] / middle[k]:.3g} times as fast "
                f"at its ends as in the middle, expected less than {_UNEVEN}: insert more knots"
            )
        self.slopes = slopes
        self.lengths = speeds_of_cubics(ends, slopes, POINTS) @ WEIGHTS

    def made_of_edges(self, formulation: DiscreteRod) -> Corners:
        """Hold unknowns that nodes of a discrete rod do not have, and return its springs."""
        m = len(self.elements)
        order = self.chains.order
        one = len(self.chains.first) == 1 and len(self.frames) == m + 1
        if not one or m < 2 or (self.masters != np.arange(m + 1)).any():
            raise ValueError(
                f"{self.label}: a DiscreteRod goes along one smooth line of two elements or more "
                f"with two ends, got {len(self.chains.first)} pieces, {m} elements and "
                f"{len(self.frames)} nodes: make one rod of each piece, and join them"
            )
        if (order != np.arange(m)).any():
            raise ValueError(
                f"{self.label}: the elements of a DiscreteRod follow each other along the line, "
                f"got their order {order}"
            )
        if self.damping.factors().any():
            raise ValueError(
                f"{formulation} has damping with mass only, got stiffness = "
                f"{self.damping.stiffness!r}"
            )
        for stiffness in self.stiffness:
            formulation.check(stiffness)
        self.held[self.elements[1:, 0], 4:] = True
        inside, after = self.elements[1:].T
        self.frames[inside, 1:] = edge_axes(self.frames, inside, after)
        return corners(
            self.elements, self.lengths, self.stiffness, self.frames, formulation.natural
        )


class Rod(Beam):
    """Shear-rigid :class:`~fem_lie.Beam`, with the same constructors, supports and queries.

    The first axis of a node is the tangent. Axial, torsional and bending stiffness of the section
    are used, with their couplings; the axis may be anywhere in the section. Sections whose shear
    centre is not their tension centre, such as channels, need a Beam: a rod twists about the
    tension centre, and a warning in the log gives the error. With
    :class:`~fem_lie.elements.KirchhoffRod`, the default, all nodes have frames. With
    :class:`~fem_lie.elements.DiscreteRod`, which needs one smooth open line, only the two ends
    have; the other nodes have a position and a rotation about the edge that follows them.

    Along the mesh of a :class:`~fem_lie.mesh.Spline` the unloaded rod is exactly that spline, also
    after knot insertion.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> rod = fl.Rod.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> type(rod.model.formulation).__name__
        'KirchhoffRod'
    """

    model: RodModel
    _model_class = RodModel
    _default: ClassVar[BeamFormulation] = KirchhoffRod()
    _has_springs: ClassVar[bool] = True

    def __init__(
        self,
        mesh: LineMesh | dolfinx.mesh.Mesh,
        section: Sections,
        *,
        up: Up | Twisted | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        rotary_inertia: bool = True,
        name: str = "",
    ) -> None:
        """Create the nodal frames; arguments as of :class:`~fem_lie.Beam`.

        Raises:
            ValueError: As for a beam; or the element is a :class:`~fem_lie.elements.DiscreteRod`
                and the line has corners, branches or no ends, the section couples axial strain and
                bending, or there is damping of strain.
        """
        super().__init__(
            mesh,
            section,
            up=up,
            formulation=formulation,
            damping=damping,
            rotary_inertia=rotary_inertia,
            name=name,
        )
        model = self.model
        if isinstance(model.formulation, KirchhoffRod):
            _log_stiff_torsion(model.label, model.stiffness)
            if isinstance(mesh, LineMesh):
                model.follow_cubics(mesh.slopes)
        if isinstance(model.formulation, DiscreteRod):
            model.corner_springs = model.made_of_edges(model.formulation)

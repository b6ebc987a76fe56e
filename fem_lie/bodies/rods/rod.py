"""Rods: bodies along lines with frames, but without shear."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any, ClassVar

import dolfinx
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.assembly import BeamAssembly
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.beams.sectioned import Sections
from fem_lie.bodies.body import NO_HOLDS, Holds
from fem_lie.bodies.nodes import Follower
from fem_lie.elements.beams.centres import torsion_about_centres
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.rods.corners import Corners, CornerSprings
from fem_lie.elements.rods.discrete_rod import DiscreteRod, corners, edge_axes
from fem_lie.elements.rods.kirchhoff import Kirchhoff, speeds_of_cubics
from fem_lie.forms.assembly import Assembly
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Twisted, Up

_log = logging.getLogger(__name__)
_STIFFER = 0.01  # in torsion, which is worth a warning
_UNEVEN = 1.8  # at twice the element's stretch is not known any more
_TWICE, _DOUBLED = np.polynomial.legendre.leggauss(6)
_POINTS, _WEIGHTS = 0.5 + 0.5 * _TWICE, 0.5 * _DOUBLED


def _log_stiff_torsion(label: str, stiffness: Array) -> None:
    """Say in the log how much stiffer sections twist about tension than about shear centres."""
    ratio = float(torsion_about_centres(stiffness).max(initial=1.0))
    if ratio > 1.0 + _STIFFER:
        _log.warning(
            "%s: the shear centre of its section is not its tension centre, about which a Rod "
            "twists: it is %.3g times as stiff in torsion as the section; take a Beam",
            label,
            ratio,
        )


class Rod(Beam):
    """A :class:`~fem_lie.Beam` of elements that have no shear; it is made, held and asked alike.

    The first axis of a node is the tangent there. Of a section stretch, torsion and bending count,
    and what couples these; the axis may run anywhere in it. Sections whose shear centre is not
    their tension centre, such as channels, are for a Beam: a rod twists about the tension centre,
    and a warning in the log says how much stiffer that is. With :class:`~fem_lie.Kirchhoff`, the
    default, all nodes have frames.
    With :class:`~fem_lie.DiscreteRod`, which needs one smooth line that is not closed, both ends
    have; other nodes are places, that turn about the edge that follows them and about nothing else.

    Along the mesh of a :class:`~fem_lie.Spline` the rod unloaded is that spline exactly, and stays
    it with more knots.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> rod = fl.Rod.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> type(rod.formulation).__name__
        'Kirchhoff'
    """

    standard: ClassVar[Formulation] = Kirchhoff()
    springs: ClassVar[bool] = True

    def __init__(
        self,
        mesh: LineMesh | dolfinx.mesh.Mesh,
        section: Sections,
        *,
        up: Up | Twisted | None = None,
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        rotary_inertia: bool = True,
        name: str = "",
    ) -> None:
        """Place nodal frames; arguments as of :class:`~fem_lie.Beam`.

        Raises:
            ValueError: As a beam; or the element is a :class:`~fem_lie.DiscreteRod` and the line
                has corners, branches or no ends, or the section couples stretch and bending, or
                there is damping with strain.
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
        if isinstance(self.formulation, Kirchhoff):
            _log_stiff_torsion(self.label, self.stiffness)
            if isinstance(mesh, LineMesh):
                self._follow_cubics(mesh.slopes)
        self._corners: Corners | None = None
        if isinstance(self.formulation, DiscreteRod):
            self._corners = self._made_of_edges(self.formulation)

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly:
        """All of one kind together, with the springs between edges."""
        assembly = BeamAssembly(bodies)
        starts = np.cumsum([0, *(len(body.frames) for body in bodies)])
        found = [
            body.corners._replace(nodes=assembly.order[body.corners.nodes + start])
            for body, start in zip(bodies, starts, strict=False)
            if body.corners is not None
        ]
        if found:
            joined = Corners(*(np.concatenate(column) for column in zip(*found, strict=True)))
            assembly.beside.append(CornerSprings(joined, assembly.count))
        return assembly

    @property
    def goes_straight(self) -> bool:
        """Those of edges do, whose places within do."""
        return self._corners is not None

    @property
    def corners(self) -> Corners | None:
        """Springs between its edges, if elements do not bend themselves."""
        return self._corners

    @property
    def edge_frames(self) -> Indices:
        """All but the first, whose frame is that of the end."""
        return super().edge_frames if self._corners is None else self.elements[1:]

    def follower(self) -> Follower | None:
        """Of edges: their frames go along with them by the smallest rotation."""
        if self._corners is None:
            return None
        inside, after = self.edge_frames.T

        def turn(rows: Array) -> None:
            rows[inside, 1:] = edge_axes(rows, inside, after)

        return turn

    def add_rigid_motion(self, translation: Array, spin: Array, about: Array) -> None:
        """As of all bodies; places between the ends turn about their edges alone."""
        super().add_rigid_motion(translation, spin, about)
        if self._corners is not None:
            self.velocities[self.elements[1:, 0], 4:] = 0.0

    def _follow_cubics(self, slopes: Array | None) -> None:
        """Lie along these, if there are any, and not along what tangents alone tell."""
        if slopes is None:
            return
        ends = self.frames[self.elements]
        mean, middle = slopes.mean(axis=1), speeds_of_cubics(ends, slopes, np.array([0.5]))[:, 0]
        if not (mean < _UNEVEN * middle).all():
            k = int((mean / np.maximum(middle, 1e-300)).argmax())
            raise ValueError(
                f"{self.label}: cell {k} of the spline is {mean[k] / middle[k]:.3g} times as fast "
                f"at its ends as in the middle, wanted is less than {_UNEVEN}: insert more knots"
            )
        self.slopes = slopes
        self.lengths = speeds_of_cubics(ends, slopes, _POINTS) @ _WEIGHTS

    def _made_of_edges(self, formulation: DiscreteRod) -> Corners:
        """Hold what its nodes do not have, and find the springs."""
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

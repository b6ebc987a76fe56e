"""Forces and moments on points, and line loads on beams and cables."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.attachment_load import AttachmentLoad
from fem_lie.bodies.beams.line_body import LineBody
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.points import A_POINT
from fem_lie.scene.load import Carrier, Field, NodalLoad, Sum, at_points

if TYPE_CHECKING:
    from fem_lie.scene.load import History

_NO_ROTATION = 1e-9
"""Work of a unit moment in a unit motion, relative to the largest, that counts as none."""


@dataclass(frozen=True, eq=False)
class PointLoad(NodalLoad):
    """Force and moment at a point.

    At a node with vector coordinates (thin shells, ANCF bodies, Hermite cables) the frame is the
    attachment frame of joints there: of the surface, of the section, or of the tangent. A cable has
    no rotation about its tangent, so the component of a moment about the tangent does no work.

    Attributes:
        point: The loaded point of a body.
        force: Force, shape (3,): global components, or components in the point's frame if
            following.
        moment: Moment, shape (3,): global components, or components in the point's frame if
            following.
        following: Whether the load rotates with the point's frame.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> _ = scene.add(fl.Clamp(beam.point("start")))
        >>> _ = scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 1.0)))
        >>> tip = fl.statics(scene).displacement(beam.point("end"))[-1]
        >>> bool(abs(tip[2] / (1 / 3 / tube.stiffness[4, 4]) - 1) < 1e-3)
        True
    """

    carrier = Carrier("point", Point, A_POINT)
    components = MappingProxyType({"force": 3, "moment": 3})

    point: Point
    force: npt.ArrayLike = (0.0, 0.0, 0.0)
    moment: npt.ArrayLike = (0.0, 0.0, 0.0)
    following: bool = False
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if a component is not finite or the point is ground."""
        if self.point.is_ground:
            raise ValueError("a load needs a point of a body, got ground")
        super().check()
        attachment = self.point.any_attachment
        if self._rotates and attachment is None:
            self.body.model.require_frames("a moment, or a follower load,")
        if attachment is not None and np.any(self.moment):
            self._check_rotation(attachment)

    def _check_rotation(self, attachment: AttachmentFrame) -> None:
        """Raise ``ValueError`` if the point has no rotation about the moment."""
        moment, spins = (
            attachment.frame(self.body.frames)[1:] @ self.axis(),
            attachment.spins(self.body.frames),
        )
        work = np.einsum("i,kij->kj", moment, spins)
        if np.abs(work).max() <= _NO_ROTATION * np.linalg.norm(moment) * np.abs(spins).max():
            raise ValueError(
                f"the moment at {self.point.label} acts about an axis about which the point has no "
                f"rotation: expected a component across the tangent, got {self.moment}"
            )

    @property
    def _rotates(self) -> bool:
        """Whether the load needs a frame at the point."""
        return self.following or bool(np.any(self.moment))

    def contribute(self, to: Sum) -> None:
        """Add the load at a node, or at the nodes on which a point between nodes depends.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        attachment = self.point.any_attachment if self._rotates else self.point.attachment
        if attachment is None or attachment.kind.rigid:
            super().contribute(to)
            return
        nodes = to.nodes(self.body)[list(attachment.nodes)]
        wrench = self.nodal()[self.point.node]
        to.add_term(AttachmentLoad(attachment, nodes, wrench, following=self.following))

    def axis(self) -> Array:
        """Moment in the initial configuration, global components, shape (3,)."""
        moment = np.asarray(self.moment, dtype=np.float64)
        return moment @ self.point.frame[1:] if self.following else moment

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        assert self.point.body is not None
        return self.point.body

    @property
    def where(self) -> str:
        """Name of the point, for messages."""
        return self.point.label

    def nodal(self) -> Array:
        """Force and moment at each node of the body, shape (n, 6)."""
        values = np.zeros((len(self.body.frames), 6))
        values[self.point.node, :3] = self.force
        values[self.point.node, 3:] = self.moment
        return values

    def on_directors(self) -> Array:
        """Forces on directors of a point that is rigidly offset from its node, shape (n, 3, 3)."""
        values, attachment = super().on_directors(), self.point.attachment
        if attachment is not None and attachment.kind.rigid:
            node = self.body.frames[self.point.node]
            arm = node[1:] @ (self.point.position - node[0])
            values[self.point.node] = np.outer(arm, np.asarray(self.force, dtype=np.float64))
        return values


@dataclass(frozen=True, eq=False)
class LineLoad(NodalLoad):
    """Force and moment per reference length on all of a beam or cable, or on some of its cells.

    Attributes:
        beam: The loaded beam or cable.
        force: Three components per length, global if fixed in space, local if following; or a
            function of the unloaded position.
        moment: Three components per length in the same axes, or such a function.
        cells: Name of a group of cells; default: all.
        following: Whether the load rotates with the nodal frames.
        history: Factor as a function of time.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> scene = fl.Scene()
        >>> _ = scene.add(beam)
        >>> load = scene.add(fl.LineLoad(beam, force=(0, 0, -5.0)))
        >>> len(scene.loads)
        1
    """

    divisible = True
    carrier = Carrier(
        "beam", LineBody | AncfBeam, "a Beam (on shells: EdgeLoad, on solids: FaceLoad)"
    )

    beam: Body
    force: Field = (0.0, 0.0, 0.0)
    moment: Field = (0.0, 0.0, 0.0)
    cells: str | None = None
    following: bool = False
    history: History | None = None

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the beam has no such cells."""
        super().check()
        if self.following or callable(self.moment) or np.any(self.moment):
            self.body.model.require_frames("a moment, or a follower load,")
        self.nodal()

    def nodal(self) -> Array:
        """Consistent nodal forces and moments of the interpolation, shape (n, 6)."""
        values, at = np.zeros((len(self.body.frames), 6)), self.body.model.line_quadrature()
        chosen, density = self.body.model.cells_of(self.cells), np.empty((*at.positions.shape, 2))
        density[..., 0] = self._density("force", at.positions)
        density[..., 1] = self._density("moment", at.positions)
        shares = np.einsum("mgk,mgjh->mkhj", at.shares[chosen], density[chosen])
        np.add.at(values, at.nodes[chosen], shares.reshape(*shares.shape[:2], 6))
        return values

    def on_directors(self) -> Array:
        """Consistent forces on directors, from the curved interpolation of the axis, (n, 3, 3)."""
        values, at = np.zeros((len(self.body.frames), 3, 3)), self.body.model.line_quadrature()
        if at.on_directors is not None:
            chosen = self.body.model.cells_of(self.cells)
            force = self._density("force", at.positions[chosen])
            shares = np.einsum("mgkd,mgj->mkdj", at.on_directors[chosen], force)
            np.add.at(values, at.nodes[chosen], shares)
        return values

    def _density(self, name: str, positions: Array) -> Array:
        what = f"{name} of the LineLoad on {self.body.label}"
        return at_points(getattr(self, name), positions, what)

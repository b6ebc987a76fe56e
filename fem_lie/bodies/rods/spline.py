"""Cables along cubic splines."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline

from fem_lie._arrays import instance
from fem_lie.bodies.beams.line_body import Placed
from fem_lie.bodies.rods.threads import Threads, successive
from fem_lie.elements.rods.isogeometric import IsogeometricCable
from fem_lie.mesh.curves import Spline
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Chains, cell_frames, shared_nodes
from fem_lie.sections.section import Section


class SplineCable(Threads):
    """A cable along a cubic spline, unstretched as it is laid, naturally straight.

    Its nodes are the knots, each with a place and a slope ``dr/du``, rows 0 and 1 of ``frames``;
    all else is as of :class:`~fem_lie.Cable`. A curve whose ends meet with one slope is closed.
    ``lengths`` are those of the parameter, whose mean speed is one.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> ring = fl.SplineCable.circle((0, 0, 0), 1.0, (0, 0, 1), tube, cells=8)
        >>> len(ring.frames)
        8
    """

    def __init__(
        self,
        knots: npt.ArrayLike,
        places: npt.ArrayLike,
        slopes: npt.ArrayLike,
        section: Section,
        *,
        formulation: IsogeometricCable | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Place the nodes.

        Args:
            knots: The parameter ``u`` there, increasing, shape (n,).
            places: Shape (n, 3).
            slopes: ``dr/du``, shape (n, 3).
            section: As of a :class:`~fem_lie.Cable`.
            formulation: The element; default: :class:`~fem_lie.IsogeometricCable`.
            damping: Of its motion in space, and of its strain.
            name: How messages and results call it.

        Raises:
            ValueError: Shapes do not fit, knots do not increase, or the curve stands still.
            TypeError: An argument is of another kind than wanted.
        """
        wanted = IsogeometricCable | None
        instance(formulation, wanted, "SplineCable: formulation", "an IsogeometricCable or None")
        line = Spline.checked(knots, places, slopes)
        element = IsogeometricCable() if formulation is None else formulation
        mesh, (u, x, rates) = line.mesh(), line
        frames, elements, masters = shared_nodes(mesh, cell_frames(mesh, Chains(mesh), None, None))
        ends = np.zeros((len(u) - 1, 2, 4, 3))
        ends[:, 0, :2], ends[:, 1, :2] = (
            np.stack([x[k], rates[k]], axis=1) for k in (slice(None, -1), slice(1, None))
        )
        arc = element.shares(ends, np.diff(u)).sum()
        scale = arc / (u[-1] - u[0])
        frames[:, 1] = rates[: len(mesh.points)] / scale
        placed = Placed(frames, elements, np.diff(u) * scale, masters, elements)
        super().__init__(mesh, placed, successive(elements), section, element, damping, name)

    @classmethod
    def of(
        cls,
        spline: BSpline,
        section: Section,
        *,
        cells: int = 1,
        formulation: IsogeometricCable | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> SplineCable:
        """Along a cubic spline of SciPy's with doubled inner knots, of points in space.

        Args:
            spline: Of degree 3, with control points of shape (n, 3).
            section: As of a :class:`~fem_lie.Cable`.
            cells: Of each piece between knots; more of them leave the curve as it is.
            formulation: See the class; likewise the others.
            damping: Likewise.
            name: Likewise.

        Raises:
            ValueError: It is of another degree or dimension, or has an inner knot that is not
                doubled: with a simple one slopes cannot move by themselves, with one that is
                tripled it has a corner.
        """
        return cls(
            *Spline.of(spline, cells), section, formulation=formulation, damping=damping, name=name
        )

    @classmethod
    def through(
        cls,
        points: npt.ArrayLike,
        section: Section,
        *,
        cells: int = 1,
        formulation: IsogeometricCable | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> SplineCable:
        """Through points, by the smooth cubic spline over their distances.

        If the last is the first it is closed.

        Args:
            points: Shape (n, 3).
            section: As of a :class:`~fem_lie.Cable`.
            cells: Of each piece between points.
            formulation: See the class; likewise the others.
            damping: Likewise.
            name: Likewise.

        Raises:
            ValueError: There are less than two points, or successive ones are the same.
        """
        return cls(
            *Spline.through(points, cells),
            section,
            formulation=formulation,
            damping=damping,
            name=name,
        )

    @classmethod
    def circle(
        cls,
        centre: npt.ArrayLike,
        radius: float,
        normal: npt.ArrayLike,
        section: Section,
        *,
        cells: int,
        formulation: IsogeometricCable | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> SplineCable:
        """Along a circle, of sixth order: slopes are those of the best cubics for arcs.

        Args:
            centre: Of it.
            radius: Of it.
            normal: Of its plane; it goes round this.
            section: As of a :class:`~fem_lie.Cable`.
            cells: Of all of it, 3 or more.
            formulation: See the class; likewise the others.
            damping: Likewise.
            name: Likewise.

        Raises:
            ValueError: The radius is not positive, there is no normal, or there are too few cells.
        """
        return cls(
            *Spline.circle(centre, radius, normal, cells),
            section,
            formulation=formulation,
            damping=damping,
            name=name,
        )

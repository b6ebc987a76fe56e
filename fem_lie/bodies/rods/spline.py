"""Cables along cubic splines."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline

from fem_lie._arrays import instance
from fem_lie.bodies.beams.line_body import Placed
from fem_lie.bodies.rods.cable_body import CableBody, CableModel, successive
from fem_lie.elements.rods.isogeometric import IsogeometricCable
from fem_lie.mesh.curves import Spline
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Chains, cell_frames, shared_nodes
from fem_lie.sections.section import Section


class SplineCable(CableBody):
    """Cable along a cubic spline, unstretched in its initial position, naturally straight.

    Its nodes are the knots, with a position and a derivative ``dr/du``, rows 0 and 1 of ``frames``;
    the rest is as of :class:`~fem_lie.Cable`. A curve whose ends meet with equal derivatives is
    closed. ``lengths`` are parameter intervals, scaled to a mean speed of one.

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
        positions: npt.ArrayLike,
        slopes: npt.ArrayLike,
        section: Section,
        *,
        formulation: IsogeometricCable | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            knots: Parameter ``u`` of the knots, increasing, shape (n,).
            positions: Positions of the knots, shape (n, 3).
            slopes: Derivatives ``dr/du`` at the knots, shape (n, 3).
            section: As of a :class:`~fem_lie.Cable`.
            formulation: Finite element; default: :class:`~fem_lie.elements.IsogeometricCable`.
            damping: Damping of motion and of strain.
            name: Name in messages and results.

        Raises:
            ValueError: Shapes do not agree, knots do not increase, or the derivative vanishes
                somewhere.
            TypeError: An argument has an unexpected type.
        """
        expected = IsogeometricCable | None
        instance(formulation, expected, "SplineCable: formulation", "an IsogeometricCable or None")
        line = Spline.checked(knots, positions, slopes)
        element = IsogeometricCable() if formulation is None else formulation
        mesh, (u, x, rates) = line.mesh(), line
        frames, elements, masters = shared_nodes(mesh, cell_frames(mesh, Chains(mesh), None, None))
        ends = np.zeros((len(u) - 1, 2, 4, 3))
        ends[:, 0, :2], ends[:, 1, :2] = (
            np.stack([x[k], rates[k]], axis=1) for k in (slice(None, -1), slice(1, None))
        )
        arc = element.line_shapes(ends, np.diff(u)).weights.sum()
        scale = arc / (u[-1] - u[0])
        frames[:, 1] = rates[: len(mesh.points)] / scale
        placed = Placed(frames, elements, np.diff(u) * scale, masters, elements)
        names = type(self).__name__, name
        super().__init__(
            CableModel(mesh, placed, successive(elements), section, element, damping, *names)
        )

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
        """Cable along a cubic spline of SciPy with doubled inner knots.

        Args:
            spline: Spline of degree 3, with control points of shape (n, 3).
            section: As of a :class:`~fem_lie.Cable`.
            cells: Cells between two knots; the curve does not depend on it.
            formulation: See :class:`SplineCable`.
            damping: See :class:`SplineCable`.
            name: Name in messages and results.

        Raises:
            ValueError: The spline has another degree or dimension, or an inner knot that is not
                doubled: with a simple knot, derivatives are not independent; a triple knot is a
                corner.
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
        """Cable along the smooth cubic spline through points, with their distances as knots.

        It is closed if the last point equals the first.

        Args:
            points: Shape (n, 3).
            section: As of a :class:`~fem_lie.Cable`.
            cells: Cells between two points.
            formulation: See :class:`SplineCable`.
            damping: See :class:`SplineCable`.
            name: Name in messages and results.

        Raises:
            ValueError: There are less than two points, or successive points coincide.
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
        """Cable along a circle, by the cubics that approximate arcs to sixth order.

        Args:
            centre: Centre of the circle, shape (3,).
            radius: Radius.
            normal: Normal of its plane, about which it is oriented.
            section: As of a :class:`~fem_lie.Cable`.
            cells: Number of cells, 3 or more.
            formulation: See :class:`SplineCable`.
            damping: See :class:`SplineCable`.
            name: Name in messages and results.

        Raises:
            ValueError: The radius is not positive, the normal is zero, or there are too few cells.
        """
        return cls(
            *Spline.circle(centre, radius, normal, cells),
            section,
            formulation=formulation,
            damping=damping,
            name=name,
        )

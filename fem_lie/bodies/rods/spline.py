"""Cables along cubic splines."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline, CubicSpline

from fem_lie._arrays import (
    Array,
    direction,
    instance,
    numbers,
    points_of,
    positive,
    vector,
    whole_number,
)
from fem_lie.bodies.beams.assembly import Damping
from fem_lie.bodies.beams.line_body import Placed
from fem_lie.bodies.beams.orientation import Chains, cell_frames, shared_nodes
from fem_lie.bodies.rods.threads import Threads, successive
from fem_lie.elements.rods.isogeometric import IsogeometricCable
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.section import Section

_SAME = 1e-9  # relative, of the two ends of a closed curve


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
        x, u = points_of(places), numbers(knots, "SplineCable: knots")
        rates = numbers(slopes, "SplineCable: slopes")
        if u.shape != (len(x),) or rates.shape != x.shape or len(x) < 2:
            raise ValueError(
                "a SplineCable has two knots or more, with a place and a slope at each, got shapes "
                f"{u.shape}, {x.shape} and {rates.shape}"
            )
        if not (np.diff(u) > 0).all():
            raise ValueError(f"the knots of a SplineCable increase, got {u}")
        speed = np.linalg.norm(rates, axis=1)
        if not speed.min() > _SAME * speed.max():
            raise ValueError(
                f"a SplineCable has slopes that are not zero, but that at knot {speed.argmin()} is "
                f"{rates[speed.argmin()]}"
            )
        element = IsogeometricCable() if formulation is None else formulation
        mesh, kept = _mesh(x, rates)
        frames, elements, leaders = shared_nodes(mesh, cell_frames(mesh, Chains(mesh), None, None))
        ends = np.zeros((len(u) - 1, 2, 4, 3))
        ends[:, 0, :2], ends[:, 1, :2] = (
            np.stack([x[k], rates[k]], axis=1) for k in (slice(None, -1), slice(1, None))
        )
        arc = element.shares(ends, np.diff(u)).sum()
        scale = arc / (u[-1] - u[0])
        frames[:, 1] = rates[:kept] / scale
        placed = Placed(frames, elements, np.diff(u) * scale, leaders, elements)
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
        instance(spline, BSpline, "SplineCable.of: spline", "a scipy.interpolate.BSpline")
        if spline.k != 3 or np.shape(spline.c)[1:] != (3,):
            raise ValueError(
                "wanted is a cubic spline of control points of shape (n, 3), got one of degree "
                f"{spline.k} of shape {np.shape(spline.c)}"
            )
        begin, end = float(spline.t[3]), float(spline.t[len(spline.c)])
        knots, count = np.unique(spline.t, return_counts=True)
        inner = (knots > begin) & (knots < end)
        if not (count[inner] == 2).all():
            k = np.flatnonzero(inner & (count != 2))[0]
            raise ValueError(
                f"inner knots of a SplineCable are doubled, so that it is once continuously "
                f"differentiable, but {knots[k]:g} is there {count[k]} times: insert it again "
                "(scipy.interpolate.insert), or use SplineCable.through"
            )
        pieces = np.array([begin, *knots[inner], end])
        u = _divided(pieces, whole_number(cells))
        rates = spline.derivative()(u)
        return cls(
            u, spline(u), rates, section, formulation=formulation, damping=damping, name=name
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
        x = points_of(points)
        steps = np.linalg.norm(np.diff(x, axis=0), axis=1)
        if len(x) < 2 or not steps.min() > 0:
            raise ValueError(f"wanted are two points or more, successive ones apart, got\n{x}")
        closed = len(x) > 3 and np.array_equal(x[0], x[-1])
        knots = np.concatenate([[0.0], np.cumsum(steps)])
        curve = CubicSpline(knots, x, bc_type="periodic" if closed else "not-a-knot")
        u = _divided(knots, whole_number(cells))
        places = curve(u)
        if closed:
            places[-1] = places[0]
        return cls(
            u, places, curve(u, 1), section, formulation=formulation, damping=damping, name=name
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
        middle, r = vector(centre, 3, "SplineCable.circle: centre"), positive(radius, "radius")
        e3 = direction(normal, "SplineCable.circle: normal")
        if whole_number(cells) < 3:
            raise ValueError(f"a circle has 3 cells or more, got {cells}")
        e1 = np.cross(e3, np.eye(3)[np.abs(e3).argmin()])
        e1 /= np.linalg.norm(e1)
        e2, angle = np.cross(e3, e1), 2 * np.pi * np.arange(cells + 1) / cells
        angle[-1] = 0.0
        c, s = np.cos(angle)[:, np.newaxis], np.sin(angle)[:, np.newaxis]
        speed = 4 * r * np.tan(np.pi / (2 * cells))
        return cls(
            np.arange(cells + 1.0),
            middle + r * (c * e1 + s * e2),
            speed * (c * e2 - s * e1),
            section,
            formulation=formulation,
            damping=damping,
            name=name,
        )


def _divided(knots: Array, cells: int) -> Array:
    """Each piece in so many equal ones."""
    ξ = np.arange(cells) / cells
    inner = knots[:-1, np.newaxis] + ξ * np.diff(knots)[:, np.newaxis]
    return np.append(inner.ravel(), knots[-1])


def _mesh(places: Array, rates: Array) -> tuple[LineMesh, int]:
    """From knot to knot, closed if it ends as it began, and how many nodes that has."""
    n = len(places)
    size, speed = np.ptp(places, axis=0).max(), np.linalg.norm(rates, axis=1).max()
    gaps = np.abs(places[-1] - places[0]).max(), np.abs(rates[-1] - rates[0]).max()
    closed = n > 3 and gaps[0] <= _SAME * size and gaps[1] <= _SAME * speed
    kept = n - 1 if closed else n
    number = np.arange(n) % kept
    cells = np.column_stack([number[:-1], number[1:]])
    tangents = rates / np.linalg.norm(rates, axis=1, keepdims=True)
    along = np.stack([tangents[:-1], tangents[1:]], axis=1)
    names = {"start": np.array([0])} | ({} if closed else {"end": np.array([n - 1])})
    return LineMesh(places[:kept], cells, along, {}, names), kept

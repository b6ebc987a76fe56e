"""Nets: cables that share nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, indices_of, instance, numbers, points_of, positive
from fem_lie.bodies.beams.line_body import Placed
from fem_lie.bodies.rods.cable_body import CableBody, CableModel
from fem_lie.elements.rods.bends import Successive
from fem_lie.elements.rods.discrete import DiscreteCable
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.section import Section


class Net(CableBody):
    """Cables through points, connected where they share a point.

    Each cable has bending stiffness at its points; at a shared point, cables are hinged to each
    other. Nodes are the points, in their order. Supports and loads are those of
    :class:`~fem_lie.Cable`.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 1, 0)]
        >>> net = fl.Net(points, [[0, 1, 2], [1, 3]], tube)
        >>> net.pin(net.point(0), net.point(2))
        >>> len(net.frames)
        4
    """

    def __init__(
        self,
        points: npt.ArrayLike,
        cables: Sequence[Sequence[int]],
        section: Section,
        *,
        stretch: npt.ArrayLike = 1.0,
        formulation: DiscreteCable | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            points: Positions, shape (n, 3).
            cables: Indices of the points along each cable, two or more; a cable whose last point
                is its first is closed.
            section: Section of all cables.
            stretch: Ratio of initial to unstretched length, of all cables or of each.
            formulation: Finite element; default: :class:`~fem_lie.elements.DiscreteCable`.
            damping: Mass-proportional damping.
            name: Name in messages and results.

        Raises:
            ValueError: A cable has less than two points, reverses, or overlaps another; a point has
                no cable; the points of an edge coincide; or ``stretch`` is not positive or has
                another shape.
            TypeError: An argument has an unexpected type.
        """
        positions, expected = points_of(points), DiscreteCable | None
        instance(formulation, expected, "Net: formulation", "a DiscreteCable or None")
        edges, along = _followed(cables, len(positions))
        chords = np.diff(positions[edges], axis=1)[:, 0]
        lengths = np.linalg.norm(chords, axis=1)
        if not lengths.min() > 0.0:
            a, b = edges[lengths.argmin()]
            raise ValueError(
                f"Net: expected distinct points along a cable, got {a} and {b} at one position"
            )
        tangents = chords / lengths[:, np.newaxis]
        mesh = LineMesh(positions, edges, np.repeat(tangents[:, np.newaxis], 2, axis=1))
        frames = _frames(positions, edges, tangents)
        lengths = lengths / _stretches(stretch, [len(cable) - 1 for cable in cables])
        placed = Placed(frames, edges, lengths, np.arange(len(positions)), edges)
        element = DiscreteCable() if formulation is None else formulation
        names = type(self).__name__, name
        super().__init__(CableModel(mesh, placed, along, section, element, damping, *names))


def _stretches(stretch: npt.ArrayLike, edges: list[int]) -> Array:
    """Stretch of each edge; ``edges`` is the number of edges of each cable."""
    given = numbers(stretch, "Net: stretch")
    if given.shape not in ((), (len(edges),)):
        raise ValueError(
            f"Net: stretch must be one number or {len(edges)}, one for each cable, got an array "
            f"of shape {given.shape}"
        )
    for value in given.ravel():
        positive(value, "Net: stretch")
    return np.repeat(np.broadcast_to(given, len(edges)), edges)


def _followed(cables: Sequence[Sequence[int]], count: int) -> tuple[Indices, Successive]:
    """Edges of all cables, shape (m, 2), and pairs of successive edges."""
    edges: list[Indices] = []
    nodes: list[Indices] = []
    pairs: list[Indices] = []
    first = 0
    for number, cable in enumerate(cables):
        path = indices_of(cable, count, f"points of cable {number}")
        if len(path) < 2:
            raise ValueError(
                f"each cable of a Net: expected two points or more, got {path.tolist()}"
            )
        edges.append(np.column_stack([path[:-1], path[1:]]))
        own: Indices = np.arange(first, first + len(path) - 1)
        first += len(own)
        # a closed cable continues with its first edge
        closed = path[0] == path[-1]
        around, again = (
            (np.append(path, path[1]), np.append(own, own[0])) if closed else (path, own)
        )
        nodes.append(np.column_stack([around[:-2], around[1:-1], around[2:]]))
        pairs.append(np.column_stack([again[:-1], again[1:]]))
    if not edges:
        raise ValueError("Net: expected at least one cable, got none")
    return np.concatenate(edges), Successive(np.concatenate(nodes), np.concatenate(pairs))


def _frames(positions: Array, edges: Indices, tangents: Array) -> Array:
    """Nodal coordinates, with the first axis along any edge of each node."""
    first = np.zeros((len(positions), 3))
    for side in (1, 0):
        first[edges[:, side]] = tangents
    across = np.eye(3)[np.abs(first).argmin(axis=1)]
    second = np.cross(across, first)
    norm = np.linalg.norm(second, axis=1, keepdims=True)
    second = second / np.where(norm > 0, norm, 1.0)  # points without cables are refused later
    return np.stack([positions, first, second, np.cross(first, second)], axis=1)

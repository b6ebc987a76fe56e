"""Which node of the system is which: all bodies, kind by kind."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._jit import Indices
from fem_lie.assembly import Assembly
from fem_lie.bodies import Body, Point
from fem_lie.info import BodyInfo


class Numbering:
    """Nodes of the system; each kind of body has a slice of them.

    Attributes:
        count: Number of nodes.
        nodes: Nodes of each body in the numbering of the system.
        assemblies: The nodes of each assembly, and the assembly.
        frames: Initial frames, shape (count, 4, 3).
        velocities: Initial local velocities, shape (count, 6).
        groups: The group of each node, shape (count,).
    """

    def __init__(self, bodies: Sequence[Body]) -> None:
        """Build the assemblies and number their nodes as they do."""
        self.nodes: dict[Body, Indices] = {}
        self.assemblies: list[tuple[slice, Assembly]] = []
        start = 0
        for kind in dict.fromkeys(body.assembly for body in bodies):
            members = [body for body in bodies if body.assembly is kind]
            total = sum(len(body.frames) for body in members)
            order: Indices = np.arange(total)
            if kind is not None:
                assembly = kind(members)  # type: ignore[call-arg, arg-type]
                order = assembly.order
                self.assemblies.append((slice(start, start + total), assembly))
            first = 0
            for body in members:
                self.nodes[body] = start + order[first : first + len(body.frames)]
                first += len(body.frames)
            start += total
        self.count = start
        self.frames, self.velocities = np.empty((start, 4, 3)), np.empty((start, 6))
        self.groups: Indices = np.empty(start, dtype=np.int64)
        for body, nodes in self.nodes.items():
            self.frames[nodes], self.velocities[nodes] = body.frames, body.velocities
            self.groups[nodes] = body.group

    def node(self, point: Point) -> int:
        """Number of a point's node; of ground it is ``count``."""
        return self.count if point.body is None else int(self.nodes[point.body][point.node])

    def bodies(self) -> tuple[BodyInfo, ...]:
        """What results must know of the bodies."""
        return tuple(
            BodyInfo(
                name=body.name,
                kind=type(body).__name__,
                nodes=nodes,
                cells=nodes[body.cells],
                outline=body.outline,
                box=body.box,
                points={key: int(nodes[node]) for key, node in body.point_names.items()},
            )
            for body, nodes in self.nodes.items()
        )

"""Partition of a scene: cells, bodies and items divided among ranks.

Bodies are divided between cells where their model says how. A body stays in one piece if it cannot
be divided, or if a contact, a connection or a load needs the whole of it. The nodes of an item stay
within one part, with all cells at them, so that constraints and springs are of one part and parts
meet within bodies only. So do nodes that are attached to each other, as along a fold of a shell.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Indices
from fem_lie.bodies.body import Body, Point
from fem_lie.linear.domains.division import Division, Links, divided
from fem_lie.parts.references import nodes_of, references
from fem_lie.scene import Scene
from fem_lie.scene.load import Load


class Partition(NamedTuple):
    """Parts of a scene, equal on all ranks.

    Attributes:
        first: Number of the first node of each body; nodes are numbered body after body.
        cells: Part of each cell of each divided body.
        pieces: Part of each other body.
        items: Part of each item of the scene; −1 for loads that all parts of their body carry.
        division: Division of all cells and nodes.
    """

    first: dict[Body, int]
    cells: dict[Body, Indices]
    pieces: dict[Body, int]
    items: Indices
    division: Division


class Need(NamedTuple):
    """What an item needs within one part.

    Attributes:
        bodies: Bodies in one piece.
        nodes: Nodes of other bodies, by their numbers in the body.
    """

    bodies: list[Body]
    nodes: list[tuple[Body, int]]


def needs_of(item: object, bodies: Sequence[Body | None]) -> Need:
    """What an item needs: nothing if it is a load that all parts of its body carry.

    Args:
        item: An item of a scene.
        bodies: Bodies on which it acts; those on which it has no point it needs in one piece.
    """
    if isinstance(item, Load) and item.divisible:
        return Need([], [])
    found = list(references(item))
    points = [each for each in found if isinstance(each, Point)]
    at_points = {point.body for point in points}
    pieces = {each for each in found if isinstance(each, Body)}
    pieces |= {body for body in bodies if body is not None and body not in at_points}
    nodes = [(p.body, node) for p in points if p.body is not None for node in nodes_of(p)]
    return Need(sorted(pieces, key=lambda body: body.label), nodes)


def partition(scene: Scene, comm: MPI.Intracomm) -> Partition:
    """Divide a scene, a part for each rank; all ranks together.

    Args:
        scene: The scene, the same on all ranks.
        comm: Communicator of the ranks.

    Raises:
        ValueError: It cannot be divided into so many.
    """
    counts = [len(body.frames) for body in scene.bodies]
    starts = np.cumsum([0, *counts])
    first = {body: int(start) for body, start in zip(scene.bodies, starts, strict=False)}
    needs = [needs_of(*item) for item in scene.items()]
    whole = {body for body in scene.bodies if body.model.divisible_cells is None}
    whole |= {body for need in needs for body in need.bodies}
    cells, attached, held = _Collected(), _Collected(), _Collected()
    ranges: dict[Body, slice] = {}
    for body in scene.bodies:
        model, begun = body.model, cells.count
        if body in whole:
            cells.add(np.arange(first[body], first[body] + len(body.frames))[np.newaxis])
        else:
            own = model.divisible_cells
            assert own is not None
            cells.add(first[body] + own)
            follow = np.flatnonzero(model.masters != np.arange(len(model.masters)))
            attached.add(first[body] + np.column_stack([model.masters[follow], follow]))
        ranges[body] = slice(begun, cells.count)
    for need in needs:
        # a node stands for all of a body in one piece
        nodes = [first[body] for body in need.bodies]
        nodes += [first[body] + node for body, node in need.nodes]
        if nodes:
            held.add(np.array([nodes], dtype=np.int64))
    free = np.concatenate([~(b.model.held | b.model.missing_unknowns) for b in scene.bodies])
    found = _of_first(comm, cells.links, held.links, attached.links, free.sum(axis=1))
    owners = np.full(len(needs), -1)
    owners[[bool(need.bodies or need.nodes) for need in needs]] = found.constraints
    return Partition(
        first,
        {body: found.cells[ranges[body]] for body in scene.bodies if body not in whole},
        {body: int(found.cells[ranges[body]][0]) for body in whole},
        owners,
        found,
    )


def _of_first(
    comm: MPI.Intracomm, cells: Links, held: Links, others: Links, free: Indices
) -> Division:
    """Division by the first rank, as SCOTCH may divide differently at each call.

    Raises:
        ValueError: On all ranks, if it is impossible.
    """
    found: Division | ValueError | None = None
    if comm.rank == 0:
        try:
            found = divided(cells, held, others, free, comm.size)
        except ValueError as error:
            found = error
    given = comm.bcast(found)
    if isinstance(given, ValueError):
        raise given
    division: Division = given
    return division


class _Collected:
    """Nodes of cells or items of different sizes."""

    def __init__(self) -> None:
        self._which: list[Indices] = [np.empty(0, np.int64)]
        self._nodes: list[Indices] = [np.empty(0, np.int64)]
        self.count = 0

    def add(self, cells: Indices) -> None:
        """Add cells of equal size, shape (m, k)."""
        self._which.append(np.repeat(self.count + np.arange(len(cells)), cells.shape[1]))
        self._nodes.append(cells.ravel())
        self.count += len(cells)

    @property
    def links(self) -> Links:
        """All of them."""
        return Links(np.concatenate(self._which), np.concatenate(self._nodes), self.count)

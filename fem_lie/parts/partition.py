"""Partition of a scene: cells, bodies and items divided among ranks.

Bodies are divided between cells where their model says how. A body stays in one piece if it cannot
be divided, or if a contact, a connection or a load needs the whole of it. The nodes of an item stay
within one part, with all cells at them, so that constraints and springs are of one part and parts
meet within bodies only. So do nodes that are attached to each other, as along a fold of a shell.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Indices
from fem_lie.bodies.body import Body
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
        items: Part of each item of :func:`items_of`; −1 for loads on divided bodies, which all
            parts of these share.
        division: Division of all cells and nodes.
    """

    first: dict[Body, int]
    cells: dict[Body, Indices]
    pieces: dict[Body, int]
    items: Indices
    division: Division


def items_of(scene: Scene) -> list[Any]:
    """All items of a scene but its bodies, in a fixed order."""
    lists = scene.joints, scene.connections, scene.links, scene.contacts
    return [item for each in (*lists, scene.loads, scene.clamps, scene.motions) for item in each]


def shared_load(item: object) -> bool:
    """Whether an item is a load on a body that all parts of the body share."""
    return isinstance(item, Load) and item.divisible


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
    whole = set(_undivided(scene))
    cells, attached = _Collected(), _Collected()
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
    held, items = _Collected(), items_of(scene)
    for item in items:
        held.add([] if shared_load(item) else [list(_nodes(item, first))])
    free = np.concatenate([~(b.model.held | b.model.missing_unknowns) for b in scene.bodies])
    found = _of_first(comm, cells.links, held.links, attached.links, free.sum(axis=1))
    owners = np.full(len(items), -1)
    owners[[k for k, item in enumerate(items) if not shared_load(item)]] = found.constraints
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

    def add(self, cells: Indices | Sequence[Sequence[int]]) -> None:
        """Add cells of equal size, shape (m, k)."""
        for size in {len(cell) for cell in cells}:
            nodes = np.asarray(cells, dtype=np.int64).reshape(-1, size)
            self._which.append(np.repeat(self.count + np.arange(len(nodes)), size))
            self._nodes.append(nodes.ravel())
        self.count += len(cells)

    @property
    def links(self) -> Links:
        """All of them."""
        return Links(np.concatenate(self._which), np.concatenate(self._nodes), self.count)


def _undivided(scene: Scene) -> Iterator[Body]:
    """Bodies that stay in one piece."""
    for body in scene.bodies:
        if body.model.divisible_cells is None:
            yield body
    for item in items_of(scene):
        if not shared_load(item):
            yield from (each for each in references(item) if isinstance(each, Body))
    for contact in (*scene.contacts, *scene.impacts):
        yield from contact.bodies


def _nodes(item: Any, first: dict[Body, int]) -> Iterator[int]:
    """Nodes of an item that stay together."""
    for each in references(item):
        body = each if isinstance(each, Body) else each.body
        if body is None:
            continue
        own = [0] if isinstance(each, Body) else nodes_of(each)
        yield from (first[body] + node for node in own)

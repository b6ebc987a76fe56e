"""The scene of one part: parts of bodies, and the items on them."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from copy import copy
from typing import Any, NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from fem_lie._arrays import Array, Indices, diameter
from fem_lie.bodies.body import Body
from fem_lie.joints.joint import RedundantConstraints
from fem_lie.parts.owners import owners
from fem_lie.parts.partition import Partition, partition
from fem_lie.parts.references import Restricted
from fem_lie.ranks.together import meet_to_divide, several
from fem_lie.scene import Scene


class ScenePart(NamedTuple):
    """What a rank has of a scene.

    Nodes of the scene are numbered body after body.

    Attributes:
        scene: Scene of its bodies, of parts of bodies, and of the items on them.
        whole: The scene.
        nodes: Number in the scene of each node of the bodies of the part.
        sharers: Other ranks, and the numbers in the scene of the nodes that they have, too,
            ascending.
        connections: Numbers of the joints, connections and prescribed motions of the part among
            those of the scene, in this order.
        contacts: Numbers of the contacts of the part among those of the scene.
        owners: Rank that has each cell of each body of the scene, as in :class:`.BodyInfo`;
            none if all of it is one part.
        items: Item of the part for each of those that events, limits and controllers switch or
            scale, if the part has it.
        length: Length of the model, of the whole scene.
        total: Number of nodes of the scene.
        comm: Communicator of the parts.
    """

    scene: Scene
    whole: Scene
    nodes: Mapping[Body, Indices]
    sharers: Mapping[int, Indices]
    connections: Indices
    contacts: Indices
    owners: Mapping[Body, Indices]
    items: Mapping[Any, Any]
    length: float
    total: int
    comm: MPI.Intracomm


def connections_of(scene: Scene) -> list[Any]:
    """Joints, connections and prescribed motions, in the order of results."""
    return [*scene.joints, *scene.connections, *scene.motions]


FROM = 20_000
"""Unknowns from which a scene is divided, unless PETSc's option ``divided_from`` sets a number of
all unknowns. Those of cables, nets, beams and rods count if there are many of their nodes between
joints: then each rank eliminates chains of its part, and little is left for messages."""

_LINES, _PER_JOINT = 20_000, 100  # nodes of lines, of all and of each joint, from which they count
_FROM, _DOMAINS = "divided_from", "domains"
_PACKAGE, _ON_RANKS = "pc_factor_mat_solver_type", "mumps"

_log = logging.getLogger(__name__)


def divided(
    scene: Scene, prefix: str, refused: Mapping[str, bool] | None = None
) -> ScenePart | None:
    """The part of a scene that this rank has, if the scene is divided among all ranks.

    Small scenes, those that cannot be divided, and those with what is not divided yet (impacts,
    ties, redundant constraints, joints that have turned before) are not: then all ranks have the
    whole scene, and the log says why. It is the same with options for subdomains, or for a package
    that factorises on one rank.

    Args:
        scene: The scene, the same on all ranks.
        prefix: Prefix of PETSc's options.
        refused: What the solver does not divide, and whether it is asked for.
    """
    if not several():
        return None
    options = PETSc.Options(prefix)
    asked = options.hasName(_FROM)
    limit = int(options.getInt(_FROM)) if asked else FROM
    lines = sum(len(body.frames) for body in scene.bodies if body.model.dimension == 1)
    least = max(_LINES, _PER_JOINT * len(connections_of(scene)))
    dimension = 0 if asked else 1 if lines >= least else 2
    counted = [body.model for body in scene.bodies if body.model.dimension >= dimension]
    unknowns = sum(int((~model.held).sum()) for model in counted)
    if unknowns < limit:
        _log.info("%d unknowns to divide: every rank has the whole scene", unknowns)
        return None
    reasons = {
        **(refused or {}),
        "redundant constraints": scene.redundant is not RedundantConstraints.REFUSE,
        "impacts": bool(scene.impacts),
        "ties": any(item.tie_definition() for item in scene.connections),
        "joints that have turned before": scene.began.turned is not None,
        f"option {_DOMAINS}": options.hasName(_DOMAINS),
        f"option {_PACKAGE}": options.getString(_PACKAGE, _ON_RANKS) != _ON_RANKS,
    }
    if any(reasons.values()):
        found = ", ".join(reason for reason, asked_for in reasons.items() if asked_for)
        _log.info("every rank has the whole scene, as these are not divided: %s", found)
        return None
    meet_to_divide()
    try:
        part = part_of(scene, MPI.COMM_WORLD)
    except ValueError as error:
        _log.info("every rank has the whole scene: %s", error)
        return None
    nodes = sum(len(own) for own in part.nodes.values())
    shared = len(np.unique(np.concatenate([np.empty(0, np.int64), *part.sharers.values()])))
    has = "rank %d has %d of %d nodes, %d of them are shared"
    _log.info(has, part.comm.rank, nodes, part.total, shared)
    return part


def undivided(scene: Scene) -> ScenePart:
    """All of a scene as a part, with its nodes numbered body after body."""
    ends = np.cumsum([len(body.frames) for body in scene.bodies])
    numbers = {
        body: np.arange(end - len(body.frames), end)
        for body, end in zip(scene.bodies, ends, strict=True)
    }
    return ScenePart(
        scene,
        scene,
        numbers,
        {},
        np.arange(len(connections_of(scene))),
        np.arange(len(scene.contacts)),
        {},
        {item: item for item in (*scene.switched, *scene.scaled)},
        _length(scene),
        int(ends[-1]),
        MPI.COMM_SELF,
    )


def whole_scene(scene: Scene, part: ScenePart | None) -> Scene:
    """The whole scene, given that of the equations, which may be of a part."""
    return scene if part is None else part.whole


def scene_numbers(part: ScenePart, nodes: Mapping[Body, Indices]) -> Indices:
    """Number in the scene of each node of a part, shape (n,).

    Args:
        part: The part.
        nodes: Numbers of the nodes of its bodies in the part.
    """
    found: Indices = np.empty(sum(map(len, nodes.values())), dtype=np.int64)
    for body, own in nodes.items():
        found[own] = part.nodes[body]
    return found


def _length(scene: Scene) -> float:
    """Length of the model."""
    places: Array = np.concatenate([body.frames[:, 0] for body in scene.bodies])
    return max(diameter(places), *(body.model.size for body in scene.bodies))


def part_of(scene: Scene, comm: MPI.Intracomm) -> ScenePart:
    """The part of a scene that this rank has.

    Args:
        scene: The scene, the same on all ranks.
        comm: Communicator with a rank for each part.

    Raises:
        ValueError: The scene cannot be divided into so many parts.
    """
    found = partition(scene, comm)
    bodies, nodes = _bodies(scene, found, comm.rank)
    restricted = Restricted(bodies)
    part = copy(scene)
    if scene.began.state is not None:
        part.began = scene.began._replace(state=scene.began.state.restricted(bodies))
    ours = {body for body in scene.bodies if body in bodies or found.pieces.get(body) == comm.rank}
    part.bodies = [
        bodies[body][0] if body in bodies else body for body in scene.bodies if body in ours
    ]
    here = [
        item
        for (item, acts_on), owner in zip(scene.items(), found.items, strict=True)
        if owner == comm.rank or (owner < 0 and any(body in ours for body in acts_on))
    ]
    own = {id(item) for item in here}
    for name in "joints", "connections", "links", "contacts", "loads", "clamps", "motions":
        chosen = [item for item in getattr(scene, name) if id(item) in own]
        setattr(part, name, [restricted.item(item) for item in chosen])
    changed: list[Any] = [*scene.switched, *scene.scaled]
    items = {item: restricted.item(item) for item in changed if id(item) in own}
    # what happens in a run concerns the whole scene; its part has what can be changed
    part.events, part.sensors, part.controllers = [], [], []
    part.initial_factors = {items[k]: start for k, start in scene.scaled.items() if k in items}
    part.switched_by_events = [items[k] for k in scene.switched_by_events if k in items]
    part.family = None
    mine = found.division.nodes[:, comm.rank]
    sharers = {
        rank: np.flatnonzero(mine & found.division.nodes[:, rank])
        for rank in range(comm.size)
        if rank != comm.rank
    }
    return ScenePart(
        part,
        scene,
        nodes,
        {rank: shared for rank, shared in sharers.items() if len(shared)},
        np.flatnonzero([id(item) in own for item in connections_of(scene)]),
        np.flatnonzero([id(item) in own for item in scene.contacts]),
        owners(scene.bodies, found),
        items,
        _length(scene),
        sum(len(body.frames) for body in scene.bodies),
        comm,
    )


def _bodies(
    scene: Scene, found: Partition, rank: int
) -> tuple[dict[Body, tuple[Body, Indices]], dict[Body, Indices]]:
    """Parts of divided bodies with the numbers of their nodes in the body, and all in the scene."""
    holds = scene.held_rotations()
    parts: dict[Body, tuple[Body, Indices]] = {}
    nodes: dict[Body, Indices] = {}
    for body in scene.bodies:
        if body in found.cells:
            cells = np.flatnonzero(found.cells[body] == rank)
            if len(cells):
                part = copy(body)
                part.model, own = body.model.restricted(cells, holds.get(body.model, ()))
                parts[body] = part, own
                nodes[part] = found.first[body] + own
        elif found.pieces[body] == rank:
            nodes[body] = found.first[body] + np.arange(len(body.frames))
    return parts, nodes

"""Results of a divided scene, put together from the parts of all ranks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, TypeVar

from mpi4py import MPI

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import JointInfo, SceneInfo, SupportInfo
from fem_lie.parts.part_scene import ScenePart, connections_of
from fem_lie.results.record import FrictionForces, with_others
from fem_lie.results.states import StateSeries, nodes_in
from fem_lie.scene import Scene
from fem_lie.scene.load import strained_bodies

_SUMS = (
    *("kinetic", "elastic", "potential", "momentum", "angular_momentum", "balance", "impulses"),
    *("invariants", "first"),
)
"""Quantities of a scene that are sums over its parts; the last two are in checkpoints: what runs
compute together, and energies of the first row."""

Series = TypeVar("Series", bound=StateSeries)


def gathered(result: Series, part: ScenePart | None) -> Series:
    """Result of the whole scene on all ranks, with the nodes numbered body after body.

    Args:
        result: Result of the part of this rank.
        part: The part; ``None``: the result is that of the whole scene.
    """
    if part is None:
        return result
    found, kept = Gathering(result.info, part), vars(result)
    others: dict[str, Any] = {"info": found.info}
    if "friction" in kept:
        others["friction"] = found.friction(kept["friction"])
    for name in found.names:
        if kept.get(name) is not None:
            others[name] = _on_all(part.comm, found.on_first(name, kept[name]))
    return with_others(result, others)


def of_part(
    values: Array, info: SceneInfo, part: ScenePart | None, nodes: Mapping[Body, Indices]
) -> Array:
    """Values of all nodes of a scene, in the numbering of the equations of a part.

    Args:
        values: Values of the nodes of the scene, shape (k, N, …).
        info: Bodies whose nodes these are.
        part: What this rank has of the scene; ``None``: all.
        nodes: Numbers of the nodes of each body in the equations.

    Raises:
        ValueError: They are not the bodies of the scene.
    """
    if part is None:
        return info.renumbered(values, nodes)
    whole = SceneInfo.of(part.whole.bodies)
    if [(b.name, len(b.nodes)) for b in whole.bodies] != [
        (b.name, len(b.nodes)) for b in info.bodies
    ]:
        raise ValueError("expected a result of this scene, got one with other bodies")
    values = info.renumbered(values, _numbers(part, whole))
    found = np.empty((len(values), sum(map(len, nodes.values())), *values.shape[2:]))
    for body, numbers in nodes.items():
        found[:, numbers] = values[:, part.nodes[body]]
    return found


def _numbers(part: ScenePart, info: SceneInfo) -> dict[Body, Indices]:
    """Numbers of the nodes of each body of the whole scene."""
    pairs = zip(part.whole.bodies, info.bodies, strict=True)
    return {body: own.nodes for body, own in pairs}


def _on_all(comm: MPI.Intracomm, values: Array) -> Array:
    """Array of the first rank on all ranks."""
    shape = comm.bcast(values.shape)
    found = values if comm.rank == 0 else np.empty(shape)
    for state in range(len(found)):  # MPI counts what it sends by 32 bits
        comm.Bcast(found[state : state + 1])
    return found


class Gathering:
    """Values of the nodes, joints and supports of all parts in the whole scene.

    Attributes:
        info: Bodies, joints and supports of the whole scene.
        nodes: Numbers of the nodes of the part in the scene, shape (n,).
        part: The part of this rank.
    """

    def __init__(self, info: SceneInfo, part: ScenePart) -> None:
        """Find the numbers; all ranks together.

        Args:
            info: Bodies, joints and supports of the part of this rank.
            part: The part.
        """
        self.part, self._own = part, info
        numbers = {body.name: nodes for body, nodes in part.nodes.items()}
        self.nodes: Indices = np.empty(sum(len(body.nodes) for body in info.bodies), np.int64)
        for body in info.bodies:
            self.nodes[body.nodes] = numbers[body.name]
        whole = SceneInfo.of(part.whole.bodies)
        self._supports: Indices = np.unique(self._all(self.nodes[info.supports.at]))
        bodies = zip(part.whole.bodies, whole.bodies, strict=True)
        self.info = replace(
            whole,
            bodies=tuple(replace(own, owners=part.owners.get(body)) for body, own in bodies),
            parts=part.comm.size if part.owners else None,
            joints=self._joints(),
            mass=float(part.comm.allreduce(info.mass)),
            supports=self._held(),
            strained=strained_bodies(part.whole.loads),
        )
        ways: dict[str, Callable[[Array], Array]] = {
            "frames": self.of_nodes,
            "velocities": self.of_nodes,
            "joint_forces": self._of_joints,
            "joint_violations": self._of_joints,
            "joint_coordinates": self._coordinates,
            "reactions": self._reactions,
        }
        self._ways = ways | dict.fromkeys(_SUMS, self.sum)
        self.names = (*self._ways,)

    def _all(self, values: Array | Indices) -> Any:
        """Values of all ranks, one after the other."""
        return np.concatenate(self.part.comm.allgather(values))

    def _joints(self) -> tuple[JointInfo, ...]:
        own = [
            replace(joint, node=joint.node if joint.node < 0 else int(self.nodes[joint.node]))
            for joint in self._own.joints
        ]
        numbers = (int(number) for number in self.part.connections)
        pairs = self.part.comm.allgather(dict(zip(numbers, own, strict=True)))
        found = {number: joint for each in pairs for number, joint in each.items()}
        first, joints = 0, []
        for number in range(len(connections_of(self.part.whole))):
            joints.append(replace(found[number], first=first))
            first += len(found[number].coordinates)
        return tuple(joints)

    def _held(self) -> SupportInfo:
        own = self._own.supports
        nodes: Indices = self._all(self.nodes[own.nodes])
        held: Indices = self._all(self.nodes[own.at[own.rows]])
        nodes, first = np.unique(nodes, return_index=True)
        rows = np.searchsorted(self._supports, held[first])
        return SupportInfo(self._supports, nodes, rows)

    # --- values, the first axis is the state; on the other ranks there are none ---

    def on_first(self, name: str, values: Array) -> Array:
        """A quantity of the whole scene, on the first rank; all ranks together.

        Args:
            name: Its name in a result; those that are no sums or lists are the same on all ranks.
            values: That of the part, the first axis is the state.
        """
        return self._ways[name](values) if name in self._ways else values

    def rows(self, rows: Mapping[str, Array]) -> dict[str, Array]:
        """Quantities of the whole scene by name, as :meth:`on_first`."""
        return {name: self.on_first(name, values) for name, values in rows.items()}

    def of_nodes(self, values: Array, nodes: Indices | None = None) -> Array:
        """Values of all nodes of the scene; nan where no part has any.

        Args:
            values: Those of the nodes of the part, shape (states, n, …).
            nodes: Numbers of these nodes in the scene; default: :attr:`nodes`.
        """
        comm, shape = self.part.comm, values.shape[2:]
        numbers = comm.gather(self.nodes if nodes is None else nodes)
        if numbers is None:
            for state in values:
                comm.Gatherv(np.ascontiguousarray(state), None)
            return np.empty((0, *values.shape[1:]))
        size, at = int(np.prod(shape, dtype=np.int64)), np.concatenate(numbers)
        pieces = np.empty((len(at), *shape))
        found = np.full((len(values), self.part.total, *shape), np.nan)
        for state, own in enumerate(values):  # memory of the whole is not there more than once
            comm.Gatherv(np.ascontiguousarray(own), (pieces, [size * len(n) for n in numbers]))
            found[state, at] = pieces
        return found

    def sum(self, values: Array) -> Array:
        """Sum over all parts."""
        found = self.part.comm.reduce(values)
        return np.empty((0, *values.shape[1:])) if found is None else np.asarray(found)

    def friction(self, own: FrictionForces | None) -> FrictionForces | None:
        """Friction forces of all parts, on all ranks; ``None`` if no contact has any.

        Args:
            own: Those of the part, whose contacts have other numbers.
        """
        pairs = zip(self._keys(self._own, self.part.scene), self.part.contacts, strict=True)
        numbers, rows = dict(pairs), None if own is None else own.each
        ours = [] if rows is None else [numbers[int(key)] for key in rows[:, 1]]
        pieces = self.part.comm.allgather((np.array(ours, dtype=np.int64), rows))
        known = [(of, each) for of, each in pieces if each is not None]
        if not known:
            return None
        of, each = (np.concatenate(pair) for pair in zip(*known, strict=True))
        each[:, 1] = np.array(self._keys(self.info, self.part.whole), dtype=np.float64)[of]
        return FrictionForces(each[np.lexsort((of, each[:, 0]))])

    def own_friction(self, whole: Array) -> Array:
        """Rows of :class:`.FrictionForces` of the part, from those of the scene; see :meth:`own`.

        Args:
            whole: Rows of all contacts of the scene.
        """
        keys = np.array(self._keys(self.info, self.part.whole), dtype=np.float64)
        own = keys[self.part.contacts]
        new = np.array(self._keys(self._own, self.part.scene), dtype=np.float64)
        found = whole[np.isin(whole[:, 1], own)].copy()
        order = np.argsort(own)
        found[:, 1] = new[order][np.searchsorted(own[order], found[:, 1])]
        return found

    @staticmethod
    def _keys(info: SceneInfo, scene: Scene) -> list[int]:
        """What identifies each contact of a scene in a result."""
        nodes = {body: nodes_in(info, body) for body in scene.bodies}
        return [each.key(nodes.__getitem__) for each in scene.contacts]

    def _of_joints(self, values: Array) -> Array:
        pieces = self.part.comm.gather((self.part.connections, values))
        found = np.empty((len(values), len(self.info.joints), *values.shape[2:]))
        for joints, part in pieces or ():
            found[:, joints] = part
        return found

    @cached_property
    def columns(self) -> list[int]:
        """Coordinates of the joints of the part among those of the scene."""
        joints = [self.info.joints[k] for k in self.part.connections]
        return [joint.first + k for joint in joints for k in range(len(joint.coordinates))]

    def _coordinates(self, values: Array) -> Array:
        at = self.columns
        total = sum(len(joint.coordinates) for joint in self.info.joints)
        found = np.empty((len(values), total))
        for columns, part in self.part.comm.gather((at, values)) or ():
            found[:, columns] = part
        return found

    def _reactions(self, values: Array) -> Array:
        """Sums of the reactions of all parts at each support."""
        found = np.zeros((len(values), len(self._supports), 6))
        found[:, self._support_rows] = values  # one of each part at a node
        return self.sum(found)

    @property
    def _support_rows(self) -> Indices:
        """Supports of the part among those of the scene."""
        return np.searchsorted(self._supports, self.nodes[self._own.supports.at])

    # --- the way back ---

    def own(self, name: str, values: Array) -> Array:
        """Quantity of the part whose :meth:`on_first` is that of the scene; all ranks together.

        A sum is that of one part, and zero for the others.

        Args:
            name: Its name in a result.
            values: That of the scene, the same on all ranks, the first axis is the state.
        """
        if name in ("frames", "velocities"):
            return values[:, self.nodes]
        if name in ("joint_forces", "joint_violations"):
            return values[:, self.part.connections]
        if name == "joint_coordinates":
            return values[:, self.columns]
        if name == "reactions":
            rows, comm = self._support_rows, self.part.comm
            earlier = comm.allgather(rows)[: comm.rank]
            found = values[:, rows]
            found[:, np.isin(rows, np.concatenate([rows[:0], *earlier]))] = 0.0
            return found
        if name in _SUMS:
            return values if self.part.comm.rank == 0 else np.zeros_like(values)
        return values


class WholeScene:
    """Bodies and nodes of a whole scene on all ranks, from its equations or those of its parts.

    Attributes:
        info: Bodies, joints and supports of the scene.
        gathering: Numbers of the nodes of the part; ``None``: it is the whole scene.
    """

    def __init__(self, info: SceneInfo, part: ScenePart | None) -> None:
        """Find the numbers; all ranks together.

        Args:
            info: Bodies, joints and supports of the part of this rank.
            part: The part; ``None``: these are those of the whole scene.
        """
        self.gathering = None if part is None else Gathering(info, part)
        self.info = info if self.gathering is None else self.gathering.info

    def on_all(self, values: Array) -> Array:
        """Real or complex values of all nodes, (k, N, …), from those of the part, (k, n, …)."""
        if self.gathering is None:
            return values
        reals = values.view(np.float64) if np.iscomplexobj(values) else values
        return _on_all(self.gathering.part.comm, self.gathering.of_nodes(reals)).view(values.dtype)

    def bodies(self, nodes: Mapping[Body, Indices]) -> Mapping[Body, Indices]:
        """Numbers of the nodes of each body of the scene, from those in the equations."""
        return nodes if self.gathering is None else _numbers(self.gathering.part, self.info)

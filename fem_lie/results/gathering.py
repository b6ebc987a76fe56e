"""Results of a divided scene, put together from the parts of all ranks."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import JointInfo, SceneInfo, SupportInfo
from fem_lie.parts.part_scene import ScenePart, connections_of
from fem_lie.results.record import with_others
from fem_lie.results.states import StateSeries

_OF_NODES = "frames", "velocities"
_OF_JOINTS = "joint_forces", "joint_violations"
_SUMS = "kinetic", "elastic", "potential", "momentum", "angular_momentum", "balance", "impulses"
"""Quantities of a scene that are sums over its parts."""

Series = TypeVar("Series", bound=StateSeries)


def gathered(result: Series, part: ScenePart | None) -> Series:
    """Result of the whole scene on all ranks, with the nodes numbered body after body.

    Args:
        result: Result of the part of this rank.
        part: The part; ``None``: the result is that of the whole scene.
    """
    if part is None:
        return result
    found = _Gathered(result, part)
    others: dict[str, Any] = {"info": found.info}
    kept = vars(result)
    for name in _OF_NODES:
        if kept.get(name) is not None:
            others[name] = found.of_nodes(kept[name])
    for name in _OF_JOINTS:
        if kept.get(name) is not None:
            others[name] = found.of_joints(kept[name])
    for name in _SUMS:
        if kept.get(name) is not None:
            others[name] = part.comm.allreduce(kept[name])
    if kept.get("joint_coordinates") is not None:
        others["joint_coordinates"] = found.coordinates(kept["joint_coordinates"])
    if kept.get("reactions") is not None:
        others["reactions"] = found.reactions(kept["reactions"])
    return with_others(result, others)


class _Gathered:
    """Numbers of the nodes, joints and supports of all parts in the whole scene.

    Attributes:
        info: Bodies, joints and supports of the whole scene.
    """

    def __init__(self, result: StateSeries, part: ScenePart) -> None:
        self._part, self._own = part, result.info
        numbers = {body.name: nodes for body, nodes in part.nodes.items()}
        self._nodes: Indices = np.empty(sum(len(body.nodes) for body in result.info.bodies), int)
        for body in result.info.bodies:
            self._nodes[body.nodes] = numbers[body.name]
        whole = SceneInfo.of(part.whole.bodies)
        self._supports: Indices = np.unique(self._all(self._nodes[result.info.supports.at]))
        self.info = replace(
            whole,
            joints=self._joints(),
            mass=float(part.comm.allreduce(result.info.mass)),
            supports=self._held(),
        )

    def _all(self, values: Array | Indices) -> Any:
        """Values of all ranks, one after the other."""
        return np.concatenate(self._part.comm.allgather(values))

    def _joints(self) -> tuple[JointInfo, ...]:
        own = [
            replace(joint, node=joint.node if joint.node < 0 else int(self._nodes[joint.node]))
            for joint in self._own.joints
        ]
        numbers = (int(number) for number in self._part.connections)
        pairs = self._part.comm.allgather(dict(zip(numbers, own, strict=True)))
        found = {number: joint for each in pairs for number, joint in each.items()}
        first, joints = 0, []
        for number in range(len(connections_of(self._part.whole))):
            joints.append(replace(found[number], first=first))
            first += len(found[number].coordinates)
        return tuple(joints)

    def _held(self) -> SupportInfo:
        own = self._own.supports
        nodes: Indices = self._all(self._nodes[own.nodes])
        held: Indices = self._all(self._nodes[own.at[own.rows]])
        nodes, first = np.unique(nodes, return_index=True)
        rows = np.searchsorted(self._supports, held[first])
        return SupportInfo(self._supports, nodes, rows)

    # --- values, the first axis is the state ---

    def of_nodes(self, values: Array) -> Array:
        """Values of all nodes of the scene."""
        found, comm = np.empty((len(values), self._part.total, *values.shape[2:])), self._part.comm
        # one part of one state at a time, as memory beyond that of the result may not be there
        for rank in range(comm.size):
            nodes = comm.bcast(self._nodes, root=rank)
            part = np.empty((len(nodes), *values.shape[2:]))
            for state in range(len(values)):
                if comm.rank == rank:
                    part[:] = values[state]
                comm.Bcast(part, root=rank)
                found[state, nodes] = part
        return found

    def of_joints(self, values: Array) -> Array:
        """Values of all joints of the scene."""
        found = np.empty((len(values), len(self.info.joints), *values.shape[2:]))
        for joints, part in self._part.comm.allgather((self._part.connections, values)):
            found[:, joints] = part
        return found

    def coordinates(self, values: Array) -> Array:
        """Coordinates of all joints."""
        joints = [self.info.joints[k] for k in self._part.connections]
        at = [joint.first + k for joint in joints for k in range(len(joint.coordinates))]
        total = sum(len(joint.coordinates) for joint in self.info.joints)
        found = np.empty((len(values), total))
        for columns, part in self._part.comm.allgather((at, values)):
            found[:, columns] = part
        return found

    def reactions(self, values: Array) -> Array:
        """Sums of the reactions of all parts at each support."""
        found = np.zeros((len(values), len(self._supports), 6))
        rows = np.searchsorted(self._supports, self._nodes[self._own.supports.at])
        found[:, rows] = values  # one of each part at a node
        return np.asarray(self._part.comm.allreduce(found))

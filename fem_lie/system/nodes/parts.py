"""Nodes of a divided scene that several ranks have, in the numbering of the equations."""

from __future__ import annotations

import numpy as np

from fem_lie.parts.part_scene import ScenePart
from fem_lie.ranks.shared_nodes import SharedNodes
from fem_lie.system.nodes.numbering import Numbering


def shared_nodes(part: ScenePart | None, numbering: Numbering) -> SharedNodes:
    """Master nodes that other ranks have, too.

    Args:
        part: What this rank has of a scene; ``None``: the scene is not divided.
        numbering: Numbering of the nodes of the part.
    """
    if part is None:
        return SharedNodes.alone(numbering.count)
    master_map = numbering.master_map
    at = np.full(part.total, -1)
    for body, numbers in part.nodes.items():
        own = numbering.nodes[body]
        leads = master_map.masters[master_map.master[own]] == own
        at[numbers[leads]] = master_map.master[own[leads]]
    # attached nodes follow from their master nodes, which all ranks have that have them
    found = {rank: at[numbers] for rank, numbers in part.sharers.items()}
    leading = {rank: nodes[nodes >= 0] for rank, nodes in found.items()}
    return SharedNodes(part.comm, numbering.count, leading)

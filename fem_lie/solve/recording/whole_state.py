"""State of a run in the numbering of the whole scene, from which any number of ranks restarts.

A divided scene has no state on one rank. What moves is gathered on the first rank for a checkpoint:
nodes body after body, multipliers joint after joint. A run that restarts from it assembles a new
matrix, so that results agree with those of an uninterrupted run to the tolerance of the iteration,
instead of bit for bit.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.results.gathering import Gathering
from fem_lie.system.equations import Equations

_FRAMES, _MOTION, _BALANCE, _TURNS = (
    "whole.frames",
    "whole.motion",
    "whole.balance",
    "whole.turns",
)
_MULTIPLIERS, _OWNERS = "whole.multipliers", "whole.owners"


class MovingState(NamedTuple):
    """What moves in a run.

    Attributes:
        frames: Frames of the moving nodes, shape (n, 4, 3).
        motion: What the scheme has of each of them, shape (k, n, 6).
        multipliers: Lagrange multipliers of the constraints, shape (m,).
        balance: Energy balance of the part, shape (15,).
    """

    frames: Array
    motion: Array
    multipliers: Array
    balance: Array


def is_whole(kept: Mapping[str, Array]) -> bool:
    """Whether a checkpoint has the state of a whole scene that was divided."""
    return _FRAMES in kept


def whole(gathering: Gathering, equations: Equations, state: MovingState) -> dict[str, Array]:
    """The state of all parts on the first rank; all ranks together.

    Args:
        gathering: Numbers of the nodes and joints of the part in the whole scene.
        equations: Equations of the part.
        state: State of the part.
    """
    comm, nodes = gathering.part.comm, gathering.nodes[equations.unknowns.masters]
    joints = gathering.part.connections[equations.arrays.owner]
    turns = comm.gather([*equations.history_variables.turns.items()])
    pairs = comm.gather((joints, state.multipliers))
    found = {
        _FRAMES: gathering.of_nodes(state.frames[np.newaxis], nodes),
        _MOTION: gathering.of_nodes(state.motion, nodes),
        _BALANCE: gathering.sum(state.balance[np.newaxis]),
    }
    if turns is None or pairs is None:
        return {}
    owners, values = (np.concatenate(each) for each in zip(*pairs, strict=True))
    order = np.argsort(owners, kind="stable")
    known = json.dumps([turn for each in turns for turn in each])
    return found | {
        _OWNERS: owners[order],
        _MULTIPLIERS: values[order],
        _TURNS: np.frombuffer(known.encode(), dtype=np.uint8),
    }


def own(gathering: Gathering, equations: Equations, kept: Mapping[str, Array]) -> MovingState:
    """State of the equations of a scene or of its part on this rank, from that of the whole scene.

    The joints of the equations get their full turns.

    Args:
        gathering: Numbers of their nodes and joints in the whole scene.
        equations: The equations.
        kept: State of the whole scene, the same on all ranks.
    """
    masters = gathering.nodes[equations.unknowns.masters]
    joints = gathering.part.connections[equations.arrays.owner]
    rows = np.searchsorted(kept[_OWNERS], joints) + _occurrences(joints)
    turns = {(name, angle): turn for (name, angle), turn in json.loads(bytes(kept[_TURNS]))}
    equations.history_variables.turns = turns
    balance = kept[_BALANCE][0]
    return MovingState(
        kept[_FRAMES][0, masters],
        kept[_MOTION][:, masters],
        kept[_MULTIPLIERS][rows],
        balance if equations.shared.comm.rank == 0 else np.zeros_like(balance),
    )


def _occurrences(numbers: Indices) -> Indices:
    """How many equal numbers come before each."""
    order = np.argsort(numbers, kind="stable")
    ordered = numbers[order]
    found = np.empty_like(order)
    found[order] = np.arange(len(order)) - np.searchsorted(ordered, ordered)
    return found

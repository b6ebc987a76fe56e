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

from mpi4py import MPI

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
_COMMON = "whole.common."  # prefix of what all ranks have in common of the equations
_CELLS, _OF_CELLS = "whole.cells", "whole.of_cells"

NO_CELLS: Indices = np.empty((0, 1), dtype=np.int64)
"""No pairs of cells and nodes, see :attr:`MovingState.cells`."""


class MovingState(NamedTuple):
    """What moves in a run.

    Attributes:
        frames: Frames of the moving nodes, shape (n, 4, 3).
        motion: What the scheme has of each of them, shape (k, n, 6).
        multipliers: What it has of each constraint, such as its multiplier, shape (j, m).
        balance: Energy balance of the part, shape (15,).
        cells: Nodes of the cell of each pair of a cell and one of its nodes, in any order, -1 where
            it has fewer, then this node; shape (c, w + 1). Pairs of cells with the same nodes have
            the same order in all divisions.
        of_cells: What the scheme has of each pair, shape (c, 12).
    """

    frames: Array
    motion: Array
    multipliers: Array
    balance: Array
    cells: Indices = NO_CELLS
    of_cells: Array = np.empty((0, 12))


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
    history = equations.history_variables
    turns = comm.gather([*history.turns.items()])
    contacts = comm.gather(history.contacts.saved_state() | history.contacts.pairs)
    # multipliers of each constraint, then whether it acts and its target, if some may be inactive
    activity = [each[np.newaxis] for each in history.activity.of_constraints.values()]
    pairs = comm.gather((joints, np.concatenate([state.multipliers, *activity]).T))
    cells, of_cells = _numbered(gathering, state.cells), comm.gather(state.of_cells)
    width = comm.allreduce(cells.shape[1], op=MPI.MAX)
    of_all = comm.gather(_padded(cells, width))
    found = {
        _FRAMES: gathering.of_nodes(state.frames[np.newaxis], nodes),
        _MOTION: gathering.of_nodes(state.motion, nodes),
        _BALANCE: gathering.sum(state.balance[np.newaxis]),
    }
    if turns is None or contacts is None or pairs is None or of_cells is None or of_all is None:
        return {}
    found |= {f"{_COMMON}{name}": values for name, values in history.activity.of_items.items()}
    found |= {name: values for each in contacts for name, values in each.items()}
    owners, values = (np.concatenate(each) for each in zip(*pairs, strict=True))
    order = np.argsort(owners, kind="stable")
    known = json.dumps([turn for each in turns for turn in each])
    return found | {
        _OWNERS: owners[order],
        _MULTIPLIERS: values[order],
        _TURNS: np.frombuffer(known.encode(), dtype=np.uint8),
        _CELLS: np.concatenate(of_all),
        _OF_CELLS: np.concatenate(of_cells),
    }


def own(
    gathering: Gathering, equations: Equations, kept: Mapping[str, Array], cells: Indices = NO_CELLS
) -> MovingState:
    """State of the equations of a scene or of its part on this rank, from that of the whole scene.

    The joints of the equations get their full turns and activity, the contacts their state.

    Args:
        gathering: Numbers of their nodes and joints in the whole scene.
        equations: The equations.
        kept: State of the whole scene, the same on all ranks.
        cells: Pairs of cells and nodes of which the scheme has something, as in
            :class:`MovingState`.
    """
    masters = gathering.nodes[equations.unknowns.masters]
    joints = gathering.part.connections[equations.arrays.owner]
    owners, pairs = (np.asarray(kept[name], dtype=np.int64) for name in (_OWNERS, _CELLS))
    rows = _rows_of(owners, joints)
    turns = {(name, angle): turn for (name, angle), turn in json.loads(bytes(kept[_TURNS]))}
    history = equations.history_variables
    history.turns = turns
    history.contacts.restore(kept)
    history.contacts.restore_pairs(kept)
    of_constraints, activity = kept[_MULTIPLIERS][rows].T, history.activity
    count = len(of_constraints) - len(activity.of_constraints)
    history.activity = activity._replace(
        of_constraints=dict(zip(activity.of_constraints, of_constraints[count:], strict=True)),
        of_items={name: kept[f"{_COMMON}{name}"] for name in activity.of_items},
    )
    balance = kept[_BALANCE][0]
    return MovingState(
        kept[_FRAMES][0, masters],
        kept[_MOTION][:, masters],
        of_constraints[:count],
        balance if equations.shared.comm.rank == 0 else np.zeros_like(balance),
        cells,
        kept[_OF_CELLS][_rows_of_cells(pairs, _numbered(gathering, cells))],
    )


def _numbered(gathering: Gathering, cells: Indices) -> Indices:
    """Pairs of cells and nodes by numbers in the whole scene, the nodes of a cell descending."""
    numbers = np.append(gathering.nodes, -1)[cells]
    return np.column_stack([np.sort(numbers[:, :-1], axis=1)[:, ::-1], numbers[:, -1]])


def _padded(pairs: Indices, width: int) -> Indices:
    """The same with ``width`` columns."""
    missing = np.full((len(pairs), width - pairs.shape[1]), -1)
    return np.column_stack([pairs[:, :-1], missing, pairs[:, -1]])


def _rows_of_cells(known: Indices, pairs: Indices) -> Indices:
    """Rows of pairs among those of the whole scene."""
    both = np.concatenate([known, _padded(pairs, known.shape[1])])
    numbers = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(numbers[: len(known)], kind="stable")
    return order[_rows_of(numbers[: len(known)][order], numbers[len(known) :])]


def _rows_of(known: Indices, numbers: Indices) -> Indices:
    """Rows of numbers, which may repeat, among known ascending ones."""
    return np.searchsorted(known, numbers) + _occurrences(numbers)


def _occurrences(numbers: Indices) -> Indices:
    """How many equal numbers come before each."""
    order = np.argsort(numbers, kind="stable")
    ordered = numbers[order]
    found = np.empty_like(order)
    found[order] = np.arange(len(order)) - np.searchsorted(ordered, ordered)
    return found

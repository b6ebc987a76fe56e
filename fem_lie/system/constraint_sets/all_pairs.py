"""Relative motions of a scene, between nodes and attachment frames, in one record.

Conserving schemes use it: they compute forces over a step from the motion of frames, and need to
know which nodes act by their position only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeGuard

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.joints.equations.functions import DISTANCE
from fem_lie.joints.equations.joint_arrays import JointArrays, PackedJoints, pack
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet
from fem_lie.system.constraint_sets.on_attachments import OnAttachments
from fem_lie.system.constraint_sets.relative_motions import RelativeMotions
from fem_lie.system.nodes.held_attachments import HeldAttachments
from fem_lie.system.nodes.numbering import Numbering

_NO_ARM = 1e-9
"""Smallest moment arm of a point, over the extent of a scene."""


class AllPairs(NamedTuple):
    """Pairs whose rows are the moving nodes, then attachments, ground and prescribed motions.

    Attributes:
        joints: The joints; frames of which only positions matter may rotate arbitrarily.
        tables: Arrays of the sets from which the joints are copied.
        attachments: The attachment frames.
        oriented: Nodes and attachments of which more than the position matters, shape (n + g,).
        turns: Whether any angle is counted beyond a full turn.
        loose: Whether axes matter that do not rotate with their node or attachment.
        other_springs: Descriptions of sets with springs whose pairs are not here.
    """

    joints: PackedJoints
    tables: Sequence[JointArrays]
    attachments: HeldAttachments
    oriented: Flags
    turns: bool
    loose: bool
    other_springs: Sequence[str]


def all_pairs(
    sets: Sequence[ConstraintSet], numbering: Numbering, frames: Array, kinds: Indices
) -> AllPairs:
    """Pairs of all sets of relative motions whose attachments have frames over a step.

    They come first. If an attachment is between frames, its set is not among them.

    Args:
        sets: Sets of a system; the first is that of nodes.
        numbering: Numbering of the nodes.
        frames: Initial frames of all nodes, ground and prescribed motions.
        kinds: Types of the nodes.
    """
    attached = [each for each in sets[1:2] if _in_pairs(each)]
    parts = [sets[0], *(each.inner for each in attached)]
    tables = [each.arrays for each in parts if isinstance(each, RelativeMotions)]
    attachments = (
        attached[0].constrained.attachments if attached else HeldAttachments([], numbering)
    )
    n, g = numbering.count, attachments.count
    rows = [np.concatenate([np.arange(n), np.arange(n, len(frames)) + g])]
    for each in attached:
        rows.append(
            np.concatenate([each.constrained.moving, n + np.arange(g), each.constrained.fixed + g])
        )
    table = _joined(tables, rows)
    oriented = _oriented(
        table, n + g, _NO_ARM * float(np.ptp(frames[:, 0], axis=0).max(initial=0.0))
    )
    table.frames[:, :, 0][
        ~np.append(oriented, np.ones(len(frames) - n, dtype=bool))[table.nodes]
    ] = 0.0
    whole = np.append(kinds < POSITION_GRADIENT, [kind.turns for kind in attachments.kinds]).astype(
        bool
    )
    turns, loose = bool(table.functions.any()), bool((oriented & ~whole).any())
    springs = [each.what for each in sets[len(parts) :] if len(each.springs)]
    return AllPairs(pack(table), tables, attachments, oriented, turns, loose, springs)


def _in_pairs(given: ConstraintSet) -> TypeGuard[OnAttachments]:
    """Whether a set has relative motions of attachments that are sums over their nodes."""
    if not (isinstance(given, OnAttachments) and isinstance(given.inner, RelativeMotions)):
        return False
    return all(kind.summed for kind in given.constrained.attachments.kinds)


def _joined(tables: Sequence[JointArrays], rows: Sequence[Indices]) -> JointArrays:
    """Concatenate the arrays: constraints first, then the springs of all."""
    m = sum(len(table.targets) for table in tables)
    row, springs, terms = 0, m, 0
    of_terms: list[Indices] = []
    first: list[Indices] = [np.zeros(1, dtype=np.int64)]
    for table in tables:
        size = len(table.targets)
        of_terms.append(table.rows + np.where(table.rows < size, row, springs - size))
        first.append(table.first[1:] + terms)
        row, springs, terms = row + size, springs + len(table.springs), terms + len(table.rows)
    own = zip(tables, rows, strict=True)
    joined = {
        name: np.concatenate([getattr(table, name) for table in tables])
        for name in (
            "frames",
            "selection",
            "functions",
            "angle",
            "curved",
            "turned",
            "springs",
            "data",
        )
    }
    data = np.cumsum([0, *(len(table.data) for table in tables)])
    pairs = np.cumsum([0, *(len(table.nodes) for table in tables)])
    return JointArrays(
        nodes=np.concatenate([numbers[table.nodes] for table, numbers in own]),
        first=np.concatenate(first),
        rows=np.concatenate(of_terms),
        incidences=np.full((terms, 2), -1, dtype=np.int64),
        targets=np.zeros(m),
        laws=np.concatenate(
            [_moved(table.laws, *at) for table, *at in zip(tables, data, pairs, strict=False)]
        ),
        clock=np.zeros(1),
        **joined,
    )


def _moved(laws: Indices, data: int, pair: int) -> Indices:
    """Laws (k, 5) after more ``data`` and pairs."""
    joints = np.where(laws[:, 3] >= 0, laws[:, 3] + pair, -1)
    return np.column_stack([laws[:, 0], laws[:, 1:3] + data, joints, laws[:, 4]])


def _oriented(table: JointArrays, count: int, short: float) -> Flags:
    """Rows, of ``count``, of which more than the position matters.

    Side A matters with its rotation if some but not all components of the gap are constrained along
    its axes; distances, and gaps constrained in all directions, do not depend on it.
    """
    oriented, m = np.zeros(count, dtype=bool), len(table.targets)
    for j in range(len(table.nodes)):
        own = slice(table.first[j], table.first[j + 1])
        S, c = table.selection[own], table.functions[own]
        turned = bool(S[:, 3:].any() or np.delete(c, DISTANCE, axis=1).any())
        partly = bool(S[:, :3].any())
        if partly and (table.rows[own] < m).all() and not c.any():
            partly = bool(np.linalg.matrix_rank(S[:, :3]) < 3)
        for side, row in enumerate(table.nodes[j].tolist()):
            arm = bool(np.abs(table.frames[j, side, 0]).max() > short)
            if row < count:
                oriented[row] |= turned or arm or (side == 0 and partly)
    return oriented

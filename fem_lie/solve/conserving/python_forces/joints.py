"""Joints, springs and drives over steps, on nodes of any type and on attachments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.balances import BY_REACTIONS, DAMPING, WORK
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays, views
from fem_lie.joints.equations.terms import spring_energy, unwrap, violations
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.solve.conserving.python_forces.attachments import (
    AttachmentSpan,
    NodalSpan,
    give,
    set_attachments,
    set_nodes,
)
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.solve.conserving.step.records import Model, Span, State, Step
from fem_lie.solve.conserving.vector_cells.cell_arrays import VectorCells
from fem_lie.solve.conserving.vector_cells.force_changes import weigh_cells
from fem_lie.system.equations import Equations

_BACK = 1e-3
"""Fraction of the constraint violation that is removed in each step."""


class _Rows(NamedTuple):
    """Nodes, attachments, ground and prescribed motions over a step.

    Attributes:
        mean: Means of positions and axes, (L, 4, 3).
        delta: Increments.
        forces: Forces and moments on nodes and attachments, (n + g, 6).
    """

    mean: Array
    delta: Array
    forces: Array


class _Nodes(NamedTuple):
    """All nodes over a step.

    Attributes:
        H: Nodal coordinates at the start, (≥ n, 4, 3).
        rest: Their digits beyond double precision, (n, 4, 3).
        moved: Means, increments and midpoints.
        step: Increments, (n, 6).
    """

    H: Array
    rest: Array
    moved: NodalSpan
    step: Array


class _Sums(NamedTuple):
    """Sums to which joints add.

    Attributes:
        change: Increments of constraints, (m,).
        losses: See :class:`~fem_lie.solve.conserving.step.records.Step`.
        outer: Forces along increments, (n, 6).
    """

    change: Array
    losses: Array
    outer: Array


@compiled
def _add_forces(
    kinds: Indices,
    joints: PackedJoints,
    span: AttachmentSpan,
    nodes: _Nodes,
    rows: _Rows,
    multipliers: Array,
    driven: Array,
    h: float,
    sums: _Sums,
) -> None:
    """Add forces of joints to ``sums``."""
    n, g = nodes.step.shape[0], span.turns.shape[0]
    (mean, delta, forces), losses = rows, sums.losses
    set_nodes(kinds, nodes.moved, nodes.step, mean, delta)
    around = nodes.H, nodes.rest, nodes.moved.middle, nodes.step
    set_attachments(span, around, mean[n : n + g], delta[n : n + g])
    forces[:] = 0.0
    work, loss = add_joints(
        mean,
        delta,
        joints,
        multipliers,
        driven,
        h,
        sums.change,
        forces,
        losses[BY_REACTIONS:],
    )
    losses[WORK] += work
    losses[DAMPING] += loss
    give(kinds, span, nodes.moved.middle, forces, sums.outer)


@compiled
def _unwrap(joints: PackedJoints, frames: Array) -> None:
    unwrap(frames, joint_arrays(joints))


@compiled
def _violations(joints: PackedJoints, frames: Array, out: Array) -> None:
    violations(frames, joint_arrays(joints), out)


@compiled
def _spring_energy(joints: PackedJoints, frames: Array) -> float:
    arrays = joint_arrays(joints)
    return spring_energy(frames, arrays) if len(arrays.springs) > 0 else 0.0


class Joints:
    """All joints of a scene.

    Attributes:
        needed: Whether any of them acts on an attachment or on a node other than a frame.
        on_attachments: Whether any of them acts on an attachment.
        count: Number of their constraints, the first of the scene.
        reached: Constraint values at the start, and accumulated increments of their targets,
            (count,).
    """

    def __init__(self, equations: Equations) -> None:
        """Compute the initial metric of the attachments."""
        pairs = equations.arrays.pairs_of_all
        assert pairs is not None, "some nodes have vector coordinates"
        self.count = len(views(pairs.joints).targets)
        self._pairs, self._attachments = pairs, pairs.attachments
        n, attachments = equations.unknowns.moving, pairs.attachments
        self._n, self.kinds = n, equations.arrays.kinds
        held = views(pairs.joints).nodes
        straight = np.append(
            self.kinds >= POSITION_GRADIENT, np.ones(attachments.count, dtype=bool)
        )
        self.needed = bool(straight[held[held < len(straight)]].any())
        self.on_attachments = attachments.count > 0
        frames = equations.start.frames
        fixed = frames[n:]
        first = np.searchsorted(attachments.of, np.arange(attachments.count + 1))
        cells = VectorCells(
            np.zeros((attachments.count, 2, 4), dtype=np.int64),
            first,
            attachments.nodes,
            self.kinds[attachments.nodes],
            np.zeros((len(attachments.nodes), 2)),
            np.zeros(attachments.count, dtype=np.int64),
            np.zeros(attachments.count),
        )
        weigh_cells(cells, equations.unknowns.lengths, frames, np.zeros_like(frames))
        located, J = attachments.locate(frames)
        entries = len(attachments.nodes)
        self._span = AttachmentSpan(
            cells,
            pairs.oriented[n:],
            located,
            located.copy(),
            located.copy(),
            J,
            np.zeros((attachments.count, 3)),
            np.zeros((entries, 2, 3)),
        )
        rows = np.concatenate([frames[:n], located, fixed])
        on = np.zeros((n + attachments.count, 6))
        self._rows = _Rows(rows, np.zeros_like(rows), on)
        self.reached = np.zeros(self.count)
        _violations(pairs.joints, rows, self.reached)

    def begin(self, H: Array) -> None:
        """Begin a step from nodes ``H``."""
        self._span.start[:] = self._attachments.locate(H)[0]

    def add_forces(self, model: Model, state: State, this: Step, h: float) -> None:
        """Add forces to ``this.outer``; compute increments of constraints, and balances."""
        span, rows, along, n = self._span, self._rows, Span(*this.coordinates), self._n
        span.middle[:], span.J[:] = self._attachments.locate(along.middle)
        if span.turns.any():
            span.end[:] = self._attachments.locate(along.end)[0]
        fixed = slice(len(rows.forces), None)
        rows.mean[fixed], rows.delta[fixed] = along.mean[n:], along.delta[n:]
        moved = NodalSpan(along.mean, along.delta, along.middle)
        nodes = _Nodes(state.H, state.rest, moved, this.step)
        own = slice(self.count)
        sums = _Sums(this.change[own], this.losses, this.outer)
        packed, multipliers, driven = self._pairs.joints, state.multipliers[own], model.driven[own]
        _add_forces(self.kinds, packed, span, nodes, rows, multipliers, driven, h, sums)

    def accept(self, H: Array, driven: Array, gap: Array) -> None:
        """Count revolutions at nodes ``H``, and correct ``gap`` (m,) towards the violation there.

        ``gap`` is a sum of increments, whose round-off accumulates if that of an attachment's
        rotation is systematic. The violation at the nodes has the round-off of a single state only,
        so a small fraction of the difference is removed in each step.

        Args:
            H: Nodes at the end of a step.
            driven: Increments of the targets in it, (m,).
            gap: Constraint violations, updated.
        """
        frames, found, own = self._all(H), np.empty(self.count), slice(self.count)
        if self._pairs.turns:
            _unwrap(self._pairs.joints, frames)
        _violations(self._pairs.joints, frames, found)
        self.reached += driven[own]
        gap[own] += _BACK * (found - self.reached - gap[own])

    def restart(self, H: Array, gap: Array) -> None:
        """Restart at nodes ``H`` with these constraint violations (m,).

        Counted angles are those of the history variables of the equations.
        """
        turned = views(self._pairs.joints).turned
        turned[:] = np.concatenate([table.turned for table in self._pairs.tables])
        _violations(self._pairs.joints, self._all(H), self.reached)
        self.reached -= gap[: self.count]

    def energy(self, H: Array) -> float:
        """Energy of springs at nodes ``H``."""
        return _spring_energy(self._pairs.joints, self._all(H))

    def _all(self, H: Array) -> Array:
        """Frames of nodes, attachments, ground and prescribed motions."""
        return np.concatenate([H[: self._n], self._attachments.locate(H)[0], H[self._n :]])

    def saved_state(self) -> dict[str, Array]:
        """State for the next steps: counted angles, and :attr:`reached`."""
        turned = views(self._pairs.joints).turned
        return {"turned": turned.copy(), "reached": self.reached.copy()}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        views(self._pairs.joints).turned[:] = kept["turned"]
        self.reached[:] = kept["reached"]

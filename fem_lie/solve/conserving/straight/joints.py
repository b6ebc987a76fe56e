"""Joints, springs and drives over steps of nodes of any kind: on nodes and on grips."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.balances import BY_REACTIONS, DAMPING, WORK
from fem_lie.joints.equations.table import PackedJoints, joint_table, views
from fem_lie.joints.equations.terms import spring_energy, unwrap, violations
from fem_lie.solve.conserving.rows.halves import CellTable
from fem_lie.solve.conserving.rows.measure import weigh_cells
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.solve.conserving.straight.grips import GripSpan, give, set_grips, set_nodes
from fem_lie.solve.conserving.straight.records import State, Step
from fem_lie.system.equations import Equations

_BACK = 1e-3
"""Of what is seen of constraints, counted in each step."""


class _Rows(NamedTuple):
    """Nodes, grips, ground and prescribed motions over a step.

    Attributes:
        mean: Of places and axes, (L, 4, 3).
        delta: Increments.
        forces: And moments on nodes and grips, (n + g, 6).
    """

    mean: Array
    delta: Array
    forces: Array


@compiled
def _add_forces(
    kinds: Indices,
    joints: PackedJoints,
    span: GripSpan,
    state: State,
    this: Step,
    rows: _Rows,
    driven: Array,
    h: float,
) -> None:
    """Add forces of joints to ``this.outer``; increments of constraints, and books."""
    n, g = this.step.shape[0], span.turns.shape[0]
    mean, delta, forces = rows
    set_nodes(kinds, this, mean, delta)
    nodes = state.H, state.rest, this.middle, this.step
    set_grips(span, nodes, mean[n : n + g], delta[n : n + g])
    forces[:] = 0.0
    losses = this.losses
    work, loss = add_joints(
        mean,
        delta,
        joints,
        state.weights,
        driven,
        h,
        this.change,
        forces,
        losses[BY_REACTIONS:],
    )
    losses[WORK] += work
    losses[DAMPING] += loss
    give(kinds, span, this.middle, forces, this.outer)


@compiled
def _unwrap(joints: PackedJoints, frames: Array) -> None:
    unwrap(frames, joint_table(joints))


@compiled
def _violations(joints: PackedJoints, frames: Array, out: Array) -> None:
    violations(frames, joint_table(joints), out)


@compiled
def _spring_energy(joints: PackedJoints, frames: Array) -> float:
    table = joint_table(joints)
    return spring_energy(frames, table) if len(table.springs) > 0 else 0.0


class Joints:
    """All joints of a scene.

    Attributes:
        any: Whether there are any.
        driven: Increments of the targets in the present step, (m,).
        reached: Values of the constraints at the start, and of these increments, (m,).
        moved: Frames of prescribed motions at both ends of the step, (2, p, 4, 3).
    """

    def __init__(self, equations: Equations) -> None:
        """Measure the grips at the start."""
        pairs = equations.tables.pairs_of_all
        assert pairs is not None, "refused before"
        self._pairs, self._grips = pairs, pairs.grips
        n, grips = equations.unknowns.moving, pairs.grips
        self._n, self.kinds = n, equations.tables.kinds
        self.any = len(views(pairs.joints).nodes) > 0
        self.driven = np.zeros(equations.unknowns.m)
        frames = equations.start.frames
        fixed = frames[n:]
        self.moved = np.stack([fixed[1:], fixed[1:]])
        first = np.searchsorted(grips.of, np.arange(grips.count + 1))
        cells = CellTable(
            np.zeros((grips.count, 2, 4), dtype=np.int64),
            first,
            grips.nodes,
            self.kinds[grips.nodes],
            np.zeros((len(grips.nodes), 2)),
            np.zeros(grips.count, dtype=np.int64),
            np.zeros(grips.count),
        )
        weigh_cells(cells, equations.unknowns.lengths, frames, np.zeros_like(frames))
        located, J = grips.locate(frames)
        entries = len(grips.nodes)
        self._span = GripSpan(
            cells,
            pairs.seen[n:],
            located,
            located.copy(),
            located.copy(),
            J,
            np.zeros((grips.count, 3)),
            np.zeros((entries, 2, 3)),
        )
        rows = np.concatenate([frames[:n], located, fixed])
        on = np.zeros((n + grips.count, 6))
        self._rows = _Rows(rows, np.zeros_like(rows), on)
        self.reached = np.zeros(equations.unknowns.m)
        if self.any:
            _violations(pairs.joints, rows, self.reached)

    def begin(self, H: Array) -> None:
        """A step from rows ``H``."""
        self._span.start[:] = self._grips.locate(H)[0]
        before, after = self.moved
        here = slice(len(self._rows.forces) + 1, None)
        self._rows.mean[here], self._rows.delta[here] = 0.5 * (before + after), after - before

    def add_forces(self, state: State, this: Step, h: float) -> None:
        """Add forces to ``this.outer``; increments of constraints, and books."""
        span = self._span
        span.middle[:], span.J[:] = self._grips.locate(this.middle)
        if span.turns.any():
            span.end[:] = self._grips.locate(this.end)[0]
        packed, rows = self._pairs.joints, self._rows
        _add_forces(self.kinds, packed, span, state, this, rows, self.driven, h)

    def accept(self, H: Array, gap: Array) -> None:
        """Count turns at rows ``H``, and lead ``gap`` (m,) to what constraints miss there.

        It is a sum of increments, whose round-off adds up where a grip's rotation has it each time.
        What is seen at the rows has that of single states, so it counts a little each time.
        """
        if not self.any:
            return
        frames, found = self._all(H), np.empty_like(gap)
        if self._pairs.turns:
            _unwrap(self._pairs.joints, frames)
        _violations(self._pairs.joints, frames, found)
        self.reached += self.driven
        gap += _BACK * (found - self.reached - gap)

    def energy(self, H: Array) -> float:
        """Of springs at rows ``H``."""
        return _spring_energy(self._pairs.joints, self._all(H))

    def _all(self, H: Array) -> Array:
        """Rows of nodes, grips, ground and prescribed motions."""
        return np.concatenate([H[: self._n], self._grips.locate(H)[0], H[self._n :]])

    @property
    def turned(self) -> Array:
        """Angles that are counted, to be written into."""
        return views(self._pairs.joints).turned

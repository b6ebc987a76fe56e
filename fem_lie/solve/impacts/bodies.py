"""Jacobians, compliance and constraints of jointed and flexible bodies for contacts by impacts."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.cones.jacobian import BlockRows, empty_rows, twist_rates
from fem_lie.contact.contact import Contact
from fem_lie.contact.impact.rows import append_rows, set_gaps
from fem_lie.contact.impact.touching import Touching
from fem_lie.contact.sides.table import on_masters
from fem_lie.lie.node_types import all_to_group, move_all
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.solve.impacts.delassus import islands_of
from fem_lie.solve.impacts.impulses import Impulses
from fem_lie.solve.impacts.step_end import Factors, Rule
from fem_lie.system.equations import Equations, TimeState


class CoupledBodies:
    """Bodies of a run with contacts by impacts.

    Attributes:
        near: Contact pairs near each other.
    """

    def __init__(
        self,
        contacts: Sequence[Contact],
        equations: Equations,
        rule: Rule,
        kept: Factors | None,
    ) -> None:
        """Collect bodies and contacts.

        Args:
            contacts: All contacts by impacts.
            equations: Equations of the scene without contacts; their matrix is overwritten.
            rule: Relation of velocities and accelerations at the end of a step to its increment.
            kept: Factors of the iteration matrix; ``None`` for scenes without elements.
        """
        unknowns, arrays, start = equations.unknowns, equations.arrays, equations.start
        self._equations, self._rule, self._kept = equations, rule, kept
        self._h = rule.h
        self._n, self._m, self._kinds = unknowns.moving, unknowns.m, unknowns.kinds
        self._rows, self._length = len(start.frames), unknowns.length
        self._free, self._known = ~unknowns.held.ravel(), -1
        # ground and prescribed motions are frames
        self._all_kinds = np.append(self._kinds, np.zeros(self._rows - self._n, dtype=np.int64))
        self.near = Touching(
            contacts,
            unknowns.bodies.__getitem__,
            np.full(self._rows, unknowns.length),
            start.frames,
            partial(on_masters, master=arrays.master, offset=arrays.offset),
            self._all_kinds < POSITION_GRADIENT,
        )
        sides = self.near.touch.a, self.near.touch.b
        self._width = sum(int((side.nodes >= 0).sum(axis=1).max()) for side in sides)
        self._impulses = Impulses(equations, rule.h)
        self._r = np.zeros(unknowns.size)
        none = self._still = np.zeros((self._n, 6))
        self._forces = equations.residual(
            TimeState(start.frames, none, none, np.zeros(self._m)), np.ones(self._m), self._r
        )

    def set_rule(self, rule: Rule) -> None:
        """Change the relation of velocities and accelerations to the increment."""
        self._rule, self._h = rule, rule.h
        self._impulses.resize(rule.h)

    def _all_rows(self, v: Array, time: float) -> Array:
        """Twists of all nodes, of ground and of prescribed motions, shape (r, 6)."""
        found = np.zeros((self._rows, 6))
        found[: self._n] = v
        if self._rows > self._n + 1:
            found[self._n + 1 :] = self._equations.prescribed(time, self._h).velocities
        return found

    def _gaps(self, H: Array) -> Array:
        g = np.empty(len(self.near.touch.pairs))
        set_gaps(self.near.touch, H, 0, g)
        return g

    def _rows_of(self, H: Array, pairs: Indices, axis: Indices) -> BlockRows:
        """Contact Jacobian at frames ``H``."""
        blocks = empty_rows(len(pairs), self._width, 3)
        append_rows(H, self.near.touch, pairs, axis, blocks)
        count = blocks.first[-1]
        return BlockRows(blocks.first, blocks.nodes[:count], blocks.values[:count])

    def _rates_of(self, rows: BlockRows, H: Array, twists: Array) -> Array:
        """Contact velocities or increments (k, 3) from twists of nodes in frames ``H``."""
        found = np.empty((len(rows.first) - 1, 3))
        twist_rates(rows, self._all_kinds, H, twists.reshape(-1, 6), found)
        return found

    @property
    def _islands(self) -> tuple[Indices, Indices]:
        matrix, has_contacts = self._equations.matrix, bool(self._equations.scene.contacts)
        if self._known != matrix.version:
            self._known, self._labels = matrix.version, islands_of(matrix, has_contacts)
        return self._labels

    def _moved_by(self, end: Array, d: Array) -> Array:
        """Frames ``end`` moved by an increment in the nodes' axes."""
        H, by = end.copy(), d.reshape(-1, 6).copy()
        all_to_group(self._kinds, end, by)
        move_all(self._kinds, end, by, H)
        return H

    def _pushed(self, f: Array) -> tuple[Array, Array]:
        """``S⁻¹ f`` with closed joints, for forces (6 n, k), and the joint multipliers, (m, k)."""
        if self._kept is None:
            found, reactions = self._impulses.solve(f)
            return np.asarray(found / self._rule.mass, dtype=np.float64), reactions
        n, kept = len(f), self._kept
        moved, held = np.empty_like(f), np.empty((self._m, f.shape[1]))
        for k in range(f.shape[1]):
            kept.right_hand_side[:n], kept.right_hand_side[n:] = f[:, k], 0.0
            kept.solve()
            moved[:, k], held[:, k] = kept.solution[:n], kept.scale * kept.solution[n:]
        return moved, held

    def _violations(self, H: Array) -> Array:
        """Violations of all constraints, shape (m,)."""
        state = TimeState(H, self._still, self._still, np.zeros(self._m))
        self._forces = self._equations.residual(state, np.ones(self._m), self._r, self._forces)
        return self._r[6 * self._n :]

    def _largest_violation(self, H: Array) -> float:
        """Largest constraint violation, over the length of the model or in rad."""
        unknowns = self._equations.unknowns
        sizes = np.where(unknowns.angular, 1.0, unknowns.length)
        return float((np.abs(self._violations(H)) / sizes).max(initial=0.0))

    def _closed(self, H: Array) -> Array:
        """Increment that closes the joints to first order, shape (6 n,)."""
        n, violation = 6 * self._n, self._violations(H)
        if self._kept is None:
            return -self._impulses.solve(np.zeros(n), violation)[0]
        kept = self._kept
        kept.right_hand_side[:n] = 0.0
        kept.right_hand_side[n:] = kept.scale * violation
        kept.solve()
        return -kept.solution[:n]

    def _rates(self, H: Array, V: Array, time: float) -> Array:
        """Constraint rates minus those of their targets, shape (m,)."""
        if not self._m:
            return np.zeros(0)
        rates, _ = self._equations.constraints(H).rates(V)
        return np.asarray(rates - self._equations.prescribed(time, self._h).target_rates[0])

    def _driven(self, time: float) -> Array:
        """Mean rates of constraint targets in the step that ends at ``time``, shape (m,)."""
        if not self._equations.unknowns.driven:
            return np.zeros(self._m)
        ends = (self._equations.prescribed(at).targets for at in (time - self._h, time))
        before, after = (np.array(each) for each in ends)
        return np.asarray((after - before) / self._h)

    def _accelerations(self, H: Array, V: Array, time: float) -> tuple[Array, Array]:
        """Rates of twists (n, 6) and multipliers without contacts."""
        n = 6 * self._n
        state = TimeState(H, V[: self._n], self._still, np.zeros(self._m))
        self._forces = self._equations.residual(state, np.ones(self._m), self._r, self._forces)
        second: Array = np.zeros(self._m)
        if self._m:
            constraints = self._equations.constraints(H)
            motions, rate = self._equations.prescribed(time, self._h), np.zeros((self._rows, 6))
            rate[self._n + 1 :] = motions.accelerations
            second = constraints.rates(V)[1] + constraints.rates(rate)[0]
            second = second - motions.target_rates[1]
        self._impulses.go_to(H)
        f: Array = self._r[:n] * self._free
        x, multipliers = self._impulses.solve(-f, -second)
        return x.reshape(-1, 6), multipliers

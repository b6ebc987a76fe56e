"""Forces of what holds nodes from outside: what is left of the equations of motion of these nodes.

Books want them after each step. Of a scene that is held at a few nodes only the cells, joints and
masses around these are looked at.
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.joints.equations.table import PackedJoints, joint_table
from fem_lie.joints.equations.terms import wrenches
from fem_lie.lie.kinds import acceleration, pull
from fem_lie.lie.kinds.inertia import PlainInertia, PlainMotion, multiply_row
from fem_lie.system.instant import Instant
from fem_lie.system.nodes.loads import PlainLoads
from fem_lie.system.nodes.sums import add_moments
from fem_lie.system.system import System
from fem_lie.system.terms.near import NearTerms


@compiled
def _add_nodal(
    kinds: Indices,
    motion: PlainMotion,
    mass: PlainInertia,
    loads: PlainLoads,
    places: tuple[Indices, Indices],
    work: Array,
    r: Array,
) -> None:
    """Add what is :func:`~fem_lie.system.nodes.sums.nodal_residual` at some nodes.

    ``places`` are these nodes, and those whose accelerations they feel; ``r`` (n, 6).
    """
    (H, v, a), (indptr, indices, blocks), (nodes, felt) = motion, mass, places
    dead, moment, following = loads
    local = np.empty((4, 3))
    for i in felt:
        acceleration(kinds[i], H[i], v[i], a[i], local, work[0, i])
    for i in nodes:
        multiply_row(i, indptr, indices, blocks, work[0], work[1, i])
        for k in range(4):
            for j in range(3):
                work[1, i, k, j] -= dead[i, k, j]
        pull(kinds[i], H[i], work[1, i], 1.0, r[i])
        add_moments(H[i], moment[i], following[i], r[i])


@compiled
def _add_joints(
    H: Array,
    v: Array,
    joints: PackedJoints,
    weights: Array,
    ends: tuple[Indices, Indices],
    forces: Array,
    r: Array,
) -> None:
    """Add what joints do at some of their ends, pairs and sides, to ``r`` (n, 6)."""
    (pairs, sides), table, moved = ends, joint_table(joints), np.empty(6)
    wrenches(H, v, table, weights, pairs, sides, forces)
    for e in range(len(pairs)):
        pair, side = pairs[e], sides[e]
        lie.apply_adjoint_inverse_transposed(table.frames[pair, side], forces[e], moved)
        for k in range(6):
            r[table.nodes[pair, side], k] -= moved[k]


class HeldForces:
    """Forces and moments of clamps and guides.

    Attributes:
        nodes: Where there are any, shape (s,).
        near: Whether only what is near them is looked at.
    """

    def __init__(self, system: System, held: Flags) -> None:
        """See what is around them.

        Args:
            system: All equations.
            held: Which unknowns are held from outside, shape (n, 6).
        """
        self._system, self._held = system, held
        chosen: Flags = np.asarray(held.any(axis=1))
        self.nodes: Indices = np.flatnonzero(chosen)
        self._values = np.zeros((system.count, 6))
        alone = system.connections.of_joints_only and not system.terms.viscous
        alone = alone and not system.floating.integers[0]
        self._terms = system.terms.near(chosen) if alone else None
        self.near = self._terms is not None
        of, to = system.inertia.pairs
        self._places = self.nodes, np.unique(to[chosen[of]])
        table = system.table
        outer = np.append(chosen, np.zeros(len(system.frames) - system.count, dtype=bool))
        pairs, sides = np.nonzero(outer[table.nodes])
        self._ends, self._of_ends = (pairs, sides), np.empty((len(pairs), 6))
        self._work = np.zeros((2, system.count, 4, 3))

    def find(self, H: Array, v: Array, a: Array, weights: Array) -> Array:
        """They are in the axes of :attr:`nodes`, shape (s, 6).

        Args:
            H: Frames of all rows.
            v: Twists, shape (≥ n, 6).
            a: Their rates.
            weights: Multipliers, shape (m,).
        """
        system, r = self._system, self._values
        if self._terms is None:
            every = np.empty(system.size)
            system.terms.condense(H)
            system.with_reactions(Instant(H, v, a, weights), np.ones(system.m), every)
            r[:] = every[: 6 * system.count].reshape(-1, 6)
        else:
            self._look_near(self._terms, Instant(H, v, a, weights))
        if not system.supports:
            return np.where(self._held[self.nodes], r[self.nodes], 0.0)
        found = np.where(self._held, r, 0.0)
        system.supports.turn_back(H, found)
        return np.asarray(found[self.nodes])

    def _look_near(self, terms: NearTerms, state: Instant) -> None:
        """All that acts on these nodes, and some of what acts on others."""
        system, r, (H, v, a, weights) = self._system, self._values, state
        r[:] = 0.0
        mass, loads = system.inertia.plain, system.loads.plain
        _add_nodal(system.kinds, (H, v, a), mass, loads, self._places, self._work, r)
        if len(self._of_ends):
            joints = system.connections.packed
            _add_joints(H, v, joints, weights, self._ends, self._of_ends, r)
        terms.add_forces(H, r)
        if system.supports:
            system.supports.turn(H, r)

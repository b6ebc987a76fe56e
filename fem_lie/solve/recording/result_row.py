"""A row of results from the state of the equations: all but elements' energy in one compiled call.

A step of a small scene takes a hundred microseconds, and a call from Python a few.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, linked
from fem_lie.bodies.balances import COLUMNS
from fem_lie.forms.fixed_arrays import (
    FixedArrays,
    integers1,
    integers2,
    numbers1,
    numbers2,
    numbers3,
    numbers4,
)
from fem_lie.forms.frames import push
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.table import joint_table
from fem_lie.system.nodes import inertia
from fem_lie.system.nodes.attachment import expand, expand_twists
from fem_lie.system.nodes.element_turns import nearest
from fem_lie.system.nodes.sums import report_rates

if TYPE_CHECKING:
    from fem_lie.solve.recording.window import Window
    from fem_lie.system import System


class ResultRow:
    """Fills all of a row but its time, reactions, and what elements and supports have in it."""

    def __init__(self, system: System) -> None:
        """Of the equations ``system``."""
        attachment, connections = system.numbering.attachment, system.connections
        nodes = attachment.leader, attachment.offset, *system.inertia, system.conservative
        joints = *connections.packed, *connections.packed_probes, *connections.reported
        self._system = system
        self._scene = FixedArrays([*nodes, *joints, *system.turns.elements])

    def by_twists(self, rows: Window, H: Array, v: Array, weights: Array, booked: Array) -> None:
        """Fill the next row of ``rows``, elastic energy with that of springs alone.

        Args:
            rows: Arrays of results, with room.
            H: Frames of all rows of the equations.
            v: Twists, shape (n, 6).
            weights: Multipliers, shape (m,).
            booked: Balance and impulses, shape (15,).
        """
        weights = self._system.felt(H, weights)
        row = rows.row
        found = fill_by_twists(H, v, weights, booked, self._scene.table, rows.arrays.table, row)
        self._complete(rows, H, v, weights, found)

    def by_rates(self, rows: Window, H: Array, V: Array, weights: Array, booked: Array) -> None:
        """Fill the next row by :meth:`by_twists` from rates of (x, d₁, d₂, d₃), shape (n, 4, 3)."""
        weights = self._system.felt(H, weights)
        v = np.empty((len(V), 6))
        found = fill_by_rates(
            H, V, v, weights, booked, self._scene.table, rows.arrays.table, rows.row
        )
        self._complete(rows, H, v, weights, found)

    def _complete(
        self,
        rows: Window,
        H: Array,
        v: Array,
        weights: Array,
        found: tuple[float, float, int, float],
    ) -> None:
        row, connections = rows.row, self._system.connections
        rows.potential[row], rows.elastic[row], element, share = found
        rows.turn = element, share
        if not connections.of_joints_only:
            forces, coordinates, violations = connections.report(H, v, weights)
            rows.joint_forces[row], rows.joint_coordinates[row] = forces, coordinates
            rows.joint_violations[row] = violations


@compiled
def fill_by_twists(
    H: Array,
    v: Array,
    weights: Array,
    booked: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, int, float]:
    """Fill row ``row`` of the arrays.

    Args:
        H: Frames of all rows of the equations.
        v: Twists, shape (n, 6).
        weights: Multipliers, shape (m,).
        booked: Balance and impulses, shape (15,).
        scene: Table of fixed arrays: leader and offset of each node, inertia, conservative loads,
            both tables of joints, which pairs, sides and owners are reported, and the elements of
            :mod:`fem_lie.system.nodes.element_turns`.
        rows: That of :attr:`~fem_lie.solve.recording.window.Window.arrays`.
        row: Number of the row.

    Returns:
        The potential of loads, the energy of springs, and of the element that is nearest to its
        limit its number and its turn.
    """
    q = np.empty((v.shape[0], 4, 3))
    push(H, v, q)
    return _fill(H, v, q, weights, booked, scene, rows, row)


@compiled
def fill_by_rates(
    H: Array,
    V: Array,
    v: Array,
    weights: Array,
    booked: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, int, float]:
    """:func:`fill_by_twists` for rates ``V`` (n, 4, 3), whose twists are written into ``v``."""
    inertia.local_twists(H, V, v)
    return _fill(H, v, V, weights, booked, scene, rows, row)


@linked
def _fill(
    H: Array,
    v: Array,
    V: Array,
    weights: Array,
    booked: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, int, float]:
    leader, offset = integers1(scene, 0), numbers3(scene, 1)
    frames, velocities, invariants = (
        numbers4(rows, 0)[row],
        numbers3(rows, 1)[row],
        numbers2(rows, 5),
    )
    if leader.shape[0] == V.shape[0]:
        frames[:], velocities[:] = H[: V.shape[0]], v
    else:
        expand(H, leader, offset, frames)
        expand_twists(v, leader, offset, velocities)
    mass = integers1(scene, 2), integers1(scene, 3), numbers3(scene, 4)
    work, dead = np.empty((1, V.shape[0], 4, 3)), numbers3(scene, 5)
    potential = report_rates(H, V, mass, dead, work, invariants[row])
    springs = _fill_joints(H, v, weights, scene, rows, row)
    balance, impulses = numbers2(rows, 6)[row], numbers3(rows, 7)[row]
    balance[:] = booked[:COLUMNS]
    for k in range(6):
        impulses[0, k], impulses[1, k] = booked[COLUMNS + k], booked[COLUMNS + 6 + k]
    limits, ends, whole = numbers1(scene, 13), integers2(scene, 14), integers1(scene, 15)
    element, angle = nearest(frames, ends, limits, whole)
    return potential, springs, element, angle


@compiled
def _fill_joints(
    H: Array, v: Array, weights: Array, scene: Indices, rows: Indices, row: int
) -> float:
    """Forces, coordinates and violations of joints; returns the energy of springs."""
    joints = numbers1(scene, 6), integers1(scene, 7)
    probes = numbers1(scene, 8), integers1(scene, 9)
    pairs, sides, owner = integers1(scene, 10), integers1(scene, 11), integers1(scene, 12)
    forces, coordinates = numbers3(rows, 2)[row, : pairs.shape[0]], numbers2(rows, 3)[row]
    largest, values = numbers2(rows, 4)[row], np.zeros(weights.shape[0])
    largest[:] = 0.0
    found = forces, coordinates, values, largest
    terms.report(H, v, joints, probes, weights, pairs, sides, owner, *found)
    table = joint_table(joints)
    return terms.spring_energy(H, table) if len(table.springs) > 0 else 0.0

"""A row of results from the state of the equations, in one compiled call.

A step of a small scene takes a hundred microseconds, and a call from Python a few.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie._jit.copies import copy_blocks, copy_vector
from fem_lie.bodies.balances import COLUMNS
from fem_lie.forms.cell_forms import add_cells
from fem_lie.forms.fixed_arrays import (
    FixedArrays,
    integers1,
    integers2,
    numbers1,
    numbers2,
    numbers3,
    numbers4,
)
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.table import PackedJoints, joint_table
from fem_lie.lie.node_types import all_result_twists, inertia, push_all_forward
from fem_lie.lie.node_types.floating import PlainFloating
from fem_lie.results.record import Record
from fem_lie.system.nodes.element_turns import most_strained, nearest
from fem_lie.system.nodes.numbering import expand_motion
from fem_lie.system.nodes.sums import report_rates

if TYPE_CHECKING:
    from fem_lie.solve.recording.window import Window
    from fem_lie.system.equations import Equations


class Given(NamedTuple):
    """What of a scene is in its rows.

    Attributes:
        kinds: What the nodes that lead are, (n,).
        master: Of each node, (N,).
        offset: Its frame in that of its master node, (N, 4, 3).
        inertia: Mass matrix.
        dead: Conservative loads on (x, d₁, d₂, d₃), (n, 4, 3).
        joints: Their table.
        probes: That of coordinates.
        pairs: Those of which forces are reported, (f,).
        sides: Of these pairs, (f,).
        owner: Connection of each constraint, (m,).
        limits: Turns that elements may make, (w,).
        ends: Nodes of these elements from end to end, (w, 3).
        whole: Whether whole frames turn, (w,).
        lengths: Unloaded lengths of those that are judged by their strain, else zero, (w,).
        chords: Unloaded chords along the mean axes of both ends, (w, 3).
        turning: Angular velocities of rates of directors, (n, 3, 3, 3).
        floating: Bodies that deform within their frames.
    """

    kinds: Indices
    master: Indices
    offset: Array
    inertia: inertia.Inertia
    dead: Array
    joints: PackedJoints
    probes: PackedJoints
    pairs: Indices
    sides: Indices
    owner: Indices
    limits: Array
    ends: Indices
    whole: Indices
    lengths: Array
    chords: Array
    turning: Array
    floating: PlainFloating


class Kept(NamedTuple):
    """Rows of a :class:`~fem_lie.solve.recording.window.Window`, the first axis of each.

    What nobody asked for has none.

    Attributes:
        frames: Of all nodes, (rows, N, 4, 3).
        velocities: Their twists, (rows, N, 6).
        joint_forces: Forces and moments, (rows, connections, 6).
        joint_coordinates: Shape (rows, probes).
        joint_violations: Shape (rows, connections).
        invariants: Kinetic energy and momenta, (rows, 7).
        balance: Work, damping, numerical loss, (rows, 3).
        impulses: Of loads and of reactions, (rows, 2, 6).
        potential: Shape (rows,).
        elastic: Shape (rows,).
    """

    frames: Array
    velocities: Array
    joint_forces: Array
    joint_coordinates: Array
    joint_violations: Array
    invariants: Array
    balance: Array
    impulses: Array
    potential: Array
    elastic: Array


@inlined
def given_of(table: Indices) -> Given:
    """In the order in which :class:`~fem_lie.solve.recording.result_row.ResultRow` puts them."""
    return Given(
        integers1(table, 0),
        integers1(table, 1),
        numbers3(table, 2),
        inertia.Inertia(integers1(table, 3), integers1(table, 4), numbers3(table, 5)),
        numbers3(table, 6),
        (numbers1(table, 7), integers1(table, 8)),
        (numbers1(table, 9), integers1(table, 10)),
        integers1(table, 11),
        integers1(table, 12),
        integers1(table, 13),
        numbers1(table, 14),
        integers2(table, 15),
        integers1(table, 16),
        numbers1(table, 17),
        numbers2(table, 18),
        numbers4(table, 19),
        (integers1(table, 20), numbers1(table, 21)),
    )


@inlined
def kept_of(table: Indices) -> Kept:
    """In the order of :attr:`~fem_lie.solve.recording.window.Window.arrays`."""
    return Kept(
        numbers4(table, 0),
        numbers3(table, 1),
        numbers3(table, 2),
        numbers2(table, 3),
        numbers2(table, 4),
        numbers2(table, 5),
        numbers2(table, 6),
        numbers3(table, 7),
        numbers1(table, 8),
        numbers1(table, 9),
    )


class ResultRow:
    """Fills all of a row but its time, reactions, and what elements and supports have in it.

    Attributes:
        scene: What of the scene is in it, see :class:`~Given`.
    """

    def __init__(self, equations: Equations) -> None:
        """Of equations."""
        known = equations.tables
        nodes = known.kinds, known.master, known.offset, *known.inertia, known.conservative
        joints = *known.joints, *known.probes, known.pairs, known.sides, known.owner
        self._equations, self._complete = equations, known.complete
        turns = known.limits, known.ends, known.whole, known.lengths, known.chords
        self._fixed = FixedArrays([*nodes, *joints, *turns, known.turning, *known.floating])
        self.scene = self._fixed.table

    def by_twists(self, rows: Window, H: Array, v: Array, weights: Array, booked: Array) -> None:
        """Fill the next row of ``rows``, elastic energy with that of springs alone.

        Args:
            rows: Arrays of results, with room.
            H: Frames of all rows of the equations.
            v: Twists, shape (n, 6).
            weights: Multipliers, shape (m,).
            booked: Balance and impulses, shape (15,).
        """
        row = rows.row
        found = fill_by_twists(H, v, weights, booked, self.scene, rows.arrays.table, row)
        self._fill_rest(rows, H, v, weights, found)

    def by_both(
        self,
        rows: Window,
        H: Array,
        motion: tuple[Array, Array],
        weights: Array,
        booked: Array,
    ) -> None:
        """Fill the next row by :meth:`by_twists` with the energy and momenta of rates of rows.

        Args:
            rows: Arrays of results, with room.
            H: Frames of all rows of the equations.
            motion: Rates (n, 4, 3) of the rows of nodes, which need not be those of turning frames,
                and velocities (n, 6) along the axes of the nodes.
            weights: Multipliers, shape (m,).
            booked: Balance and impulses, shape (15,).
        """
        (V, v), table = motion, rows.arrays.table
        found = fill_by_both(H, v, V, weights, booked, self.scene, table, rows.row)
        self._fill_rest(rows, H, v, weights, found)

    def _fill_rest(
        self,
        rows: Window,
        H: Array,
        v: Array,
        weights: Array,
        found: tuple[float, float, bool],
    ) -> None:
        row, record = rows.row, rows.filled
        potential, springs, rows.turns_far = found
        if Record.ENERGIES in record:
            rows.potential[row], rows.elastic[row] = potential, springs
        if self._complete or not record & (Record.FORCES | Record.COORDINATES):
            return
        told = self._equations.report(H, v, multipliers=weights).joints
        if Record.FORCES in record:
            rows.joint_forces[row] = told.forces
        if Record.COORDINATES in record:
            rows.joint_coordinates[row], rows.joint_violations[row] = (
                told.coordinates,
                told.violations,
            )


@compiled
def fill_by_twists(
    H: Array,
    v: Array,
    weights: Array,
    booked: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, bool]:
    """Fill row ``row`` of the arrays.

    Args:
        H: Frames of all rows of the equations.
        v: Twists, shape (n, 6).
        weights: Multipliers, shape (m,).
        booked: Balance and impulses, shape (15,).
        scene: Table of fixed arrays, :class:`~Given`.
        rows: That of :attr:`~fem_lie.solve.recording.window.Window.arrays`.
        row: Number of the row.

    Returns:
        The potential of loads, the energy of springs, and whether an element turns nearly too far.
    """
    q = np.empty((v.shape[0], 4, 3))
    if _any(kept_of(rows).invariants):
        push_all_forward(given_of(scene).kinds, H, v, q)
    return _fill(H, v, q, weights, booked, scene, rows, row)


@linked
def fill_whole(
    H: Array,
    v: Array,
    weights: Array,
    booked: Array,
    scene: Indices,
    rows: Indices,
    cells: tuple[Indices, Indices],
    row: int,
    iterations: int,
    time: float,
) -> bool:
    """:func:`fill_by_twists` and all the rest, where cells of a table have all other energy.

    Args:
        H: See there, and so on.
        v: See there.
        weights: See there.
        booked: See there.
        scene: See there.
        rows: See there.
        cells: Table of their energy, see :class:`~fem_lie.forms.cell_forms.FormTable`.
        row: Number of the row.
        iterations: So far.
        time: Of the state.

    Returns:
        Whether an element turns nearly too far.
    """
    potential, springs, near = fill_by_twists(H, v, weights, booked, scene, rows, row)
    energy = np.zeros(1)
    if _any(kept_of(rows).elastic):
        add_cells(H, cells, 0, energy)
    close_row(rows, row, potential, springs + energy[0], time, iterations)
    return near


@linked
def close_row(
    rows: Indices, row: int, potential: float, elastic: float, time: float, iterations: int
) -> None:
    """Fill in the energies that cells and loads have, if they are wanted, the time, and counts."""
    kept = kept_of(rows)
    if _any(kept.elastic):
        kept.potential[row], kept.elastic[row] = potential, elastic
    numbers1(rows, 10)[row], integers1(rows, 11)[row] = time, iterations


@compiled
def fill_by_both(
    H: Array,
    v: Array,
    V: Array,
    weights: Array,
    booked: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, bool]:
    """:func:`fill_by_twists` for ``v`` and the rates ``V`` (n, 4, 3) of all rows."""
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
) -> tuple[float, float, bool]:
    given, kept = given_of(scene), kept_of(rows)
    frames = kept.frames[row]
    _fill_motion(H, v, given, kept, row)
    potential = 0.0
    if _any(kept.invariants):
        work = np.empty((1, V.shape[0], 4, 3))
        mass, bodies = given.inertia, given.floating
        potential = report_rates(H, V, mass, bodies, given.dead, work, kept.invariants[row])
    springs = _fill_joints(H, v, weights, scene, rows, row)
    if _any(kept.balance):
        copy_vector(booked, kept.balance[row])
    if _any(kept.impulses):
        for k in range(6):
            kept.impulses[row, 0, k] = booked[COLUMNS + k]
            kept.impulses[row, 1, k] = booked[COLUMNS + 6 + k]
    _, _, near = nearest(frames, given.ends, given.limits, given.whole)
    _, _, _, _, strained = most_strained(frames, given.ends, given.lengths, given.chords)
    return potential, springs, near or strained


@inlined
def _any(rows: Array) -> bool:
    """Whether they are wanted."""
    return rows.shape[0] > 0


@inlined
def _fill_motion(H: Array, v: Array, given: Given, kept: Kept, row: int) -> None:
    """Frames of all nodes, and their velocities if they are wanted."""
    moving, wanted = given.kinds.shape[0], _any(kept.velocities)
    velocities = kept.velocities[row] if wanted else np.empty((0, 6))
    leads = given.master.shape[0] == moving
    own = velocities if leads else np.empty_like(v)
    if wanted:
        all_result_twists(given.kinds, H, v, own)
    if leads:
        copy_blocks(H, kept.frames[row])
    else:
        expand_motion(H, own, given.master, given.offset, kept.frames[row], velocities)


@compiled
def _fill_joints(
    H: Array, v: Array, weights: Array, scene: Indices, rows: Indices, row: int
) -> float:
    """Forces, coordinates and violations of joints; returns the energy of springs."""
    given, kept = given_of(scene), kept_of(rows)
    table = joint_table(given.joints)
    if _any(kept.joint_forces):
        forces = kept.joint_forces[row, : given.pairs.shape[0]]
        terms.wrenches(H, v, table, weights, given.pairs, given.sides, forces)
    if _any(kept.joint_coordinates):
        largest, values = kept.joint_violations[row], np.zeros(weights.shape[0])
        largest[:] = 0.0
        terms.violations(H, joint_table(given.probes), kept.joint_coordinates[row])
        terms.violations(H, table, values)
        for c in range(len(table.targets)):
            size = abs(values[c])
            if size > largest[given.owner[c]] or size != size:  # nan stays
                largest[given.owner[c]] = size
    wanted = _any(kept.elastic) and len(table.springs) > 0
    return terms.spring_energy(H, table) if wanted else 0.0

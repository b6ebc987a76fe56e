"""What rows of results are made of, as compiled code reads it: tables of arrays that stay."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie.forms.fixed_arrays import (
    integers1,
    integers2,
    numbers1,
    numbers2,
    numbers3,
    numbers4,
)
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.lie.kinds import inertia
from fem_lie.lie.kinds.floating import PlainFloating


class Given(NamedTuple):
    """What of a scene is in its rows.

    Attributes:
        kinds: What the nodes that lead are, (n,).
        leader: Of each node, (N,).
        offset: Its frame in that of its leader, (N, 4, 3).
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
    leader: Indices
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

"""A row of results from the state of the equations: all but elements' energy in one compiled call.

A step of a small scene takes a hundred microseconds, and a call from Python a few: the longer the
more arrays it has. So all that stays the same is in two of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fem_lie import constraints, inertia
from fem_lie._jit import Array, Indices, compiled, inlined
from fem_lie.attachment import expand, expand_twists
from fem_lie.balances import COLUMNS
from fem_lie.element_turns import nearest
from fem_lie.frames import push
from fem_lie.joint_table import joint_table
from fem_lie.nodal import report_rates

if TYPE_CHECKING:
    from fem_lie.solve.window import Window
    from fem_lie.system import System


class Reported(NamedTuple):
    """What of a scene is constant in rows of results; ``N`` nodes, ``n`` of which lead.

    Attributes:
        offset: Of each node in its leader's frame, shape (N, 4, 3), with ``leader``, shape (N,).
        blocks: Of the inertia, shape (nnz, 4, 4), with ``indptr`` and ``indices``.
        dead: Conservative loads, shape (n, 4, 3).
        limits: Of the turn of each element, with ``ends`` (w, 3) and ``whole`` (w,), see
            :mod:`fem_lie.element_turns`.
        leader: See ``offset``.
        indptr: See ``blocks``, likewise ``indices``.
        indices: See there.
        ends: See ``limits``, likewise ``whole``.
        whole: See there.
        pairs: Pairs of joints whose forces are reported, with their ``sides``.
        sides: See there.
        owner: Item of each constraint, shape (m,).
    """

    offset: Array
    blocks: Array
    dead: Array
    limits: Array
    leader: Indices
    indptr: Indices
    indices: Indices
    ends: Indices
    whole: Indices
    pairs: Indices
    sides: Indices
    owner: Indices


def pack(parts: Reported) -> tuple[Array, Indices]:
    """The same in two arrays; :func:`_views` gives it back."""
    numbers, integers = parts[:4], parts[4:]
    counts = (parts.leader, parts.dead, parts.blocks, parts.limits, parts.pairs, parts.owner)
    sizes = np.array([len(part) for part in counts], dtype=np.int64)
    return (
        np.concatenate([part.ravel() for part in numbers]),
        np.concatenate([sizes, *(part.ravel().astype(np.int64) for part in integers)]),
    )


@inlined
def _views(x: Array, i: Indices) -> Reported:
    nodes, n, entries, w, pairs, m = i[0], i[1], i[2], i[3], i[4], i[5]
    blocks = 12 * nodes
    dead = blocks + 16 * entries
    limits = dead + 12 * n
    indptr = 6 + nodes
    indices = indptr + n + 1
    ends = indices + entries
    whole = ends + 3 * w
    reported = whole + w
    sides = reported + pairs
    owner = sides + pairs
    return Reported(
        x[:blocks].reshape(nodes, 4, 3),
        x[blocks:dead].reshape(entries, 4, 4),
        x[dead:limits].reshape(n, 4, 3),
        x[limits : limits + w],
        i[6:indptr],
        i[indptr:indices],
        i[indices:ends],
        i[ends:whole].reshape(w, 3),
        i[whole:reported],
        i[reported:sides],
        i[sides:owner],
        i[owner : owner + m],
    )


class ResultRow:
    """Fills all of a row but its time, reactions, and what elements and supports have in it."""

    def __init__(self, system: System) -> None:
        """Of the equations ``system``."""
        attachment, connections = system.numbering.attachment, system.connections
        mass, (limits, ends, whole) = system.inertia, system.turns.elements
        pairs, sides, owner = connections.reported
        reported = Reported(
            offset=attachment.offset,
            blocks=mass.blocks,
            dead=system.conservative,
            limits=limits,
            leader=attachment.leader,
            indptr=mass.indptr,
            indices=mass.indices,
            ends=ends,
            whole=whole,
            pairs=pairs,
            sides=sides,
            owner=owner,
        )
        self._system = system
        self._scene = connections.packed, connections.packed_probes, pack(reported)

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
        found = fill_by_twists(H, v, weights, booked, self._scene, rows.arrays, row)
        self._complete(rows, H, v, weights, found)

    def by_rates(self, rows: Window, H: Array, V: Array, weights: Array, booked: Array) -> None:
        """Likewise, from rates of (x, d₁, d₂, d₃), shape (n, 4, 3)."""
        weights = self._system.felt(H, weights)
        v = np.empty((len(V), 6))
        found = fill_by_rates(H, V, v, weights, booked, self._scene, rows.arrays, rows.row)
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
        rows.potential[row], rows.elastic[row], *turned = found
        rows.turn = turned[0], turned[1]
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
    scene: tuple[Any, ...],
    rows: tuple[Array, ...],
    row: int,
) -> tuple[float, float, int, float]:
    """Fill row ``row`` of the arrays.

    Args:
        H: See :meth:`ResultRow.by_twists`, likewise the following.
        v: See there.
        weights: See there.
        booked: See there.
        scene: Both tables of joints, and :class:`Reported`, packed.
        rows: See :attr:`~fem_lie.solve.window.Window.arrays`.
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
    scene: tuple[Any, ...],
    rows: tuple[Array, ...],
    row: int,
) -> tuple[float, float, int, float]:
    """:func:`fill_by_twists` for rates ``V`` (n, 4, 3), whose twists are written into ``v``."""
    inertia.local_twists(H, V, v)
    return _fill(H, v, V, weights, booked, scene, rows, row)


@compiled
def _fill(  # type: ignore[no-untyped-def]
    H, v, V, weights, booked, scene, rows, row
):
    joints, probes, packed = scene
    s = _views(packed[0], packed[1])
    frames, velocities, forces, coordinates, violations, invariants, balance, impulses = rows
    if s.leader.shape[0] == V.shape[0]:
        frames[row], velocities[row] = H[: V.shape[0]], v
    else:
        expand(H, s.leader, s.offset, frames[row])
        expand_twists(v, s.leader, s.offset, velocities[row])
    values, largest, count = np.zeros(weights.shape[0]), violations[row], s.pairs.shape[0]
    largest[:] = 0.0
    given = weights, s.pairs, s.sides, s.owner, forces[row, :count], coordinates[row]
    constraints.report(H, v, joints, probes, *given, values, largest)
    mass, work = (s.indptr, s.indices, s.blocks), np.empty((1, V.shape[0], 4, 3))
    potential = report_rates(H, V, mass, s.dead, work, invariants[row])
    balance[row] = booked[:COLUMNS]
    for k in range(6):
        impulses[row, 0, k] = booked[COLUMNS + k]
        impulses[row, 1, k] = booked[COLUMNS + 6 + k]
    table = joint_table(joints)
    springs = constraints.spring_energy(H, table) if len(table.springs) > 0 else 0.0
    element, angle = nearest(frames[row], s.ends, s.limits, s.whole)
    return potential, springs, element, angle

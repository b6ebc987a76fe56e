"""A row of results, computed from the state of the equations in one compiled call.

A step of a small scene takes a hundred microseconds, and a call from Python a few.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie._jit.copies import copy_blocks, copy_vector
from fem_lie._jit.packed_arrays import (
    Integers1,
    Integers2,
    Numbers1,
    Numbers2,
    Numbers3,
    Numbers4,
    PackedArrays,
    unpacking,
)
from fem_lie.bodies.balances import COLUMNS
from fem_lie.forms.cell_forms import energy_of
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.lie.node_types import all_result_twists, inertia, push_all_forward
from fem_lie.lie.node_types.floating import PlainFloating
from fem_lie.results.record import Record
from fem_lie.system.nodes.element_rotations import most_strained, nearest
from fem_lie.system.nodes.numbering import expand_motion
from fem_lie.system.nodes.sums import report_rates

if TYPE_CHECKING:
    from fem_lie.solve.recording.window import Window
    from fem_lie.system.equations import Equations


class SceneArrays(NamedTuple):
    """Constant arrays of a scene that its rows of results depend on.

    Attributes:
        kinds: Types of the master nodes, (n,).
        master: Master node of each node, (N,).
        offset: Frame of each node in the frame of its master, (N, 4, 3).
        inertia: Mass matrix.
        dead: Conservative loads on (x, d₁, d₂, d₃), (n, 4, 3).
        joints: Packed arrays of the joints.
        probes: Packed arrays of the reported joint coordinates.
        pairs: Node pairs whose forces are reported, (f,).
        sides: Sides of these pairs, (f,).
        items: Connections to whose forces these pairs add, (f,).
        owner: Connection of each constraint, (m,).
        limits: Largest allowed rotations of elements, (w,).
        ends: Nodes of these elements along the axis, (w, 3).
        whole: Whether the whole frame rotates, (w,).
        lengths: Unloaded lengths of elements that are checked by their strain, else zero, (w,).
        chords: Unloaded chords along the mean axes of both ends, (w, 3).
        turning: Angular velocities per rate of the directors, (n, 3, 3, 3).
        gradients: Master nodes with position gradients, (g,).
        floating: Reduced-order bodies.
    """

    kinds: Integers1
    master: Integers1
    offset: Numbers3
    inertia: inertia.Inertia
    dead: Numbers3
    joints: PackedJoints
    probes: PackedJoints
    pairs: Integers1
    sides: Integers1
    items: Integers1
    owner: Integers1
    limits: Numbers1
    ends: Integers2
    whole: Integers1
    lengths: Numbers1
    chords: Numbers2
    turning: Numbers4
    gradients: Integers1
    floating: PlainFloating


class ResultColumns(NamedTuple):
    """Recorded arrays of a :class:`~fem_lie.solve.recording.window.Window`.

    The first axis is the row.

    Quantities that are not recorded have no rows.

    Attributes:
        frames: Frames of all nodes, (rows, N, 4, 3).
        velocities: Their twists, (rows, N, 6).
        gradient_velocities: Velocities of nodes with position gradients, (rows, g, 6).
        joint_forces: Forces and moments, (rows, connections, 6).
        joint_coordinates: Reported joint coordinates, (rows, probes).
        joint_violations: Constraint violations, (rows, connections).
        invariants: Kinetic energy and momenta, (rows, 7).
        balance: Work, damping, numerical dissipation, (rows, 3).
        impulses: Impulses of loads and of reactions, (rows, 2, 6).
        potential: Potential energy of loads, (rows,).
        elastic: Strain energy, (rows,).
        times: Time of each row, (rows,).
        iterations: Number of iterations so far, (rows,).
    """

    frames: Numbers4
    velocities: Numbers3
    gradient_velocities: Numbers3
    joint_forces: Numbers3
    joint_coordinates: Numbers2
    joint_violations: Numbers2
    invariants: Numbers2
    balance: Numbers2
    impulses: Numbers3
    potential: Numbers1
    elastic: Numbers1
    times: Numbers1
    iterations: Integers1


scene_arrays_of = unpacking(SceneArrays)
columns_of = unpacking(ResultColumns)


class ResultRow:
    """Fills a row of results, except time, reactions, and contributions of elements and supports.

    Attributes:
        scene: Packed arrays of the scene, see :class:`~SceneArrays`.
    """

    def __init__(self, equations: Equations) -> None:
        """Pack the arrays of the equations."""
        known = equations.arrays
        nodes = known.kinds, known.master, known.offset, *known.inertia, known.conservative
        reported = known.pairs, known.sides, known.items
        joints = *known.joints, *known.probes, *reported, known.owner
        self._equations, self._complete = equations, known.complete
        turns = known.limits, known.ends, known.whole, known.lengths, known.chords
        gradients = known.master[equations.info.gradient_nodes]
        rest = known.turning, gradients, *known.floating
        self._fixed = PackedArrays([*nodes, *joints, *turns, *rest])
        self.scene = self._fixed.addresses

    def by_twists(
        self, rows: Window, H: Array, v: Array, multipliers: Array, balance: Array
    ) -> None:
        """Fill the next row of ``rows`` from twists; elastic energy is that of springs only.

        Args:
            rows: Arrays of results, with a free row.
            H: Frames of all nodes of the equations.
            v: Twists, shape (n, 6).
            multipliers: Lagrange multipliers, shape (m,).
            balance: Energy balance and impulses, shape (15,).
        """
        row = rows.row
        found = fill_by_twists(H, v, multipliers, balance, self.scene, rows.arrays.addresses, row)
        self._fill_rest(rows, H, v, multipliers, found)

    def by_both(
        self,
        rows: Window,
        H: Array,
        motion: tuple[Array, Array],
        multipliers: Array,
        balance: Array,
    ) -> None:
        """Fill the next row as :meth:`by_twists`, energy and momenta from coordinate rates.

        Args:
            rows: Arrays of results, with a free row.
            H: Frames of all nodes of the equations.
            motion: Rates (n, 4, 3) of the nodal coordinates (position and directors), which need
                not be those of a rotating frame, and velocities (n, 6) along the axes of the nodes.
            multipliers: Lagrange multipliers, shape (m,).
            balance: Energy balance and impulses, shape (15,).
        """
        (V, v), arrays = motion, rows.arrays.addresses
        found = fill_by_both(H, v, V, multipliers, balance, self.scene, arrays, rows.row)
        self._fill_rest(rows, H, v, multipliers, found)

    def _fill_rest(
        self,
        rows: Window,
        H: Array,
        v: Array,
        multipliers: Array,
        found: tuple[float, float, bool],
    ) -> None:
        row, record = rows.row, rows.filled
        potential, springs, rows.turns_far = found
        if Record.ENERGIES in record:
            rows.potential[row], rows.elastic[row] = potential, springs
        if self._complete or not record & (Record.FORCES | Record.COORDINATES):
            return
        report = self._equations.report(H, v, multipliers=multipliers).joints
        if Record.FORCES in record:
            rows.joint_forces[row] = report.forces
        if Record.COORDINATES in record:
            rows.joint_coordinates[row], rows.joint_violations[row] = (
                report.coordinates,
                report.violations,
            )


@compiled
def fill_by_twists(
    H: Array,
    v: Array,
    multipliers: Array,
    balance: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, bool]:
    """Fill row ``row`` of the arrays from twists.

    Args:
        H: Frames of all nodes of the equations.
        v: Twists, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        balance: Energy balance and impulses, shape (15,).
        scene: Packed arrays of the scene, :class:`~SceneArrays`.
        rows: Packed arrays of :attr:`~fem_lie.solve.recording.window.Window.arrays`.
        row: Number of the row.

    Returns:
        The potential of loads, the energy of springs, and whether an element is near its rotation
        limit.
    """
    q = np.empty((v.shape[0], 4, 3))
    if _any(columns_of(rows).invariants):
        push_all_forward(scene_arrays_of(scene).kinds, H, v, q)
    return _fill(H, v, q, multipliers, balance, scene, rows, row)


@linked
def fill_whole(
    H: Array,
    v: Array,
    multipliers: Array,
    balance: Array,
    scene: Indices,
    rows: Indices,
    cells: tuple[Indices, Indices],
    row: int,
    iterations: int,
    time: float,
) -> bool:
    """Fill a row as :func:`fill_by_twists`, with the energy of all cells.

    All other energy must be stored in these cells.

    Args:
        H: Frames of all nodes of the equations.
        v: Twists, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        balance: Energy balance and impulses, shape (15,).
        scene: Packed arrays of the scene, :class:`~SceneArrays`.
        rows: Packed arrays of :attr:`~fem_lie.solve.recording.window.Window.arrays`.
        cells: Packed arrays of the cells, see :class:`~fem_lie.forms.cell_forms.FormArrays`.
        row: Number of the row.
        iterations: Number of iterations so far.
        time: Time of the state.

    Returns:
        Whether an element is near its rotation limit.
    """
    potential, springs, near = fill_by_twists(H, v, multipliers, balance, scene, rows, row)
    energy = energy_of(H, cells) if _any(columns_of(rows).elastic) else 0.0
    close_row(rows, row, potential, springs + energy, time, iterations)
    return near


@linked
def close_row(
    rows: Indices, row: int, potential: float, elastic: float, time: float, iterations: int
) -> None:
    """Fill in time, iterations, and the recorded energies of cells and loads."""
    kept = columns_of(rows)
    if _any(kept.elastic):
        kept.potential[row], kept.elastic[row] = potential, elastic
    kept.times[row], kept.iterations[row] = time, iterations


@compiled
def fill_by_both(
    H: Array,
    v: Array,
    V: Array,
    multipliers: Array,
    balance: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, bool]:
    """Fill a row as :func:`fill_by_twists`, from ``v`` and the coordinate rates ``V`` (n, 4, 3)."""
    return _fill(H, v, V, multipliers, balance, scene, rows, row)


@linked
def _fill(
    H: Array,
    v: Array,
    V: Array,
    multipliers: Array,
    balance: Array,
    scene: Indices,
    rows: Indices,
    row: int,
) -> tuple[float, float, bool]:
    given, kept = scene_arrays_of(scene), columns_of(rows)
    frames = kept.frames[row]
    _fill_motion(H, v, given, kept, row)
    potential = 0.0
    if _any(kept.invariants):
        work = np.empty((1, V.shape[0], 4, 3))
        mass, bodies, out = given.inertia, given.floating, kept.invariants[row]
        potential = report_rates(given.kinds, H, V, mass, bodies, given.dead, work, out)
    springs = _fill_joints(H, v, multipliers, scene, rows, row)
    if _any(kept.balance):
        copy_vector(balance, kept.balance[row])
    if _any(kept.impulses):
        for k in range(6):
            kept.impulses[row, 0, k] = balance[COLUMNS + k]
            kept.impulses[row, 1, k] = balance[COLUMNS + 6 + k]
    _, _, near = nearest(frames, given.ends, given.limits, given.whole)
    _, _, _, _, strained = most_strained(frames, given.ends, given.lengths, given.chords)
    return potential, springs, near or strained


@inlined
def _any(rows: Array) -> bool:
    """Whether the quantity is recorded."""
    return rows.shape[0] > 0


@inlined
def _fill_motion(H: Array, v: Array, given: SceneArrays, kept: ResultColumns, row: int) -> None:
    """Frames of all nodes, and their velocities if they are recorded."""
    moving, wanted = given.kinds.shape[0], _any(kept.velocities)
    velocities = kept.velocities[row] if wanted else np.empty((0, 6))
    leads = given.master.shape[0] == moving
    own = velocities if leads else np.empty_like(v)
    if wanted:
        all_result_twists(given.kinds, H, v, own)
        for k in range(given.gradients.shape[0]):
            kept.gradient_velocities[row, k] = v[given.gradients[k]]
    if leads:
        copy_blocks(H, kept.frames[row])
    else:
        expand_motion(H, own, given.master, given.offset, kept.frames[row], velocities)


@compiled
def _fill_joints(
    H: Array, v: Array, multipliers: Array, scene: Indices, rows: Indices, row: int
) -> float:
    """Forces, coordinates and violations of joints; returns the energy of springs."""
    given, kept = scene_arrays_of(scene), columns_of(rows)
    arrays = joint_arrays(given.joints)
    if _any(kept.joint_forces):
        forces = kept.joint_forces[row]
        terms.wrenches(H, v, arrays, multipliers, given.pairs, given.sides, given.items, forces)
    if _any(kept.joint_coordinates):
        largest, values = kept.joint_violations[row], np.zeros(multipliers.shape[0])
        largest[:] = 0.0
        terms.violations(H, joint_arrays(given.probes), kept.joint_coordinates[row])
        terms.violations(H, arrays, values)
        for c in range(len(arrays.targets)):
            size = abs(values[c])
            if size > largest[given.owner[c]] or size != size:  # nan stays
                largest[given.owner[c]] = size
    wanted = _any(kept.elastic) and len(arrays.springs) > 0
    return terms.spring_energy(H, arrays) if wanted else 0.0

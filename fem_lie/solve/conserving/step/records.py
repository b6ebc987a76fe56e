"""What a step of a conserving scheme works on: the scene, the start of the step, the step.

In Python and in compiled code these are the same records; between the two they are
:class:`~fem_lie.solve.conserving.step.packing.Packed`.
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie.forms.cells import CellTable
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.solve.conserving.midpoint.reduced_bodies import PackedBodies
from fem_lie.solve.conserving.vector_cells.cell_table import CellTable as RowCells
from fem_lie.system.nodes.masses import Loads

FORCES, LEARN, JOINTS, ERROR, TOUCHES, ADDRESSES = 0, 1, 2, 3, 4, 5
"""Indices into :attr:`Model.outside`: the address of the function that adds forces from outside of
compiled code, and of the one that improves corrections; whether joints are among these forces, 0 or
1; whether a called function has failed; whether contacts may act in the step, in a scene of frames
alone; and its length."""


class Scheme(NamedTuple):
    """Parameters of a scheme.

    Attributes:
        h: Step size.
        dissipation: χ of :mod:`fem_lie.solve.conserving.step.dissipation`.
        filter_gain: μ.
    """

    h: float
    dissipation: float
    filter_gain: float


class Masters(NamedTuple):
    """Which node follows which, see :class:`~fem_lie.system.nodes.numbering.Attachment`.

    Attributes:
        master: Of each node, (N,).
        offset: Frame of each node in that of its leader, (N, 4, 3).
        trivial: Whether all lead themselves, and none has a frame that turns with an edge.
        edges: Nodes with such frames, and the other nodes of these edges, (k, 2), see
            :mod:`fem_lie.solve.conserving.midpoint.any_node`.
    """

    master: Indices
    offset: Array
    trivial: bool
    edges: Indices


class Pieces(NamedTuple):
    """Pieces of lines under pressure.

    Attributes:
        pairs: Their nodes, (s, 2).
        across: Axes across them times the pressure, (s, 3); they may be changed.
    """

    pairs: Indices
    across: Array


class Incidences(NamedTuple):
    """Which nodes the constraints touch, see :class:`~fem_lie.linear.saddle_point.Incidences`.

    Attributes:
        nodes: Of each leg.
        constraints: Likewise.
    """

    nodes: Indices
    constraints: Indices


class IncidencePositions(NamedTuple):
    """The unknowns in which the matrix changes with the constraints, where these are few.

    Attributes:
        unknowns: Which they are, (k,).
        at: Of each leg, where among them its node begins and where its multiplier is, (2, legs).
        inverse: Of the matrix that is kept, columns of the inverse in these unknowns, (k, k).
            Without any (0, 0) all unknowns are solved for instead.
        columns: The same in all unknowns, (k, 6 n + m), or, where these are too many, none: then a
            solution is made for the sum of terms.
    """

    unknowns: Indices
    at: Indices
    inverse: Array
    columns: Array


class Model(NamedTuple):
    """What does not change in a step.

    Attributes:
        cells: All cells.
        joints: Table of all joints.
        inertia: Mass matrix of the rows of nodes, and of products of reduced-order bodies, see
            :mod:`fem_lie.solve.conserving.midpoint.reduced_bodies`; n + p.
        damping: The same of damping that goes with mass; without rows there is none.
        masters: Who leads.
        held: Which unknowns are zero, 0 or 1, (n, 6).
        measure: Size of each unknown and scaled multiplier, shape (6 n + m,).
        scale: Factor of each constraint, (m,).
        loads: In the middle of the step, ``dead`` of rows with inertia; they may be changed.
        conservative: Those of ``loads.dead`` that have a potential, (n + p, 4, 3).
        pressure: Where it acts.
        viscous: Whether cells have viscous forces.
        scheme: Parameters.
        probes: Table of the coordinates that results report.
        driven: Increments of the constraints' targets in the step, (m,); they may be changed.
        supported: Which unknowns are held from outside, 0 or 1, (n, 6).
        incidences: Of the constraints.
        ends: Of the legs.
        kinds: Types of the nodes, (n,).
        arms: Moment arm of both halves of each node, by which what acts on it is a force, (n, 2).
        rows: Cells of nodes that are no frames.
        of_frames: As ``measure`` for frames and constraints between these alone, else nil.
        addresses: Addresses of :data:`FORCES` and :data:`LEARN`, nil without, and flags, (5,).
        bodies: Those of reduced order.
        light: Projectors on rotations of frames that have no inertia and are not held, in the axes
            of the nodes, (n, 3, 3), or (0, 3, 3) if there are none.
    """

    cells: CellTable
    joints: PackedJoints
    inertia: Inertia
    damping: Inertia
    masters: Masters
    held: Indices
    measure: Array
    scale: Array
    loads: Loads
    conservative: Array
    pressure: Pieces
    viscous: bool
    scheme: Scheme
    probes: PackedJoints
    driven: Array
    supported: Indices
    incidences: Incidences
    ends: IncidencePositions
    kinds: Indices
    arms: Array
    rows: RowCells
    of_frames: Array
    addresses: Indices
    bodies: PackedBodies
    light: Array


class State(NamedTuple):
    """Start of a step, and its end with index 1.

    Attributes:
        H: Frames of all rows, ground and prescribed motions last, (n + 1 + p, 4, 3).
        rest: Digits of ``H`` that do not fit into it, (n, 4, 3).
        V: Velocities of (x, d₁, d₂, d₃), and of products, (n + p, 4, 3).
        weights: Multipliers, (m,).
        gap: Values of the constraints, (m,).
        F: Forces of the cells, in the frames of their nodes, (places, 6).
        W: Energies of the cells, frames first and reduced-order bodies last, (M,).
        account: Work done on each cell, (M,).
        w: Memory of changes of velocity, (n + p, 4, 3).
        w_F: Of changes of forces, (places, 6).
        filter_state: Numbers of the last iteration, see
            :mod:`fem_lie.solve.conserving.step.dissipation`, (13,).
        carry: Forces left over by the last step, and moments about where the nodes are now, global
            components, (n, 6).
        balance: Work of loads and drives that has no potential, of damping, numerical loss, and
            impulses of loads and of reactions, (15,).
        trend: Half the change of the nodes' spatial velocities in the last step, per time, (n, 6).
        earlier: Multipliers of the two steps before the last one, (2, m).
        sizes: Of the last three steps since the start or an event, 0 for those before, (3,).
        border: Rows and columns of the constraints in the matrix, (2, legs, 6).
        slow: Of :func:`~fem_lie.solve.conserving.step.corrections.hasten`, (2, 6 n + m); without
            dissipation (0, 6 n + m).
        share: Likewise, (2,).
        probe: Of :func:`~fem_lie.solve.conserving.step.corrections.growth`, (6 n + m,).
        cell_forces: Forces of cells of nodes that are no frames, and memory of their changes, see
            :mod:`fem_lie.solve.conserving.vector_cells.force_changes`, (2, places, 2, 3); without
            dissipation no places.
        rates: Accelerations of increments: means over the last step and the one before, (2, n, 6).
        within: Memory of changes of stresses of reduced-order bodies, (coordinates,); without
            dissipation (0,).
    """

    H: Array
    rest: Array
    V: Array
    weights: Array
    gap: Array
    F: Array
    W: Array
    account: Array
    w: Array
    w_F: Array
    filter_state: Array
    carry: Array
    balance: Array
    trend: Array
    earlier: Array
    sizes: Array
    border: Array
    slow: Array
    share: Array
    probe: Array
    cell_forces: Array
    rates: Array
    within: Array


class Products(NamedTuple):
    """Of velocities in the metric of inertia, see :mod:`.dissipation`.

    Attributes:
        δ: ``Δq/h − V``, (n + p, 4, 3).
        Gδ: That times the mass matrix.
        GV: V times the mass matrix, likewise.
        sums: Of each pair of (V, δ, w), (3, 3, 3, 3).
    """

    δ: Array
    Gδ: Array
    GV: Array
    sums: Array


class Step(NamedTuple):
    """What a step consists of, and memory without meaning between two of them.

    Attributes:
        step: Spatial translation and rotation of the nodes, (n, 6).
        rows: :class:`Span` of all rows, (4, rows, 4, 3).
        V1: Velocities at the end, (n + p, 4, 3).
        F1: Forces of the cells at the end, (places, 6).
        W1: Their energies, (M,).
        work: Done on them in the step, (M,).
        change: Of the constraints, (m,).
        losses: Work of drives, of damping, numerical loss in the step, and forces and moments about
            the origin of pressure and mass damping, and of reactions, (15,).
        start: Frames of all nodes at the start, (N, 4, 3).
        nodes: :class:`Span` of all nodes, (4, N, 4, 3).
        exact: Increments of all nodes with ``rest``, (N, 4, 3).
        steps: Translation and rotation of all nodes, (N, 6).
        twists: In half-way frames, (N, 6).
        on_nodes: Forces on all nodes, (N, 6).
        forces: On the leaders, (n, 6).
        q: For inertia, (2, n + p, 4, 3).
        F_viscous: Viscous forces of the cells, (places, 6).
        r: :class:`Solution` of the equations, (5, 6 n + m).
        weights: Multipliers at the start of the step, (m,).
        filtered: Forces of the changes of elastic forces, of their memory, and what of both acts,
            on all nodes, (3, N, 6).
        border: How the constraints differ from those in the matrix, (2, legs, 6).
        sums: Of :class:`Products`, (3, 3, 3, 3).
        own: Its arrays of the nodes, (3, n + p, 4, 3).
        turnings: What the matrix lacks of dissipation, see :mod:`.dissipation`, (2, 3, 6 n);
            without dissipation (2, 0, 6 n).
        gains: Of the cells' energies, (M,).
        cell_forces: Forces at the end of cells of nodes that are no frames, changes and what is
            kept of the memory, see :mod:`fem_lie.solve.conserving.vector_cells.force_changes`, (3,
            places, 2, 3).
        changes: Changes of the forces of these cells, and their memory, (2, n, 6).
        outer: Forces from outside of compiled code, as increments, (n, 6).
        moved: Increments of all rows with inertia, (n + p, 4, 3); without products the same memory
            as in ``rows``.
        products: Means of the products, (p, 4, 3).
        within: Coordinates of reduced-order bodies over the step, see
            :data:`~fem_lie.solve.conserving.midpoint.reduced_bodies.START`, (3, coordinates).
    """

    step: Array
    rows: Array
    V1: Array
    F1: Array
    W1: Array
    work: Array
    change: Array
    losses: Array
    start: Array
    nodes: Array
    exact: Array
    steps: Array
    twists: Array
    on_nodes: Array
    forces: Array
    q: Array
    F_viscous: Array
    r: Array
    weights: Array
    filtered: Array
    border: Array
    sums: Array
    own: Array
    turnings: Array
    gains: Array
    cell_forces: Array
    changes: Array
    outer: Array
    moved: Array
    products: Array
    within: Array


class Span(NamedTuple):
    """What lies between both ends of a step, of k nodes, (k, 4, 3).

    See :mod:`~fem_lie.solve.conserving.midpoint.cayley`.

    Attributes:
        end: Frames at the end.
        mean: Means of (x, d₁, d₂, d₃).
        middle: Mean positions with the half-way rotations.
        delta: Increments of (x, d₁, d₂, d₃).
    """

    end: Array
    mean: Array
    middle: Array
    delta: Array


class Solution(NamedTuple):
    """Of the equations, each of shape (6 n + m,).

    Attributes:
        residual: What is wrong.
        x: The correction.
        work: Of the solver.
        rest: What of the equations a solution has not met.
        term: The solution for that.
    """

    residual: Array
    x: Array
    work: Array
    rest: Array
    term: Array


@inlined
def span_of(rows: Array) -> Span:
    """Parts of ``rows`` (4, k, 4, 3)."""
    return Span(rows[0], rows[1], rows[2], rows[3])


@inlined
def products_of(this: Step) -> Products:
    """Parts of a step."""
    return Products(this.own[0], this.own[1], this.own[2], this.sums)


@inlined
def solution_of(r: Array) -> Solution:
    """Parts of ``r`` (5, size)."""
    return Solution(r[0], r[1], r[2], r[3], r[4])

"""Records of a step of a conserving scheme: the model, the start of the step, the step.

Python and compiled code use the same records;
:class:`~fem_lie.solve.conserving.step.packing.Packed` passes them.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.packed_arrays import (
    Frames,
    Integers1,
    Integers2,
    IntegerSixes,
    ManyFrames,
    ManySixes,
    Numbers1,
    Numbers2,
    Numbers3,
    Numbers4,
    Sixes,
    one,
)
from fem_lie._jit.records import Records, record_type
from fem_lie.forms.cells import CellArrays
from fem_lie.joints.equations.joint_arrays import PackedJoints
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.solve.conserving.midpoint.reduced_bodies import PackedBodies
from fem_lie.solve.conserving.vector_cells.cell_arrays import VectorCells
from fem_lie.system.nodes.masses import Loads

FORCES, LEARN, JOINTS, ERROR, TOUCHES = range(5)
SUM, TURNINGS, LARGEST, TOTAL, SOLVE, ADDRESSES = range(5, 11)
"""Indices into :attr:`Model.addresses`: address of the callback that adds forces of Python, and of
the one that improves corrections; whether joints are among these forces, 0 or 1; whether a callback
has failed; whether contacts may act in the step, in a scene of frames only. Of a scene that is
divided among ranks: those that add up residuals and :attr:`Step.turnings` at shared nodes, find the
largest first one of :attr:`Step.common` and the totals of all, and solve for the workspace of a
:class:`Solution`, in place. And the length."""

COMMON = 27
"""Most numbers that ranks exchange at a time."""


FILTER = record_type(
    gain=float,
    elastic=float,
    active=float,
    change_work=float,
    filter_work=float,
    length=float,
    leak=float,
    squares=float,
    limit=float,
    repaid=float,
    energy=float,
    row_squares=float,
    row_repaid=float,
    all_squares=float,
    all_change_work=float,
    all_filter_work=float,
)
"""Numbers of the filters and of round-off: β; the fraction of elastic forces that is filtered;
whether there is an earlier change (0 or 1; without it there is no dissipation); works of the
changes of elastic forces and of their filter state, and ``|w|²`` of the latter; energy added by
round-off; squares of the deformations of all elements; level of round-off forces; energy removed
again; the largest energy so far; squares, and energy removed again, of cells of nodes other than
frames; and squares and works of all ranks. Except for sums over cells and what they remove, numbers
are those of all ranks."""


class Scheme(NamedTuple):
    """Parameters of a scheme.

    Attributes:
        h: Step size.
        dissipation: Dissipation parameter χ, see :mod:`fem_lie.solve.conserving.step.dissipation`.
        filter_gain: Filter gain μ.
    """

    h: float
    dissipation: float
    filter_gain: float


class Masters(NamedTuple):
    """Master nodes, see :class:`~fem_lie.system.nodes.numbering.MasterMap`.

    Attributes:
        master: Master node of each node, (N,).
        offset: Frame of each node in the frame of its master, (N, 4, 3).
        trivial: Whether all nodes are their own masters, and no frame rotates with an edge.
        edges: Nodes with frames along edges, and the other nodes of these edges, (k, 2), see
            :mod:`fem_lie.solve.conserving.midpoint.any_node`.
    """

    master: Integers1
    offset: Frames
    trivial: bool
    edges: Integers2


class Segments(NamedTuple):
    """Segments of lines under pressure.

    Attributes:
        pairs: Their nodes, (s, 2).
        across: Axes across them times the pressure, (s, 3); may change in time.
    """

    pairs: Integers2
    across: Numbers2


class Incidences(NamedTuple):
    """Constraint-node incidences, see :class:`~fem_lie.linear.saddle_point.Incidences`.

    Attributes:
        nodes: Node of each incidence.
        constraints: Constraint of each incidence.
    """

    nodes: Integers1
    constraints: Integers1


class IncidencePositions(NamedTuple):
    """Unknowns in which the matrix changes with the constraints, if these are few.

    Attributes:
        unknowns: Indices of these unknowns, (k,).
        at: Positions among them of the node and of the multiplier of each incidence, (2,
            incidences).
        inverse: Inverse of the frozen matrix in these unknowns, columns first, (k, k). If empty (0,
            0), the complete system is solved instead.
        columns: The same in all unknowns, (k, 6 n + m), or empty, if there are too many: then the
            complete system is solved for the sum of terms.
    """

    unknowns: Integers1
    at: Integers2
    inverse: Numbers2
    columns: Numbers2


class Model(NamedTuple):
    """Constants of a step.

    Attributes:
        cells: All cells of frames.
        joints: Packed arrays of all joints.
        inertia: Mass matrix of nodal coordinates, and of products of reduced-order bodies, see
            :mod:`fem_lie.solve.conserving.midpoint.reduced_bodies`; n + p.
        damping: Mass-proportional damping matrix; empty if there is none.
        masters: Master nodes.
        held: Which unknowns are zero, 0 or 1, (n, 6).
        measure: Norm weight of each unknown and scaled multiplier, shape (6 n + m,).
        scale: Scale of each constraint, (m,).
        loads: Loads at the midpoint of the step; ``dead`` on coordinates with inertia; may change
            in time.
        conservative: The part of ``loads.dead`` with a potential, (n + p, 4, 3).
        pressure: Segments under pressure.
        viscous: Whether cells have viscous forces.
        scheme: Parameters.
        probes: Packed arrays of the reported joint coordinates.
        driven: Increments of the constraints' targets in the step, (m,); may change in time.
        supported: Which unknowns of owned nodes have supports, 0 or 1, (n, 6).
        incidences: Constraint-node incidences.
        ends: Positions of the incidences in the dense inverse.
        kinds: Types of the nodes, (n,).
        arms: Moment arm of both halves of each node, which converts its loads to forces, (n, 2).
        vector_cells: Cells of nodes other than frames.
        of_frames: As ``measure`` for frames and constraints between frames only, else zero.
        addresses: Addresses of callbacks, zero without, and flags, see :data:`FORCES`, (11,).
        bodies: Reduced-order bodies.
        light: Projectors on free rotations of frames without inertia, in the axes of the nodes, (n,
            3, 3), or (0, 3, 3) if there are none.
        owned: Whether a node counts as one of this rank, 0 or 1, (n,); each has one owner.
        vectors: Whether there are nodes other than frames, on any rank.
        total: Number of cells of all ranks.
        signs: Signs of a perturbation of all unknowns, (6 n + m,).
    """

    cells: CellArrays
    joints: PackedJoints
    inertia: Inertia
    damping: Inertia
    masters: Masters
    held: IntegerSixes
    measure: Numbers1
    scale: Numbers1
    loads: Loads
    conservative: Frames
    pressure: Segments
    viscous: bool
    scheme: Scheme
    probes: PackedJoints
    driven: Numbers1
    supported: IntegerSixes
    incidences: Incidences
    ends: IncidencePositions
    kinds: Integers1
    arms: Numbers2
    vector_cells: VectorCells
    of_frames: Numbers1
    addresses: Integers1
    bodies: PackedBodies
    light: Numbers3
    owned: Integers1
    vectors: bool
    total: int
    signs: Numbers1


class State(NamedTuple):
    """Start of a step.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions, (n + 1 + p, 4, 3).
        rest: Digits of ``H`` beyond double precision, (n, 4, 3).
        V: Velocities of (x, d₁, d₂, d₃), and of products, (n + p, 4, 3).
        multipliers: Lagrange multipliers, (m,).
        gap: Values of the constraints, (m,).
        F: Forces of the cells, in the frames of their nodes, (cell nodes, 6).
        W: Energies of the cells, frames first and reduced-order bodies last, (M,).
        account: Work done on each cell, (M,).
        w: Filter state of changes of velocity, (n + p, 4, 3).
        w_F: Filter state of changes of forces, (cell nodes, 6).
        filter_state: Numbers of the filters and of round-off, see :data:`FILTER`.
        last_residual: Residual forces of the last step, and moments about the current positions of
            nodes, global components, (n, 6); zero except for owned nodes.
        balance: Work of non-conservative loads and drives, of damping, numerical dissipation, and
            impulses of loads and of reactions, (15,).
        trend: Half the change of the nodes' spatial velocities in the last step, per time, (n, 6).
        earlier: Multipliers of the two steps before the last one, (2, m).
        sizes: Sizes of the last three steps since the start or an event, 0 for those before, (3,).
        border: Constraint rows and columns of the frozen matrix, (2, incidences, 6).
        slow: See :func:`~fem_lie.solve.conserving.step.corrections.accelerate`, (2, 6 n + m);
            without dissipation (0, 6 n + m).
        share: See :func:`~fem_lie.solve.conserving.step.corrections.accelerate`, (2,).
        probe: See :func:`~fem_lie.solve.conserving.step.series.growth`, (6 n + m,).
        cell_forces: Forces of cells of nodes other than frames, and the filter state of their
            changes, see :mod:`fem_lie.solve.conserving.vector_cells.force_changes`, (2, cell nodes,
            2, 3); empty without dissipation.
        rates: Accelerations of increments: means over the last step and the one before, (2, n, 6).
        within: Filter state of changes of stresses of reduced-order bodies, (coordinates,); without
            dissipation (0,).
    """

    H: Frames
    rest: Frames
    V: Frames
    multipliers: Numbers1
    gap: Numbers1
    F: Sixes
    W: Numbers1
    account: Numbers1
    w: Frames
    w_F: Sixes
    filter_state: Annotated[Records, one(FILTER)]
    last_residual: Sixes
    balance: Numbers1
    trend: Sixes
    earlier: Numbers2
    sizes: Numbers1
    border: ManySixes
    slow: Numbers2
    share: Numbers1
    probe: Numbers1
    cell_forces: Numbers4
    rates: ManySixes
    within: Numbers1


class Products(NamedTuple):
    """Velocities in the metric of inertia, see :mod:`.dissipation`.

    Attributes:
        δ: ``Δq/h − V``, (n + p, 4, 3).
        Gδ: The mass matrix times ``δ``.
        GV: The mass matrix times ``V``.
        sums: Sums for each pair of (V, δ, w), (3, 3, 3, 3).
    """

    δ: Array
    Gδ: Array
    GV: Array
    sums: Array


class Step(NamedTuple):
    """The current step, and workspace.

    Attributes:
        step: Spatial translation and rotation of the nodes, (n, 6).
        coordinates: :class:`Span` of all nodes, ground and prescribed frames, (4, r, 4, 3).
        V1: Velocities at the end, (n + p, 4, 3).
        F1: Forces of the cells at the end, (cell nodes, 6).
        W1: Energies of the cells at the end, (M,).
        work: Work done on them in the step, (M,).
        change: Increments of the constraints, (m,).
        losses: Work of drives, of damping, numerical dissipation in the step, and forces and
            moments about the origin of pressure and mass damping, and of reactions, (15,).
        start: Frames of all nodes at the start, (N, 4, 3).
        nodes: :class:`Span` of all nodes, (4, N, 4, 3).
        exact: Increments of all nodes with ``rest``, (N, 4, 3).
        steps: Translation and rotation of all nodes, (N, 6).
        twists: Twists in midpoint frames, (N, 6).
        on_nodes: Forces on all nodes, (N, 6).
        forces: Forces on the master nodes, (n, 6).
        q: Workspace for inertia, (2, n + p, 4, 3).
        F_viscous: Viscous forces of the cells, (cell nodes, 6).
        r: :class:`Solution` of the equations, (5, 6 n + m).
        multipliers: Lagrange multipliers at the start of the step, (m,).
        filtered: Forces of the changes of elastic forces, of their filter state, and the resulting
            dissipative force, on all nodes, (3, N, 6).
        border: Difference of constraint rows and columns from those of the matrix, (2, incidences,
            6).
        sums: Sums of :class:`Products`, (3, 3, 3, 3).
        own: Arrays of :class:`Products`, (3, n + p, 4, 3).
        turnings: Contribution of dissipation that the matrix lacks, see :mod:`.dissipation`, (2, 3,
            6 n); without dissipation (2, 0, 6 n).
        gains: Gains of the cells' energies, (M,).
        cell_forces: Forces at the end of cells of nodes other than frames, their changes and filter
            state, see :mod:`fem_lie.solve.conserving.vector_cells.force_changes`, (3, cell nodes,
            2, 3).
        changes: Forces on nodes of these changes and of their filter state, (2, n, 6).
        outer: Forces of Python callbacks, along increments, (n, 6).
        moved: Increments of all coordinates with inertia, (n + p, 4, 3); without products the same
            array as in ``coordinates``.
        products: Means of the products, (p, 4, 3).
        within: Modal coordinates over the step, see
            :data:`~fem_lie.solve.conserving.midpoint.reduced_bodies.START`, (3, coordinates).
        common: Numbers that ranks exchange, (:data:`COMMON`,).
    """

    step: Sixes
    coordinates: ManyFrames
    V1: Frames
    F1: Sixes
    W1: Numbers1
    work: Numbers1
    change: Numbers1
    losses: Numbers1
    start: Frames
    nodes: ManyFrames
    exact: Frames
    steps: Sixes
    twists: Sixes
    on_nodes: Sixes
    forces: Sixes
    q: ManyFrames
    F_viscous: Sixes
    r: Numbers2
    multipliers: Numbers1
    filtered: ManySixes
    border: ManySixes
    sums: Numbers4
    own: ManyFrames
    turnings: Numbers3
    gains: Numbers1
    cell_forces: Numbers4
    changes: ManySixes
    outer: Sixes
    moved: Frames
    products: Frames
    within: Numbers2
    common: Numbers1


class Span(NamedTuple):
    """Kinematics over a step of k nodes, (k, 4, 3), see :mod:`..midpoint.cayley`.

    Attributes:
        end: Frames at the end.
        mean: Means of (x, d₁, d₂, d₃).
        middle: Mean positions with the half rotations.
        delta: Increments of (x, d₁, d₂, d₃).
    """

    end: Array
    mean: Array
    middle: Array
    delta: Array


class Solution(NamedTuple):
    """Solution of the equations; each array has shape (6 n + m,).

    Attributes:
        residual: Residual.
        x: Correction.
        work: Workspace of the solver.
        rest: Remaining residual of a solution.
        term: Solution for it.
    """

    residual: Array
    x: Array
    work: Array
    rest: Array
    term: Array


@inlined
def span_of(coordinates: Array) -> Span:
    """Unpack ``coordinates`` (4, k, 4, 3)."""
    return Span(coordinates[0], coordinates[1], coordinates[2], coordinates[3])


@inlined
def products_of(this: Step) -> Products:
    """Unpack the products of a step."""
    return Products(this.own[0], this.own[1], this.own[2], this.sums)


@inlined
def solution_of(r: Array) -> Solution:
    """Unpack ``r`` (5, size)."""
    return Solution(r[0], r[1], r[2], r[3], r[4])

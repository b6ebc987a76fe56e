"""What stays the same of equations: numbers, sizes, what is held, and arrays for compiled code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Body
from fem_lie.forms.assembly import BodyTerm
from fem_lie.forms.term import Term
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.joints.redundant import Redundant
from fem_lie.lie.node_types.floating import Floating
from fem_lie.lie.node_types.inertia import Inertia, turning_of
from fem_lie.lie.polar import PlainSurroundings
from fem_lie.system import describe
from fem_lie.system.balance import supported
from fem_lie.system.constraint_sets.all_pairs import AllPairs
from fem_lie.system.nodes.masses import Loads
from fem_lie.system.potential import has_potential
from fem_lie.system.system import System


class Unknowns(NamedTuple):
    """Which unknowns there are: those of ``moving`` nodes, then ``m`` multipliers.

    Attributes:
        moving: Nodes ``n`` that move, six unknowns each.
        m: Constraints.
        size: All unknowns, ``6 n + m``.
        length: Of the model, that of tolerances.
        kinds: What each node is, (n,), see :mod:`fem_lie.lie.node_types`.
        lengths: Which halves of the unknowns of the nodes are lengths, (n, 2); others have no
            dimension.
        held: Which unknowns of the nodes are zero, (n, 6).
        supported: Nodes that something holds, (s,), of which reactions are told.
        uncoupled: Which nodes move by ``x + R u`` in statics, tilted and then drilled, (n,).
        straight: Which of the others do, turned at once, (n,).
        angular: Which constraints are angles, (m,).
        joined: Which of them are one vector with the one before, (m,).
        vectors: The constraints of the vector of each, (m, w); beyond its end any.
        of_velocities: How many constraints, the last, bind velocities.
        connections: Number of joints and what else results tell the forces of.
        masters: The moving nodes among all, (n,).
        total: All nodes, those that follow others included.
        bodies: Which of all nodes are whose.
        rigid: Whether there are no elements.
        time_dependent: Whether loads, drives or prescribed motions change in time.
        driven: Whether targets of constraints do.
        strains_change: Whether strains without stress do.
        preloaded: Whether there are springs with a rest value of their own.
        may_be_redundant: Whether constraints may follow from others.
        other_constraints: What constraints are called that no pair of frames has.
        other_springs: Whether there are springs along coordinates of these.
        drilling: Shells whose nodes turn about their third directors.
        floating: Bodies that deform within their frames.
        has_potential: Whether all loads have one.
        apart: Whether some of the matrix may be beside it.
        summary: What there is, in one line for the log.
    """

    moving: int
    m: int
    size: int
    length: float
    kinds: Indices
    lengths: Flags
    held: Flags
    supported: Indices
    uncoupled: Flags
    straight: Flags
    angular: Flags
    joined: Flags
    vectors: Indices
    of_velocities: int
    connections: int
    masters: Indices
    total: int
    bodies: Mapping[Body, Indices]
    rigid: bool
    time_dependent: bool
    driven: bool
    strains_change: bool
    preloaded: bool
    may_be_redundant: bool
    other_constraints: Sequence[str]
    other_springs: bool
    drilling: Sequence[str]
    floating: Sequence[str]
    has_potential: bool
    apart: bool
    summary: str

    @property
    def units(self) -> Array:
        """Unit of each unknown of the nodes, (6 n,): the length of the model, or 1."""
        return np.repeat(np.where(self.lengths, self.length, 1.0).ravel(), 3)

    @classmethod
    def of(cls, system: System) -> Unknowns:
        """Those of a system."""
        numbering, connections = system.numbering, system.connections
        shown = numbering, system.terms, system.kinds, system.m
        potential = has_potential(system)
        return cls(
            moving=system.count,
            m=system.m,
            size=system.size,
            length=system.length,
            kinds=system.kinds,
            lengths=system.lengths,
            held=system.held,
            supported=system.supported,
            uncoupled=system.uncoupled,
            straight=numbering.straight,
            angular=connections.angular,
            joined=connections.joined,
            vectors=system.tangent.vectors.others,
            of_velocities=connections.of_velocities,
            connections=len(connections.items),
            masters=numbering.master_map.masters,
            total=numbering.total,
            bodies=numbering.nodes,
            rigid=not numbering.assemblies,
            time_dependent=system.time_dependent,
            driven=connections.driven,
            strains_change=system.load_cases.strains_change,
            preloaded=connections.preloaded,
            may_be_redundant=system.scene.redundant is not Redundant.REFUSE,
            other_constraints=connections.others,
            other_springs=any(len(each.springs) > 0 for each in connections.sets[1:]),
            drilling=[b.label for b, six in numbering.drills.items() if b.uncoupled and six],
            floating=[b.label for b in numbering.nodes if b.within_frame() is not None],
            has_potential=potential,
            apart=any(term.low_rank is not None for term in system.terms),
            summary=describe.in_one_line(*shown, time_dependent=system.time_dependent),
        )


class Start(NamedTuple):
    """Initial values of all rows: moving nodes, ground, prescribed motions.

    Attributes:
        frames: Shape (n + 1 + p, 4, 3).
        velocities: Local twists, same rows, (…, 6).
        unloaded: Frames where nothing is strained, same rows.
    """

    frames: Array
    velocities: Array
    unloaded: Array


class Tables(NamedTuple):
    """Arrays that stay where they are, for compiled code that goes round the verbs.

    Attributes:
        kinds: What each moving node is, (n,).
        master: Of each node, (N,).
        offset: Its frame in that of its master node, (N, 4, 3).
        inertia: Mass matrix on (x, d₁, d₂, d₃).
        turning: Angular velocities of rates of directors, see
            :func:`~fem_lie.lie.node_types.inertia.turning_of`, (n, 3, 3, 3).
        floating: Inertia of bodies that deform within their frames, beyond that.
        damping: Damping that goes with mass, likewise; empty without.
        loads: At the time that was set last.
        conservative: Loads with a potential on (x, d₁, d₂, d₃), (n, 4, 3).
        joints: Table of constraints of joints, and springs.
        probes: That of the coordinates that results tell.
        pairs: Those of which forces are told, (f,).
        sides: Of these pairs, (f,).
        owner: Connection of each constraint, (m,).
        limits: Turns that elements may make, (w,).
        ends: Nodes of these elements from end to end, (w, 3).
        whole: Whether whole frames turn, (w,).
        lengths: Unloaded lengths of those that are judged by their strain, else zero, (w,).
        chords: Unloaded chords along the mean axes of both ends, (w, 3).
        supported: Which unknowns of the nodes are held from outside, (n, 6).
        assemblies: Those of elements, with their part of all nodes.
        terms: All that adds forces.
        complete: Whether forces of joints follow from these tables and the multipliers alone.
        in_one_sum: Whether a residual is the compiled sum of :attr:`.Forces.table`, but for what is
            held.
        stored: Cells whose energy is all that bodies have, as two arrays, see
            :class:`~fem_lie.forms.cell_forms.FormTable`; ``None`` if there is more.
        pairs_of_all: All relative motions of nodes and attachments, where some nodes have no frame
            and there are no other constraints; else ``None``.
        edges: Nodes with frames along the edge to another node, and those others, among all nodes,
            (k, 2).
        turns: Whether joints count their turns.
        around: Places whose axes follow what is around them, turned after each step.
        drills: Whether other axes do, of a mid-surface or as bodies say.
    """

    kinds: Indices
    master: Indices
    offset: Array
    inertia: Inertia
    turning: Array
    floating: Floating
    damping: Inertia
    loads: Loads
    conservative: Array
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
    supported: Flags
    assemblies: Sequence[tuple[slice, BodyTerm]]
    terms: Sequence[Term]
    complete: bool
    in_one_sum: bool
    stored: tuple[Indices, Indices] | None
    pairs_of_all: AllPairs | None
    edges: Indices
    turns: bool
    around: PlainSurroundings
    drills: bool

    @classmethod
    def of(cls, system: System) -> Tables:
        """Those of a system."""
        master_map, connections = system.numbering.master_map, system.connections
        limits, ends, whole, lengths, chords = system.turns.elements
        rates = system.terms.rates
        all_felt = system.scene.redundant is not Redundant.MINIMUM_NORM or not system.m
        return cls(
            system.kinds,
            master_map.master,
            master_map.offset,
            system.inertia,
            turning_of(system.inertia, system.held),
            system.floating,
            Inertia.none() if rates is None else Inertia(*rates),
            system.lasting_loads,
            system.load_cases.constant,
            connections.packed,
            connections.packed_probes,
            *connections.reported,
            limits,
            ends,
            whole,
            lengths,
            chords,
            supported(system),
            system.numbering.assemblies,
            list(system.terms),
            complete=connections.of_joints_only and all_felt,
            in_one_sum=system.in_one_sum,
            stored=system.terms.tables[1] if system.terms.energy_in_tables else None,
            pairs_of_all=connections.all_pairs(system.frames, system.kinds),
            edges=_edges(system.numbering.nodes),
            turns=connections.first.turns,
            around=system.carried_axes.plain,
            drills=any(each is not system.carried_axes for each in system.carried),
        )


def _edges(bodies: Mapping[Body, Indices]) -> Indices:
    """Those of all bodies, each of which has these of all nodes."""
    found = [nodes[body.edge_frames] for body, nodes in bodies.items()]
    return np.concatenate([np.empty((0, 2), dtype=np.int64), *found])

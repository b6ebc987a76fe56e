"""Constant properties of the equations: numbers, supports, and packed arrays for compiled code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Body
from fem_lie.forms.assembly import BodyTerm
from fem_lie.forms.term import Term
from fem_lie.joints.equations.joint_arrays import PackedJoints
from fem_lie.joints.joint import RedundantConstraints
from fem_lie.lie.node_types.floating import Floating
from fem_lie.lie.node_types.inertia import Inertia, director_inertia, turning_of
from fem_lie.lie.polar import PlainSurroundings
from fem_lie.system import describe
from fem_lie.system.balance import supported
from fem_lie.system.constraint_sets.all_pairs import AllPairs
from fem_lie.system.nodes.masses import Loads
from fem_lie.system.potential import has_potential
from fem_lie.system.system import System


class Unknowns(NamedTuple):
    """The unknowns: six of each of ``moving`` nodes, then ``m`` Lagrange multipliers.

    Attributes:
        moving: Number n of moving nodes.
        m: Number of constraints.
        constraints: Number of constraints of all parts of a divided scene.
        degrees_of_freedom: Number of free unknowns less that of constraints, of all parts.
        size: Number of unknowns, ``6 n + m``.
        length: Length of the model, the scale of tolerances.
        kinds: Type of each node, (n,), see :mod:`fem_lie.lie.node_types`.
        lengths: Whether the first and the last three unknowns of the nodes are lengths, (n, 2);
            others have no dimension.
        held: Unknowns of the nodes that are zero, (n, 6).
        supported: Supported nodes, whose reactions are reported, (s,).
        separates_director: Nodes that statics moves by ``x + R u``, tilts and then drills, (n,).
        separates_rotation: Other nodes that move by ``x + R u``, with one rotation, (n,).
        angular: Whether a constraint is an angle, (m,).
        joined: Whether a constraint belongs to the vector of the one before, (m,).
        vectors: Constraints of the vector of each, (m, w); arbitrary beyond its end.
        of_velocities: Number of velocity constraints, the last.
        connections: Number of joints, springs, drives and gears in results.
        masters: Numbers of the moving nodes among all, (n,).
        total: Number of all nodes, attached ones included.
        bodies: Numbers of the nodes of each body.
        rigid: Whether there are no elements.
        time_dependent: Whether loads, drives, prescribed motions or force laws depend on time.
        has_laws: Whether there are force laws.
        prescribes: Whether loads, drives or prescribed motions do.
        laws_without_potential: Whether there are force laws without a potential.
        joint_friction: Whether joints have friction.
        driven: Whether targets of constraints depend on time.
        strains_change: Whether stress-free strains depend on time.
        preloaded: Whether there are springs with a prescribed rest value.
        may_be_redundant: Whether constraints may be redundant.
        other_constraints: Descriptions of constraints that are not between two frames.
        other_springs: Descriptions of these that have springs.
        drilling: Shells whose nodes have drilling rotations.
        floating: Bodies that deform within their frames.
        has_potential: Whether all loads have a potential.
        has_low_rank: Whether the matrix may have a separate low-rank correction.
        summary: Summary of the scene, in one line for the log.
    """

    moving: int
    m: int
    constraints: int
    degrees_of_freedom: int
    size: int
    length: float
    kinds: Indices
    lengths: Flags
    held: Flags
    supported: Indices
    separates_director: Flags
    separates_rotation: Flags
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
    has_laws: bool
    prescribes: bool
    laws_without_potential: bool
    joint_friction: bool
    driven: bool
    strains_change: bool
    preloaded: bool
    may_be_redundant: bool
    other_constraints: Sequence[str]
    other_springs: Sequence[str]
    drilling: Sequence[str]
    floating: Sequence[str]
    has_potential: bool
    has_low_rank: bool
    summary: str

    @property
    def units(self) -> Array:
        """Unit of each unknown of the nodes, (6 n,): the length of the model, or 1."""
        return np.repeat(np.where(self.lengths, self.length, 1.0).ravel(), 3)

    def mode_count(self, count: int | None, default: int) -> int:
        """A number of modes; default: ``default``, or the degrees of freedom if they are fewer.

        Raises:
            ValueError: It is not between 1 and the degrees of freedom.
        """
        if count is None:
            count = min(default, max(self.degrees_of_freedom, 1))
        if not 1 <= count <= self.degrees_of_freedom:
            raise ValueError(
                f"count must be 1 … {self.degrees_of_freedom}, the degrees of freedom, got {count}"
            )
        return count

    @classmethod
    def of(cls, system: System) -> Unknowns:
        """Unknowns of a system."""
        numbering, connections = system.numbering, system.connections
        shown = numbering, system.terms, system.kinds, system.m
        shared, low_rank = system.shared, any(term.low_rank is not None for term in system.terms)
        free = (~system.held[shared.owned]).sum() - system.m
        return cls(
            moving=system.count,
            m=system.m,
            constraints=int(shared.total(np.array(system.m))),
            degrees_of_freedom=int(shared.total(np.array(free))),
            size=system.size,
            length=system.length,
            kinds=system.kinds,
            lengths=system.lengths,
            held=system.held,
            supported=system.supported,
            separates_director=system.separates_director,
            separates_rotation=numbering.separates_rotation,
            angular=connections.angular,
            joined=connections.joined,
            vectors=system.tangent.vectors.others,
            of_velocities=connections.of_velocities,
            connections=len(connections.items),
            masters=numbering.master_map.masters,
            total=numbering.total,
            bodies=numbering.nodes,
            rigid=shared.all(not numbering.assemblies),
            time_dependent=shared.any(system.time_dependent or connections.laws_depend_on_time),
            has_laws=shared.any(connections.has_laws),
            prescribes=system.prescribes,
            laws_without_potential=shared.any(connections.laws_depend_on_time),
            joint_friction=shared.any(connections.has_friction),
            driven=shared.any(connections.driven),
            strains_change=shared.any(system.load_cases.strains_change),
            preloaded=shared.any(connections.preloaded),
            may_be_redundant=system.scene.redundant is not RedundantConstraints.REFUSE,
            other_constraints=connections.others,
            other_springs=[each.what for each in connections.sets[1:] if len(each.springs)],
            drilling=[
                b.label
                for b, six in numbering.has_drilling.items()
                if b.model.separates_director and six
            ],
            floating=[b.label for b in numbering.nodes if b.model.floating_modes() is not None],
            has_potential=shared.all(has_potential(system)),
            # solutions for a correction are solutions of all ranks
            has_low_rank=low_rank and not shared.several,
            summary=describe.in_one_line(*shown, time_dependent=system.time_dependent),
        )


class Start(NamedTuple):
    """Initial values of moving nodes, ground and prescribed motions.

    Attributes:
        frames: Current frames at the start, shape (n + 1 + p, 4, 3).
        velocities: Local twists, same rows, (…, 6).
        unloaded: Frames of the unstrained configuration, same rows.
    """

    frames: Array
    velocities: Array
    unloaded: Array


class SystemArrays(NamedTuple):
    """Packed arrays with fixed addresses, for compiled code that bypasses the interface.

    Attributes:
        kinds: Type of each moving node, (n,).
        master: Master node of each node, (N,).
        offset: Frame of each node in that of its master node, (N, 4, 3).
        inertia: Mass matrix on (x, d₁, d₂, d₃).
        turning: Map from rates of directors to angular velocities, see
            :func:`~fem_lie.lie.node_types.inertia.turning_of`, (n, 3, 3, 3).
        floating: Further inertia of bodies that deform within their frames.
        damping: Mass-proportional damping on (x, d₁, d₂, d₃); empty without.
        loads: Loads at the time that was set last.
        conservative: Loads with a potential on (x, d₁, d₂, d₃), (n, 4, 3).
        changing: Nodes with loads fixed in space that change in time, (n,).
        joints: Joint constraints and springs.
        probes: Coordinates in results.
        probed: Numbers of these among all coordinates in results, increasing, (p,).
        pairs: Pairs of frames whose forces are reported, (f,).
        sides: Reported sides of these pairs, (f,).
        items: Items to whose forces these pairs add, (f,).
        owner: Item of each constraint, (m,).
        limits: Largest rotations of elements, rad, (w,).
        ends: Nodes of these elements from end to end, (w, 3).
        whole: Whether the rotation of whole frames counts, (w,).
        lengths: Unloaded lengths of elements whose strain is checked, else zero, (w,).
        chords: Unloaded chords along the mean axes of both ends, (w, 3).
        supported: Unknowns of the nodes held from outside, (n, 6).
        assemblies: Assemblies of elements, with their slice of all nodes.
        terms: All terms.
        complete: Whether joint forces follow from these arrays and the Lagrange multipliers only.
        in_one_sum: Whether a residual is the compiled sum of :attr:`.Forces.addresses` only,
            except for held unknowns.
        stored: Cells with all stored energy of bodies, as two arrays, see
            :class:`~fem_lie.forms.cell_forms.FormArrays`; ``None`` if there is more.
        pairs_of_all: Relative motions of nodes and attachments, if some nodes have vector
            coordinates; else ``None``.
        edges: Nodes with a frame along the edge to another node, and these other nodes, (k, 2).
        turns: Whether joints count their turns.
        around: Position nodes with convected axes, rotated after each step.
        drills: Whether other nodes have convected axes.
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
    changing: Flags
    joints: PackedJoints
    probes: PackedJoints
    probed: Indices
    pairs: Indices
    sides: Indices
    items: Indices
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
    def of(cls, system: System) -> SystemArrays:
        """Packed arrays of a system."""
        master_map, connections = system.numbering.master_map, system.connections
        limits, ends, whole, lengths, chords = system.rotations.elements
        rates = system.terms.rates
        directors = director_inertia(system.inertia, system.count)
        system.shared.sum(directors)
        all_felt = system.scene.redundant is not RedundantConstraints.MINIMUM_NORM or not system.m
        all_act = not system.scene.switched
        return cls(
            system.kinds,
            master_map.master,
            master_map.offset,
            system.inertia,
            turning_of(directors, system.held),
            system.floating,
            Inertia.none() if rates is None else Inertia(*rates),
            system.lasting_loads,
            system.load_cases.constant,
            system.load_cases.changing,
            connections.packed,
            connections.packed_probes,
            connections.first.probed,
            *connections.reported,
            limits,
            ends,
            whole,
            lengths,
            chords,
            supported(system),
            system.numbering.assemblies,
            list(system.terms),
            complete=connections.of_joints_only and all_felt and all_act,
            in_one_sum=system.in_one_sum,
            stored=system.terms.tables[1] if system.terms.energy_in_tables else None,
            pairs_of_all=connections.all_pairs(system.frames, system.kinds),
            edges=_edges(system.numbering.nodes),
            turns=connections.first.turns,
            around=system.convected_axes.plain,
            drills=any(each is not system.convected_axes for each in system.convected),
        )


def _edges(bodies: Mapping[Body, Indices]) -> Indices:
    """Edges of all bodies in the numbering of all nodes."""
    found = [nodes[body.model.edge_frames] for body, nodes in bodies.items()]
    return np.concatenate([np.empty((0, 2), dtype=np.int64), *found])

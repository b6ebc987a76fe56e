"""The equations of a scene: residual, tangent matrix and invariants on nodes in local frames.

Unknowns are six per moving node (all bodies, type by type) and one Lagrange multiplier per
constraint. A node that is rigidly attached to a master node has none and appears in results only.
In every array the rows of frames that do not move by themselves follow those of the moving nodes:
ground first, then the prescribed motions. Index 3 equations at a time level::

    Lᵀ G q̈ + f_elastic(H) − f_load(H, t) + Bᵀ λ = 0,     Φ(H) = 0
"""

from __future__ import annotations

import logging
from collections.abc import Collection

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import MassMatrix
from fem_lie.joints.joint import RedundantConstraints
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.lie.node_types.inertia import Inertia, PlainEnds
from fem_lie.linear.redundancy import redundant_constraints
from fem_lie.parts.part_scene import ScenePart
from fem_lie.scene import Scene
from fem_lie.system.constraints import Connections
from fem_lie.system.describe import refuse
from fem_lie.system.load_cases import LoadCases
from fem_lie.system.nodes.convected_axes import BodyAxes, ConvectedAxes, ConvectedDrilling
from fem_lie.system.nodes.element_rotations import ElementRotations
from fem_lie.system.nodes.masses import Loads, floating_of, inertia_of, weight_of
from fem_lie.system.nodes.numbering import numbering_for
from fem_lie.system.nodes.parts import shared_nodes
from fem_lie.system.nodes.sums import add_joints, nodal_residual, report, residual
from fem_lie.system.parts import Sharing
from fem_lie.system.tangent import Tangent, every, whole
from fem_lie.system.terms.all_terms import terms_of
from fem_lie.system.time_state import Forces, NodalData, Plan, TimeState

_log = logging.getLogger(__name__)


class System:
    """The equations of a scene.

    Attributes:
        count: Number n of moving nodes; the ``size`` unknowns are six of each and ``m``
            multipliers.
        frames: Initial frames, shape (n + 1 + p, 4, 3): moving nodes, ground, prescribed motions.
        velocities: Initial local velocities, same rows, (…, 6).
        connections: All joints, springs, drives and gears; ``table`` is the table of the first set.
        kinds: Type of each moving node, shape (n,), see :mod:`fem_lie.lie.node_types`.
        held: Unknowns of the moving nodes that are zero, shape (n, 6).
        supported: Moving nodes that clamps and bodies support, shape (s,).
        separates_director: Moving nodes that move by ``x + R u`` in statics, shape (n,).
        inertia: Mass matrix of the moving nodes, zero in statics without gravity.
        floating: Further inertia of bodies that deform within their frames.
        rows: Frames of all nodes, ground and prescribed motions at the start.
        load_cases: Loads as functions of time.
        loads: Loads at the time that was set last; ``lasting_loads``: the same in fixed arrays.
        terms: All terms that add forces and stiffness besides inertia, nodal loads and constraints.
        elastic: Terms of bodies.
        tangent: Tangent matrix; it is filled into ``kkt``.
        convected_drilling: Frames that follow the mid-surface, to be rotated after each step.
        convected_axes: Axes of position nodes that follow their neighbourhood.
        convected: All convected axes.
        in_one_sum: Whether :meth:`residual` is the compiled sum of :attr:`Forces.addresses` only,
            except for held unknowns.
        rotations: Rotations of elements from end to end.
        lengths: Whether the first and the last three unknowns of the nodes are lengths, shape (n,
            2); others have no dimension.
        length: Largest distance of two nodes, or size of a body: the length scale of tolerances.
        shared: Nodes that other ranks have, too.
        prescribes: Whether loads, motions or drives of any rank depend on time.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        dynamics: bool,
        parametrisation: Parametrisation = Parametrisation.EXPONENTIAL,
        group: Group | None = None,
        mass: MassMatrix = MassMatrix.CONSISTENT,
        lumped: Collection[Body] = (),
        part: ScenePart | None = None,
    ) -> None:
        """Number the unknowns and build the constant parts.

        Args:
            scene: The scene, or that of a part.
            dynamics: Whether inertia is needed.
            parametrisation: Parametrisation of the increments of :meth:`fill_matrix`.
            group: Group of all frames; default: that of each body.
            mass: Mass matrix.
            lumped: Bodies whose mass matrix is lumped whatever ``mass`` is.
            part: What this rank has of a scene that is divided; ``None``: the scene is not.

        Raises:
            ValueError: There is no body; inertia is missing; joints are redundant.
        """
        if not scene.bodies:
            raise ValueError("the scene has no body")
        self.scene = scene
        self.numbering = numbering_for(scene, self)
        self.count = self.numbering.count
        self.nodal_data = nodal = NodalData(scene, self.numbering, parametrisation, group)
        self.kinds, self.frames, self.velocities = nodal.kinds, nodal.frames, nodal.velocities
        self.held, self.supported = nodal.held, nodal.supported
        self.lengths = nodal.lengths
        self.length = nodal.length if part is None else part.length
        self.shared = shared_nodes(part, self.numbering)
        self.separates_director, self._any_held = (
            self.numbering.separates_director,
            bool(self.held.any()),
        )
        self.connections = Connections(scene, self.numbering, self.frames, self.held)
        self.table, self.m = self.connections.table, self.connections.m
        self._others = not self.connections.of_joints_only
        # without definitions the compiled functions are not called: compiling them takes seconds
        self._joined = len(self.table.nodes) > 0
        self._switched = bool(scene.switched)
        if self._switched and not dynamics:
            raise ValueError(
                f"{scene.switched[0].label} is inactive or switched by an event: expected a run of "
                "GeneralisedAlpha"
            )
        if self.connections.of_velocities and not dynamics:
            raise ValueError("KnifeEdge and RollingDisc constrain velocities: use dynamics")
        self.size = 6 * self.count + self.m
        self.inertia, damping = Inertia.zero(self.count), Inertia.none()
        if dynamics or scene.gravity.any():
            self.inertia, damping = inertia_of(scene.bodies, self.numbering, mass, lumped)
        self.floating = floating_of(self.numbering)
        self._gravity = scene.gravity
        z, n = np.zeros, self.count
        self.lasting_loads = Loads(z((n, 4, 3)), z((n, 3)), z((n, 6)))
        weight = weight_of(self.inertia, self.count, scene.gravity)
        self.load_cases = LoadCases(scene, self.numbering, weight)
        moves = bool(scene.motions) or self.connections.driven
        self.time_dependent = self.load_cases.time_dependent or moves
        self.prescribes = self.shared.any(self.time_dependent)
        numbering, loads = self.numbering, self.load_cases.terms
        between = scene.contacts, self.connections.sets
        self.terms = terms_of(numbering, loads, *between, damping, self.kinds, moving=dynamics)
        self.elastic = self.terms.chosen(lambda term: term.of_bodies)
        self.tangent = Tangent(
            self.inertia,
            self.floating,
            self.terms,
            self.connections,
            self.held,
            numbering.supports,
            self.kinds,
            redundant=scene.redundant is not RedundantConstraints.REFUSE,
            switched=bool(scene.switched),
            sharing=Sharing.POSITIONS if dynamics else Sharing.ALL,
            units=self.units,
            length=self.length,
        )
        self.rotations = ElementRotations(self.numbering)
        self.kkt, self.supports = self.tangent.kkt, self.tangent.supports
        self.kkt.shared = self.shared
        self._guided = bool(self.supports)
        held, nodes = self.held, self.connections.nodes
        self.convected_drilling = ConvectedDrilling(numbering, held, nodes, self.shared)
        self.convected_axes = ConvectedAxes(numbering, held, self.connections.bound, self.shared)
        following = BodyAxes(numbering, nodes)
        self.convected: list[ConvectedDrilling | ConvectedAxes | BodyAxes] = [
            each for each in (self.convected_drilling, self.convected_axes, following) if each
        ]
        self.kkt.inactive = self.connections.inactive
        self._check_redundant()
        self._still = np.zeros((self.count, 6))
        self._any_separates_director = bool(self.separates_director.any())
        self._some_outside_tables, self._viscous = not self.terms.all_in_tables, self.terms.viscous
        separate = self._others or self._any_separates_director or self._some_outside_tables
        settles = any(term.local is not None for term in self.terms)
        self.in_one_sum = not (separate or self._viscous or self._guided or settles)
        self._found = self.workspace()
        self._plain_inertia, self._plain_floating = self.inertia.plain, self.floating.plain
        self.set_time(scene.began.time, 1.0)

    @property
    def units(self) -> Array:
        """Unit of each unknown of the nodes, (6 n,): the length of the model, or 1."""
        return np.repeat(np.where(self.lengths, self.length, 1.0).ravel(), 3)

    def _check_redundant(self) -> None:
        acting = np.flatnonzero(~self.connections.inactive)
        B = self.tangent.jacobian(self.frames)[acting]
        units = np.asarray(self.units / self.length)
        redundant = acting[redundant_constraints(B, units, self.kkt.measure[acting])]
        if self.scene.redundant is RedundantConstraints.REFUSE:
            refuse(redundant, self.connections)
        elif len(redundant):
            _log.info("%d of %d constraints are redundant", len(redundant), self.m)

    def set_time(self, time: float, factor: float = 1.0) -> None:
        """Set loads (gravity and those without history times ``factor``) and targets at ``time``.

        Raises:
            ValueError: A history, motion or drive is not finite.
        """
        self.loads = self.load_cases.at(time, factor)
        for lasting, now in zip(self.lasting_loads, self.loads, strict=True):
            lasting[:] = now
        self._plain_loads = self.loads.plain
        self.floating.numbers[:3] = factor * self._gravity
        self.connections.set_clock(time)
        if self.connections.driven:
            self.connections.set_time(time)

    def prescribed_frames(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, shape (p, 4, 3)."""
        return self.nodal_data.prescribed(time)

    # --- equations ---

    def workspace(self) -> Forces:
        """Zero arrays for the forces of :meth:`residual` on all moving nodes."""
        constant = None
        if not self._others and not self._any_separates_director:
            mass, loads = self.inertia, self.lasting_loads
            nodes = self.kinds, *mass, *loads
            cells = *self.terms.tables[0], *self.terms.attached_cells.plain
            constant = *nodes, *self.connections.packed, None, *cells, *self.floating
        return Forces(self.count, self.terms.workspace(), constant)

    def residual(
        self,
        state: TimeState,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        *,
        per_increment: float = 1.0,
    ) -> None:
        """Equations of motion and constraints times ``scale``, into ``r`` (size,).

        Args:
            state: The state.
            scale: Scale factor of each constraint, shape (m,).
            r: Residual, overwritten.
            forces: Forces that the derivative needs, overwritten; default: not stored.
            per_increment: Factor of velocity constraints, ∂d/∂v, which makes their rows in the
                matrix like those of position constraints.
        """
        self.with_reactions(state, scale, r, forces, per_increment)
        if self._any_held:
            r[: 6 * self.count].reshape(-1, 6)[self.held] = 0.0
        if self._switched:
            r[6 * self.count :][self.connections.inactive] = 0.0

    def with_reactions(
        self,
        state: TimeState,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        per_increment: float = 1.0,
    ) -> None:
        """:meth:`residual` without zeroing the reactions of held unknowns."""
        found = self._found if forces is None else forces
        H, v, a, multipliers = state
        if found.addresses is None:
            self.applied(state, scale, r, found, per_increment)
            self.terms.add_forces(H, r, found.own)
        else:
            residual(H, v, a, multipliers, scale, r, found.addresses)
            if self._some_outside_tables:
                self.terms.add_others(H, r, found.own)
        if self._viscous:
            self.terms.add_viscous_forces(H, v, r)
        if self._any_separates_director:
            found.inner[:] = r[: 6 * self.count].reshape(-1, 6) - found.outer
        if self._guided:
            self.supports.rotate(H, r[: 6 * self.count].reshape(-1, 6))

    def applied(
        self,
        state: TimeState,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        per_increment: float = 1.0,
    ) -> None:
        """:meth:`residual` without terms other than springs and dampers of joints.

        Forces of terms in ``forces`` stay as they are.
        """
        found = self._found if forces is None else forces
        H, v, a, multipliers = state
        mass, loads, joints = self._plain_inertia, self._plain_loads, self.connections.packed
        nodal_residual(self.kinds, (H, v, a), mass, self._plain_floating, loads, found.work, r)
        if self._joined:
            add_joints(H, v, joints, multipliers, scale, self.count, r)
        if self._others:
            self.connections.add_others(H, v, multipliers, scale, per_increment, r)
        if self._any_separates_director:
            found.outer[:] = r[: 6 * self.count].reshape(-1, 6)

    def follow_motion(self, forces: Forces) -> None:
        """Turn the matrix into the derivative along the motion of statics.

        The parts are derivatives in twists of forces in local axes. The correction is linear in the
        sum of all forces on a node, which is zero at equilibrium.
        """
        if self._any_separates_director:
            total = np.where(self.nodal_data.turning, forces.outer + forces.inner, 0.0)
            self.tangent.add_turnings(total, self.separates_director)

    def fill_matrix(self, state: TimeState, forces: Forces, plan: Plan) -> Array:
        """Fill the KKT matrix with the derivative of :meth:`residual` in the increments of a state.

        Args:
            state: The state.
            forces: Forces of the residual there.
            plan: Contents of the matrix, complete.

        Returns:
            The scale of the constraints in it, (m,).
        """
        H, v, _, multipliers = state
        tangent, damping = self.tangent, plan.damping
        loads = (forces.on_rows, self.loads.moment) if plan.matrix_terms.geometric else None
        factors = plan.mass, damping
        ends = _ends(plan)
        if not plan.matrix_terms.gyroscopic:
            state, ends = state._replace(v=self._still, a=self._still), None
        tangent.clear()
        tangent.add_inertia(state, self.kinds, loads, factors, ends)
        tangent.add_terms(H, forces.own, whole if plan.without_low_rank else every, ends=plan.ends)
        if damping != 0.0:
            tangent.add_viscosity(H, v, damping)
            tangent.add_friction(H, v, multipliers, damping)
        if plan.matrix_terms.geometric:
            tangent.add_geometric(H, multipliers)
        self.follow_motion(forces)
        return tangent.fill_increments(H, self.kinds, plan)

    def report(self, H: Array, v: Array, invariants: Array) -> float:
        """Set kinetic energy, momentum and angular momentum, (7,).

        Returns:
            Potential of the loads that have one.
        """
        mass, bodies, dead = self._plain_inertia, self._plain_floating, self.load_cases.constant
        work = self._found.work
        return float(report(self.kinds, H, v, mass, bodies, dead, work, invariants))


def _ends(plan: Plan) -> PlainEnds | None:
    """Ends of the step whose momenta the matrix changes; ``None``: inertia is at the state."""
    start, end = plan.forces_at, plan.joint_frames
    if plan.start_forces is None:
        return None
    assert start is not None and end is not None and plan.end_motions is not None
    return (start, end), (plan.start_forces, plan.end_motions)

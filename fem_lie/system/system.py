"""The equations of a scene: residual, matrix and invariants on nodes in local frames.

Unknowns are six per moving node (all bodies, kind by kind) and one multiplier per constraint. A
node that follows another rigidly has none and appears in results only. The frames of what does not
move by itself follow the moving ones in every array: ground first, then the prescribed motions.
Index 3 equations at a time level::

    Lᵀ G q̈ + f_elastic(H) − f_load(H, t) + Bᵀ λ = 0,     Φ(H) = 0
"""

from __future__ import annotations

import logging

import numpy as np

from fem_lie._arrays import Array
from fem_lie.joints.redundant import Redundant
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.linear.redundancy import redundant_constraints
from fem_lie.scene import Scene
from fem_lie.system.constraints import Connections
from fem_lie.system.describe import refuse
from fem_lie.system.load_cases import LoadCases
from fem_lie.system.nodes.carried_axes import CarriedAxes, CarriedDrilling, FollowingAxes
from fem_lie.system.nodes.element_turns import ElementTurns
from fem_lie.system.nodes.masses import Loads, floating_of, inertia_of, lumped, weight_of
from fem_lie.system.nodes.numbering import numbering_for
from fem_lie.system.nodes.sums import add_joints, nodal_residual, report, residual
from fem_lie.system.tangent import Tangent, every, whole
from fem_lie.system.terms.all_terms import terms_of
from fem_lie.system.time_state import Forces, FrameRows, Plan, TimeState

_log = logging.getLogger(__name__)


class System:
    """The equations of a scene.

    Attributes:
        count: Moving nodes ``n``; ``size`` unknowns are six of each and ``m`` multipliers.
        frames: Initial frames, shape (n + 1 + p, 4, 3): moving nodes, ground, prescribed motions.
        velocities: Initial local velocities, same rows, (…, 6).
        connections: All joints, and what acts along them; ``table`` is theirs.
        kinds: What each moving node is, shape (n,), see :mod:`fem_lie.lie.node_types`.
        held: Which unknowns of the moving nodes are zero, shape (n, 6).
        supported: Moving nodes that clamps and bodies hold, shape (s,).
        uncoupled: Which of them move by ``x + R u`` in statics, shape (n,).
        inertia: That of the moving nodes.
        floating: That of bodies that deform within their frames, beyond it.
        rows: What stands in the rows of frames at the start.
        load_cases: Loads as functions of time.
        loads: At the time that was set last; ``lasting_loads``: the same in arrays that stay.
        terms: All that adds forces and a matrix beside inertia, nodal loads and constraints.
        elastic: Those within bodies and on them.
        tangent: The matrix; ``kkt`` is what it is filled into.
        carried_drilling: Frames that follow the mid-surface, to be turned after each step.
        carried_axes: Axes of places that follow what is around them.
        carried: All axes that follow something, if there are any.
        in_one_sum: Whether :meth:`residual` is the compiled sum of :attr:`Forces.table` alone, but
            for what is held.
        turns: How far elements turn from end to end.
        lengths: Which halves of the unknowns of the nodes are lengths, shape (n, 2); others have no
            dimension.
        length: Largest distance of two nodes, or a body's size: the length of tolerances.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        dynamics: bool,
        parametrisation: Parametrisation = Parametrisation.EXPONENTIAL,
        group: Group | None = None,
        without_coupling: bool = False,
    ) -> None:
        """Number the unknowns and build what stays constant.

        Args:
            scene: What there is.
            dynamics: Whether inertia is needed.
            parametrisation: What the increments of :meth:`fill_matrix` are.
            group: On which all frames move; default: each on that of its body.
            without_coupling: Whether inertia is lumped.

        Raises:
            ValueError: No body; no inertia though needed; redundant joints.
        """
        if not scene.bodies:
            raise ValueError("the scene has no body")
        self.scene = scene
        self.numbering = numbering_for(scene, self)
        self.count = self.numbering.count
        self.rows = rows = FrameRows(scene, self.numbering, parametrisation, group)
        self.kinds, self.frames, self.velocities = rows.kinds, rows.frames, rows.velocities
        self.held, self.supported = rows.held, rows.supported
        self.lengths, self.length = rows.lengths, rows.length
        self.uncoupled, self._any_held = self.numbering.uncoupled, bool(self.held.any())
        self.connections = Connections(scene, self.numbering, self.frames, self.held)
        self.table, self.m = self.connections.table, self.connections.m
        self._others = not self.connections.of_joints_only
        # without ties nothing is compiled for them, which would take seconds
        self._joined = len(self.table.nodes) > 0
        if self.connections.of_velocities and not dynamics:
            raise ValueError("KnifeEdge and RollingDisc bind velocities: they are for dynamics")
        self.size = 6 * self.count + self.m
        required = dynamics or bool(scene.gravity.any())
        self.inertia, damping = inertia_of(scene.bodies, self.numbering, required=required)
        if without_coupling:
            self.inertia = lumped(self.inertia, self.kinds)
            damping = lumped(damping, self.kinds) if len(damping.indptr) else damping
        self.floating = floating_of(self.numbering)
        self._gravity = scene.gravity
        z, n = np.zeros, self.count
        self.lasting_loads = Loads(z((n, 4, 3)), z((n, 3)), z((n, 6)))
        weight = weight_of(self.inertia, self.count, scene.gravity)
        self.load_cases = LoadCases(scene, self.numbering, weight)
        moves = bool(scene.motions) or self.connections.driven
        self.time_dependent = self.load_cases.time_dependent or moves
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
            redundant=scene.redundant is not Redundant.REFUSE,
            units=self.units,
            length=self.length,
        )
        self.turns = ElementTurns(self.numbering)
        self.kkt, self.supports = self.tangent.kkt, self.tangent.supports
        self._guided = bool(self.supports)
        self.carried_drilling = CarriedDrilling(numbering, self.held, self.connections.nodes)
        self.carried_axes = CarriedAxes(numbering, self.held, self.connections.bound)
        following = FollowingAxes(numbering, self.connections.nodes)
        self.carried: list[CarriedDrilling | CarriedAxes | FollowingAxes] = [
            each for each in (self.carried_drilling, self.carried_axes, following) if each
        ]
        self._check_redundant()
        self._still = np.zeros((self.count, 6))
        self._any_uncoupled = bool(self.uncoupled.any())
        self._some_apart, self._viscous = not self.terms.all_in_tables, self.terms.viscous
        apart = self._others or self._any_uncoupled or self._some_apart
        settles = any(term.local is not None for term in self.terms)
        self.in_one_sum = not (apart or self._viscous or self._guided or settles)
        self._found = self.workspace()
        self._plain_inertia, self._plain_floating = self.inertia.plain, self.floating.plain
        self.set_time(scene.began.time, 1.0)

    @property
    def units(self) -> Array:
        """Unit of each unknown of the nodes, (6 n,): the length of the model, or 1."""
        return np.repeat(np.where(self.lengths, self.length, 1.0).ravel(), 3)

    def _check_redundant(self) -> None:
        B = self.tangent.jacobian(self.frames)
        units = np.asarray(self.units / self.length)
        redundant = redundant_constraints(B, units, self.kkt.measure)
        if self.scene.redundant is Redundant.REFUSE:
            refuse(redundant, self.connections)
        elif len(redundant):
            _log.info("%d of %d constraints are redundant", len(redundant), self.m)

    def set_time(self, time: float, factor: float = 1.0) -> None:
        """Loads at ``time`` (those without history times ``factor``, as gravity is) and motions.

        Raises:
            ValueError: A history, motion or drive is not finite.
        """
        self.loads = self.load_cases.at(time, factor)
        for lasting, now in zip(self.lasting_loads, self.loads, strict=True):
            lasting[:] = now
        self._plain_loads = self.loads.plain
        self.floating.numbers[:3] = factor * self._gravity
        if self.connections.driven:
            self.connections.set_time(time)

    def prescribed_frames(self, time: float) -> Array:
        """See :meth:`~fem_lie.system.time_state.FrameRows.prescribed`."""
        return self.rows.prescribed(time)

    # --- equations ---

    def workspace(self) -> Forces:
        """For what a residual finds."""
        constant = None
        if not self._others and not self._any_uncoupled:
            mass, loads = self.inertia, self.lasting_loads
            nodes = self.kinds, *mass, *loads
            cells = *self.terms.tables[0], *self.terms.following.plain
            constant = *nodes, *self.connections.packed, None, *cells, *self.floating
        return Forces(self.count, self.terms.room(), constant)

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
            state: Where.
            scale: Factor of each constraint, shape (m,).
            r: Overwritten.
            forces: What the derivative needs of them, overwritten; default: it is not kept.
            per_increment: Factor of constraints of velocities, ∂d/∂v: their rows in the matrix are
                then like those of positions.
        """
        self.with_reactions(state, scale, r, forces, per_increment)
        if self._any_held:
            r[: 6 * self.count].reshape(-1, 6)[self.held] = 0.0

    def with_reactions(
        self,
        state: TimeState,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        per_increment: float = 1.0,
    ) -> None:
        """:meth:`residual`, with the forces that hold what is held."""
        found = self._found if forces is None else forces
        H, v, a, multipliers = state
        if found.table is None:
            self.applied(state, scale, r, found, per_increment)
            self.terms.add_forces(H, r, found.own)
        else:
            residual(H, v, a, multipliers, scale, r, found.table)
            if self._some_apart:
                self.terms.add_others(H, r, found.own)
        if self._viscous:
            self.terms.add_viscous_forces(H, v, r)
        if self._any_uncoupled:
            found.inner[:] = r[: 6 * self.count].reshape(-1, 6) - found.outer
        if self._guided:
            self.supports.turn(H, r[: 6 * self.count].reshape(-1, 6))

    def applied(
        self,
        state: TimeState,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        per_increment: float = 1.0,
    ) -> None:
        """What :meth:`residual` is without terms, but for those in the sum over joints.

        Of ``forces`` it leaves those as they are.
        """
        found = self._found if forces is None else forces
        H, v, a, multipliers = state
        mass, loads, joints = self._plain_inertia, self._plain_loads, self.connections.packed
        nodal_residual(self.kinds, (H, v, a), mass, self._plain_floating, loads, found.work, r)
        if self._joined:
            add_joints(H, v, joints, multipliers, scale, self.count, r)
        if self._others:
            self.connections.add_others(H, v, multipliers, scale, per_increment, r)
        if self._any_uncoupled:
            found.outer[:] = r[: 6 * self.count].reshape(-1, 6)

    def follow_motion(self, forces: Forces) -> None:
        """Make the matrix the derivative along the motion of statics, see :attr:`uncoupled`.

        The parts are derivatives in twists of forces in local axes. What is added is linear in the
        sum of all forces on a node, zero at equilibrium.
        """
        if self._any_uncoupled:
            total = np.where(self.rows.turning, forces.outer + forces.inner, 0.0)
            self.tangent.add_turnings(total, self.uncoupled)

    def fill_matrix(self, state: TimeState, forces: Forces, plan: Plan) -> Array:
        """Derivative of :meth:`residual` in the increments that led to a state, into the KKT.

        Args:
            state: Where.
            forces: That the residual has found there.
            plan: What the matrix is to be, all of it.

        Returns:
            The scale of the constraints in it, (m,).
        """
        H, v, _, multipliers = state
        tangent, damping = self.tangent, plan.damping
        loads, factors = (forces.on_rows, self.loads.moment), (plan.mass, damping)
        if not plan.choices.gyroscopic:
            state = state._replace(v=self._still, a=self._still)
        tangent.clear()
        tangent.add_inertia(state, self.kinds, loads, factors)
        tangent.add_terms(H, forces.own, whole if plan.apart else every, ends=plan.ends)
        if damping != 0.0:
            tangent.add_viscosity(H, v, damping)
        if plan.choices.geometric:
            tangent.add_geometric(H, multipliers)
        self.follow_motion(forces)
        return tangent.fill_increments(H, self.kinds, plan)

    def report(self, H: Array, v: Array, invariants: Array) -> float:
        """Set kinetic energy, momentum and angular momentum, (7,).

        Returns:
            Potential of loads that have one.
        """
        mass, bodies, dead = self._plain_inertia, self._plain_floating, self.load_cases.constant
        work = self._found.work
        return float(report(self.kinds, H, v, mass, bodies, dead, work, invariants))

"""The equations of a scene as solvers see them.

States belong to the solver: frames ``H`` (moving nodes, ground, prescribed motions),
local twists ``v`` and their rates ``a``, and Lagrange multipliers. Only the methods here change
what is behind them, and solvers use nothing else.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.bodies.initial_state import InitialState
from fem_lie.bodies.model import MassMatrix
from fem_lie.joints.connection import LostBranchError
from fem_lie.joints.laws import ForceLawError
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.linear.saddle_point import KKT
from fem_lie.parts.part_scene import ScenePart
from fem_lie.scene import Scene
from fem_lie.scene.load import strained_bodies
from fem_lie.scene.rotation import Rotation
from fem_lie.system import describe
from fem_lie.system.balance import EnergyBalance
from fem_lie.system.equations.history_variables import HistoryVariables
from fem_lie.system.equations.prescribed import Prescribed
from fem_lie.system.equations.report import ConstraintsAt, Report, contents
from fem_lie.system.equations.unknowns import Start, SystemArrays, Unknowns
from fem_lie.system.nodes.fixed_axes import Supports
from fem_lie.system.nodes.masses import total_mass
from fem_lie.system.small_motions import SmallMotions, fill_steady
from fem_lie.system.system import System
from fem_lie.system.time_state import Forces, Plan, TimeState


def fill_at_rest(system: System, H: Array, step: float) -> Array:
    """Fill the KKT matrix with ``M + h² K/4`` and the constraints; return their scale, (m,).

    Modes that the step does not resolve would otherwise start with meaningless accelerations.

    Args:
        system: The equations; unless the step is zero, the independent stress is reset to the
            current one.
        H: Frames of all nodes, ground and prescribed motions.
        step: Step size ``h``.
    """
    # A and K may share blocks: the sum is scaled by 4/h² until it is complete
    tangent, inverse = system.tangent, 4.0 / step**2 if step else 1.0
    if step:
        _add_stiffness(system, H, step)
    else:
        tangent.clear()
    tangent.add_mass(H, system.kinds, inverse)
    tangent.parts.add_K()
    tangent.A[:] /= inverse
    scale = tangent.constraint_scale(H)
    tangent.fill(tangent.A, H, scale)
    return scale


def _add_stiffness(system: System, H: Array, step: float) -> None:
    """Clear the matrix and add stiffness and viscosity of a step at rest, in units of stiffness."""
    tangent, terms, still = system.tangent, system.terms, np.zeros((system.count, 6))
    kept = terms.workspace()
    terms.reset_stress(H)
    terms.add_forces(H, np.zeros(system.size), kept)
    # after the forces, which may change the pairs of nodes in contact
    tangent.clear()
    tangent.add_terms(H, kept)
    tangent.add_viscosity(
        H, still, 2.0 / step, lambda term, of: not (term.of_bodies or of.in_space)
    )


class LinearState:
    """Stress and forces along increments of the nodes, to first order.

    The tangent stiffness of nodes whose translations are along fixed axes has terms of the forces
    of shells and of all forces on the node. In linear theory these are the forces here, not those
    at the current frames.

    Attributes:
        multipliers: Multipliers in the units of the matrix, shape (m,).
    """

    def __init__(
        self, system: System, history: HistoryVariables, H: Array, dx: Array, forces: Forces
    ) -> None:
        """Compute the forces.

        Args:
            system: The equations.
            history: History variables, with the independent stress.
            H: Frames of all nodes, ground and prescribed motions.
            dx: Local increments of the moving nodes from there, and multipliers, shape (6 n + m,).
            forces: Forces of the residual there.
        """
        self._history, self._H, self._joints = history, H, system.connections.sets
        self._h, self.multipliers = np.split(dx.copy(), [6 * system.count])
        history.update_stress(H)
        self._start = history.saved_state()
        nodal = self._h.reshape(-1, 6)
        self._own = [
            term.linear_forces(H, kept, nodal)
            for term, kept in zip(system.terms, forces.own, strict=True)
        ]
        self._inner = np.zeros_like(nodal)
        for term, kept in zip(system.terms, forces.own, strict=True):
            if not term.within_joints:
                rows, columns = term.pairs
                pulled = np.einsum("pij,pj->pi", term.tangent(H, kept), nodal[columns])
                np.add.at(self._inner, rows, pulled)

    def apply(self, factor: float) -> None:
        """Set the stress and spring forces of ``factor`` times the increments.

        Springs get them by changed rest values.
        """
        h = factor * self._h
        # local unknowns of cells are updated from their values at the start
        self._history.restore(self._start)
        self._history.update_stress(self._H, h)
        for each in self._joints:
            each.stretch_springs(self._H, h.reshape(-1, 6))

    def add_forces(self, factor: float, forces: Forces) -> None:
        """Add the forces of ``factor`` times the increments to those at the frames."""
        forces.inner += factor * self._inner
        for kept, own in zip(forces.own, self._own, strict=True):
            kept += factor * own


class Equations:
    """The equations of a scene.

    Attributes:
        scene: The scene, or that of the part which this rank has.
        part: This part, if the scene is divided among ranks; else ``None``.
        shared: Nodes that other ranks have, too. Their copies have equal states on all ranks;
            forces on them are sums over all ranks, while matrices and reports are partial.
        unknowns: Numbers, types and properties of the unknowns.
        start: Frames and velocities at the start of a run.
        tables: Packed arrays for compiled code.
        matrix: The saddle-point matrix that :meth:`fill` fills.
        supports: Nodes whose unknowns are along axes fixed in space, with transformations.
        info: Bodies and joints, for results.
        history_variables: History variables, which neither states nor the time determine.
        last: End of the run: prescribed functions are not evaluated after it for their rates.
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
        """Build the equations.

        Args:
            scene: The scene.
            dynamics: Whether inertia is needed.
            parametrisation: Parametrisation of increments.
            group: Group of all frames; default: that of each body.
            mass: Mass matrix.
            lumped: Bodies whose mass matrix is lumped whatever ``mass`` is.
            part: What this rank has of the scene, if it is divided; states are those of the part.

        Raises:
            ValueError: Inertia is needed, and a contact law is for statics; or see
                :class:`~fem_lie.system.system.System`.
        """
        self.part, self.scene = part, scene if part is None else part.scene
        for contact in self.scene.contacts if dynamics else ():
            if contact.law.static:
                raise ValueError(
                    f"{contact.label}: {type(contact.law).__name__} is for statics; expected a law "
                    "for motions such as MortarPenalty or Penalty"
                )
        self._system = System(
            self.scene,
            dynamics=dynamics,
            parametrisation=parametrisation,
            group=group,
            mass=mass,
            lumped=lumped,
            part=part,
        )
        self.shared = self._system.shared
        # compiled sums over joints include their springs
        self._terms = self._system.terms.chosen(lambda term: not term.within_joints)
        self._settles = any(term.local is not None for term in self._terms)
        self.unknowns = Unknowns.of(self._system)
        self.last = np.inf
        nodal, began = self._system.nodal_data, self.scene.began
        self.start = Start(nodal.start_frames, nodal.velocities, self._system.frames)
        self._system.connections.remember(began.turned)
        if began.state is not None:
            self._follow(began.state)
        self.arrays = SystemArrays.of(self._system)
        self.matrix: KKT = self._system.kkt
        self.supports: Supports = self._system.supports
        self.info: SceneInfo = self._info()
        self.history_variables = HistoryVariables(self._system, self._terms, part)
        self._still = np.zeros((self.unknowns.moving, 6))

    def _follow(self, start: InitialState) -> None:
        """Let joints count their turns along the states that led to the start, and drives hold."""
        connections, unknowns = self._system.connections, self.unknowns
        number: Indices = np.empty(unknowns.total, dtype=np.int64)
        for body, own in unknowns.bodies.items():
            number[own] = start.nodes[body]
        H, masters = self.start.frames.copy(), number[unknowns.masters]
        counts = connections.first.turns or len(connections.sets) > 1
        # joints that count may be on one rank only
        with self.shared.errors(LostBranchError):
            for frames in start.path if counts else ():
                H[: unknowns.moving] = frames[masters]
                connections.accept(H)
        for item in connections.items:
            if item.holds and item.active:
                connections.switch(item, self.start.frames, active=True)

    def _info(self) -> SceneInfo:
        """Bodies and joints in the numbering of all nodes."""
        system = self._system
        mass = total_mass(self.scene.bodies, system.numbering)
        joints = system.connections.info()
        strained = strained_bodies(self.scene.loads)
        return describe.catalogue(system.numbering, joints, system.supported, mass, strained)

    @property
    def system(self) -> System:
        """The system behind this interface."""
        return self._system

    # --- time ---

    def prescribed(self, time: float, step: float = np.inf) -> Prescribed:
        """Drives, motions and loads at ``time``; rates are differences over ``step``.

        Args:
            time: Time.
            step: Step size.
        """
        return Prescribed(self._system, time, step, self.last)

    # --- residual and matrix ---

    def residual(
        self,
        state: TimeState,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        *,
        linearised: bool = False,
        known: bool = False,
        per_increment: float = 1.0,
    ) -> Forces:
        """Equations of motion and constraints times ``scale``, into ``r`` (size,).

        Args:
            state: The state.
            scale: Scale factor of each constraint, shape (m,).
            r: Residual, overwritten.
            forces: Forces of an earlier residual, overwritten; default: new ones.
            linearised: Whether local unknowns of cells keep their linearised values.
            known: Whether only loads have changed since ``forces`` were computed: parts of ``r``
                that follow from the rest may be left out.
            per_increment: Factor of velocity constraints, ∂d/∂v, which makes their rows in the
                matrix like those of position constraints.

        Returns:
            Forces that the derivative needs.
        """
        found = self._system.workspace() if forces is None else forces
        if known and not self._system.terms.loads:
            self._system.applied(state, scale, r, found)
        else:
            if self._settles and not linearised:
                self._terms.condense(state.H)
            self._system.residual(state, scale, r, found, per_increment=per_increment)
        self.shared.sum(r[: 6 * self.unknowns.moving].reshape(-1, 6))
        self.check_laws()
        return found

    def check_laws(self) -> None:
        """Raise the error of a force law, if there was one, on all ranks.

        Raises:
            ForceLawError: A law of the user has failed since the last call.
        """
        if self.unknowns.has_laws:
            with self.shared.errors(ForceLawError):
                self._system.connections.check_laws()

    def linear_state(self, H: Array, dx: Array, forces: Forces) -> LinearState:
        """Stress and forces of linear theory along ``dx`` (size,) from frames ``H``.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
            dx: Increments of all unknowns, shape (size,).
            forces: Forces of the state.
        """
        return LinearState(self._system, self.history_variables, H, dx, forces)

    def fill(self, state: TimeState, forces: Forces | None, plan: Plan) -> Array:
        """Fill :attr:`matrix` with the derivative of :meth:`residual`, without factorising it.

        If the matrix is divided into subdomains, that of this rank goes into its ``part`` as well.

        Args:
            state: The state.
            forces: Forces of the residual there; ``None``: no forces.
            plan: Contents of the matrix.

        Returns:
            The scale of the constraints in it, (m,).
        """
        scale, tangent = self._fill(state, forces, plan), self._system.tangent
        if tangent.domain is not None and not plan.low_rank_only:
            tangent.domain.see(state.H, self.unknowns.kinds, inertial=plan.inertial)
            with tangent.of_domain(scale):
                self._fill(state, forces, plan._replace(scale=scale, spread=None))
        return scale

    def _fill(self, state: TimeState, forces: Forces | None, plan: Plan) -> Array:
        """:meth:`fill`, for the whole scene or a subdomain."""
        system = self._system
        if plan.at_rest is not None:
            return fill_at_rest(system, state.H, plan.at_rest)
        if plan.steady:
            assert plan.scale is not None
            fill_steady(system, state.H, state.v, state.multipliers, plan.scale)
            return plan.scale
        if plan.low_rank_only:
            assert plan.scale is not None
            system.tangent.set_correction(state.H)
            return plan.scale
        if plan.constraints_only:
            return system.tangent.refill_constraints(state.H, plan)
        if not plan.matrix_terms.geometric:
            self._terms.clear_stress()
        elif plan.stressed is not None:
            self._terms.reset_stress(plan.stressed)
        if forces is None:
            # pairs in contact are found with the forces, and tangents need them
            self._terms.add_forces(state.H, np.zeros(system.size))
            forces = system.workspace()
        return system.fill_matrix(state, forces, plan)

    def constraints(self, H: Array) -> ConstraintsAt:
        """Constraints at frames ``H``: Jacobian, rates, and remaining rigid motions.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
        """
        return ConstraintsAt(self._system, H)

    # --- reports of a state ---

    def report(
        self,
        H: Array,
        v: Array | None = None,
        a: Array | None = None,
        multipliers: Array | None = None,
        *,
        linearised: bool = True,
    ) -> Report:
        """Report of a state, by default at rest and with all multipliers zero.

        ``linearised``: see :meth:`residual`.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
            v: Twists of all nodes, shape (n, 6).
            a: Rates of the twists, shape (n, 6).
            multipliers: Lagrange multipliers of all constraints.
            linearised: Linearised stress.
        """
        none = np.zeros(self.unknowns.m) if multipliers is None else multipliers
        still = self._still
        state = TimeState(H, still if v is None else v, still if a is None else a, none)
        return Report(self._system, self._terms, state, linearised=linearised)

    def energy_balance(self) -> EnergyBalance:
        """Empty energy balance, for the work of loads, drives and supports."""
        return EnergyBalance(self._system)

    def of_bodies(self, twists: Array) -> dict[Body, Array]:
        """Twists of the nodes of each body, attached ones included, from those of moving nodes.

        Args:
            twists: Local velocities, or changes of these, shape (n, 6).
        """
        numbering = self._system.numbering
        found = numbering.master_map.twists(twists)
        return {body: found[nodes] for body, nodes in numbering.nodes.items()}

    # --- properties ---

    def small_motions(self, rotation: Rotation) -> SmallMotions:
        """Linear equations about the initial frames, in a rotating frame.

        Args:
            rotation: Steady rotation of that frame.
        """
        return SmallMotions(self._system, rotation)

    def contents(self) -> list[tuple[str, Any, str]]:
        """Data on which the equations depend, but functions of time: name, value, description."""
        return contents(self._system)

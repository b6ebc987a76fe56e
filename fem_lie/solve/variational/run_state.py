"""State of a run of the variational scheme: start of a step, equations and matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import attributes
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.lie.node_types import push_all_forward
from fem_lie.linear.factors import Factors, factorise, solve
from fem_lie.solve.conserving.midpoint.products import (
    accelerations,
    add_inertia,
    inertia_with_products,
    product_rates,
)
from fem_lie.solve.convergence import unknown_scaling
from fem_lie.solve.impacts.contacts import CoupledContacts
from fem_lie.solve.impacts.step_end import Factors as StepFactors
from fem_lie.solve.impacts.step_end import Rule
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.motion.policies import RefactorisationPolicy
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.rotations import MeanPositions, by_momenta
from fem_lie.solve.variational import kinematics, momenta
from fem_lie.solve.variational.ends import Binding, Ends
from fem_lie.solve.variational.limit import Pairs
from fem_lie.system.equations import Equations, Plan, TimeState


@dataclass(frozen=True)
class Options:
    """Options of :class:`~fem_lie.solve.variational.variational.Variational`."""

    tolerance: float
    policy: RefactorisationPolicy
    max_iterations: int


class RunState(DividedIntegration[Recorder]):
    """State of a run of the variational scheme.

    Between two steps the state is frames and momenta; velocities are computed from them on request.

    Attributes:
        size: Size of the current step or sub-step.
    """

    STATE = attributes(
        "H",
        "rest",
        "rates",
        "before",
        "multipliers",
        "earlier",
        "gap",
        "scale",
        "twists",
        "coordinates",
        "_made",
        "_factorisations",
        "_iterations",
        "_born",
        "balance",
        "_v",
        "_contacts",
    )

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Allocate all arrays without computing anything.

        Args:
            options: Options of the scheme.
            equations: Equations of the scene.
            step: Step size.
        """
        super().__init__(options.policy, equations, step)
        unknowns, known = equations.unknowns, equations.arrays
        n, m, z = unknowns.moving, unknowns.m, np.zeros
        self.options, self._n, self.size = options, n, self.h
        self._rotations = MeanPositions(by_momenta, np.diff(known.inertia.indptr) > 1)
        self._changing = unknowns.time_dependent
        self._mass = inertia_with_products(known.inertia, known.floating)
        self._viscous = _dissipates(equations)
        self._convects_axes = any(body.model.axes_update() is not None for body in unknowns.bodies)
        self.H, self.rest = equations.start.frames.copy(), z((n, 4, 3))
        self._within = momenta.Within.of(known.floating, self.rest)
        # of the last step and the one before
        self.rates, self.step = z((2, n, 6)), z((n, 6))
        self._maps = z((2, n, 2, 3, 3))
        self.before, self.after = z((n, 6)), z((n, 6))
        self.multipliers, self.earlier, self.gap = z(m), z(m), z(m)
        self.coordinates = z(self.H.shape), self.H.copy(), self.H.copy(), self.H.copy()
        self.twists, self._still = equations.start.velocities.copy(), z((n, 6))
        self._none, self._driven, self._change = z(m), z(m), z(m)
        self._forces, self._constraints = z((n, 6)), z((n, 6))
        self._r, self._x, self._y = z((3, unknowns.size))
        self._work, self._q = z(unknowns.size), z(self._within.moved.shape)
        self.scale: Array = np.ones(m)
        self._measure = unknown_scaling(unknowns)
        now = TimeState(self.H, self.twists[:n], self._still, self._none)
        self._found = equations.residual(now, self.scale, self._work)
        self.balance = equations.energy_balance()
        self._factors: Factors | None = None
        self._made, self._factorisations, self._iterations = 0, 0, 0
        self._increment, self._born = np.inf, 0
        self._ends, self._pairs = Ends(equations, step), Pairs.of(equations)
        self._binding = Binding(equations) if unknowns.other_constraints else None
        # twists at the start of the step, which only contacts need
        self._v: Array = equations.start.velocities[:n].copy()
        self._contacts: CoupledContacts | None = None
        # factors that impulses at the ends of steps use
        self._at_ends: StepFactors | None = None
        if contacts := equations.scene.impacts:
            if not unknowns.rigid or len(known.terms):
                given = self._factorise, self._solve, self._r, self._x, self.scale
                self._at_ends = StepFactors(*given)
            self._contacts = CoupledContacts(contacts, equations, self._end_rule, self._at_ends)

    @property
    def _end_rule(self) -> Rule:
        """Relation of the trapezoidal rule: ``Δq = ½ h (v₀ + v₁)``."""
        return Rule(self.size, 4.0 / self.size**2, 2.0 / self.size)

    def _solve(self) -> None:
        """Solve with the frozen factors."""
        assert self._factors is not None
        solve(self._factors.plain, self._r, self._y, self._x)

    # --- start ---

    def start(self) -> None:
        """Compute the initial momenta and multipliers."""
        equations, n = self.equations, self._n
        check_velocities(equations, self.h)
        v = equations.start.velocities
        self.before[:] = self._momenta(self.H, v[:n])
        self._set_rates(v[:n], np.zeros((n, 6)))
        rates, self.multipliers[:] = self._ends.accelerations(self.H, v, 0.0)
        self.earlier[:] = self.multipliers
        now = TimeState(self.H, v[:n], rates, self.multipliers)
        equations.residual(now, np.ones(len(self.multipliers)), self._work)
        self.gap[:] = self._work[6 * n :]
        self.balance.open(0.0, *now)
        self._reset_coordinates()
        self.scale[:] = self._fill(None)

    def _momenta(self, H: Array, v: Array) -> Array:
        """Momenta of twists ``v``, shape (n, 6)."""
        n, kinds, bodies = self._n, self.equations.unknowns.kinds, self._within.bodies
        V, products = np.empty(self._q.shape), np.empty((2, *self._within.means.shape))
        found = np.empty((n, 6))
        push_all_forward(kinds, H[:n], v, V[:n])
        product_rates(*bodies, (H, V[:n], np.zeros_like(V[:n])), products)
        V[n:] = products[0]
        momenta.of_rates(kinds, H, V, self._mass, bodies, found)
        return found

    def _set_rates(self, v: Array, acceleration: Array) -> None:
        """Set the rates of the last two steps to those of a uniform acceleration.

        Args:
            v: Twists at its end, shape (n, 6).
            acceleration: Rates of these, shape (n, 6).
        """
        kinds = self.equations.unknowns.kinds
        kinematics.set_rates(kinds, self.H, v, acceleration, self.size, self.rates)

    def _reset_coordinates(self) -> None:
        for row in self.coordinates[1:]:
            row[:] = self.H

    # --- the size of the step ---

    def resize(self, time: float, size: float) -> None:
        """Start steps of another size; momenta do not depend on it."""
        self._take_size(size)
        self._reset_coordinates()
        self.scale[:] = self._fill(None)
        self._factors = None

    def _take_size(self, size: float) -> None:
        self.size = self._ends.h = size
        if self._contacts is not None:
            self._contacts.set_rule(self._end_rule)

    # --- one iteration ---

    def _correct(self) -> None:
        size = 6 * self._n
        unknowns = self.equations.unknowns
        middle = self.coordinates[3]
        kinematics.correct(unknowns.kinds, self.H, middle, unknowns.held, self._x, self.step)
        # the residual has 4 times the forces of constraints
        self.multipliers -= 0.25 * self.scale * self._x[size:]

    def _residual(self) -> None:
        """Residual of the momenta at the start and of the constraints at the end."""
        equations, n, coordinates, h = self.equations, self._n, self.coordinates, self.size
        kinds = equations.unknowns.kinds
        kinematics.between(kinds, self.H, self.step, coordinates, h, self.twists)
        middle = coordinates[3]
        v = self.twists if self._viscous else np.zeros_like(self.twists)
        equations.residual(
            TimeState(middle, v, self._still, self._none), self.scale, self._work, self._found
        )
        self._forces[:] = self._work[: 6 * n].reshape(n, 6)
        if self._viscous:
            bodies = self._within.bodies
            accelerations(kinds, bodies, middle, v[:n], self._q)
            add_inertia(kinds, self._mass, bodies, middle, self._q, -1.0, self._forces)
        constraints = self._change, self._constraints
        joints = equations.arrays.joints
        if self._binding is None:
            momenta.constrain(
                self.H, coordinates, joints, self.multipliers, self._driven, constraints
            )
        else:
            self._binding.constrain(coordinates[2], self.multipliers, self.gap, constraints)
        acting = self.before, self._forces, self._constraints
        r = self._r[: 6 * n].reshape(n, 6)
        held = equations.unknowns.held
        out = r, self.after
        inside = self._inside
        momenta.balance(
            kinds, self.H, self.step, coordinates, self._mass, h, acting, held, inside, out
        )
        self._r[6 * n :] = self.scale * (self.gap + self._change)

    @property
    def _inside(self) -> momenta.PlainWithin:
        """Reduced-order bodies over the step, from the current start."""
        return (*self._within._replace(rest=self.rest),)

    def _factorise(self) -> None:
        self._fill(self.scale)
        self._factors = factorise(self.equations.matrix)
        self._factorisations, self._born = self._factorisations + 1, self.index

    def _fill(self, scale: Array | None) -> Array:
        """Assemble the matrix at the midpoint of the step; returns the scale of its constraints."""
        equations, h, n = self.equations, self.size, self._n
        _, _, end, middle = self.coordinates
        v, H = self.twists.copy(), middle.copy()
        now = TimeState(H, v, np.zeros((n, 6)), self.multipliers)
        ones = np.ones(len(self.multipliers)) if scale is None else scale
        equations.residual(now, ones, self._work, self._found)
        plan = Plan(self._still, scale, 4.0 / h**2, 2.0 / h, end.copy(), self.H)
        plan = plan._replace(stressed=H, matrix_terms=self.matrix_terms)
        # impulses are along the axes at the end of a step
        if self._at_ends is None:
            motions, forces = self._maps
            kinematics.maps(equations.unknowns.kinds, end, middle, motions)
            kinematics.maps(equations.unknowns.kinds, self.H, middle, forces)
            plan = plan._replace(end_motions=motions, start_forces=forces)
        return equations.fill(now, self._found, plan)


def _dissipates(equations: Equations) -> bool:
    """Whether forces depend on velocities."""
    known = equations.arrays
    dampers = joint_arrays(known.joints).springs[:, 1].any()
    return bool(dampers) or len(known.damping.indptr) > 0 or any(t.viscosity for t in known.terms)

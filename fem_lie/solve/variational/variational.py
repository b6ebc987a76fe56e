r"""Variational integrator on the group: exact momenta, and an energy without drift.

The motion makes a discrete action stationary (Marsden & West, Acta Numerica 10 (2001) 357). With
``q = (x, d₁, d₂, d₃)`` of the nodes, the constant mass matrix ``G`` and midpoint frames ``H̄``
(mean position, half of the rotation), the action is the sum of::

    h L(H₀, H₁) = 1/(2h) Δq·G Δq − h V(H̄)

Both terms depend on relative motions ``H₀⁻¹ H₁`` and on frames that move with the body only: for
one rigid body the first is that of Moser & Veselov. Momentum and angular momentum are therefore
those of the discrete action, ``p₁ = ∂(h L)/∂H₁``, and are conserved exactly. Half of a rotation is
the same whether increments are parametrised by exp or by the Cayley map; the iteration uses the
latter, ``R₁ = cay(ψ) R₀``. With its half ``a``, ``cay(a)² = cay(ψ)``, midpoint frames rotate by::

    φ̄ = ½ (φ₀ + φ₁) + ¼ a × (φ₀ − φ₁)            φ₀, φ₁ at the ends

and a step satisfies the momenta at its start and the constraints at its end::

    p₀ = L(H₀)ᵀ G Δq/h − ½ h W₀ᵀ f(H̄) + h B(H₀)ᵀ λ,      Φ(H₁) = 0

Forces without a potential, follower loads and dampers enter by their virtual work at the midpoint
frames (Lagrange-d'Alembert), with the velocities ``(u, ψ)/h``. The scheme is symmetric, of second
order and symplectic; the energy oscillates with the square of the step size and does not drift.
Steps of variable size keep that of reversible motions if they are chosen symmetrically
(:mod:`fem_lie.solve.symmetric_steps`).
With a quadratic potential it is as stable as the trapezoidal rule. Vibrations of bodies that rotate
grow in large steps (:mod:`.limit`), which are therefore divided.

Contacts by impacts change frames and momenta at the end of a step, as in generalised-α
(:mod:`fem_lie.solve.impacts`), by the velocities there.

Velocities in results are the admissible velocities with these momenta; joint forces are those of
the equations of motion at the ends of steps. Both need a factorisation for each recorded state,
one without elastic bodies and springs. Work and impulses are integrated by the trapezoidal rule.
The groups of bodies do not matter for this scheme.

Sources: Moser & Veselov, Commun. Math. Phys. 139 (1991) 217; Bou-Rabee & Marsden, Found. Comput.
Math. 9 (2009) 197; Leyendecker, Marsden & Ortiz, ZAMM 88 (2008) 677 (constraints).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from fem_lie.bodies.model import MassMatrix
from fem_lie.lie.motions import Group
from fem_lie.scene import Scene
from fem_lie.solve.impacts.impulses import massless
from fem_lie.solve.impacts.step_end import refuse_impacts
from fem_lie.solve.motion.integrator import Integrator, check_until_round_off, refuse
from fem_lie.solve.motion.policies import Automatic, RefactorisationPolicy
from fem_lie.solve.motion.variable_steps import Stepper
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.step_control import Control
from fem_lie.solve.symmetric_steps import SymmetricControl, SymmetricStep
from fem_lie.solve.variational.run import VariationalRun
from fem_lie.solve.variational.run_state import Options
from fem_lie.solve.variational.variable import VariationalSteps
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class Variational(Integrator):
    """Options of the scheme; :meth:`run` integrates with constant or symmetric steps.

    Steps of variable size, :class:`~fem_lie.schemes.SymmetricStep`, follow the speed of the motion.

    Attributes:
        tolerance: 0: iterate down to round-off. Otherwise the predicted iteration error in each
            step over the largest motion in it.
        policy: When to refactorise the iteration matrix.
        max_iterations: Largest number of iterations of a step.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.schemes.Variational().run(scene, duration=1.0, step=0.01)
        >>> bool(result.angular_momentum_error < 1e-12)
        True
    """

    _wanted_step: ClassVar[str] = (
        "makes constant steps, or symmetric ones, for its energy would drift with others: expected "
        "the step size as a number and a scene without discontinuities, or SymmetricStep (or use "
        "EnergyMomentum)"
    )
    _reports_energy = True

    tolerance: float = 0.0
    policy: RefactorisationPolicy = field(default_factory=Automatic)
    max_iterations: int = 100

    def __post_init__(self) -> None:
        """Check the options."""
        check_until_round_off(self.tolerance, self.max_iterations, self.policy)
        if self.policy.secants:
            given = self.policy.secants
            raise ValueError(
                f"Variational does not support secants: expected secants=0, got {given}"
            )

    def equations(self, scene: Scene) -> Equations:
        """Equations of a scene; ``ValueError`` if the scheme does not support the scene.

        Args:
            scene: The scene.
        """
        equations = Equations(
            scene, dynamics=True, group=Group.R3xSO3, mass=MassMatrix.WITH_DRILLING
        )
        _refuse(equations)
        return equations

    def options(self) -> Options:
        """Options of a run."""
        return Options(self.tolerance, self.policy, self.max_iterations)

    def _equations(self, scene: Scene) -> Equations:
        """Equations of a scene without impacts, which change the ends of steps."""
        equations = self.equations(scene.without_impacts())
        if equations.scene.impacts:
            refuse_impacts(equations)
            unknowns = equations.unknowns
            if massless(equations.arrays.inertia, unknowns.kinds, unknowns.held).count_nonzero():
                raise ValueError(
                    "Variational computes velocities for impacts from momenta: expected "
                    "rotary inertia at all nodes, got a beam whose section has none; give its "
                    "section rotary inertia, or use GeneralisedAlpha"
                )
        return equations

    def _integration(self, equations: Equations, step: float) -> VariationalRun:
        return VariationalRun(self.options(), equations, step)

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        if not isinstance(plan.choice, SymmetricStep):
            return super()._steppers(scene, plan)
        if contacts := scene.without_impacts().impacts:
            raise ValueError(
                f"{contacts[0].label}: Impact is for Variational with constant steps, expected "
                f"the step size as a number, got {plan.choice}"
            )

        def begin(equations: Equations, control: Control) -> VariationalSteps:
            assert isinstance(control, SymmetricControl)
            return VariationalSteps(self.options(), equations, control)

        return begin


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` if the scheme does not support the scene."""
    unknowns = equations.unknowns
    reasons = {
        "force laws without a potential (ForceLaw)": unknowns.laws_without_potential,
        "friction in joints (JointFriction)": unknowns.joint_friction,
        "velocity constraints (KnifeEdge, RollingDisc), whose motion makes no action stationary": (
            unknowns.of_velocities > 0
        ),
        "supports along axes fixed in space (Shell.roller)": bool(equations.supports),
        "friction of penalties": any(term.has_friction for term in equations.arrays.terms),
    }
    refuse("Variational", reasons)

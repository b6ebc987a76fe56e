r"""A variational integrator on the group: exact momenta, and an energy that does not drift.

Motion is what makes a discrete action stationary (Marsden & West, Acta Numerica 10 (2001) 357).
With ``q = (x, d₁, d₂, d₃)`` of the nodes, the constant matrix of inertia ``G`` and frames ``H̄``
half-way between the ends of a step, at the mean place and turned by half the rotation, that is the
sum of::

    h L(H₀, H₁) = 1/(2h) Δq·G Δq − h V(H̄)

Both parts see nothing but relative motions ``H₀⁻¹ H₁`` and frames that go with them: of one rigid
body the first is that of Moser & Veselov. So momentum and angular momentum are those of the
discrete action, ``p₁ = ∂(h L)/∂H₁``, and are kept exactly. Half a rotation is the same whether
increments are parametrised by exp or by the Cayley map; the latter is what is iterated,
``R₁ = cay(ψ) R₀``. With its half ``a``, ``cay(a)² = cay(ψ)``, half-way frames turn by::

    φ̄ = ½ (φ₀ + φ₁) + ¼ a × (φ₀ − φ₁)            φ₀, φ₁ at the ends

and a step is: momenta at its start, and constraints at its end::

    p₀ = L(H₀)ᵀ G Δq/h − ½ h W₀ᵀ f(H̄) + h B(H₀)ᵀ λ,      Φ(H₁) = 0

Forces without a potential, following loads and dampers do their virtual work on the half-way frames
(Lagrange-d'Alembert), with the velocities ``(u, ψ)/h``. The scheme is symmetric, of second order
and symplectic; energy goes up and down with the step squared and does not drift. With a quadratic
potential it is as stable as the trapezoidal rule.

Contacts by impacts change frames and momenta at the end of a step, as in generalised-α
(:mod:`fem_lie.solve.impacts`), by the velocities that there are then.

Velocities in results are those that have the momenta and that joints allow, joint forces those of
the equations of motion at the ends of steps; both take a factorisation for each state that is kept.
Work and impulses are booked by the trapezoidal rule. Bodies' groups have no meaning for it.

Sources: Moser & Veselov, Commun. Math. Phys. 139 (1991) 217; Bou-Rabee & Marsden, Found. Comput.
Math. 9 (2009) 197; Leyendecker, Marsden & Ortiz, ZAMM 88 (2008) 677 (constraints).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from fem_lie.lie.motions import Group
from fem_lie.scene import Scene
from fem_lie.solve.impacts.impulses import massless
from fem_lie.solve.impacts.step_end import refuse_impacts
from fem_lie.solve.motion.integrator import Integrator, check_until_round_off, refuse
from fem_lie.solve.motion.policies import Automatic, Policy
from fem_lie.solve.variational.run import VariationalRun
from fem_lie.solve.variational.run_state import Options
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class Variational(Integrator):
    """Options of the scheme; :meth:`run` integrates with constant steps.

    Attributes:
        tolerance: 0: iterate until only round-off changes. Otherwise the predicted error of the
            iteration in each step over the largest motion in it.
        policy: When to factorise.
        max_iterations: More in one step are a failure.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.Variational().run(scene, duration=1.0, step=0.01)
        >>> bool(result.angular_momentum_error < 1e-12)
        True
    """

    _wanted_step: ClassVar[str] = (
        "makes constant steps, for its energy would drift with others: wanted the size of the step "
        "as a number and nothing that jumps (or use EnergyMomentum)"
    )

    tolerance: float = 0.0
    policy: Policy = field(default_factory=Automatic)
    max_iterations: int = 100

    def __post_init__(self) -> None:
        """Check the options."""
        check_until_round_off(self.tolerance, self.max_iterations, self.policy)
        if self.policy.secants:
            given = self.policy.secants
            raise ValueError(
                f"Variational learns from no corrections: expected secants=0, got {given}"
            )

    def equations(self, scene: Scene) -> Equations:
        """The equations of a scene; ``ValueError`` names what the scheme cannot do."""
        equations = Equations(scene, dynamics=True, group=Group.R3xSO3)
        _refuse(equations)
        return equations

    def told(self) -> Options:
        """What a run is told."""
        return Options(self.tolerance, self.policy, self.max_iterations)

    def _equations(self, scene: Scene) -> Equations:
        """Those of a scene; impacts are in none: they change the ends of steps."""
        equations = self.equations(scene.without_impacts())
        if equations.scene.impacts:
            refuse_impacts(equations)
            if massless(equations.tables.inertia, equations.unknowns.held).count_nonzero():
                raise ValueError(
                    "Variational finds velocities of impacts from momenta: expected rotary inertia "
                    "at all nodes, got a beam whose section has none; give its section rotary "
                    "inertia, or use GeneralisedAlpha"
                )
        return equations

    def _integration(self, equations: Equations, step: float) -> VariationalRun:
        return VariationalRun(self.told(), equations, step)


def _refuse(equations: Equations) -> None:
    """Raise ``ValueError`` for what the scheme cannot do."""
    unknowns = equations.unknowns
    drilling = ", ".join(unknowns.drilling)
    reasons = {
        "velocity constraints (KnifeEdge, RollingDisc), whose motion makes no action stationary": (
            unknowns.of_velocities > 0
        ),
        "supports along axes fixed in space (Shell.guide)": bool(equations.supports),
        "redundant constraints": unknowns.may_be_redundant,
        "friction of penalties": any(term.has_friction for term in equations.tables.terms),
        f"shells with six parameters ({drilling}), whose drilling has no inertia, so that no "
        "momentum gives its rate": bool(drilling),
    }
    refuse("Variational", reasons)

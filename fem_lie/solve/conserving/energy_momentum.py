"""Schemes that conserve energy, momentum and angular momentum to round-off, and what they refuse.

With ``q = (x, d₁, d₂, d₃)`` of the nodes, the constant matrix of inertia ``G``, velocities ``V``
and increments ``Δq`` that come from a translation and a Cayley rotation of each node
(:mod:`fem_lie.solve.conserving.midpoint.cayley`)::

    V₁ = 2 Δq/h − V
    L(q̄)ᵀ [G (V₁ − V)/h − dead] + elastic forces + joint forces − loads = 0,      Φ(q₁) = 0

``L(q̄)`` turns motions of the nodes into those of the *mean* ``q̄ = ½(q + q₁)``, so that the work
of every force is that on ``Δq`` without any error:

- *inertia:* ``(V₁ − V)·G Δq/h = ½ V₁·G V₁ − ½ V·G V``, and the angular momentum ``Σ q × G V``
  changes by ``Σ q̄ × (forces)`` alone;
- *elements:* forces that do the work ``W₁ − W`` and have neither a resultant nor a moment, for any
  objective energy (:mod:`fem_lie.solve.conserving.midpoint.discrete_gradient`);
- *joints:* ``Φ`` is bilinear in ``q``, and its gradient at ``q̄`` does the work ``λ (Φ₁ − Φ) = 0``
  (:mod:`fem_lie.solve.conserving.step.joints`); constraints between more than two frames, and those
  of velocities, have a discrete gradient (:mod:`.python_forces.constraints`);
- *loads* at the middle of the step: gravity and constant forces have a potential, the work of all
  others is counted, and so is what viscous forces take.

The scheme is of second order. It damps nothing: what a step does not resolve stays. Multipliers act
over a step; joint forces are reported at its end
(:mod:`fem_lie.solve.conserving.midpoint.end_forces`). The iteration goes on until nothing but
round-off changes, with a matrix in local frames that is kept as the policy says. Bodies' groups
have no meaning for it. Nodes that are no frames have rows whose increments add: for these ``L`` is
constant, and they stand in one system with frames (:mod:`fem_lie.solve.conserving.vector_cells`).
Reduced-order bodies have further rows with inertia
(:mod:`fem_lie.solve.conserving.midpoint.reduced_bodies`).

Sources: Simo, Tarnow & Doblaré, IJNME 38 (1995) 1431; Gonzalez, J. Nonlinear Sci. 6 (1996) 449;
Romero & Armero, IJNME 54 (2002) 1683; Betsch & Leyendecker, IJNME 67 (2006) 499.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from fem_lie._arrays import Indices, number
from fem_lie.forms.term import Term
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.scene import Scene
from fem_lie.solve.conserving.model import has_vector_nodes
from fem_lie.solve.conserving.python_forces.forces import acts_in_the_middle
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.run_state import Options
from fem_lie.solve.conserving.variable import ConservingSteps
from fem_lie.solve.motion.integrator import Integrator, check_until_round_off, refuse
from fem_lie.solve.motion.policies import Automatic, Policy
from fem_lie.solve.motion.variable_steps import Stepper
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations

_WITHOUT_FRAMES = (
    "nodes without frames (Cable, Net, ThinShell, AncfBeam, AncfShell, Solid, reduced-order bodies)"
)
"""Bodies with nodes that have no rotation of their own."""


def refuse_scene(equations: Equations) -> None:
    """Refuse scenes with something that has no forces over a step.

    Raises:
        ValueError: Says what there is.
    """
    unknowns, known = equations.unknowns, equations.tables
    vectors, drilling = has_vector_nodes(equations), ", ".join(unknowns.drilling)
    rotated = {body.label for each in equations.scene.contacts for body in each.pair.rotated}
    forces = any(term.over_step is not None for term in known.terms)
    touched = ", ".join(label for label in unknowns.drilling if forces and label in rotated)
    apart = [
        f"{term.label} with damping" if term.viscosity is not None else term.label
        for term in known.terms
        if not _has_forces_over_steps(term, known.kinds)
    ]
    reasons = {
        "springs along coordinates of joints between the nodes of a Beam": (
            not vectors and unknowns.other_springs
        ),
        "supports along axes fixed in space (Shell.guide)": bool(equations.supports),
        "redundant constraints": unknowns.may_be_redundant,
        "velocity constraints (KnifeEdge, RollingDisc) beside shells with six parameters "
        f"({drilling}), whose drilling has no inertia": bool(drilling)
        and unknowns.of_velocities > 0,
        "contacts by penalty that rotate nodes of shells with six parameters "
        f"({touched}), whose drilling has no inertia": bool(touched),
        ", ".join(dict.fromkeys(apart)): bool(apart),
    }
    refuse("a conserving scheme", reasons)
    if vectors:
        _refuse_joints(equations)


def _refuse_joints(equations: Equations) -> None:
    """Refuse joints that scenes with nodes without frames do not have."""
    pairs = equations.tables.pairs_of_all
    reasons = {
        "velocity constraints, joints that slide or roll, or joints between the nodes of a Beam": (
            pairs is None
        ),
        "joints that need the rotation of a cable's end or of a node without axes "
        "(Revolute, Fixed; Spherical away from the node)": pairs is not None and pairs.loose,
    }
    refuse(f"a conserving scheme, where there are {_WITHOUT_FRAMES},", reasons)


def _has_forces_over_steps(term: Term, kinds: Indices) -> bool:
    """Whether steps have the forces of a term, as cells of nodes of one sort or in other sums."""
    viscosity = term.viscosity
    constant = viscosity is not None and viscosity.rates is not None
    if term.over_step or constant or term.within_joints or acts_in_the_middle(term):
        return True
    if term.within_frames:
        return True
    if (kinds[term.pairs[0]] < POSITION_GRADIENT).all():
        return term.conserved
    if term.tables is None or term.local is not None:
        return False
    return bool((kinds[term.tables[0].nodes] >= POSITION_GRADIENT).all())


@dataclass(frozen=True)
class EnergyMomentum(Integrator):
    """Options of the scheme; :meth:`run` integrates.

    ``result.balance`` follows the work of loads and drives, and the loss by damping;
    ``result.balance_error`` says how well energy, work and loss close.

    Attributes:
        tolerance: 0: iterate until only round-off changes, which conserves to round-off. Otherwise
            the predicted error of the iteration in each step over the largest motion in a step;
            energy and momenta are then kept to some hundred times that, and
            ``result.balance_error`` and the errors of momenta say how well.
        policy: When to factorise.
        max_iterations: More in one step are a failure.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.EnergyMomentum().run(scene, duration=1.0, step=0.01)
        >>> bool(result.energy_error < 1e-12)
        True
    """

    tolerance: float = 0.0
    policy: Policy = field(default_factory=Automatic)
    max_iterations: int = 100

    def __post_init__(self) -> None:
        """Check the options."""
        check_until_round_off(self.tolerance, self.max_iterations, self.policy)

    def _equations(self, scene: Scene) -> Equations:
        return self.equations(scene)

    def equations(self, scene: Scene) -> Equations:
        """Those of a scene; ``ValueError`` names what the scheme cannot do."""
        # translations are global, so the derivatives in velocities are those of R³×SO(3)
        equations = Equations(scene, dynamics=True, group=Group.R3xSO3)
        refuse_scene(equations)
        if self.policy.secants and not has_vector_nodes(equations):
            raise ValueError(
                "conserving schemes learn from corrections where nodes have no frames (Cable, Net, "
                f"ThinShell, Solid): expected secants=0 without these, got {self.policy.secants}"
            )
        return equations

    def _integration(self, equations: Equations, step: float) -> Run:
        return Run(self.options(), equations, step)

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        def begin(equations: Equations, control: Control) -> ConservingSteps:
            if any(term.over_step is not None for term in equations.tables.terms):
                raise ValueError(
                    "conserving schemes have contacts by penalty in constant steps: expected the "
                    "step size as a number and a scene without discontinuities"
                )
            return ConservingSteps(self.options(), equations, control)

        return begin

    def options(self) -> Options:
        """What a run is told."""
        return Options(self.tolerance, self.policy, self.max_iterations)


@dataclass(frozen=True)
class EnergyDecaying(EnergyMomentum):
    """:class:`EnergyMomentum` with dissipation at high frequencies.

    Kinetic and elastic energy, less the work of loads, does not increase in any step, whatever the
    scene and the step. Momenta are conserved as by :class:`EnergyMomentum`. Linear problems are
    integrated by an A-stable two-step method of second order, between the trapezoidal rule
    (``radius`` 1) and BDF2 (``radius`` 0); see :mod:`fem_lie.solve.conserving.step.dissipation`.
    What was dissipated is the third column of ``result.balance``.

    Attributes:
        radius: Spectral radius at infinite frequency, in [0, 1]; 1 conserves.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.EnergyDecaying(radius=0.8).run(scene, duration=1.0, step=0.01)
        >>> bool(np.all(np.diff(result.total_energy) < 1e-9))
        True
    """

    radius: float = 0.8

    def __post_init__(self) -> None:
        """Check the options."""
        super().__post_init__()
        number(self.radius, "radius")
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"the spectral radius must be in [0, 1], got {self.radius}")

    def options(self) -> Options:
        """See the base class."""
        loss = (1.0 - self.radius) / (3.0 + self.radius)
        return Options(self.tolerance, self.policy, self.max_iterations, loss, 1.0 - loss)

"""Schemes that conserve energy, momentum and angular momentum to round-off.

With ``q = (x, d₁, d₂, d₃)`` of the nodes, the constant mass matrix ``G``, velocities ``V``, and
increments ``Δq`` from a translation and a Cayley rotation of each node
(:mod:`fem_lie.solve.conserving.midpoint.cayley`)::

    V₁ = 2 Δq/h − V
    L(q̄)ᵀ [G (V₁ − V)/h − dead] + elastic forces + joint forces − loads = 0,      Φ(q₁) = 0

``L(q̄)`` maps motions of the nodes to increments of the *mean* ``q̄ = ½(q + q₁)``, so that every
force does its exact work on ``Δq``:

- *inertia:* ``(V₁ − V)·G Δq/h = ½ V₁·G V₁ − ½ V·G V``, and the angular momentum ``Σ q × G V``
  changes by ``Σ q̄ × (forces)`` only;
- *elements:* forces do the work ``W₁ − W`` and have neither a resultant nor a moment, for any
  objective energy (:mod:`fem_lie.solve.conserving.midpoint.discrete_gradient`);
- *joints:* ``Φ`` is bilinear in ``q``, and its gradient at ``q̄`` does the work ``λ (Φ₁ − Φ) = 0``
  (:mod:`fem_lie.solve.conserving.step.joints`); constraints between more than two frames, and
  velocity constraints, have a discrete gradient (:mod:`.python_forces.constraints`);
- *loads* act at the midpoint of the step: gravity and constant forces have a potential; the work of
  all others and of viscous forces enters the energy balance.

The scheme is of second order. It has no numerical damping: oscillations that a step does not
resolve remain. Multipliers act over a step; joint forces are reported at its end
(:mod:`fem_lie.solve.conserving.midpoint.end_forces`). The iteration continues down to round-off,
with a frozen matrix in local frames. The groups of bodies do not matter for this scheme. Nodes with
vector coordinates have additive increments: their ``L`` is constant, and they are solved together
with frames (:mod:`fem_lie.solve.conserving.vector_cells`). Reduced-order bodies have further
coordinates with inertia (:mod:`fem_lie.solve.conserving.midpoint.reduced_bodies`).

Sources: Simo, Tarnow & Doblaré, IJNME 38 (1995) 1431; Gonzalez, J. Nonlinear Sci. 6 (1996) 449;
Romero & Armero, IJNME 54 (2002) 1683; Betsch & Leyendecker, IJNME 67 (2006) 499.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem_lie._arrays import Indices, number
from fem_lie.bodies.model import MassMatrix
from fem_lie.forms.term import Term
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.parts.part_scene import ScenePart, divided
from fem_lie.scene import Scene
from fem_lie.solve.conserving.model import has_vector_nodes, rotations_without_inertia
from fem_lie.solve.conserving.python_forces.forces import acts_in_the_middle
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.run_state import PREFIX, Options
from fem_lie.solve.conserving.variable import ConservingSteps
from fem_lie.solve.motion.integrator import Integrator, check_until_round_off, refuse
from fem_lie.solve.motion.policies import Automatic, RefactorisationPolicy
from fem_lie.solve.motion.variable_steps import Stepper
from fem_lie.solve.recording.plan import ChosenSteps, Plan
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations


def refuse_scene(equations: Equations) -> None:
    """Raise an error for scenes with features that have no forces over a step.

    Raises:
        ValueError: The message names the feature.
    """
    unknowns, known = equations.unknowns, equations.arrays
    pairs = known.pairs_of_all
    springs = unknowns.other_springs if pairs is None else pairs.other_springs
    apart = [
        f"{term.label} with damping" if term.viscosity is not None else term.label
        for term in known.terms
        if not _has_forces_over_steps(term, known.kinds)
    ]
    reasons = {
        "force laws without a potential (ForceLaw)": unknowns.laws_without_potential,
        "friction in joints (JointFriction)": unknowns.joint_friction,
        f"springs of {', '.join(springs)}": bool(springs),
        "supports along axes fixed in space (Shell.roller)": bool(equations.supports),
        "joints that need the rotation of a cable's end or of a node without axes "
        "(Revolute, Fixed; Spherical away from the node)": pairs is not None and pairs.loose,
        "velocity constraints (KnifeEdge, RollingDisc) on rotations without inertia (interfaces of "
        "reduced-order bodies, sections without rotary inertia)": (
            _binds_massless_rotations(equations)
        ),
        ", ".join(dict.fromkeys(apart)): bool(apart),
    }
    refuse("a conserving scheme", reasons)


def _binds_massless_rotations(equations: Equations) -> bool:
    """Whether a velocity constraint acts on rotations without inertia, at the start.

    No momentum gives their rates, which are means over a step, not those at its end.
    """
    bound = equations.unknowns.of_velocities
    light = rotations_without_inertia(equations)
    if not bound or not len(light):
        return False
    B = equations.constraints(equations.start.frames).jacobian.toarray()[-bound:]
    rates = B.reshape(bound, -1, 6)[:, :, 3:]
    return bool(np.any(np.einsum("cni,nij->cnj", rates, light)))


def _has_forces_over_steps(term: Term, kinds: Indices) -> bool:
    """Whether a step has forces of the term.

    Cells of nodes of one sort, or terms with such forces.
    """
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
    """Energy-momentum conserving scheme; :meth:`run` integrates.

    ``result.balance`` contains the work of loads and drives, and the loss by damping;
    ``result.balance_error`` is the error of the energy balance.

    Attributes:
        tolerance: 0: iterate down to round-off, which conserves to round-off. Otherwise the
            predicted iteration error in each step over the largest motion in a step. Energy and
            momenta are then conserved to some hundred times this value; see
            ``result.balance_error`` and the errors of momenta.
        policy: When to refactorise the iteration matrix.
        max_iterations: Largest number of iterations of a step.

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
    policy: RefactorisationPolicy = field(default_factory=Automatic)
    max_iterations: int = 100

    def __post_init__(self) -> None:
        """Check the options."""
        check_until_round_off(self.tolerance, self.max_iterations, self.policy)

    def _equations(self, scene: Scene) -> Equations:
        return self.equations(scene)

    def _divided_equations(self, scene: Scene, plan: Plan) -> Equations | None:
        """Equations of the part of this rank."""
        part = divided(scene, PREFIX)
        return None if part is None else self.equations(scene, part)

    def equations(self, scene: Scene, part: ScenePart | None = None) -> Equations:
        """Equations of a scene; ``ValueError`` if the scheme does not support the scene.

        Args:
            scene: The scene.
            part: What this rank has of it, if it is divided.
        """
        # translations are global, so derivatives by velocities are those of R³×SO(3)
        equations = Equations(
            scene, dynamics=True, group=Group.R3xSO3, mass=MassMatrix.WITH_DRILLING, part=part
        )
        with equations.shared.errors(ValueError):
            refuse_scene(equations)
        if self.policy.secants and not has_vector_nodes(equations):
            raise ValueError(
                "conserving schemes use secants where nodes have no frames (Cable, Net, "
                f"ThinShell, Solid): expected secants=0 without these, got {self.policy.secants}"
            )
        return equations

    def _integration(self, equations: Equations, step: float) -> Run:
        return Run(self.options(), equations, step)

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        def begin(equations: Equations, control: Control) -> ConservingSteps:
            contact = any(term.over_step is not None for term in equations.arrays.terms)
            if equations.shared.any(contact):
                raise ValueError(
                    "conserving schemes support contacts by penalty with constant steps only: "
                    "expected the step size as a number and a scene without discontinuities"
                )
            return ConservingSteps(self.options(), equations, control)

        return begin

    def options(self) -> Options:
        """Options of a run."""
        return Options(self.tolerance, self.policy, self.max_iterations)


@dataclass(frozen=True)
class EnergyDecaying(EnergyMomentum):
    """:class:`EnergyMomentum` with numerical dissipation at high frequencies.

    Kinetic and elastic energy, minus the work of loads, does not increase in any step, whatever the
    scene and the step. Momenta are conserved as by :class:`EnergyMomentum`. Linear problems are
    integrated by an A-stable two-step method of second order, between the trapezoidal rule
    (``radius`` 1) and BDF2 (``radius`` 0); see :mod:`fem_lie.solve.conserving.step.dissipation`.
    The dissipated energy is the third column of ``result.balance``.

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
        """Options of a run, with the dissipation parameter."""
        loss = (1.0 - self.radius) / (3.0 + self.radius)
        return Options(self.tolerance, self.policy, self.max_iterations, loss, 1.0 - loss)

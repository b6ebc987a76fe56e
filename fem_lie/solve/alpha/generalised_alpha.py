"""Generalised-α in local frames, index 3, with a frozen iteration matrix.

Brüls, Cardona & Arnold, Mech. Mach. Theory 48 (2012) 121. With ``d`` the increment of a step::

    d = h v + h² ((½ − β) a + β a₁)            H₁ = H exp(d)
    v₁ = v + h ((1 − γ) a + γ a₁)              (1 − α_m) a₁ + α_m a = (1 − α_f) v̇₁ + α_f v̇

and the equations of motion at the end of the step. Each body moves on SE(3), as written here, or on
R³×SO(3) (:mod:`fem_lie.lie.motions`). Constraints are scaled as in Bottasso, Bauchau & Cardona,
SIAM J. Sci. Comput. 29 (2007) 397, which makes the conditioning independent of h.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from fem_lie.lie.motions import Parametrisation
from fem_lie.parts.part_scene import ScenePart, divided
from fem_lie.scene import Scene
from fem_lie.solve.alpha import free_bodies
from fem_lie.solve.alpha.free_impacts import applies
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.alpha.variable import AlphaSteps
from fem_lie.solve.impacts.step_end import refuse_impacts
from fem_lie.solve.motion.integration import Driver
from fem_lie.solve.motion.integrator import Integrator
from fem_lie.solve.motion.variable_steps import Stepper
from fem_lie.solve.recording.plan import ChosenSteps, Plan
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations


@dataclass(frozen=True)
class GeneralisedAlpha(Options, Integrator):
    """Options of the scheme; :meth:`run` integrates.

    Scenes of rigid bodies only, without joints, clamps and motions, need no global matrix: one
    compiled loop makes their steps, see :mod:`fem_lie.solve.alpha.free_bodies`.

    If Newton's method does not converge, the step is divided into up to 64 sub-steps, with a radius
    of at most 0.5. A warning gives the number of divided steps (:mod:`fem_lie.solve.division`).

    Attributes:
        radius: Spectral radius at infinite frequency, in [0, 1]: 1 conserves, 0 damps at once.
        tolerance: Predicted iteration error in each step over the largest motion in a step so far.
            This is the relative error of velocities, which determines that of energy and momentum.
        policy: When to refactorise the iteration matrix.
        max_iterations: Largest number of iterations of a step.
        parametrisation: The map from increments to rotations.
        matrix_frame: Axes in which the iteration matrix is frozen.
        skew_part: What happens to the skew-symmetric part of the iteration matrix.
        index: Which constraints hold at the end of each step; default: those of positions
            (``THREE``), and in scenes with impacts of velocities, too (``STABILISED_TWO``).
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=1.0, step=0.01)
        >>> bool(result.energy_error < 1e-9)
        True
    """

    _has_events = True

    def _equations(self, scene: Scene, part: ScenePart | None = None) -> Equations:
        """Equations of a scene without impacts, which change the ends of steps."""
        scene = scene.without_impacts()
        if scene.impacts and scene.switched:
            raise ValueError(
                f"{scene.impacts[0].label}: expected Penalty with joints that are inactive or "
                f"switched ({scene.switched[0].label}), got Impact"
            )
        chosen = self.parametrisation
        equations = Equations(scene, dynamics=True, parametrisation=chosen, part=part)
        if scene.impacts and not self._free(scene):
            refuse_impacts(equations)
        return equations

    def _divided_equations(self, scene: Scene, plan: Plan) -> Equations | None:
        """Equations of the part of this rank."""
        part = divided(scene.without_impacts(), self.petsc_options_prefix)
        return None if part is None else self._equations(scene, part)

    def _free(self, scene: Scene) -> bool:
        """Whether all bodies of a scene are free rigid bodies, stepped independently."""
        exponential = self.parametrisation == Parametrisation.EXPONENTIAL
        return exponential and applies(scene, self.policy)

    def _integration(self, equations: Equations, step: float) -> Driver[Any]:
        # a part of free bodies may belong to a scene with others
        free = equations.part is None and self._free(equations.scene)
        return (free_bodies.Run if free else Run)(self, equations, step)

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        if found := scene.without_impacts().impacts:
            raise ValueError(
                f"{found[0].label}: Impact is for GeneralisedAlpha with constant steps, expected "
                f"their size as a number and no discontinuities, got {plan.choice}; give Penalty "
                "elsewhere"
            )
        return partial(AlphaSteps, self)

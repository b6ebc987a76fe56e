"""Generalised-α in local frames, index 3, with a kept iteration matrix.

Brüls, Cardona & Arnold, Mech. Mach. Theory 48 (2012) 121. With ``d`` the increment of a step::

    d = h v + h² ((½ − β) a + β a₁)            H₁ = H exp(d)
    v₁ = v + h ((1 − γ) a + γ a₁)              (1 − α_m) a₁ + α_m a = (1 − α_f) v̇₁ + α_f v̇

and the equations of motion at the end of the step. Each body moves on SE(3), as written here, or on
R³×SO(3) (:mod:`fem_lie.lie.motions`). Constraints are scaled as in Bottasso, Bauchau & Cardona,
SIAM J. Sci. Comput. 29 (2007) 397, which makes the conditioning independent of h.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

from fem_lie.lie.motions import Parametrisation
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.alpha import coupled_impacts, free_bodies, impacts, variable
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.motion.integrator import Alone, Integrator
from fem_lie.solve.motion.step_control import StepChoice
from fem_lie.solve.recording.saving import Saving
from fem_lie.system.equations import Equations

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class GeneralisedAlpha(Options, Integrator):
    """Options of the scheme; :meth:`run` integrates.

    Scenes of rigid bodies alone, without joints, clamps and motions, need no matrix of the scene:
    they go through one compiled loop, see :mod:`fem_lie.solve.alpha.free_bodies`.

    A step of which Newton's method finds no solution is made in up to 64 parts, with a radius of at
    most 0.5, and a warning says how many steps were (:mod:`fem_lie.solve.motion.division`).

    Attributes:
        radius: Spectral radius at infinite frequency, in [0, 1]: 1 conserves, 0 damps at once.
        tolerance: Predicted error of the iteration in each step over the largest motion in a step
            so far: the relative error of velocities, which is what energy and momentum feel.
        policy: When to factorise.
        max_iterations: More in one step are a failure.
        parametrisation: The map from increments to rotations.
        components: In which components the iteration matrix is kept.
        index: Which constraints hold at the end of each step.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.turn((0, 0, 2), about=top.centre)
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=1.0, step=0.01)
        >>> bool(result.energy_error < 1e-9)
        True
    """

    def _equations(self, scene: Scene) -> Equations:
        return Equations(scene, dynamics=True, parametrisation=self.parametrisation)

    def _integration(self, equations: Equations, step: float) -> Run:
        return Run(self, equations, step)

    def _follow(
        self,
        scene: Scene,
        duration: float,
        choice: StepChoice,
        saving: Saving,
        progress: bool | None,
    ) -> Result:
        equations = self._equations(scene)
        return variable.run(self, equations, duration, choice, saving, progress)

    def _compiled(
        self, scene: Scene, steps: int, step: float, saving: Saving, progress: bool | None
    ) -> Result | None:
        exponential = self.parametrisation == Parametrisation.EXPONENTIAL
        if exponential and impacts.applies(scene, self.policy):
            return impacts.Run(self, scene, step).integrate(steps, saving, progress)
        if coupled_impacts.applies(scene):
            return coupled_impacts.CoupledRun(self, scene, step).whole(steps, saving, progress)
        if not exponential or not free_bodies.applies(scene, self.policy):
            return None
        _log.info("free rigid bodies only (%d): no matrix of the scene", len(scene.bodies))
        return free_bodies.Run(self, scene, step).integrate(steps, saving, progress)

    def _alone(self, scene: Scene) -> Alone | None:
        exponential = self.parametrisation == Parametrisation.EXPONENTIAL
        if exponential and impacts.applies(scene, self.policy):
            return impacts.Alone(self, scene)
        if coupled_impacts.applies(scene):
            return coupled_impacts.CoupledAlone(self, scene)
        if exponential and free_bodies.applies(scene, self.policy):
            return free_bodies.Alone(self, scene)
        return None

r"""Energy, momentum and angular momentum to round-off, for beams, shells, rigid bodies and joints.

With ``q = (x, d₁, d₂, d₃)`` of the nodes, the constant matrix of inertia ``G``, velocities ``V``
and increments ``Δq`` that come from a translation and a Cayley rotation of each node
(:mod:`fem_lie.solve.between`)::

    V₁ = 2 Δq/h − V
    L(q̄)ᵀ [G (V₁ − V)/h − dead] + elastic forces + joint forces − loads = 0,      Φ(q₁) = 0

``L(q̄)`` turns motions of the nodes into those of the *mean* ``q̄ = ½(q + q₁)``, so that the work of
every force is that on ``Δq`` without any error:

- *inertia:* ``(V₁ − V)·G Δq/h = ½ V₁·G V₁ − ½ V·G V``, and the angular momentum ``Σ q × G V``
  changes by ``Σ q̄ × (forces)`` alone;
- *elements:* forces that do the work ``W₁ − W`` and have neither a resultant nor a moment, for any
  objective energy (:mod:`fem_lie.solve.discrete_gradient`);
- *joints:* ``Φ`` is bilinear in ``q``, and its gradient at ``q̄`` does the work ``λ (Φ₁ − Φ) = 0``
  (:mod:`fem_lie.solve.joints_between`);
- *loads* at the middle of the step: gravity and constant forces have a potential, the work of all
  others is counted, and so is what viscous forces take.

The scheme is of second order. It damps nothing: what a step does not resolve stays. Joint forces
are means over the step. The iteration goes on until nothing but round-off changes, with a matrix in
local frames that is kept as the policy says. Bodies' groups have no meaning for it.

Sources: Simo, Tarnow & Doblaré, IJNME 38 (1995) 1431; Gonzalez, J. Nonlinear Sci. 6 (1996) 449;
Romero & Armero, IJNME 54 (2002) 1683; Betsch & Leyendecker, IJNME 67 (2006) 499.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import numpy as np

from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.checkpoints import Checkpoints, fingerprint
from fem_lie.solve.conserving_run import Options, Run
from fem_lie.solve.policies import Automatic, Policy
from fem_lie.solve.recorder import History
from fem_lie.system import System


@dataclass(frozen=True)
class EnergyMomentum:
    """Options of the scheme; :meth:`run` integrates.

    ``result.balance`` follows the work of loads and drives, and the loss by damping;
    ``result.balance_error`` says how well energy, work and loss close.

    Attributes:
        tolerance: 0: iterate until only round-off changes, which conserves to round-off. Otherwise
            the predicted error of the iteration in each step over the largest motion in a step.
        policy: When to factorise.
        max_iterations: More in one step are a failure.
    """

    tolerance: float = 0.0
    policy: Policy = field(default_factory=Automatic)
    max_iterations: int = 50

    def __post_init__(self) -> None:
        """Check the options."""
        if not self.tolerance >= 0 or self.max_iterations < 1:
            raise ValueError(
                "wanted tolerance ≥ 0 and max_iterations ≥ 1, got "
                f"{self.tolerance}, {self.max_iterations}"
            )

    def run(
        self,
        scene: Scene,
        *,
        duration: float,
        step: float,
        save_every: int = 1,
        progress: bool | None = None,
        file: str | os.PathLike[str] | None = None,
        checkpoint_every: int | None = None,
    ) -> Result:
        """Integrate from the bodies' initial frames and velocities.

        Args:
            scene: What there is.
            duration: End time; a multiple of ``step``.
            step: Step size h.
            save_every: Keep every so many steps.
            progress: Show a bar; default: if standard error is a terminal.
            file: Where results go as they are made, instead of into memory; the result reads them
                from there. With it :meth:`resume` can go on after an interruption.
            checkpoint_every: Steps between two checkpoints; default: a hundredth of all.

        Raises:
            ValueError: Bad options or scene, before anything is computed.
            ConvergenceError: A step failed; its ``result`` holds what was computed.
        """
        steps = number_of_steps(duration, step, save_every)
        if file is None and checkpoint_every is not None:
            raise ValueError("checkpoint_every needs a file to which results go")
        system = System(scene, dynamics=True)
        store = None
        if file is not None:
            every = max(1, steps // 100) if checkpoint_every is None else checkpoint_every
            store = Checkpoints(file, every, (steps, step, save_every), fingerprint(system, self))
        history = History(system.info(), steps, step, save_every, progress, store)
        return Run(self._told(), system, step).integrate(history)

    def resume(
        self, scene: Scene, file: str | os.PathLike[str], *, progress: bool | None = None
    ) -> Result:
        """Go on from the last checkpoint of an interrupted run, to the same end.

        Args:
            scene: The scene as it was given to :meth:`run`.
            file: The file that was given.
            progress: Show a bar; default: if standard error is a terminal.

        Returns:
            To the last bit what :meth:`run` would have returned, but for the seconds.

        Raises:
            FileNotFoundError: There is no such file, or no checkpoint yet.
            ValueError: The checkpoint belongs to another scene or other options.
        """
        system = System(scene, dynamics=True)
        store = Checkpoints.resume(file, fingerprint(system, self))
        steps, step, save_every = store.plan
        history = History(system.info(), steps, step, save_every, progress, store)
        run = Run(self._told(), system, step)
        run.restore(store.memory)
        return run.integrate(history)

    def _told(self) -> Options:
        return Options(self.tolerance, self.policy, self.max_iterations)


def number_of_steps(duration: float, step: float, save_every: int) -> int:
    """How many steps there are.

    Raises:
        ValueError: They are not positive, the duration is no multiple of the step, or less than
            every step is to be kept.
    """
    if not (np.isfinite(step) and step > 0 and np.isfinite(duration) and duration > 0):
        raise ValueError(f"step and duration must be positive, got {step} and {duration}")
    steps = round(duration / step)
    if steps < 1 or abs(steps * step - duration) > 1e-6 * step:
        raise ValueError(f"duration {duration} is not a multiple of the step {step}")
    if save_every < 1:
        raise ValueError(f"save_every must be at least 1, got {save_every}")
    return steps

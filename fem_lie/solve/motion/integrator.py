"""What the schemes in time offer: a run, and to go on with one that was interrupted.

Arguments are checked here, before any work; how steps are made is in the modules of the schemes.
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, number, positive, whole
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.motion.integration import Driver
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.motion.variable_steps import ORDER, Stepper, VariableSteps, events
from fem_lie.solve.recording.checkpoints import Checkpoints, require_files
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.plan import ChosenSteps, EqualSteps, Plan, Saving
from fem_lie.solve.step_control import ConstantStep, Control, StepChoice
from fem_lie.system.equations import Equations


class Integrator(ABC):
    """Options of a scheme; :meth:`run` integrates."""

    _wanted_step: ClassVar[str] = (
        "makes constant steps: wanted the size of the step as a number and nothing that jumps "
        "(or use GeneralisedAlpha)"
    )

    def run(
        self,
        scene: Scene,
        *,
        duration: float,
        step: float | StepChoice,
        save_every: int = 1,
        save_at: float | npt.ArrayLike | None = None,
        record: Record = Record.ALL,
        progress: bool | None = None,
        file: str | os.PathLike[str] | None = None,
        checkpoint_every: int | None = None,
    ) -> Result:
        """Integrate from the bodies' initial frames and velocities.

        Args:
            scene: What there is.
            duration: End time; a multiple of ``step``.
            step: Step size h; or :class:`~fem_lie.AdaptiveStep`, which chooses it by a tolerance,
                or :class:`~fem_lie.ConstantStep`, which estimates the error of each step, too. It
                is taken, whose steps end where something jumps, if a load, drive or motion says
                that it does (:mod:`fem_lie.joints.histories`).
            save_every: Keep every so many steps, and the last one.
            save_at: Keep instead the states at these times, increasing, or at all multiples of an
                interval and at the end, whatever the steps are. Between two steps they are as
                :meth:`~fem_lie.Result.resampled` has them: frames and velocities by cubics on
                SE(3), of fourth order in the step; forces, energies and momenta linearly. Where
                something jumps at a named event, that of the side after it counts.
            record: What is kept of each state, such as ``Record.VELOCITIES | Record.ENERGIES``;
                nothing else is computed but what the steps themselves need.
            progress: Show a bar; default: if standard error is a terminal.
            file: Where results go as they are made, instead of into memory; the result reads them
                from there. With it :meth:`resume` can go on after an interruption.
            checkpoint_every: Steps between two checkpoints; default: a hundredth of all, or of the
                duration if the size of the steps changes. Such a run has a new matrix after each.

        Raises:
            ValueError: Bad options or scene, before anything is computed.
            ConvergenceError: A step failed; its ``result`` holds what was computed.
            OSError: Results cannot be written, as on a full disk; the message names the file and
                the time that was reached. What was written before can be read.
        """
        require_scene(scene)
        positive(duration, "duration")
        instance(save_every, int | np.integer, "save_every", "a whole number")
        plan = _plan(scene, duration, step, (save_every, save_at, record))
        if checkpoint_every is not None:
            whole(checkpoint_every, "checkpoint_every")
            if file is None:
                raise ValueError("checkpoint_every needs a file to which results go")
        begin, store = self._beginning(scene, plan), None
        equations = self._equations(scene)
        if file is not None:
            every = plan.checkpoint_interval(checkpoint_every)
            store = Checkpoints(file, every, plan, Fingerprint(equations, self))
        return begin(equations).run(plan, progress, store)

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
            ValueError: The checkpoint belongs to another scene or other options; the message says
                what differs. Functions of time are compared by their values on the steps made.
        """
        require_scene(scene)
        require_files(Path(file))
        equations = self._equations(scene)
        store = Checkpoints.resume(file, Fingerprint(equations, self))
        return self._beginning(scene, store.plan)(equations).run(store.plan, progress, store)

    def _beginning(self, scene: Scene, plan: Plan) -> Callable[[Equations], Driver[Any]]:
        """What makes the run of a plan; ``ValueError`` if the scheme has no such steps."""
        if isinstance(plan, EqualSteps):
            return partial(self._integration, step=plan.step)
        assert isinstance(plan, ChosenSteps)
        choice, steppers = plan.choice, self._steppers(scene, plan)

        def begin(equations: Equations) -> VariableSteps:
            jumps, length = events(scene, plan.duration), equations.unknowns.length
            control = choice.control(plan.duration, length, ORDER, jumps)
            finer = steppers(equations, control) if choice.refinement > 1 else None
            return VariableSteps(steppers(equations, control), control, finer, choice.refinement)

        return begin

    @abstractmethod
    def _equations(self, scene: Scene) -> Equations:
        """The equations of a scene; ``ValueError`` names what the scheme cannot do."""

    @abstractmethod
    def _integration(self, equations: Equations, step: float) -> Driver[Any]:
        """A run with constant steps."""

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        """What makes steps whose sizes change; refused by schemes of constant steps."""
        jumps = events(scene, plan.duration)
        what = f"something in the scene jumps at the times {list(jumps)}" if jumps else plan.choice
        raise ValueError(f"{type(self).__name__} {self._wanted_step}, got {what}")


def refuse(scheme: str, unsupported: Mapping[str, bool], instead: str = "GeneralisedAlpha") -> None:
    """Refuse a scene that has what a scheme does not support.

    Args:
        scheme: What the message calls it.
        unsupported: Names of what it does not support, and whether the scene has it.
        instead: Schemes that may support it.

    Raises:
        ValueError: The scene has some of it; the message names the first.
    """
    for what, present in unsupported.items():
        if present:
            raise ValueError(f"{scheme} does not support {what}: use {instead}")


def check_kinds(tolerance: float, max_iterations: int, policy: Policy) -> None:
    """Refuse options of an iteration that are of another kind than wanted.

    Raises:
        TypeError: One of them is.
        ValueError: The tolerance is not finite, or the number of iterations is out of its range.
    """
    number(tolerance, "tolerance")
    whole(max_iterations, "max_iterations")
    instance(policy, Policy, "policy", "a Policy such as Automatic()")


def check_until_round_off(tolerance: float, max_iterations: int, policy: Policy) -> None:
    """:func:`check_kinds` of an iteration whose tolerance may be 0: until only round-off changes.

    Raises:
        TypeError: One is of another kind than wanted.
        ValueError: One is out of its range.
    """
    check_kinds(tolerance, max_iterations, policy)
    if not tolerance >= 0:
        raise ValueError(f"expected tolerance ≥ 0, got {tolerance}")


def _plan(
    scene: Scene,
    duration: float,
    step: float | StepChoice,
    kept: tuple[int, float | npt.ArrayLike | None, Record],
) -> Plan:
    """What a run is to do; ``ValueError`` if that contradicts itself."""
    save_every, save_at, record = kept
    if isinstance(step, StepChoice):
        step.check(duration)
        return ChosenSteps(Saving.chosen(save_every, save_at, duration, record), duration, step)
    steps = _number_of_steps(duration, step)
    saving = Saving.chosen(save_every, save_at, steps * step, record)
    if events(scene, duration):
        return ChosenSteps(saving, duration, ConstantStep(step))
    return EqualSteps(saving, steps, float(step))


_MOST_STEPS = 2.0**53  # beyond, times of steps are no numbers of their own


def _number_of_steps(duration: float, step: float) -> int:
    positive(step, "step")
    if not duration / step < _MOST_STEPS:
        raise ValueError(
            f"duration {duration} is {duration / step:g} times the step {step}, and at most "
            f"{_MOST_STEPS:.0e} steps can be counted"
        )
    steps = round(duration / step)
    if steps < 1 or abs(steps * step - duration) > 1e-6 * step:
        raise ValueError(f"duration {duration} is not a multiple of the step {step}")
    return steps

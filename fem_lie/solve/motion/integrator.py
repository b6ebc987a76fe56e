"""What the schemes in time offer: a run, and to go on with one that was interrupted.

Arguments are checked here, before any work; how steps are made is in the modules of the schemes.
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, number, positive, whole
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.motion.step_control import ConstantStep, StepChoice
from fem_lie.solve.motion.variable_steps import events
from fem_lie.solve.recording.checkpoints import Checkpoints, Plan, require_files
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.saving import Saving
from fem_lie.system.equations import Equations


class Alone(Protocol):
    """Runs to files of a scene of which there are no equations as a whole.

    Attributes:
        fingerprint: Of the scene.
    """

    fingerprint: Fingerprint

    def integrate(self, store: Checkpoints, progress: bool | None) -> Result:
        """All steps that are left."""


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
            checkpoint_every: Steps between two checkpoints; default: a hundredth of all.

        Raises:
            ValueError: Bad options or scene, before anything is computed.
            ConvergenceError: A step failed; its ``result`` holds what was computed.
            OSError: Results cannot be written, as on a full disk; the message names the file and
                the time that was reached. What was written before can be read.
        """
        require_scene(scene)
        positive(duration, "duration")
        instance(save_every, int | np.integer, "save_every", "a whole number")
        if isinstance(step, StepChoice):
            if file is not None or checkpoint_every is not None:
                raise ValueError("results go to a file as they are made with constant steps only")
            step.check(duration)
            saving = Saving.chosen(save_every, save_at, duration, record)
            return self._follow(scene, duration, step, saving, progress)
        steps = _number_of_steps(duration, step)
        saving = Saving.chosen(save_every, save_at, steps * step, record)
        if file is None and checkpoint_every is not None:
            raise ValueError("checkpoint_every needs a file to which results go")
        if jumps := events(scene, duration):
            if file is not None:
                raise ValueError(
                    f"something in the scene jumps at the times {list(jumps)}, where steps are to "
                    "end; results go to a file as they are made with constant steps only"
                )
            return self._follow(scene, duration, ConstantStep(step), saving, progress)
        if file is None:
            result = self._compiled(scene, steps, step, saving, progress)
            if result is not None:
                return result
        every = max(1, steps // 100) if checkpoint_every is None else checkpoint_every
        plan = Plan(steps, step, saving)
        if file is not None and (alone := self._alone(scene)) is not None:
            return alone.integrate(Checkpoints(file, every, plan, alone.fingerprint), progress)
        equations, store = self._equations(scene), None
        if file is not None:
            store = Checkpoints(file, every, plan, Fingerprint(equations, self))
        run = self._integration(equations, step)
        return run.integrate(run.history(steps, saving, progress, store))

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
        if (alone := self._alone(scene)) is not None:
            return alone.integrate(Checkpoints.resume(file, alone.fingerprint), progress)
        equations = self._equations(scene)
        store = Checkpoints.resume(file, Fingerprint(equations, self))
        steps, step, saving = store.plan
        run = self._integration(equations, step)
        history = run.history(steps, saving, progress, store)
        run.restore(store.memory)
        return run.integrate(history)

    @abstractmethod
    def _equations(self, scene: Scene) -> Equations:
        """The equations of a scene; ``ValueError`` names what the scheme cannot do."""

    @abstractmethod
    def _integration(self, equations: Equations, step: float) -> Integration[Any]:
        """The state of a run with constant steps."""

    def _follow(
        self,
        scene: Scene,
        duration: float,
        choice: StepChoice,
        saving: Saving,
        progress: bool | None,
    ) -> Result:
        """A run with the steps of ``choice``; refused by schemes of constant steps."""
        jumps = events(scene, duration)
        given = f"something in the scene jumps at the times {list(jumps)}" if jumps else choice
        raise ValueError(f"{type(self).__name__} {self._wanted_step}, got {given}")

    def _compiled(
        self, scene: Scene, steps: int, step: float, saving: Saving, progress: bool | None
    ) -> Result | None:
        """The result for a scene that needs no matrix, if the scheme has a loop for such."""
        return None

    def _alone(self, scene: Scene) -> Alone | None:
        """What makes runs to files by itself, if the scheme has it for such a scene."""
        return None


WITHOUT_FRAMES = "nodes without frames (Cable, Net, ThinShell, AncfBeam, AncfShell, Solid)"
"""How refusals name bodies whose nodes have no rotation of their own."""


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

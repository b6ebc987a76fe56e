"""Base of all time integration schemes: a run, and the restart of an interrupted one.

Arguments are checked here before any computation; the modules of the schemes make the steps.
"""

from __future__ import annotations

import logging
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, number, positive, whole
from fem_lie.ranks.files import place, read_together, restart_file
from fem_lie.ranks.together import all_stay, several
from fem_lie.results import Result
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.record import Record
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.motion.integration import Driver
from fem_lie.solve.motion.policies import RefactorisationPolicy
from fem_lie.solve.motion.variable_steps import ORDER, Stepper, VariableSteps, events
from fem_lie.solve.recording.checkpoints import Checkpoints, Last, checkpoints_of
from fem_lie.solve.recording.fingerprint import Fingerprint
from fem_lie.solve.recording.parts_file import PartsFile
from fem_lie.solve.recording.plan import ChosenSteps, EqualSteps, Plan, Saving
from fem_lie.solve.recording.whole_state import is_whole
from fem_lie.solve.starting import starting_from, violated
from fem_lie.solve.step_control import ConstantStep, Control, StepChoice, number_of_steps
from fem_lie.solve.symmetric_steps import SymmetricStep
from fem_lie.system.equations import Equations

_log = logging.getLogger(__name__)


class Integrator(ABC):
    """Options of a time integration scheme; :meth:`run` integrates."""

    _wanted_step: ClassVar[str] = (
        "makes constant steps: expected the step size as a number and a scene without "
        "discontinuities (or use GeneralisedAlpha)"
    )

    _has_events: ClassVar[bool] = False
    """Whether the scheme ends steps at events, and has constraints that may be inactive."""

    _order: ClassVar[int] = ORDER
    """Order of the error estimate of a step, over its size."""

    _reports_energy: ClassVar[bool] = False
    """Whether variable steps are chosen by their kinetic energy, and not by their error."""

    @all_stay("a run")
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
        start: StaticResult | None = None,
    ) -> Result:
        """Integrate from the bodies' initial frames and velocities, or from an equilibrium.

        Args:
            scene: Bodies, joints, loads and contacts.
            duration: End time; a multiple of ``step``.
            step: Step size h; or :class:`~fem_lie.schemes.AdaptiveStep`, which chooses it by a
                tolerance, or :class:`~fem_lie.schemes.ConstantStep`, which also estimates the error
                of each step; for ``Variational`` :class:`~fem_lie.schemes.SymmetricStep`. If a
                load, drive or motion declares discontinuities (:mod:`fem_lie.joints.histories`),
                constant steps are fitted to end at them.
            save_every: Record every n-th state, and the last one.
            save_at: Record instead the states at these increasing times, or at all multiples of an
                interval and at the end, whatever the steps are. States between two steps are
                interpolated as by :meth:`~fem_lie.Result.resampled`: frames and velocities by
                cubics on SE(3), of fourth order in the step; forces, energies and momenta linearly.
                At a discontinuity the value after it is recorded.
            record: Recorded quantities, such as ``Record.VELOCITIES | Record.ENERGIES``; no others
                are computed, unless the steps themselves need them.
            progress: Show a bar; default: if standard error is a terminal.
            file: File to which results are written during the run, instead of memory; the result
                reads them from there. :meth:`resume` can then continue after an interruption.
            checkpoint_every: Steps between two checkpoints; default: a hundredth of all, or of the
                duration if the step size changes. Such a run refactorises after each checkpoint.
            start: Equilibrium, the last state of a result of :func:`~fem_lie.statics` or of a path
                of the same bodies, from which the motion starts at time 0, with the velocities of
                the bodies along the axes of their nodes, and in addition those of the steady
                rotation of the equilibrium (``spin``). Loads, supports and joints need not be those
                of the equilibrium, but it must satisfy the joints, drives and prescribed motions at
                time 0. Default: bodies start where they were made.

        Raises:
            ValueError: Invalid options or scene, or an equilibrium of other bodies, meshes or
                elements, before anything is computed; an equilibrium that violates a joint.
            ConvergenceError: A step failed; its ``result`` holds the states computed so far.
            OSError: Results cannot be written, for example to a full disk; the message names the
                file and the time that was reached. Results written before can be read.
        """
        require_scene(scene)
        if start is not None:
            instance(start, StaticResult, "start", "a result of statics or of a path")
            scene = starting_from(scene, start)
        positive(duration, "duration")
        instance(save_every, int | np.integer, "save_every", "a whole number")
        self._refuse_switches(scene)
        plan = _plan(scene, duration, step, (save_every, save_at, record))
        if checkpoint_every is not None:
            whole(checkpoint_every, "checkpoint_every")
            if file is None:
                raise ValueError("checkpoint_every needs a file to which results go")
        begin, store = self._beginning(scene, plan), None
        equations = self._divided_equations(scene, plan) or self._equations(scene)
        if start is not None:
            _check_joints(equations)
        if file is not None:
            every = plan.checkpoint_interval(checkpoint_every)
            given = every, plan, Fingerprint(equations, self)
            if equations.part is None:
                store = Checkpoints(place(file), *given)
            else:
                store = PartsFile(Path(file), *given, equations)
        equations.last = plan.last
        return begin(equations).run(plan, progress, store)

    @all_stay("a resumed run")
    def resume(
        self, scene: Scene, file: str | os.PathLike[str], *, progress: bool | None = None
    ) -> Result:
        """Restart an interrupted run from its last checkpoint, to the same end.

        Args:
            scene: The scene as it was given to :meth:`run`; an equilibrium from which the run
                started is in the file.
            file: The file given to :meth:`run`.
            progress: Show a bar; default: if standard error is a terminal.

        Returns:
            The result that :meth:`run` would have returned, bit for bit, except for the wall time.
            A scene that was divided among ranks restarts on any number of them, and its result is
            the same to the tolerance of the iteration.

        Raises:
            FileNotFoundError: There is no such file, or no checkpoint yet.
            ValueError: The checkpoint belongs to another scene or other options; the message names
                the differences. Functions of time are compared by their values on the steps made.
        """
        require_scene(scene)
        path = Path(file)
        last = read_together(path, partial(Last.of, path))
        scene = last.starting(scene)
        if is_whole(last.kept):
            part = self._divided_equations(scene, last.plan)
            equations = part or self._equations(scene)
            given = path, last.every, last.plan, Fingerprint(equations, self)
            store: Checkpoints = PartsFile(*given, equations)
        else:
            equations = self._equations(scene)
            path = restart_file(path, checkpoints_of(path))
            store = Checkpoints(path, last.every, last.plan, Fingerprint(equations, self))
        with equations.shared.errors(ValueError):
            store.resume(last)
        equations.last = last.plan.last
        return self._beginning(scene, last.plan)(equations).run(last.plan, progress, store)

    def _beginning(self, scene: Scene, plan: Plan) -> Callable[[Equations], Driver[Any]]:
        """Factory of the run of a plan; ``ValueError`` if the scheme does not support the plan."""
        if isinstance(plan, EqualSteps):
            return partial(self._integration, step=plan.step)
        assert isinstance(plan, ChosenSteps)
        choice, steppers = plan.choice, self._steppers(scene, plan)
        if isinstance(choice, SymmetricStep) and not self._reports_energy:
            raise ValueError(
                f"{type(self).__name__} chooses steps by their error: expected AdaptiveStep, got "
                f"{choice} (which is for Variational)"
            )

        def begin(equations: Equations) -> VariableSteps:
            jumps, length = events(scene, plan.duration), equations.unknowns.length
            control = choice.control(plan.duration, length, self._order, jumps)
            finer = steppers(equations, control) if choice.refinement > 1 else None
            return VariableSteps(steppers(equations, control), control, finer, choice.refinement)

        return begin

    def _refuse_switches(self, scene: Scene) -> None:
        """Raise ``ValueError`` if the scheme has no events and the scene has."""
        found = [each.label for each in scene.switched] + [each.label for each in scene.events]
        if found and not self._has_events:
            raise ValueError(
                f"{type(self).__name__} does not support events and inactive joints ({found[0]}): "
                "use GeneralisedAlpha"
            )
        others = [each.name for each in scene.sensors] + [each.label for each in scene.controllers]
        if others and not self._has_events:
            raise ValueError(
                f"{type(self).__name__} does not support sensors and controllers ({others[0]}): "
                "use GeneralisedAlpha"
            )

    def _divided_equations(self, scene: Scene, plan: Plan) -> Equations | None:
        """Equations of the part of a scene that this rank has, if the scheme divides it."""
        if several():
            name = type(self).__name__
            _log.info("every rank has the whole scene, as %s does not divide it", name)
        return None

    @abstractmethod
    def _equations(self, scene: Scene) -> Equations:
        """Equations of a scene; ``ValueError`` if the scheme does not support the scene."""

    @abstractmethod
    def _integration(self, equations: Equations, step: float) -> Driver[Any]:
        """A run with constant steps."""

    def _steppers(
        self, scene: Scene, plan: ChosenSteps
    ) -> Callable[[Equations, Control], Stepper[Any]]:
        """Factory of variable-size steppers; schemes with constant steps raise ``ValueError``."""
        jumps = events(scene, plan.duration)
        what = f"a scene with discontinuities at the times {list(jumps)}" if jumps else plan.choice
        raise ValueError(f"{type(self).__name__} {self._wanted_step}, got {what}")


def refuse(scheme: str, unsupported: Mapping[str, bool], instead: str = "GeneralisedAlpha") -> None:
    """Raise an error if the scene has something that a scheme does not support.

    Args:
        scheme: Name of the scheme in the message.
        unsupported: Names of unsupported features, and whether the scene has them.
        instead: Schemes that may support them.

    Raises:
        ValueError: The scene has some of them; the message names the first.
    """
    for what, present in unsupported.items():
        if present:
            raise ValueError(f"{scheme} does not support {what}: use {instead}")


def _check_joints(equations: Equations) -> None:
    """Raise ``ValueError`` on all ranks if the start violates a joint."""
    text = violated(equations, equations.start.frames)
    with equations.shared.errors(ValueError):
        if text:
            raise ValueError(
                f"start: expected a state that satisfies all joints, but {text} (drives without a "
                "function hold their coordinates)"
            )


def check_kinds(tolerance: float, max_iterations: int, policy: RefactorisationPolicy) -> None:
    """Check the types of the options of an iteration.

    Args:
        tolerance: The tolerance.
        max_iterations: Largest number of iterations.
        policy: The refactorisation policy.

    Raises:
        TypeError: An option has a wrong type.
        ValueError: The tolerance is not finite, or the number of iterations is out of range.
    """
    number(tolerance, "tolerance")
    whole(max_iterations, "max_iterations")
    instance(policy, RefactorisationPolicy, "policy", "a Policy such as Automatic()")


def check_until_round_off(
    tolerance: float, max_iterations: int, policy: RefactorisationPolicy
) -> None:
    """Check as :func:`check_kinds`, with tolerance 0 allowed: iterate down to round-off.

    Raises:
        TypeError: An option has a wrong type.
        ValueError: An option is out of range.
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
    """Plan of a run; ``ValueError`` if the arguments contradict each other."""
    save_every, save_at, record = kept
    if isinstance(step, StepChoice):
        step.check(duration)
        return ChosenSteps(Saving.chosen(save_every, save_at, duration, record), duration, step)
    steps = _number_of_steps(duration, step)
    saving = Saving.chosen(save_every, save_at, steps * step, record)
    if events(scene, duration) or scene.happens:
        return ChosenSteps(saving, duration, ConstantStep(step))
    return EqualSteps(saving, steps, float(step))


_MOST_STEPS = 2.0**53  # beyond this number, times of successive steps are not distinct


def _number_of_steps(duration: float, step: float) -> int:
    positive(step, "step")
    if not duration / step < _MOST_STEPS:
        raise ValueError(
            f"duration {duration} is {duration / step:g} times the step {step}, and at most "
            f"{_MOST_STEPS:.0e} steps can be counted"
        )
    return number_of_steps(duration, step)

"""Log of a run with variable steps: sizes and local errors of all steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.events.sensor import Sensor
from fem_lie.lie.node_types import floating, inertia, pull_all_back
from fem_lie.lie.tuples import dot, load
from fem_lie.parts.part_scene import scene_numbers, undivided, whole_scene
from fem_lie.results.record import StepHistory
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


class StepError(NamedTuple):
    """Largest errors of one step over all nodes.

    Attributes:
        translation: Error of positions, length.
        rotation: Error of rotations, rad, and of position gradients.
        translation_node: Node with the largest translation error, as results number it.
        rotation_node: Node with the largest rotation error, as results number it.
    """

    translation: float
    rotation: float
    translation_node: int
    rotation_node: int


@compiled
def largest(e: Array, lengths: Flags | Indices) -> tuple[float, float, int, int]:
    """Largest norms of the length halves and of the other halves of errors (n, 6), and their nodes.

    ``lengths`` (n, 2) says which halves are lengths.
    """
    translation = rotation = 0.0
    first = second = 0
    for i in range(e.shape[0]):
        for half in range(2):
            part = load(e[i], 3 * half)
            square = dot(part, part)
            if lengths[i, half]:
                if square > translation or square != square:  # nan is passed on
                    translation, first = square, i
            elif square > rotation or square != square:
                rotation, second = square, i
    return np.sqrt(translation), np.sqrt(rotation), first, second


def result_numbers(equations: Equations) -> Indices:
    """Number in results of the scene of each moving node, shape (n,)."""
    unknowns, part = equations.unknowns, equations.part
    if part is None:
        return unknowns.masters
    return scene_numbers(part, unknowns.bodies)[unknowns.masters]


class LargestError:
    """Largest of the errors of all nodes, over all parts of a divided scene."""

    def __init__(self, equations: Equations) -> None:
        """Store the numbers of the nodes.

        Args:
            equations: Equations of the scene, or of the part of this rank.
        """
        self._shared, self._lengths = equations.shared, equations.unknowns.lengths
        self._numbers = result_numbers(equations)

    def of(self, e: Array) -> StepError:
        """Largest error, the same on all ranks.

        Args:
            e: Errors of the moving nodes along their axes, shape (n, 6).
        """
        *own, first, second = largest(e, self._lengths)
        found = [self._shared.largest(value) for value in own]
        pairs = zip(own, found, self._numbers[[first, second]], strict=True)
        here = np.array([number if value == most else -1 for value, most, number in pairs])
        nodes = self._shared.highest(here)
        return StepError(found[0], found[1], int(nodes[0]), int(nodes[1]))


def add_inertia_forces(
    equations: Equations, H: Array, q: Array, factor: float, forces: Array
) -> None:
    """Add ``factor Lᵀ G q`` at frames ``H``: ``q`` (n, 4, 3), ``forces`` (n, 6).

    The forces are those of all parts of a divided scene. Inertia of reduced-order bodies is
    included for nodal coordinates that accelerate by ``q`` from rest.
    """
    work, kinds = np.empty_like(q), equations.unknowns.kinds
    indptr, indices, blocks = equations.arrays.inertia
    inertia.multiply(indptr, indices, blocks, q, work)
    bodies, numbers = equations.arrays.floating
    if bodies[0]:
        _add_floating(kinds, H, q, bodies, numbers, work)
    pull_all_back(kinds, H, work, factor, forces.reshape(-1))
    equations.shared.sum(forces)


@compiled
def _add_floating(
    kinds: Indices, H: Array, q: Array, integers: Indices, numbers: Array, out: Array
) -> None:
    """Add inertia forces of reduced-order bodies for accelerations ``q``, without weight."""
    still, with_weight = np.zeros((q.shape[0], 6)), np.zeros_like(q)
    floating.add_forces(kinds, H, still, q, integers, numbers, out)
    floating.add_forces(kinds, H, still, np.zeros_like(q), integers, numbers, with_weight)
    out -= with_weight


def largest_gaps(H: Array, other: Array) -> tuple[float, float]:
    """Largest distances and angles between frames of the same nodes, shape (n, 4, 3)."""
    gap = np.linalg.norm(other[:, 0] - H[:, 0], axis=1).max()
    turned = lie.se3_relative(H, other)[:, 3:]
    return float(gap), float(np.linalg.norm(turned, axis=1).max())


@dataclass
class StepLog:
    """Collects :class:`~fem_lie.results.record.StepHistory`."""

    equations: Equations
    times: list[float] = field(default_factory=list)
    sizes: list[float] = field(default_factory=list)
    errors: list[StepError] = field(default_factory=list)
    measured: list[tuple[float, float]] = field(default_factory=list)
    rejected: list[float] = field(default_factory=list)
    events: list[tuple[float, int, float]] = field(default_factory=list)
    sensed: list[tuple[float, ...]] = field(default_factory=list)

    @property
    def _sensors(self) -> list[Sensor]:
        """Sensors of the scene."""
        return whole_scene(self.equations.scene, self.equations.part).sensors

    def add(
        self, time: float, size: float, error: StepError, measured: tuple[float, float]
    ) -> None:
        """Add an accepted step."""
        self.times.append(time)
        self.sizes.append(size)
        self.errors.append(error)
        self.measured.append(measured)

    def add_many(self, times: Array, sizes: Array, errors: Array) -> None:
        """Add accepted steps whose errors are not measured, (k,), (k,) and (k, 4)."""
        self.times += map(float, times)
        self.sizes += map(float, sizes)
        numbers = result_numbers(self.equations)
        self.errors += [
            StepError(float(t), float(r), int(numbers[int(i)]), int(numbers[int(k)]))
            for t, r, i, k in errors
        ]
        self.measured += [(np.nan, np.nan)] * len(times)

    def saved_state(self) -> dict[str, Array]:
        """Arrays of the log, by name."""
        return {
            "times": np.array(self.times),
            "sizes": np.array(self.sizes),
            "errors": np.array(self.errors, dtype=np.float64).reshape(-1, 4),
            "measured": np.array(self.measured, dtype=np.float64).reshape(-1, 2),
            "rejected": np.array(self.rejected),
            "events": np.array(self.events, dtype=np.float64).reshape(-1, 3),
            "sensed": np.array(self.sensed, dtype=np.float64).reshape(-1, 1 + len(self._sensors)),
        }

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the arrays that :meth:`saved_state` returned."""
        for name in ("times", "sizes", "rejected"):
            getattr(self, name)[:] = map(float, kept[name])
        self.errors[:] = (
            StepError(float(t), float(r), int(i), int(k)) for t, r, i, k in kept["errors"]
        )
        self.events[:] = ((float(t), int(k), float(lost)) for t, k, lost in kept["events"])
        self.sensed[:] = (tuple(map(float, row)) for row in kept["sensed"])
        self.measured[:] = ((float(t), float(r)) for t, r in kept["measured"])

    def history(self) -> StepHistory:
        """All steps as a record."""
        known = self.saved_state()
        errors, measured = known["errors"], known["measured"]
        return StepHistory(
            times=known["times"],
            sizes=known["sizes"],
            translation=errors[:, 0],
            rotation=errors[:, 1],
            nodes=errors[:, 2:].astype(np.int64),
            measured_translation=measured[:, 0],
            measured_rotation=measured[:, 1],
            rejected=known["rejected"],
            event_times=known["events"][:, 0],
            event_numbers=known["events"][:, 1].astype(np.int64),
            event_losses=known["events"][:, 2],
            sensor_names=np.array([each.name.encode() for each in self._sensors], "S"),
            sensor_times=known["sensed"][:, 0],
            sensor_values=known["sensed"][:, 1:],
        )

    def body(self, node: int) -> str:
        """Label of the body of a node, as results number it."""
        part = self.equations.part
        known = self.equations.unknowns.bodies if part is None else undivided(part.whole).nodes
        return next(body.label for body, nodes in known.items() if node in nodes)

    def underflow(
        self, control: Control, time: float, h: float, error: StepError | None, increment: float
    ) -> str:
        """Error message if the step size becomes too small.

        Args:
            control: Step size control.
            time: Current time.
            h: Size of the last rejected step.
            error: Its error; ``None`` if it did not converge.
            increment: Its last increment.
        """
        text = f"at time {time:.9g} a step of {h:.3g} "
        if error is None:
            return (
                f"{text}did not converge, and smaller ones than {control.smallest:.3g} are not "
                f"allowed: last increment {increment:.2e}"
            )
        if control.tolerance == inf:
            smaller = f"smaller ones than {control.smallest:.3g} are not allowed"
            return f"{text}is not admissible, and {smaller}"
        moved = error.translation / control.tolerance >= error.rotation / control.rotation_tolerance
        size, tolerance, unit, node = (
            (error.translation, control.tolerance, "length", error.translation_node)
            if moved
            else (error.rotation, control.rotation_tolerance, "rad", error.rotation_node)
        )
        return (
            f"{text}has an estimated error of {size / h:.3e} {unit} per time, expected at most "
            f"{tolerance:.3e}, and steps below {control.smallest:.3g} are not allowed; "
            f"{self.body(node)} limits it. Name the times of jumps as events, or give a larger "
            "tolerance or a smaller `smallest`"
        )

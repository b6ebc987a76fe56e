"""Drives, prescribed motions and loads at one time, and rotations of drives in an interval."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import cached_property
from math import ceil
from typing import TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.system.nodes.sums import load_vector
from fem_lie.system.system import System

FRAME_STEP = 0.25 * np.pi
"""Largest rotation of a prescribed frame in one step, rad: Newton starts along its tangent."""

ANGLE_STEP = 0.5 * np.pi
"""Largest change of an angle in one step, rad."""

_PIECES = 16  # initial subdivision of an interval
_AT = 0.381966  # point of bisection: no simple fraction, to detect full turns
_SMALL = 0.5  # largest rotation between samples, rad
_STRAIGHT = 0.05  # largest excess of two rotations over the one from end to end, rad
_DEPTH = 12  # bisections; a rotation that is still large is a jump

_Sample: TypeAlias = tuple[float, Array, Array]


class RotationAhead:
    """Rotations of all that is prescribed, relative to the largest admissible in one step."""

    def __init__(self, system: System) -> None:
        """Find the prescribed motions and driven angles of a system."""
        connections = system.connections
        self._frames: Callable[[float], Array] = system.prescribed_frames
        self._targets: Callable[[float], Array] = connections.targets
        self._angular = connections.angular
        self._any = bool(system.scene.motions) or connections.driven

    def limited(self, time: float, end: float) -> float:
        """End of the first of equal steps from ``time`` to ``end`` with admissible rotations.

        Raises:
            ValueError: A motion or drive is not finite, or a motion is not a frame, in between.
        """
        if not self._any:
            return end
        first = self._sample(time)
        before, times = first, [time]
        travelled: list[Array] = [np.zeros(len(first[1]) + len(first[2]))]
        for piece in range(_PIECES):
            after = self._sample(end - (end - time) * (1 - (piece + 1) / _PIECES))
            for sample in self._between(before, after, _DEPTH):
                times.append(sample[0])
                travelled.append(travelled[-1] + np.concatenate(_rotations(before, sample)))
                before = sample
        limits = np.repeat([FRAME_STEP, ANGLE_STEP], [len(first[1]), len(first[2])])
        shares = (np.array(travelled) / limits).max(axis=1, initial=0.0)
        steps = ceil(shares[-1] - 1e-9)
        if steps <= 1:
            return end
        found = float(np.interp(shares[-1] / steps, shares, times))
        # if a motion jumps, no step is short enough
        return found if found > time + 1e-9 * (end - time) else end

    def _sample(self, time: float) -> _Sample:
        return time, self._frames(time)[:, 1:], self._targets(time)[self._angular]

    def _between(self, a: _Sample, b: _Sample, depth: int) -> Iterator[_Sample]:
        """Samples after ``a`` up to ``b`` between which rotations are unambiguous."""
        if depth and len(a[1]):
            m = self._sample(a[0] + _AT * (b[0] - a[0]))
            first, second, whole = (_rotations(*ends)[0] for ends in ((a, m), (m, b), (a, b)))
            apart = first + second
            if (apart > _SMALL).any() or (apart > whole + _STRAIGHT).any():
                yield from self._between(a, m, depth - 1)
                yield from self._between(m, b, depth - 1)
                return
        yield b


def _rotations(a: _Sample, b: _Sample) -> tuple[Array, Array]:
    """Rotations of frames and changes of angles between two samples, rad."""
    # |R − R'| = √8 sin(θ/2)
    chords = np.sqrt(np.sum((b[1] - a[1]) ** 2, axis=(1, 2)) / 8.0)
    return 2.0 * np.arcsin(np.minimum(chords, 1.0)), np.abs(b[2] - a[2])


class Prescribed:
    """Frames of prescribed motions, targets of constraints, and loads at one time, computed lazily.

    Rates are differences over later times before the next jump, near the end of the run over
    earlier ones: prescribed functions need not be defined before the start of the run or after its
    end.
    """

    def __init__(self, system: System, time: float, step: float, last: float) -> None:
        """Store the time.

        Args:
            system: The equations.
            time: Time since the start of the scene.
            step: Interval of the differences for rates.
            last: End of the run, or infinity.
        """
        self._system, self._step = system, step
        self._time, self._last = system.scene.began.time + time, system.scene.began.time + last

    def act(self, factor: float = 1.0, preload: float = 1.0) -> None:
        """Apply loads and targets of this time from now on.

        Args:
            factor: Factor of loads without history, and of gravity.
            preload: Fraction of the difference between rest values of springs and initial
                coordinates.

        Raises:
            ValueError: A history, motion or drive is not finite.
        """
        system = self._system
        system.connections.preload(system.nodal_data.start_frames, preload)
        # a function of the user may fail on the rank that has its load
        with system.shared.errors(Exception) if system.prescribes else nullcontext():
            system.set_time(self._time, factor)

    def loads(self, H: Array) -> Array:
        """Loads at frames ``H`` in the unknowns of the nodes, (6 n,); they act from now on.

        Raises:
            ValueError: A history is not finite.
        """
        self.act()
        system, forces = self._system, np.zeros((self._system.count, 6))
        loads = system.loads
        load_vector(system.kinds, H, loads.dead, loads.moment, loads.following, forces)
        forces += system.terms.of_loads(H)
        system.supports.rotate(H, forces)
        forces[system.held] = 0.0
        system.shared.sum(forces)
        return forces.ravel()

    @cached_property
    def frames(self) -> Array:
        """Frames of the prescribed motions, (p, 4, 3).

        Raises:
            ValueError: The value of a motion is not a frame.
        """
        return self._system.prescribed_frames(self._time)

    @cached_property
    def targets(self) -> Array:
        """Targets of the constraints, (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        return self._system.connections.targets(self._time)

    def limited(self, end: float) -> float:
        """End of the first of equal steps to ``end`` with admissible prescribed rotations.

        Raises:
            ValueError: A motion or drive is invalid in between.
        """
        began = self._system.scene.began.time
        return RotationAhead(self._system).limited(self._time, began + end) - began

    @property
    def velocities(self) -> Array:
        """Twists of the motions in their frames, (p, 6)."""
        return self._rates[0]

    @property
    def accelerations(self) -> Array:
        """Rates of these twists, (p, 6)."""
        return self._rates[1]

    @cached_property
    def target_rates(self) -> tuple[Array, Array]:
        """First and second rates of the targets, (m,)."""
        return self._system.connections.target_rates(self._time, self._step, self._last)

    @cached_property
    def _rates(self) -> tuple[Array, Array]:
        """Rates of the motions, by differences over three other times."""
        system, time, here = self._system, self._time, self.frames
        if len(here) == 0:
            return np.zeros((0, 6)), np.zeros((0, 6))
        step = system.nodal_data.difference_step(time, self._step, 3, self._last)
        others = [system.prescribed_frames(time + k * step) for k in (1, 2, 3)]
        d1, d2, d3 = (lie.se3_relative(here, frames) for frames in others)
        # d(t) = v t + v̇ t²/2 + j t³/6 through the three
        first = (18 * d1 - 9 * d2 + 2 * d3) / (6 * step)
        return np.asarray(first), np.asarray((-5 * d1 + 4 * d2 - d3) / step**2)

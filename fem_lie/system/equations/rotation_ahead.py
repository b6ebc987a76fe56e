"""How far prescribed motions and drives rotate within an interval of time, whole turns included."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil
from typing import TypeAlias

import numpy as np

from fem_lie._arrays import Array
from fem_lie.system.system import System

FRAME_STEP = 0.25 * np.pi
"""Rotation of a prescribed frame in one step, rad: Newton's first increment is its tangent."""

ANGLE_STEP = 0.5 * np.pi
"""Change of an angle in one step, rad."""

_PIECES = 16  # of an interval, to begin with
_AT = 0.381966  # where a piece is divided: no simple fraction, so that whole turns are noticed
_SMALL = 0.5  # rad: rotations between samples are less …
_STRAIGHT = 0.05  # … and exceed the one from end to end by no more than this, rad
_DEPTH = 12  # times that a piece is divided; what still rotates far jumps

_Sample: TypeAlias = tuple[float, Array, Array]


class RotationAhead:
    """Rotations of all that is prescribed, over the largest that one step may have."""

    def __init__(self, system: System) -> None:
        """Of prescribed motions and of driven angles."""
        connections = system.connections
        self._frames: Callable[[float], Array] = system.prescribed_frames
        self._targets: Callable[[float], Array] = connections.targets
        self._angular = connections.angular
        self._any = bool(system.scene.motions) or connections.driven

    def limited(self, time: float, end: float) -> float:
        """The end of the first of equal steps from ``time`` to ``end``, none of which rotates far.

        Raises:
            ValueError: A motion or drive is not finite, or a motion is no frame, in between.
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
        # where a motion jumps, no step is short enough
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
    """Of frames and of angles between two samples, rad."""
    # |R − R'| = √8 sin(θ/2)
    chords = np.sqrt(np.sum((b[1] - a[1]) ** 2, axis=(1, 2)) / 8.0)
    return 2.0 * np.arcsin(np.minimum(chords, 1.0)), np.abs(b[2] - a[2])

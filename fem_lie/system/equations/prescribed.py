"""What drives, prescribed motions and loads do at a time."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.system.equations.rotation_ahead import RotationAhead
from fem_lie.system.nodes.sums import load_vector
from fem_lie.system.system import System


class Prescribed:
    """Places of prescribed motions, targets of constraints and loads, found when asked for.

    Rates are differences over later times, none beyond the next jump: what is prescribed need not
    be defined before.
    """

    def __init__(self, system: System, time: float, step: float) -> None:
        """Nothing is found yet.

        Args:
            system: The equations.
            time: When, from the time on at which the scene began.
            step: Over which rates are differences.
        """
        self._system, self._step = system, step
        self._time = system.scene.began.time + time

    def act(self, factor: float = 1.0, preload: float = 1.0) -> None:
        """Let loads and targets of this time act from now on.

        Args:
            factor: Of loads without history, and of gravity.
            preload: Part of the difference between the rest values of springs and the values of
                their coordinates at the start.

        Raises:
            ValueError: A history, motion or drive is not finite.
        """
        self._system.connections.preload(self._system.rows.begins_at, preload)
        self._system.set_time(self._time, factor)

    def loads(self, H: Array) -> Array:
        """Loads, which act from now on, at frames ``H``, in the unknowns of the nodes, (6 n,).

        Raises:
            ValueError: A history is not finite.
        """
        self.act()
        system, forces = self._system, np.zeros((self._system.count, 6))
        loads = system.loads
        load_vector(system.kinds, H, loads.dead, loads.moment, loads.following, forces)
        forces += system.terms.of_loads(H)
        system.supports.turn(H, forces)
        forces[system.held] = 0.0
        return forces.ravel()

    @cached_property
    def frames(self) -> Array:
        """Frames of the prescribed motions, (p, 4, 3).

        Raises:
            ValueError: One of them is not a frame then.
        """
        return self._system.prescribed_frames(self._time)

    @cached_property
    def targets(self) -> Array:
        """What constraints are to be, (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        return self._system.connections.targets(self._time)

    def limited(self, end: float) -> float:
        """The end of the first of equal steps to ``end``, none with a large prescribed rotation.

        Raises:
            ValueError: A motion or drive is bad in between.
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
        return self._system.connections.target_rates(self._time, self._step)

    @cached_property
    def _rates(self) -> tuple[Array, Array]:
        """Of the motions, by differences over three later times."""
        system, time, here = self._system, self._time, self.frames
        if len(here) == 0:
            return np.zeros((0, 6)), np.zeros((0, 6))
        step = min(self._step, system.rows.until_break(time) / 3.0)
        later = [system.prescribed_frames(time + k * step) for k in (1, 2, 3)]
        d1, d2, d3 = (lie.se3_relative(here, frames) for frames in later)
        # d(t) = v t + v̇ t²/2 + j t³/6 through the three
        first = (18 * d1 - 9 * d2 + 2 * d3) / (6 * step)
        return np.asarray(first), np.asarray((-5 * d1 + 4 * d2 - d3) / step**2)

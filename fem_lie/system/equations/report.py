"""What is told of a state."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.kinds import shown_all
from fem_lie.linear.redundancy import IdleMultipliers
from fem_lie.scene.choices import Redundant
from fem_lie.system.instant import Instant
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.system import System
from fem_lie.system.terms.all_terms import Terms


class Joints(NamedTuple):
    """What is told of joints and of what acts along them.

    Attributes:
        forces: Force and moment of each on its point ``a``, in its axes, (j, 6).
        coordinates: Of all, one after the other, (c,).
        violations: The largest of each, (j,).
    """

    forces: Array
    coordinates: Array
    violations: Array


class Report:
    """What is told of one state, found when asked for.

    Only what needs velocities, their rates or multipliers asks for these.
    """

    def __init__(self, system: System, terms: Terms, state: Instant, *, carried: bool) -> None:
        """Nothing is found yet.

        Args:
            system: The equations.
            terms: Those whose energy no table of joints has.
            state: Of which to tell.
            carried: Whether cells keep their own unknowns as they were carried along.
        """
        self._system, self._terms, self._state, self._carried = system, terms, state, carried

    @cached_property
    def frames(self) -> Array:
        """Frames of all nodes, those that follow others included, (N, 4, 3)."""
        return self._system.numbering.attachment.frames(self._state.H)

    @property
    def twists(self) -> Array:
        """Velocities as twists of all nodes along the rows of their frames, (N, 6)."""
        H, v = self._state.H, self._state.v
        shown = np.empty_like(v)
        shown_all(self._system.kinds, H, np.ascontiguousarray(v), shown)
        return self._system.numbering.attachment.twists(shown)

    @property
    def elastic(self) -> float:
        """Energy of elements, and of springs that are not in the tables of the equations."""
        H, connections = self._state.H, self._system.connections
        with self._terms.unchanged():
            found = self._terms.energy(H)
        return found if connections.of_joints_only else found + connections.other_spring_energy(H)

    @property
    def joints(self) -> Joints:
        """Of joints, and of what acts along them."""
        system, (H, v, _, weights) = self._system, self._state
        if system.scene.redundant is Redundant.MINIMUM_NORM and system.m:
            # of all multipliers that make the same motion the smallest
            B = system.tangent.jacobian(H)
            units = np.asarray(system.units / system.length)
            weights = IdleMultipliers.of(B, units, system.kkt.measure).remove(weights)
        return Joints(*system.connections.report(H, v, weights))

    @property
    def reactions(self) -> Array:
        """Force and moment of supports on what is held, about it, global components, (s, 6)."""
        system, state = self._system, self._state
        if not len(system.supported):
            return np.zeros((0, 6))
        H, r = state.H, np.empty(system.size)
        with self._terms.unchanged():
            if not self._carried:
                self._terms.condense(state.H)
            # along the axes of supports, where there are any
            system.with_reactions(state, np.ones(system.m), r)
        local, held = r[: 6 * system.count].reshape(-1, 6), system.held
        if system.supports:
            local[~held] = 0.0
            system.supports.turn_back(H, local)
            held = np.ones_like(held)
        return wrenches(system.kinds, H, local, held, system.supported)

    def check_turns(self, when: str | float) -> None:
        """Warn where an element turns nearly as far as it may, and refuse rotations that are lost.

        Args:
            when: Of which state, for messages; a number is a time.

        Raises:
            FoldedElementError: One turns farther.
            LostBranchError: Since the last accepted state the angle of a spring, drive, gear or
                screw has changed by more than a quarter turn, or axes that a joint or a prescribed
                motion keeps together point against each other.
        """
        self._system.connections.check_branch(self._state.H)
        self._system.turns.check(self.frames, when)

    @property
    def turn_hint(self) -> str:
        """What to say of the element that turns most, after a failure, if that may be why."""
        return self._system.turns.hint(self.frames)

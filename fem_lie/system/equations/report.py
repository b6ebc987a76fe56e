"""Reports of a state and of its constraints, and data on which equations depend."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.bodies.model import FoldedElementError
from fem_lie.joints.connection import LostBranchError
from fem_lie.joints.joint import RedundantConstraints
from fem_lie.lie.node_types import all_result_twists
from fem_lie.linear.redundancy import IdleMultipliers
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.small_motions import RigidMotions, rigid_motions
from fem_lie.system.system import System
from fem_lie.system.terms.all_terms import Terms
from fem_lie.system.time_state import TimeState


def contents(system: System) -> list[tuple[str, Any, str]]:
    """Data on which the equations depend, but functions of time: name, value, description."""
    numbering = system.numbering
    found: list[tuple[str, Any, str]] = []
    pairs = zip(numbering.members, numbering.assemblies, strict=True)
    for k, (members, (_, assembly)) in enumerate(pairs, start=1):
        others = f" and {len(members) - 1} others" if len(members) > 1 else ""
        shown = f"energy of the elements of {members[0].label}{others}"
        found.append((f"energy of assembly {k}", assembly.contents, shown))
    contacts = system.scene.contacts
    groups = system.kinds, system.held, numbering.supports
    sums = {
        "inertia": tuple(system.inertia),
        "damping of mass": system.terms.rates,
        "loads": system.load_cases.contents,
        "groups and supports": groups,
        "contacts": [each.contents(numbering.nodes.__getitem__) for each in contacts],
    }
    if system.floating.integers[0]:
        sums["inertia within frames"] = system.floating.contents
    return found + [(name, value, name) for name, value in sums.items()]


_INVOLVED = 1e-2  # share of the largest contradiction from which a joint is named


class ConstraintsAt:
    """All constraints ``Φ`` at frames ``H``, evaluated lazily."""

    def __init__(self, system: System, H: Array) -> None:
        """Store the frames.

        Args:
            system: The equations.
            H: Frames of all nodes, ground and prescribed motions.
        """
        self._system, self._H = system, H

    @property
    def jacobian(self) -> sp.csr_matrix:
        """Constraint Jacobian ``B`` in twists of the moving nodes without held ones, (m, 6 n)."""
        return self._system.tangent.jacobian(self._H)

    @property
    def values(self) -> Array:
        """Violations of position constraints at their current targets, (m,)."""
        return self._system.connections.values(self._H)

    def rates(self, v: Array) -> tuple[Array, Array]:
        """``dΦ/dt`` and ``d²Φ/dt²`` at constant twists ``v`` of the nodes, targets fixed, (m,)."""
        return self._system.connections.rates(self._H, v)

    def rigid_motions(self, weight: Array) -> RigidMotions:
        """Rigid motions that supports allow of connected groups of elements.

        See :func:`~fem_lie.system.small_motions.rigid_motions`.
        """
        return rigid_motions(self._system, self._H, weight)

    def contradiction(self, values: Array, bound: float) -> str:
        """Message about joints that contradict each other, as no motion reduces their violation.

        It is empty if motions can reduce all but ``bound`` of the violation.

        With redundant constraints the iteration ignores the violations conjugate to multipliers
        without force. A movable mechanism has none of these. In a mechanism that cannot move but is
        driven, increments vanish while the constraints stay violated.

        Args:
            values: Violations of the constraints.
            bound: Tolerance, over the length of the model, or rad.
        """
        system = self._system
        connections = system.connections
        units = np.asarray(system.units / system.length)
        idle = IdleMultipliers.of(self.jacobian, units, system.kkt.measure)
        # lengths are relative to that of the model
        left = idle.part(values)
        sizes = np.abs(left) * np.where(connections.angular, 1.0, 1.0 / system.length)
        if sizes.max(initial=0.0) <= bound:
            return ""
        owners = dict.fromkeys(connections.owner[sizes > _INVOLVED * sizes.max(initial=0.0)])
        names = ", ".join(connections.items[int(k)].label for k in owners)
        worst = int(sizes.argmax())
        unit = "rad" if connections.angular[worst] else "length"
        return (
            f"{names} contradict each other: no motion can remove a violation of "
            f"{abs(left[worst]):.2e} ({unit}). The mechanism cannot move as it is driven; check "
            "the axes of its joints, or give it joints with fewer constraints"
        )


class Joints:
    """Forces, coordinates and violations of joints, springs, drives and gears."""

    def __init__(self, system: System, state: TimeState) -> None:
        """Store the state; quantities are computed when they are asked for."""
        self._system, self._state = system, state

    @property
    def forces(self) -> Array:
        """Force and moment of each on its point ``a``, in its axes, (j, 6)."""
        system, (H, v, _, multipliers) = self._system, self._state
        if system.scene.redundant is RedundantConstraints.MINIMUM_NORM and system.m:
            # the smallest of all multipliers that cause the same motion
            B = system.tangent.jacobian(H)
            units = np.asarray(system.units / system.length)
            multipliers = IdleMultipliers.of(B, units, system.kkt.measure).remove(multipliers)
        return system.connections.wrenches(H, v, multipliers)

    @property
    def coordinates(self) -> Array:
        """Coordinates of all, one after the other, (c,)."""
        return self._system.connections.coordinates(self._state.H)

    @property
    def violations(self) -> Array:
        """Largest constraint violation of each joint, (j,)."""
        return self._system.connections.violations(self._state.H, self._state.v)


class Report:
    """Report of one state, evaluated lazily.

    Velocities, their rates and multipliers are used only by the quantities that depend on them.
    """

    def __init__(self, system: System, terms: Terms, state: TimeState, *, linearised: bool) -> None:
        """Store the state.

        Args:
            system: The equations.
            terms: Terms whose energy is not in the table of joints.
            state: The state.
            linearised: Whether local unknowns of cells keep their linearised values.
        """
        self._system, self._terms, self._state, self._linearised = system, terms, state, linearised

    @cached_property
    def frames(self) -> Array:
        """Frames of all nodes, attached ones included, (N, 4, 3)."""
        return self._system.numbering.master_map.frames(self._state.H)

    @property
    def twists(self) -> Array:
        """Twists of all nodes along the axes of their frames, (N, 6)."""
        H, v = self._state.H, self._state.v
        shown = np.empty_like(v)
        all_result_twists(self._system.kinds, H, np.ascontiguousarray(v), shown)
        return self._system.numbering.master_map.twists(shown)

    @property
    def kinetic(self) -> float:
        """Kinetic energy."""
        found = np.empty(7)
        self._system.report(self._state.H, self._state.v, found)
        return float(found[0])

    @property
    def elastic(self) -> float:
        """Energy of elements, and of springs that are not in the tables of the equations."""
        H, connections = self._state.H, self._system.connections
        with self._terms.unchanged():
            found = self._terms.energy(H)
        return found if connections.of_joints_only else found + connections.other_spring_energy(H)

    @property
    def joints(self) -> Joints:
        """Forces, coordinates and violations of joints."""
        return Joints(self._system, self._state)

    @property
    def reactions(self) -> Array:
        """Reaction force and moment at each supported node, about it, global components, (s, 6)."""
        system, state = self._system, self._state
        if not len(system.supported):
            return np.zeros((0, 6))
        H, r = state.H, np.empty(system.size)
        with self._terms.unchanged():
            if not self._linearised:
                self._terms.condense(state.H)
            # along the axes of supports, where there are any
            system.with_reactions(state, np.ones(system.m), r)
        local, held = r[: 6 * system.count].reshape(-1, 6), system.held
        if system.supports:
            local[~held] = 0.0
            system.supports.rotate_back(H, local)
            held = np.ones_like(held)
        return wrenches(system.kinds, H, local, held, system.supported)

    def check_rotations(self, when: str | float) -> None:
        """Warn of elements near their largest rotation, and refuse ambiguous rotations.

        Args:
            when: Description of the state for messages; a number is a time.

        Raises:
            FoldedElementError: An element rotates farther.
            LostBranchError: The angle of a spring, drive, gear or screw has changed by more than a
                quarter turn since the last accepted state, or aligned axes of a joint or a
                prescribed motion are opposite.
        """
        with self._system.shared.errors(FoldedElementError, LostBranchError):
            self._system.connections.check_branch(self._state.H)
            self._system.rotations.check(self.frames, when)

    @property
    def rotation_hint(self) -> str:
        """Hint for the message of a failure, if a large rotation of an element may be the cause."""
        return self._system.rotations.hint(self.frames)

"""What of each state a run keeps, and the steps that it made.

A step of a small scene takes thirty microseconds, and to say all of its end a third as long again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Flag, auto
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array
from fem_lie.bodies import balances
from fem_lie.bodies.catalogue import SceneInfo

INVARIANTS: dict[str, int | slice] = {
    "kinetic": 0,
    "momentum": slice(1, 4),
    "angular_momentum": slice(4, 7),
}
"""Where they are among the seven numbers that a run computes as one array."""


class Record(Flag):
    """What is kept of each state, beside its time, frames and iterations; joined by ``|``.

    What was not asked for is not computed, and looking at it says what to ask for.

    Attributes:
        FRAMES: Nothing beside.
        VELOCITIES: Velocities; :meth:`Result.resampled` and damping within bodies need them.
        ENERGIES: Kinetic, elastic and potential energy, work and losses.
        MOMENTA: Both momenta, and impulses. Their errors are measured with ``ENERGIES``, too.
        FORCES: Those of joints, and reactions.
        COORDINATES: Relative coordinates of joints, and how far constraints are violated.
        ALL: All of these.
    """

    FRAMES = 0
    VELOCITIES = auto()
    ENERGIES = auto()
    MOMENTA = auto()
    FORCES = auto()
    COORDINATES = auto()
    ALL = VELOCITIES | ENERGIES | MOMENTA | FORCES | COORDINATES


BOOKED = Record.ENERGIES | Record.MOMENTA
"""For any of these, what acts from outside is summed up in each step."""

_BY = {
    Record.VELOCITIES: ("velocities",),
    Record.ENERGIES: ("kinetic", "elastic", "potential", "balance"),
    Record.MOMENTA: ("momentum", "angular_momentum", "impulses"),
    Record.FORCES: ("joint_forces", "reactions"),
    Record.COORDINATES: ("joint_coordinates", "joint_violations"),
}
RECORDED_BY = {name: part for part, names in _BY.items() for name in names}
"""Part of each quantity that may be missing."""


def row_shapes(info: SceneInfo, nodes: int) -> dict[str, tuple[int, ...]]:
    """Shape of what each array of a result has for one time, see :class:`fem_lie.Result`."""
    joints = len(info.joints)
    return {
        "times": (),
        "frames": (nodes, 4, 3),
        "velocities": (nodes, 6),
        "joint_forces": (joints, 6),
        "reactions": (len(info.supports.at), 6),
        "joint_coordinates": (sum(len(joint.coordinates) for joint in info.joints),),
        "joint_violations": (joints,),
        "kinetic": (),
        "elastic": (),
        "potential": (),
        "momentum": (3,),
        "angular_momentum": (3,),
        "balance": (balances.COLUMNS,),
        "impulses": (2, 6),
        "iterations": (),
    }


def is_kept(name: str, record: Record) -> bool:
    """Whether the array of this name is in a result of a run with ``record``."""
    return name not in RECORDED_BY or RECORDED_BY[name] in record


def if_recorded() -> Any:
    """Field of a result that may not have been recorded; for type checkers an array."""
    return _Recorded()


class _Recorded:
    """An array that a run has recorded; ``None`` is given for one that it has not."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, result: object | None, owner: type | None = None) -> Array | None:
        # what dataclasses take for the default
        if result is None:
            return None
        found: Array | None = vars(result)[self._name]
        if found is None:
            part = RECORDED_BY[self._name].name
            raise AttributeError(
                f"{self._name} was not recorded in this run: ask for it with "
                f"record=Record.{part}, or for everything with Record.ALL, the default"
            )
        return found

    def __set__(self, result: object, value: Array | None) -> None:
        vars(result)[self._name] = value


Recorded = TypeVar("Recorded")


def with_others(result: Recorded, others: Mapping[str, Any]) -> Recorded:
    """A copy of a result in which some fields are others, whatever was recorded.

    ``dataclasses.replace`` looks at all fields, and so asks for what is not there.

    Args:
        result: A dataclass, some of whose fields may be :func:`if_recorded`.
        others: By the names of the fields.
    """
    kept = {each.name: vars(result)[each.name] for each in fields(result)}  # type: ignore[arg-type]
    return type(result)(**kept | dict(others))


class Balanced:
    """How well a motion keeps what must not change, see :mod:`fem_lie.bodies.balances`.

    Attributes are those of :class:`fem_lie.Result`.
    """

    frames: Array
    kinetic: Array
    elastic: Array
    potential: Array
    momentum: Array
    angular_momentum: Array
    balance: Array
    impulses: Array
    info: SceneInfo

    @property
    def total_energy(self) -> Array:
        """Kinetic, elastic and potential energy, shape (T,)."""
        return self.kinetic + self.elastic + self.potential

    @property
    def energy_error(self) -> float:
        """Largest gap between the change of energy and work less loss, over the energy in play.

        That is the largest energy that is turned over, see :mod:`fem_lie.bodies.balances`: never
        a matter of where the potential is zero.
        """
        return self._relative_energy(balances.energy_gaps(self.total_energy, self.balance))

    @property
    def balance_error(self) -> float:
        """:attr:`energy_error` without what the scheme says it loses: the third of ``balance``."""
        gaps = balances.energy_gaps(self.total_energy, self.balance)
        return self._relative_energy(gaps + self.balance[:, 2] - self.balance[0, 2])

    def _relative_energy(self, gaps: Array) -> float:
        stored = self.kinetic + self.elastic
        scale = balances.energy_scale(stored, self.potential, self.balance)
        return balances.relative(float(np.abs(gaps).max()), scale)

    @property
    def momentum_error(self) -> float:
        """Largest gap between the change of momentum and impulses, over the momentum in play.

        That is the largest momentum that is turned over, see :mod:`fem_lie.bodies.balances`.
        """
        return self._relative_momentum(self.momentum, slice(0, 3), 1.0)

    @property
    def angular_momentum_error(self) -> float:
        """Largest gap between the change of angular momentum and its impulses, as above.

        About the origin; a momentum at the largest distance from it counts as turned over, too.
        """
        arm = balances.reach(self.frames[:, :, 0])
        return self._relative_momentum(self.angular_momentum, slice(3, 6), arm)

    def _relative_momentum(self, momentum: Array, part: slice, arm: float) -> float:
        impulses = self.impulses[:, :, part]
        exchanged = arm * np.sqrt(2.0 * self.info.mass * self.kinetic.max())
        scale = balances.momentum_scale(momentum, impulses, float(exchanged))
        return balances.relative(float(balances.momentum_gaps(momentum, impulses).max()), scale)


@dataclass(frozen=True, eq=False)
class StepHistory:
    """All S steps of a run, kept or not, and the local error of each.

    Attributes:
        times: At the ends of the steps, shape (S,).
        sizes: Step sizes, shape (S,).
        translation: Estimated error of positions in the step, the largest of all nodes, shape (S,).
        rotation: Estimated error of rotations in the step, the largest of all nodes, rad.
        nodes: The nodes with these two errors, shape (S, 2).
        measured_translation: Error of positions, measured by a refined step; nan if it was not.
        measured_rotation: Error of rotations, rad, measured in the same way.
        rejected: Ends of the steps that were not accepted, shape (R,).
    """

    times: Array
    sizes: Array
    translation: Array
    rotation: Array
    nodes: npt.NDArray[np.int64]
    measured_translation: Array
    measured_rotation: Array
    rejected: Array

    def __post_init__(self) -> None:
        count = len(self.times)
        for field in fields(self):
            shape = getattr(self, field.name).shape
            wanted = {"nodes": (count, 2), "rejected": (len(self.rejected),)}
            if shape != wanted.get(field.name, (count,)):
                raise ValueError(f"{field.name} has the shape {shape} for {count} steps")

    @property
    def ratios(self) -> Array:
        """Estimated over measured errors of positions and of rotations, shape (S, 2)."""
        estimated = np.stack([self.translation, self.rotation], axis=1)
        measured = np.stack([self.measured_translation, self.measured_rotation], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(estimated / measured)


@dataclass(frozen=True, eq=False)
class ContactSteps:
    """All S steps of a run, kept or not.

    Attributes:
        times: At the ends of the steps, shape (S,).
        contacts: How many took part, zero in free flight, shape (S,).
        sweeps: Over these, in all passes.
        cone_residual: What is left of Coulomb's law, as a part of the largest impulse.
        penetration: The deepest overlap at the end.
        impact_loss: Energy that impulses along normals took.
        friction_loss: Energy that friction took.
        each: Contacts that pushed in the last step before each state that was kept, one after the
            other: time, a number for the contact, those of both its places, gap, position
            (3), impulse on the first side in that step (3), its velocity across the normal at the
            end (3), whether it sticks; :func:`~fem_lie.contact_forces` reads it, shape (k, 15).
    """

    times: Array
    contacts: Array
    sweeps: Array
    cone_residual: Array
    penetration: Array
    impact_loss: Array
    friction_loss: Array
    each: Array

    def __post_init__(self) -> None:
        """Raise ``ValueError`` if lengths differ."""
        for field in fields(self)[:-1]:
            if (shape := getattr(self, field.name).shape) != self.times.shape:
                raise ValueError(f"{field.name} has the shape {shape}, not {self.times.shape}")

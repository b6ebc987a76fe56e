"""Which quantities a run records at each state, and the history of its steps.

A step of a small scene takes thirty microseconds; computing all quantities at its end takes ten
more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import Flag, auto
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array
from fem_lie._summary import Summarised
from fem_lie.bodies import balances
from fem_lie.bodies.catalogue import SceneInfo

INVARIANTS: dict[str, int | slice] = {
    "kinetic": 0,
    "momentum": slice(1, 4),
    "angular_momentum": slice(4, 7),
}
"""Indices in the array of seven numbers that a run computes together."""


class Record(Flag):
    """Quantities recorded at each state, besides time, frames and iterations; joined by ``|``.

    A quantity that is not recorded is not computed; access to it raises an error that names the
    flag.

    Attributes:
        FRAMES: No further quantities.
        VELOCITIES: Velocities; :meth:`Result.resampled` and damping within bodies need them.
        ENERGIES: Kinetic, elastic and potential energy, work and dissipation.
        MOMENTA: Linear and angular momentum, and impulses. Their errors need ``ENERGIES``, too.
        FORCES: Joint forces and reactions.
        COORDINATES: Relative coordinates and constraint violations of joints.
        ALL: All of these.
    """

    FRAMES = 0
    VELOCITIES = auto()
    ENERGIES = auto()
    MOMENTA = auto()
    FORCES = auto()
    COORDINATES = auto()
    ALL = VELOCITIES | ENERGIES | MOMENTA | FORCES | COORDINATES


WITH_BALANCE = Record.ENERGIES | Record.MOMENTA
"""For any of these, work and impulses of external forces are accumulated in each step."""

_BY = {
    Record.VELOCITIES: ("velocities",),
    Record.ENERGIES: ("kinetic", "elastic", "potential", "balance"),
    Record.MOMENTA: ("momentum", "angular_momentum", "impulses"),
    Record.FORCES: ("joint_forces", "reactions"),
    Record.COORDINATES: ("joint_coordinates", "joint_violations"),
}
RECORDED_BY = {name: part for part, names in _BY.items() for name in names}
"""Flag of each quantity that is optional."""


def row_shapes(info: SceneInfo, nodes: int) -> dict[str, tuple[int, ...]]:
    """Shape of each array of a result for a single time, see :class:`fem_lie.Result`."""
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
    """Whether the array of this name is recorded in a run with ``record``."""
    return name not in RECORDED_BY or RECORDED_BY[name] in record


def if_recorded() -> Any:
    """Field of a result that may not have been recorded; type checkers see an array."""
    return _Recorded()


class _Recorded:
    """Descriptor of an array that may not have been recorded: it is then set to ``None``."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, result: object | None, owner: type | None = None) -> Array | None:
        # dataclasses read the default here
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
    """A copy of a result in which some fields are replaced, whatever was recorded.

    ``dataclasses.replace`` accesses all fields, and would fail for those that were not recorded.

    Args:
        result: A dataclass, some of whose fields may be :func:`if_recorded`.
        others: New values by the names of the fields.
    """
    kept = {each.name: vars(result)[each.name] for each in fields(result)}  # type: ignore[arg-type]
    return type(result)(**kept | dict(others))


class Balanced:
    """Conservation errors of a motion, see :mod:`fem_lie.bodies.balances`.

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
        """Largest error of the energy balance, relative to the largest energy exchanged.

        The error is the change of energy minus work plus dissipation by damping; numerical
        dissipation counts as an error. The reference is the largest of kinetic plus elastic energy,
        change of the potential, work and dissipation in the run; it does not depend on the zero of
        the potential.
        """
        return self._relative_energy(balances.energy_gaps(self.total_energy, self.balance))

    @property
    def balance_error(self) -> float:
        """:attr:`energy_error` without the numerical dissipation, the third column of balance."""
        gaps = balances.energy_gaps(self.total_energy, self.balance)
        return self._relative_energy(gaps + self.balance[:, 2] - self.balance[0, 2])

    def _relative_energy(self, gaps: Array) -> float:
        stored = self.kinetic + self.elastic
        scale = balances.energy_scale(stored, self.potential, self.balance)
        return balances.relative(float(np.abs(gaps).max()), scale)

    @property
    def momentum_error(self) -> float:
        """Largest difference of linear momentum and impulses, relative to the momentum exchanged.

        See :mod:`fem_lie.bodies.balances` for the reference value.
        """
        return self._relative_momentum(self.momentum, slice(0, 3), 1.0)

    @property
    def angular_momentum_error(self) -> float:
        """Largest difference of angular momentum and angular impulses, relative to that exchanged.

        About the origin; the reference includes the linear momentum times the largest distance from
        it.
        """
        arm = balances.reach(self.frames[:, :, 0])
        return self._relative_momentum(self.angular_momentum, slice(3, 6), arm)

    def _relative_momentum(self, momentum: Array, part: slice, arm: float) -> float:
        impulses = self.impulses[:, :, part]
        exchanged = arm * np.sqrt(2.0 * self.info.mass * self.kinetic.max())
        scale = balances.momentum_scale(momentum, impulses, float(exchanged))
        return balances.relative(float(balances.momentum_gaps(momentum, impulses).max()), scale)


@dataclass(frozen=True, eq=False, repr=False)
class StepHistory(Summarised):
    """All S steps of a run, recorded or not, with error estimates.

    Attributes:
        times: Ends of the steps, shape (S,).
        sizes: Step sizes, shape (S,).
        translation: Estimated error of positions in the step, the largest of all nodes, shape (S,).
        rotation: Estimated error of rotations in the step, the largest of all nodes, rad.
        nodes: Nodes with these two errors, shape (S, 2).
        measured_translation: Error of positions, measured by a refined step; nan if not measured.
        measured_rotation: Error of rotations, rad, measured in the same way.
        rejected: Ends of the rejected steps, shape (R,).
        event_times: Times of the events and of impacts on limits, shape (E,).
        event_numbers: Number of each among the events of the scene, followed by its limits, (E,).
        event_losses: Kinetic energy that each has taken, shape (E,).
        sensor_names: Names of the sensors of the scene in UTF-8, shape (q,).
        sensor_times: Times of samples: the start, and the ends of all steps, shape (P,).
        sensor_values: Values of all sensors at these times, shape (P, q).
    """

    times: Array
    sizes: Array
    translation: Array
    rotation: Array
    nodes: npt.NDArray[np.int64]
    measured_translation: Array
    measured_rotation: Array
    rejected: Array
    event_times: Array = field(default_factory=lambda: np.empty(0))
    event_numbers: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    event_losses: Array = field(default_factory=lambda: np.empty(0))
    sensor_names: npt.NDArray[np.bytes_] = field(default_factory=lambda: np.empty(0, "S1"))
    sensor_times: Array = field(default_factory=lambda: np.empty(0))
    sensor_values: Array = field(default_factory=lambda: np.empty((0, 0)))

    def __post_init__(self) -> None:
        count = len(self.times)
        for each in fields(self):
            shape = getattr(self, each.name).shape
            events = (len(self.event_times),)
            wanted = {"nodes": (count, 2), "rejected": (len(self.rejected),)}
            wanted |= dict.fromkeys(("event_times", "event_numbers", "event_losses"), events)
            samples, sensors = (len(self.sensor_times),), (len(self.sensor_names),)
            wanted |= {"sensor_names": sensors, "sensor_times": samples}
            wanted |= {"sensor_values": samples + sensors}
            if shape != wanted.get(each.name, (count,)):
                raise ValueError(f"{each.name} has the shape {shape} for {count} steps")

    def sensor(self, name: str) -> Array:
        """Values of a sensor at :attr:`sensor_times`, shape (P,).

        Args:
            name: Its name.

        Raises:
            KeyError: There is no such sensor.
        """
        known = [each.decode() for each in self.sensor_names]
        if name not in known:
            raise KeyError(f"no sensor named {name!r}; known: {', '.join(known) or 'none'}")
        return self.sensor_values[:, known.index(name)]

    @property
    def ratios(self) -> Array:
        """Ratios of estimated to measured errors of positions and of rotations, shape (S, 2)."""
        estimated = np.stack([self.translation, self.rotation], axis=1)
        measured = np.stack([self.measured_translation, self.measured_rotation], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(estimated / measured)


@dataclass(frozen=True, eq=False, repr=False)
class ContactSteps(Summarised):
    """Contacts with impacts in all S steps of a run, recorded or not.

    Attributes:
        times: Ends of the steps, shape (S,).
        contacts: Number of active contacts, zero in free flight, shape (S,).
        sweeps: Number of sweeps over the contacts, in all passes.
        cone_residual: Residual of Coulomb's law, relative to the largest impulse.
        penetration: Largest overlap at the end.
        impact_loss: Energy dissipated by normal impulses.
        friction_loss: Energy dissipated by friction.
        each: Active contacts in the last step before each recorded state, one after the other:
            time, number of the contact, numbers of both points, gap, position (3), impulse on the
            first side in that step (3), its tangential velocity at the end (3), whether it sticks;
            see :func:`~fem_lie.post.contact_forces`, shape (k, 15).
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
        """Raise ``ValueError`` if the lengths of the arrays differ."""
        for each in fields(self)[:-1]:
            if (shape := getattr(self, each.name).shape) != self.times.shape:
                raise ValueError(f"{each.name} has the shape {shape}, not {self.times.shape}")


@dataclass(frozen=True, eq=False, repr=False)
class FrictionForces(Summarised):
    """Friction forces of contacts by penalty in all recorded states.

    Frames do not determine them, since they depend on the path.

    Attributes:
        each: Points with friction, one state after the other: index of the state, number of the
            contact, numbers of both points, gap, position (3), friction force on the first side
            (3), global components; see :func:`~fem_lie.post.contact_forces`, shape (k, 11).
    """

    each: Array

    @classmethod
    def of_states(cls, states: Sequence[Array | None]) -> FrictionForces | None:
        """Record of all states from the rows of each; ``None`` if no contact has friction."""
        rows = [with_state(k, each) for k, each in enumerate(states) if each is not None]
        return cls(np.concatenate(rows)) if rows else None


def with_state(index: int, rows: Array) -> Array:
    """Rows of :class:`FrictionForces` of a state from those without its index."""
    return np.column_stack([np.full(len(rows), float(index)), rows])

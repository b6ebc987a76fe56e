"""Results of dynamics: histories, with access by point and joint, files and pictures."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import partial, reduce
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures import bodies, diagrams
from fem_lie.pictures.bodies import Arrows
from fem_lie.pictures.page.page import Diagram, energies
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.ranks.files import before_reading, write_once
from fem_lie.ranks.shared_factors import Subdomains
from fem_lie.results.file import NUMBERS, Stored, read, write
from fem_lie.results.files.functions import NodalFields
from fem_lie.results.files.tables import Columns, components
from fem_lie.results.files.written import EVERY, Nodes, Rows
from fem_lie.results.record import (
    RECORDED_BY,
    Balanced,
    ContactSteps,
    FrictionForces,
    Record,
    StepHistory,
    if_recorded,
    row_shapes,
)
from fem_lie.results.resampling import resampled
from fem_lie.results.states import StateSeries, nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_lie.bodies.body import Point
    from fem_lie.joints.connection import Connection
    from fem_lie.results.plotted_quantities import Quantity

_DRAWN = 6  # states in a picture


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Result(Balanced, StateSeries):
    """Histories at the T recorded times.

    Access to a quantity that was not recorded raises ``AttributeError``, see
    :class:`fem_lie.schemes.Record`.

    Attributes:
        times: Recorded times, shape (T,).
        frames: Frames of the N nodes, shape (T, N, 4, 3): position, then the directors d₁, d₂, d₃
            in global components (:mod:`fem_lie.lie`).
        velocities: Velocities (translation, rotation) in the nodes' own axes, shape (T, N, 6).
        joint_forces: Force and moment of each joint on its point ``a``, about the joint and in its
            axes on that side, shape (T, j, 6).
        reactions: Force and moment of each support on its node, about the node, global components,
            see :meth:`reaction`, shape (T, s, 6).
        joint_coordinates: Relative coordinates of all joints, see :meth:`coordinate`, (T, c).
        joint_violations: Largest constraint violation of each joint, shape (T, j).
        kinetic: Kinetic energy, shape (T,).
        elastic: Elastic energy, including that of springs, shape (T,).
        potential: Potential energy of gravity and of constant forces fixed in space, shape (T,).
        momentum: Linear momentum, global components, shape (T, 3).
        angular_momentum: Angular momentum about the origin, global components, shape (T, 3).
        balance: Work of all forces without a potential (see :mod:`fem_lie.bodies.balances`),
            dissipation by damping, and numerical dissipation as far as the scheme computes it, each
            accumulated since the start, shape (T, 3).
        impulses: Impulses of loads (including gravity) and of reactions, force before moment about
            the origin, accumulated since the start, global components, shape (T, 2, 6).
        iterations: Number of linear solutions in all accepted steps up to each time, shape (T,).
        factorisations: Number of factorisations in the whole run.
        k_updates: Number of those with updated mass and stiffness matrices.
        phi_updates: Number of those with an updated constraint Jacobian.
        divided: Number of steps of constant size that did not converge and were divided into
            sub-steps.
        seconds: Wall time of the time loop.
        info: Bodies and joints.
        steps: All steps and their error estimates, if the step size was variable or errors were
            requested.
        contacts: Statistics and forces of contacts with impacts in each step, if there are any.
        friction: Friction forces of contacts by penalty, if there are any; ``None`` for states
            between steps.
        subdomains: Statistics of the domain decomposition, if it was used; not stored in files.
        gradient_velocities: Rates of the coordinate vectors of nodes with position gradients at the
            last state, along their axes, for :func:`fem_lie.adaptivity.transfer`, shape (g, 6);
            ``None`` without such nodes, on several ranks, in files and for other states.
    """

    times: Array
    frames: Array
    velocities: Array = if_recorded()
    joint_forces: Array = if_recorded()
    reactions: Array = if_recorded()
    joint_coordinates: Array = if_recorded()
    joint_violations: Array = if_recorded()
    kinetic: Array = if_recorded()
    elastic: Array = if_recorded()
    potential: Array = if_recorded()
    momentum: Array = if_recorded()
    angular_momentum: Array = if_recorded()
    balance: Array = if_recorded()
    impulses: Array = if_recorded()
    iterations: Indices
    factorisations: int
    k_updates: int
    phi_updates: int
    seconds: float
    info: SceneInfo
    steps: StepHistory | None = None
    contacts: ContactSteps | None = None
    friction: FrictionForces | None = None
    divided: int = 0
    subdomains: Subdomains | None = None
    gradient_velocities: Array | None = None

    def __post_init__(self) -> None:
        nodes, count = self.frames.shape[1] if self.frames.ndim == 4 else 0, len(self.times)
        for name, shape in row_shapes(self.info, nodes).items():
            value = vars(self)[name]
            if value is not None and value.shape != (count, *shape):
                raise ValueError(f"{name} must have shape {(count, *shape)}, got {value.shape}")

    def _summary(self) -> Iterator[tuple[str, object]]:
        """Bodies, times, what was recorded, and the work that the motion took."""
        yield "info.bodies", [body.name for body in self.info.bodies]
        yield "times", self.times
        yield from (("times[-1]", float(self.times[-1])),) if len(self.times) else ()
        yield "recorded", self.recorded
        yield "total_iterations", self.total_iterations
        yield "factorisations", self.factorisations
        yield "seconds", self.seconds

    _PLOTTED: ClassVar[Quantity] = "position"

    @property
    def recorded(self) -> Record:
        """Which quantities were recorded."""
        missing = (RECORDED_BY[name] for name in _ARRAYS if vars(self)[name] is None)
        return reduce(lambda record, part: record & ~part, missing, Record.ALL)

    def velocity(self, point: Point | str | int) -> Array:
        """Velocity of a point (translation, rotation) in its local frame, shape (T, 6).

        Args:
            point: As for :meth:`position`.

        Raises:
            ValueError: There is no such point.
        """
        return self.info.twist(point, self.frames, self.velocities)

    def coordinate(self, joint: Connection | str, name: str | None = None) -> Array:
        """Relative coordinate of a joint, shape (T,): an unwrapped angle in rad, or a length.

        Args:
            joint: A joint, spring or drive of the scene, or its name.
            name: Name of the coordinate, such as "angle" or "displacement", for joints with
                several.

        Raises:
            ValueError: There is no such joint or coordinate.
        """
        return self.joint_coordinates[:, self.info.coordinate(joint, name)]

    def joint_violation(self, joint: Connection | str) -> Array:
        """Largest constraint violation of a joint, shape (T,).

        Args:
            joint: A joint of the scene, or its name.

        Raises:
            ValueError: There is no such joint.
        """
        return self.joint_violations[:, self.info.joint(joint)]

    def index(self, time: float) -> int:
        """Index of the recorded time that is nearest to ``time``.

        Args:
            time: Time.

        Raises:
            ValueError: The time is not finite.
        """
        return nearest(self.times, time, "time")

    def sensor(self, name: str) -> Array:
        """Values of a sensor of the scene at the times ``result.steps.sensor_times``, shape (P,).

        Args:
            name: Its name.

        Raises:
            KeyError: The scene had no such sensor.
        """
        if self.steps is None:
            raise KeyError(f"no sensor named {name!r}; the scene of this run had none")
        return self.steps.sensor(name)

    def resampled(self, times: npt.ArrayLike) -> Result:
        """The same motion at other times, for plots, or to compare runs with different steps.

        Frames and velocities are interpolated by cubics on SE(3) between the recorded times, and
        positions and velocities of nodes without frames by cubics in space; both are of fourth
        order in the distance of these times. Position gradients and the axes of such nodes, forces,
        energies and momenta are of second order.

        Args:
            times: Shape (K,), within the recorded times; no node may rotate by π or more between
                two recorded times.

        Raises:
            ValueError: Times are outside the recorded ones, or the file does not have node types.
            AttributeError: Velocities were not recorded.
        """
        rows = self._kept | {"velocities": self.velocities}
        found = resampled(rows, self.info.node_types, times)
        return Result(**vars(self) | found | {"gradient_velocities": None})

    @property
    def _kept(self) -> dict[str, Array]:
        """All arrays that were recorded."""
        return {name: vars(self)[name] for name in _ARRAYS if vars(self)[name] is not None}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all contents to an HDF5 file, replacing an existing file in one step.

        Args:
            path: Name of the file.

        Raises:
            OSError: The file cannot be written, for example because the disk is full.
        """
        numbers = {name: getattr(self, name) for name in NUMBERS}
        stored = Stored(self._kept, numbers, self.info, self.steps, self.contacts, self.friction)
        write_once(path, partial(write, path, stored))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Result:
        """Read a file that :meth:`save` wrote; all values are bitwise equal.

        Args:
            path: Name of the file.

        Raises:
            FileNotFoundError: There is no such file.
            ValueError: The file is not a file of results, or has an unsupported version.
        """
        before_reading(path)
        found = read(path, _ARRAYS)
        values: dict[str, Any] = {**found.arrays, **found.numbers}
        values |= {"steps": found.steps, "contacts": found.contacts, "friction": found.friction}
        return cls(**values, info=found.info)

    def _rows(self) -> Rows:
        return Rows("time", self.times)

    def _fields_of(self, row: int, nodes: Nodes = EVERY) -> NodalFields:
        """Displacements, rotations, and velocities if they were recorded."""
        found = dict(super()._fields_of(row, nodes))
        if Record.VELOCITIES in self.recorded:
            R, v = self._frames_of(row, nodes)[:, 1:], self.velocities[row, nodes]
            for name, part in (("velocity", slice(0, 3)), ("angular velocity", slice(3, 6))):
                found[name] = np.einsum("ni,nij->nj", v[:, part], R)
        return found

    def _forces(self) -> tuple[Array, Array]:
        if Record.FORCES in self.recorded:
            return super()._forces()
        none = np.empty((len(self.times), 0, 6))
        return none, none

    def _quantities(self) -> Columns:
        """What was recorded: energies, momenta, coordinates of joints, forces."""
        scalars = ("kinetic", "elastic", "potential")
        found: Columns = {name: self._kept[name] for name in scalars if name in self._kept}
        for name in ("momentum", "angular_momentum"):
            if name in self._kept:
                found |= components(name.replace("_", " "), self._kept[name], ("x", "y", "z"))
        if Record.COORDINATES in self.recorded:
            for joint in self.info.joints:
                for i, name in enumerate(joint.coordinates, start=joint.first):
                    found[f"{joint.name} {name}"] = self.joint_coordinates[:, i]
        return found | super()._quantities()

    def plot_energies(
        self, path: str | os.PathLike[str] | None = None, *, units: Units = SI
    ) -> Figure:
        """Plot energies and the change of their sum over time; saved if ``path`` is given.

        Args:
            path: Name of the file; default: none is written.
            units: Units, for labels.
        """
        parts = self.kinetic, self.elastic, self.potential
        return diagrams.energies(self.times, *parts, path, units=units)

    def plot_momentum(
        self, path: str | os.PathLike[str] | None = None, *, units: Units = SI
    ) -> Figure:
        """Plot linear and angular momentum over time; saved if ``path`` is given.

        Args:
            path: Name of the file; default: none is written.
            units: Units, for labels.
        """
        parts = self.momentum, self.angular_momentum
        return diagrams.momenta(self.times, *parts, path, units=units)

    def picture(
        self,
        path: str | os.PathLike[str],
        times: Sequence[float] | None = None,
        *,
        trace: Sequence[Point | str | int] = (),
        frames: bool = False,
        arrows: Arrows | None = None,
        magnified: float = 1.0,
        title: str = "",
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw the bodies at several times; later states are darker.

        Args:
            path: Name of the ``.png`` file.
            times: Default: six times from the first to the last.
            trace: Points whose paths are drawn.
            frames: Whether to draw the nodal frames at the last of the times.
            arrows: Forces at that time, such as :meth:`~fem_lie.post.ContactForces.arrows` returns.
            magnified: Factor of displacements and rotations from the undeformed configuration, also
                of the paths of ``trace``; forces stay at their positions in the state.
            title: Title of the picture.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).
        """
        rows = self._instants(_DRAWN) if times is None else [self.index(time) for time in times]
        drawn = self._magnified(self.frames[rows], magnified)
        paths = self._traces(trace, magnified)
        canvas = Canvas(title, units, view=view)
        bodies.draw(
            self.info, drawn, path, paths=paths, triads=frames, arrows=arrows, canvas=canvas
        )

    def _along(self, units: Units) -> tuple[Array, str, str]:
        """Times, and their label."""
        return self.times, "time", units.time

    def _diagrams(
        self, rows: Indices, trace: Sequence[Point | str | int], units: Units
    ) -> Sequence[Diagram]:
        """Diagram of energies, if they were recorded."""
        if Record.ENERGIES not in self.recorded:
            return ()
        parts = {"kinetic": self.kinetic, "elastic": self.elastic, "potential": self.potential}
        return energies(self.times, parts, rows, units)

    def _instants(self, images: int) -> Indices:
        """Indices of the states at evenly spaced times."""
        at = np.linspace(self.times[0], self.times[-1], images)
        return np.array([self.index(time) for time in at])


_NOT_ARRAYS = "info", "steps", "contacts", "friction", "subdomains", "gradient_velocities"
_ARRAYS = tuple(
    field.name for field in fields(Result) if field.name not in (*NUMBERS, *_NOT_ARRAYS)
)

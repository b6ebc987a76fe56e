"""What an integrator found: histories, how to look them up, to keep them and to draw them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import partial, reduce
from typing import TYPE_CHECKING, Any

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
from fem_lie.results.record import (
    RECORDED_BY,
    Balanced,
    ContactSteps,
    Record,
    StepHistory,
    if_recorded,
    row_shapes,
)
from fem_lie.results.resampling import resampled
from fem_lie.results.states import StateSeries, label_of, nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_lie.bodies.body import Point
    from fem_lie.joints import Connection
    from fem_lie.pictures.vtk import ForcesInBeam

_DRAWN = 6  # states in a picture


@dataclass(frozen=True, eq=False, kw_only=True)
class Result(Balanced, StateSeries):
    """Histories at the T times that were kept.

    Of what a run did not record, see :class:`fem_lie.Record`, looking raises ``AttributeError``.

    Attributes:
        times: Shape (T,).
        frames: Frames of the N nodes, shape (T, N, 4, 3): position, then the directors e₁, e₂, e₃
            in global components (:mod:`fem_lie.lie`).
        velocities: Local velocities (translation, rotation), shape (T, N, 6).
        joint_forces: Force and moment of each joint on its point ``a``, at the joint and in the
            axes that it has on that side, shape (T, j, 6).
        reactions: Force and moment of each support on its node, about it, global components, see
            :meth:`reaction`, shape (T, s, 6).
        joint_coordinates: Relative coordinates of all joints, see :meth:`coordinate`, (T, c).
        joint_violations: Largest violation of a constraint of each joint, shape (T, j).
        kinetic: Kinetic energy, shape (T,).
        elastic: Elastic energy, that of springs included, shape (T,).
        potential: That of gravity and of forces fixed in space without a history, shape (T,).
        momentum: Linear momentum, global components, shape (T, 3).
        angular_momentum: About the origin, global components, shape (T, 3).
        balance: Work of all that acts and has no potential (see :mod:`fem_lie.bodies.balances`),
            loss by damping, and numerical loss as far as the scheme knows it, each up to these
            times, shape (T, 3).
        impulses: Of loads (gravity included) and of reactions, force before moment about the
            origin, up to these times, global components, shape (T, 2, 6).
        iterations: Newton iterations so far, shape (T,).
        factorisations: Number of factorisations in the whole run.
        k_updates: Number of those in which mass and stiffness matrix were new.
        phi_updates: Number of those in which the constraint Jacobian was new.
        divided: Steps of constant size that were made in parts, because no solution was found in
            full.
        seconds: Wall time of the time loop.
        info: Bodies and joints.
        steps: All steps and their errors, if they were asked for.
        contacts: What contacts by impacts did in each step, if there are any.
        subdomains: What the solution on these took, if there are any; not in files.
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
    iterations: npt.NDArray[np.int64]
    factorisations: int
    k_updates: int
    phi_updates: int
    seconds: float
    info: SceneInfo
    steps: StepHistory | None = None
    contacts: ContactSteps | None = None
    divided: int = 0
    subdomains: Subdomains | None = None

    def __post_init__(self) -> None:
        nodes, count = self.frames.shape[1] if self.frames.ndim == 4 else 0, len(self.times)
        for name, shape in row_shapes(self.info, nodes).items():
            value = vars(self)[name]
            if value is not None and value.shape != (count, *shape):
                raise ValueError(f"{name} must have shape {(count, *shape)}, got {value.shape}")

    @property
    def recorded(self) -> Record:
        """What was recorded, if it was not all."""
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
        """Relative coordinate of a joint, shape (T,): angle in rad, unwrapped, or a length.

        Args:
            joint: A joint, spring or drive of the scene, or its name.
            name: Such as "angle" or "displacement", for joints with several of them.

        Raises:
            ValueError: There is none.
        """
        return self.joint_coordinates[:, self.info.coordinate(joint, name)]

    def joint_violation(self, joint: Connection | str) -> Array:
        """Largest violation of a joint's constraints, shape (T,).

        Raises:
            ValueError: There is no such joint.
        """
        return self.joint_violations[:, self.info.joint(joint)]

    def index(self, time: float) -> int:
        """Number of the kept time that is nearest to ``time``.

        Raises:
            ValueError: It is not finite.
        """
        return nearest(self.times, time, "time")

    def resampled(self, times: npt.ArrayLike) -> Result:
        """The same motion at other times, for plots, or to compare runs with different steps.

        Frames and velocities are interpolated by cubics on SE(3) between the recorded times, and
        positions and velocities of nodes that are no frames by cubics in space: both are of fourth
        order in the distance of these times. Position gradients and the axes of such nodes,
        forces, energies and momenta are of second order.

        Args:
            times: Shape (K,), within those that were kept; no turn between two by π or more.

        Raises:
            ValueError: Times that are not within, or a file that does not say what nodes are.
            AttributeError: There are no velocities.
        """
        rows = self._kept | {"velocities": self.velocities}
        return Result(**vars(self) | resampled(rows, self.info.node_types, times))

    @property
    def _kept(self) -> dict[str, Array]:
        """All arrays that there are."""
        return {name: vars(self)[name] for name in _ARRAYS if vars(self)[name] is not None}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write everything to an HDF5 file; an old file is replaced only when the new is whole.

        Raises:
            OSError: It cannot be written, as on a full disk; the message names it.
        """
        numbers = {name: getattr(self, name) for name in NUMBERS}
        stored = Stored(self._kept, numbers, self.info, self.steps, self.contacts)
        write_once(path, partial(write, path, stored))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Result:
        """Read what :meth:`save` wrote, to the last bit.

        Raises:
            FileNotFoundError: There is no such file.
            ValueError: It is not a file of results, or one of another version.
        """
        before_reading(path)
        found = read(path, _ARRAYS)
        values: dict[str, Any] = {**found.arrays, **found.numbers}
        return cls(**values, info=found.info, steps=found.steps, contacts=found.contacts)

    def write_vtk(
        self, path: str | os.PathLike[str], *, forces: Sequence[ForcesInBeam] = ()
    ) -> None:
        """Write a time series for ParaView.

        Args:
            path: Name of the ``.pvd`` file; the data of each time go to a folder beside it.
            forces: Section forces of beams at all times, to be in the file, too.

        Raises:
            ValueError: The name does not end in ``.pvd``, or there are forces at other times.
        """
        from fem_lie.pictures.vtk import write_series

        velocities = self.velocities if Record.VELOCITIES in self.recorded else None
        write_series(path, self.info, self.times, self.frames, velocities, forces)

    def plot_energies(
        self, path: str | os.PathLike[str] | None = None, *, units: Units = SI
    ) -> Figure:
        """Energies and the change of their sum over time; saved if there is a path."""
        parts = self.kinetic, self.elastic, self.potential
        return diagrams.energies(self.times, *parts, path, units=units)

    def plot_momentum(
        self, path: str | os.PathLike[str] | None = None, *, units: Units = SI
    ) -> Figure:
        """Momentum and angular momentum over time; saved if there is a path."""
        parts = self.momentum, self.angular_momentum
        return diagrams.momenta(self.times, *parts, path, units=units)

    def plot(
        self,
        *points: Point | str | int,
        path: str | os.PathLike[str] | None = None,
        units: Units = SI,
    ) -> Figure:
        """Positions of points over time; saved if there is a path."""
        places = [(label_of(point), self.position(point)) for point in points]
        return diagrams.positions(self.times, places, path, units=units)

    def picture(
        self,
        path: str | os.PathLike[str],
        times: Sequence[float] | None = None,
        *,
        trace: Sequence[Point | str | int] = (),
        frames: bool = False,
        arrows: Arrows | None = None,
        title: str = "",
        units: Units = SI,
    ) -> None:
        """Draw the bodies at several times, the later the darker.

        Args:
            path: Name of the ``.png`` file.
            times: Default: six from the first to the last.
            trace: Points whose paths are drawn, too.
            frames: Draw the nodal frames at the last of the times.
            arrows: Forces then, such as :meth:`~fem_lie.ContactForces.arrows` has.
            title: Above the picture.
            units: For the axes.
        """
        rows = self._instants(_DRAWN) if times is None else [self.index(time) for time in times]
        drawn, paths = self.frames[rows], self._traces(trace)
        canvas = Canvas(title, units)
        bodies.draw(
            self.info, drawn, path, paths=paths, triads=frames, arrows=arrows, canvas=canvas
        )

    def _along(self, units: Units) -> tuple[Array, str, str]:
        """Times."""
        return self.times, "time", units.time

    def _diagrams(
        self, rows: Indices, trace: Sequence[Point | str | int], units: Units
    ) -> Sequence[Diagram]:
        """Energies, if they were recorded."""
        if Record.ENERGIES not in self.recorded:
            return ()
        parts = {"kinetic": self.kinetic, "elastic": self.elastic, "potential": self.potential}
        return energies(self.times, parts, rows, units)

    def _instants(self, images: int) -> Indices:
        """Numbers of the states at evenly spaced times."""
        at = np.linspace(self.times[0], self.times[-1], images)
        return np.array([self.index(time) for time in at])


_ARRAYS = tuple(
    field.name
    for field in fields(Result)
    if field.name not in (*NUMBERS, "info", "steps", "contacts", "subdomains")
)

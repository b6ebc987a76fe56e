"""A reduction basis in the frames of a body's nodes, states projected onto it, and its file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, instance, positive, whole
from fem_lie._summary import Summarised
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.bodies import draw
from fem_lie.pictures.stage import Canvas
from fem_lie.reduction.axes import Axes, LocalMotion, MeanAxes, expanded, frames_of, local_motion
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.record import with_others
from fem_lie.results.states import StateSeries

if TYPE_CHECKING:
    import h5py

VERSION = 3
_SAME = 1e-9  # relative to the size of the body


def write_mesh(file: h5py.File, what: str, body: Body) -> None:
    """Write the type of the file, such as ``basis``, its version, and the nodes and cells."""
    file.attrs.update({"format": f"fem_lie {what}", "version": VERSION})
    file["frames"], file["cells"] = body.frames, body.model.cells


def check_mesh(file: h5py.File, path: str | os.PathLike[str], what: str, body: Body) -> None:
    """Refuse a file of another body; the position of the body does not matter.

    Raises:
        ValueError: The file has another type, version or mesh.
    """
    name = os.fspath(path)
    if file.attrs.get("format") != f"fem_lie {what}":
        raise ValueError(f"{name} has no {what}")
    if file.attrs["version"] != VERSION:
        raise ValueError(
            f"{name} has version {file.attrs['version']} of the format, expected {VERSION}: "
            "compute it again"
        )
    frames, cells = file["frames"][()], file["cells"][()]
    if frames.shape != body.frames.shape or not np.array_equal(cells, body.model.cells):
        raise ValueError(
            f"{name} has another mesh: {len(frames)} nodes and {len(cells)} cells, but "
            f"{body.label} has {len(body.frames)} and {len(body.model.cells)}"
        )
    here, there = (lie.se3_compose(lie.se3_inverse(H[0]), H) for H in (body.frames, frames))
    if np.abs(here - there).max() > _SAME * max(1.0, body.model.size):
        raise ValueError(f"{name} has another mesh: its nodes have other positions in the body")


States = TypeVar("States", Result, StaticResult)

_WHAT = "basis"


@dataclass(frozen=True, eq=False, repr=False)
class ReducedStates(Summarised):
    """States of a reduced-order body: ``Hᵢ = G Hᵢ⁰ exp(Φᵢ η)``.

    Attributes:
        basis: The modes ``Φ``.
        rigid: Rigid motion ``G`` of the floating frame, shape (k, 4, 3).
        coordinates: Modal coordinates ``η``, shape (k, m).
        errors: Largest distance of a node from its position in the full state, shape (k,).
    """

    basis: Basis
    rigid: Array
    coordinates: Array
    errors: Array

    def expand(self) -> Array:
        """Frames of all nodes of the body, shape (k, n, 4, 3)."""
        increments = np.einsum("km,mni->kni", self.coordinates, self.basis.modes)
        return expanded(self.basis.body, LocalMotion(self.rigid, increments))

    def within(self, result: States) -> States:
        """The result with these frames of the body, for pictures, section forces and resultants.

        All other quantities, such as velocities, energies and joint forces, remain those of the
        full states. The result must have recorded all optional quantities.

        Args:
            result: A result of a scene that contains the body.

        Raises:
            ValueError: The result has other states, or not this body with this mesh.
        """
        if frames_of(result, self.basis.body).shape[0] != len(self.coordinates):
            raise ValueError(
                f"the result has {len(result.frames)} states, and the reduced states are "
                f"{len(self.coordinates)}"
            )
        frames = result.frames.copy()
        frames[:, result.info.body(self.basis.body.name).nodes] = self.expand()
        return with_others(result, {"frames": frames})


@dataclass(frozen=True, eq=False, repr=False)
class Basis(Summarised):
    """Reduction basis of a body: modes as local increments of its nodes.

    The modes are expressed in the nodes' own frames and do not depend on the position and
    orientation of the body: a basis is valid in any configuration with small strains.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> scene, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=8))
        >>> clamp = scene.add(fl.Clamp(beam.point("start")))
        >>> basis = fl.reduction.craig_bampton(scene, interfaces=[], modes=4)
        >>> load = scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 100)))
        >>> reduced = basis.project(fl.statics(scene),
        ...     axes=fl.reduction.NodeAxes(beam.point("start").node))
        >>> reduced.expand().shape, bool(reduced.errors[0] < 1e-4)
        ((1, 9, 4, 3), True)

    Attributes:
        body: The body.
        modes: Translation and rotation of each node in each mode, along its initial axes, shape
            (m, n, 6).
    """

    body: Body
    modes: Array

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if the modes do not fit the body."""
        instance(self.body, Body, "Basis: body", "a body")
        wanted = (len(self.body.frames), 6)
        if self.modes.ndim != 3 or self.modes.shape[1:] != wanted or not len(self.modes):
            raise ValueError(
                f"Basis: modes of {self.body.label} must have shape (m, {wanted[0]}, 6), got "
                f"{self.modes.shape}"
            )
        if not np.isfinite(self.modes).all():
            raise ValueError("Basis: modes must be finite numbers")

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.modes)

    def transferred(self, body: Body) -> Basis:
        """The same modes on a body of other dimensions: displacements in proportion to its size.

        Args:
            body: A body with as many nodes, in the same order.

        Raises:
            ValueError: It has another number of nodes.
        """
        instance(body, Body, "transferred: body", "a body")
        if len(body.frames) != len(self.body.frames):
            raise ValueError(
                f"transferred: body: expected a body with {len(self.body.frames)} nodes, as "
                f"{self.body.label} has, got {body.label} with {len(body.frames)}"
            )
        ratio = self.body.model.size / body.model.size
        return Basis(body, self.modes * np.repeat([1.0, ratio], 3))

    def project(self, result: StateSeries, *, axes: Axes | None = None) -> ReducedStates:
        """Project states onto the basis by least squares, with the projection error.

        Args:
            result: States of a scene with this body.
            axes: Floating frame; default: :class:`MeanAxes`. Modes that are zero at a node need the
                :class:`NodeAxes` of that node.

        Raises:
            ValueError: The result has no such body, or one with another mesh.
        """
        frames = frames_of(result, self.body)
        motion = local_motion(self.body, frames, MeanAxes() if axes is None else axes)
        scale = np.repeat([1.0, self.body.model.size], 3)  # rotations are multiplied by this length
        flat = (self.modes * scale).reshape(len(self), -1)
        wanted = (motion.increments * scale).reshape(len(frames), -1)
        coordinates = np.linalg.lstsq(flat.T, wanted.T, rcond=None)[0].T
        shown = ReducedStates(self, motion.rigid, coordinates, np.zeros(len(frames)))
        away = np.linalg.norm(shown.expand()[:, :, 0] - frames[:, :, 0], axis=2)
        return ReducedStates(self, motion.rigid, coordinates, away.max(axis=1))

    def picture(self, path: str | os.PathLike[str], number: int, *, amplitude: float = 0.1) -> None:
        """Draw half an oscillation of a mode.

        Args:
            path: Name of the ``.png`` file.
            number: Number of the mode, counted from 1.
            amplitude: Largest increment: displacement over the size of the body, or rotation.

        Raises:
            ValueError: There is no such mode.
        """
        if not 1 <= whole(number, "number") <= len(self):
            raise ValueError(f"modes are 1 … {len(self)}, got {number}")
        shape = self.modes[number - 1] / np.repeat([self.body.model.size, 1.0], 3)
        shape = shape * (positive(amplitude, "amplitude") / np.abs(shape).max())
        moved = shape * np.repeat([self.body.model.size, 1.0], 3)
        swing = np.linspace(-1.0, 1.0, 5)[:, np.newaxis, np.newaxis]
        frames = lie.se3_retract(self.body.frames, swing * moved)
        draw(SceneInfo.of([self.body]), frames, path, canvas=Canvas(f"Shape {number}"))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an HDF5 file with the modes and the mesh.

        Args:
            path: Name of the file.

        Raises:
            OSError: The file cannot be written.
        """
        import h5py

        with h5py.File(path, "w") as file:
            write_mesh(file, _WHAT, self.body)
            file["modes"] = self.modes


def load_basis(path: str | os.PathLike[str], body: Body) -> Basis:
    """Basis from a file of :meth:`Basis.save`, for a body with the same mesh anywhere in space.

    Args:
        path: The HDF5 file.
        body: A body whose mesh is that of the file up to a rigid motion.

    Raises:
        ValueError: The file has no basis, or one of another version or mesh.
        OSError: The file cannot be read.
    """
    import h5py

    instance(body, Body, "body", "a body")
    with h5py.File(path, "r") as file:
        check_mesh(file, path, _WHAT, body)
        return Basis(body, file["modes"][()])

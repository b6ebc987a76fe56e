"""Mode shapes: access to single modes, states along a mode, pictures; buckling modes."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Scalar, instance, number
from fem_lie._summary import Summarised
from fem_lie.bodies.catalogue import SCENE_RECORDS, SceneInfo
from fem_lie.pictures import bodies
from fem_lie.pictures.page.colours import NodalColours
from fem_lie.pictures.page.content import drawn
from fem_lie.pictures.page.page import Page, Slider, page
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.results.files.functions import NodalFields
from fem_lie.results.files.tables import Columns, components
from fem_lie.results.files.written import EVERY, Nodes, Rows, Saved, Written
from fem_lie.results.states import Located, label_of

if TYPE_CHECKING:
    from dolfinx import fem

    from fem_lie.bodies.body import Body, Point

LARGEST_ROTATION = 0.5
"""Largest rotation in pictures, rad, unless an amplitude is given."""

_PHASES = 49  # states of one oscillation in a page
_SIZE = "displacement / largest"
_PART = 0.1  # largest displacement in pictures, relative to the length of the model

_Shapes = TypeVar("_Shapes", bound=npt.NDArray[Any])


class ModeLook(NamedTuple):
    """How a mode is drawn.

    Attributes:
        title: Title of the picture.
        size: Length of the model.
        parts: Fractions of the amplitude at which the mode is drawn, the last in full colour.
    """

    title: str
    size: float
    parts: Sequence[float] = (0.0, 1.0)


def size_colours(info: SceneInfo, shape: npt.NDArray[Any], states: int) -> list[NodalColours]:
    """Colours of a page by the modulus of the displacement over the largest, none without any.

    Args:
        info: Bodies of the scene.
        shape: Increments of all nodes, real or complex, shape (n, 6).
        states: Number of states of the page.
    """
    size = np.linalg.norm(np.abs(shape[:, :3]), axis=1)
    if not size.max() > 0.0:
        return []
    return [
        NodalColours(body.name, np.tile(size[body.nodes] / size.max(), (states, 1)), _SIZE)
        for body in info.bodies
    ]


class ModeShapes(ABC):
    """Mode shapes of an instability.

    Attributes:
        shapes: Local increments (translation, rotation) of all nodes, shape (k, n, 6).
        rotation_only: Whether each mode has no displacement beyond round-off, shape (k,).
        frames: The reference state, shape (n, 4, 3).
        info: Bodies and joints.
    """

    shapes: Array
    rotation_only: Flags
    frames: Array
    info: SceneInfo

    def shape(self, mode: int) -> Array:
        """Mode shape: increments of all nodes, shape (n, 6).

        Args:
            mode: Number of the mode.

        Raises:
            ValueError: There is no such mode; they are counted from 1.
        """
        return chosen(self.shapes, mode)

    def displacing_shape(self, mode: int) -> Array:
        """Mode shape, shape (n, 6), of a mode whose amplitude is a displacement.

        Args:
            mode: Number of the mode.

        Raises:
            ValueError: There is no such mode, or it has rotations only.
        """
        shape = self.shape(mode)
        if self.rotation_only[mode - 1]:
            raise ValueError(f"mode {mode} has rotations only, so its amplitude is no displacement")
        return shape

    def picture(
        self,
        path: str | os.PathLike[str],
        mode: int = 1,
        *,
        amplitude: float | None = None,
        title: str | None = None,
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw a mode; for a critical point, with the critical state.

        Args:
            path: Name of the ``.png`` file.
            mode: Counted from 1.
            amplitude: Largest displacement. Default: a tenth of the length of the model, or less so
                that no node rotates by more than half a radian; a mode with rotations only has this
                largest rotation.
            title: Title of the picture; default: description and load factor.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).

        Raises:
            ValueError: There is no such mode, or an amplitude is given for a mode with rotations
                only.
        """
        look = self._look(mode)
        frames = self._frames(mode, amplitude, np.asarray(look.parts))
        name = look.title if title is None else title
        bodies.draw(self.info, frames, path, canvas=Canvas(name, units, view=view))

    def page(
        self,
        mode: int = 1,
        path: str | os.PathLike[str] | None = None,
        *,
        amplitude: float | None = None,
        seconds: float = 2.0,
        title: str | None = None,
        units: Units = SI,
    ) -> Page:
        """HTML page in which a mode oscillates about the state; see :meth:`StateSeries.page`.

        Args:
            mode: Counted from 1.
            path: Name of the ``.html`` file; a notebook shows the returned page without one.
            amplitude: As for :meth:`picture`.
            seconds: Duration of one oscillation.
            title: Title of the page; default: description and load factor.
            units: Units of the axes.

        Raises:
            ValueError: As for :meth:`picture`, or the name does not end in ``.html``.
        """
        phases = np.linspace(0.0, 2 * np.pi, _PHASES)
        frames = self._frames(mode, amplitude, np.sin(phases))
        colours = size_colours(self.info, self.shape(mode), _PHASES)
        content = drawn(self.info, frames, (), colours, units)
        slider = Slider(np.degrees(phases), "phase", "°", seconds, plays=True)
        return page(path, content, slider, (), self._look(mode).title if title is None else title)

    def _frames(self, mode: int, amplitude: float | None, parts: Array) -> Array:
        """Frames along the mode at fractions of an amplitude."""
        shape = self.shape(mode) if amplitude is None else self.displacing_shape(mode)
        fitting = self._fitting(mode, self._look(mode).size)
        largest = fitting if amplitude is None else number(amplitude, "amplitude")
        return moved_along(shape, self.frames, largest * parts)

    @abstractmethod
    def _look(self, mode: int) -> ModeLook:
        """How a mode is drawn by default."""

    def _fitting(self, mode: int, size: float) -> float:
        """Factor of a mode shape in a picture of a model with this length."""
        turn = float(np.abs(self.shape(mode)[:, 3:]).max())
        fitting = LARGEST_ROTATION / turn if turn > 0 else np.inf
        return fitting if self.rotation_only[mode - 1] else min(_PART * size, fitting)


class ModeDisplacements(Summarised, Located, Written, Saved, Generic[Scalar]):
    """Access to displacements of points in k modes of one state.

    Attributes:
        shapes: Local increments (translation, rotation) of all nodes, shape (k, n, 6).
        frames: The state, shape (n, 4, 3), of which :meth:`position` and :meth:`rotation` are.
    """

    shapes: npt.NDArray[Scalar]

    _PARTS: ClassVar[tuple[type, ...]] = SCENE_RECORDS

    def functions(self, body: Body | str, mode: int = 1) -> dict[str, fem.Function]:
        """A mode of a body as DOLFINx functions, vectors in global components, by name.

        ``displacement`` and ``rotation``; of complex modes these are the real parts, and
        ``displacement im`` and ``rotation im`` the imaginary ones.

        Args:
            body: As for :meth:`fem_lie.Result.functions`.
            mode: Counted from 1.

        Raises:
            ValueError: There is no such body or mode, or the body has no cells.
        """
        chosen(self.shapes, mode)
        return self._functions(body, mode - 1)

    def write_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write all modes as a series for ParaView, pyvista or meshio; times are their numbers.

        Points are those of the state, point data are those of :meth:`functions`.

        Args:
            path: Name of the ``.pvd`` file; each mode is a ``.vtu`` file in a folder of the same
                name, on several ranks a ``.pvtu`` file with a ``.vtu`` file of each rank.

        Raises:
            ValueError: The name does not end in ``.pvd``.
        """
        self._write_vtk(path, {})

    def _rows(self) -> Rows:
        return Rows("mode", np.arange(1, len(self) + 1).astype(np.float64))

    def _frames_of(self, row: int, nodes: Nodes = EVERY) -> Array:
        return self.frames[nodes]

    def _fields_of(self, row: int, nodes: Nodes = EVERY) -> NodalFields:
        R, shape = self.frames[nodes, 1:], self.shapes[row, nodes]
        parts = (("displacement", slice(0, 3)), ("rotation", slice(3, 6)))
        found = {name: np.einsum("ni,nij->nj", shape[:, part], R) for name, part in parts}
        if not np.iscomplexobj(shape):
            return found
        imaginary = {f"{name} im": values.imag for name, values in found.items()}
        return {name: values.real for name, values in found.items()} | imaginary

    def _quantities_at(self, point: Point | str | int) -> Columns:
        """Displacement of the point."""
        return components(label_of(point), self.displacement(point), ("ux", "uy", "uz"))

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.shapes)

    def displacement(self, point: Point | str | int) -> npt.NDArray[Scalar]:
        """Displacement of a point in each mode, global components, shape (k, 3).

        Args:
            point: As for :meth:`position`.

        Raises:
            ValueError: There is no such point.
        """
        frames = np.broadcast_to(self.frames, (len(self), *self.frames.shape))
        u = self.info.twist(point, frames, self.shapes)[:, :3]
        return np.asarray(u @ self.info.frame(point, self.frames)[1:])


@dataclass(frozen=True, eq=False, repr=False)
class BucklingModes(ModeDisplacements[np.float64], ModeShapes):
    """Buckling load factors and modes of linear buckling analysis, the lowest first.

    Attributes:
        factors: Load factors, shape (k,).
        shapes: Local increments (translation, rotation) of all nodes, shape (k, n, 6). The largest
            displacement is 1, or the largest rotation of a mode with rotations only.
        rotation_only: Whether each mode has no displacement beyond round-off, shape (k,).
        frames: The undeformed configuration, shape (n, 4, 3).
        size: Length of the model.
        info: Bodies and joints.
        seconds: Wall time, without set-up.
    """

    factors: Array
    shapes: Array
    rotation_only: Flags
    frames: Array
    size: float
    info: SceneInfo
    seconds: float

    def __str__(self) -> str:
        """One line for each mode."""
        marks = ["  rotations only" if only else "" for only in self.rotation_only]
        rows = enumerate(zip(self.factors, marks, strict=True), start=1)
        lines = [f"{number:4}  {factor:.8g}{mark}" for number, (factor, mark) in rows]
        return "\n".join(["mode  load factor", *lines])

    def _quantities(self) -> Columns:
        return {"load factor": self.factors}

    def _look(self, mode: int) -> ModeLook:
        return ModeLook(f"Mode {mode}: load factor {chosen(self.factors, mode):.5g}", self.size)


def chosen(shapes: _Shapes, mode: int) -> _Shapes:
    """One of the mode shapes, counted from 1.

    Raises:
        ValueError: There is no such mode.
        TypeError: The number is not an integer.
    """
    instance(mode, int | np.integer, "mode", "a whole number")
    if not 1 <= mode <= len(shapes):
        raise ValueError(f"modes are 1 … {len(shapes)}, got {mode}")
    found: _Shapes = shapes[mode - 1]
    return found


def moved_along(shape: Array, frames: Array, amplitudes: Array) -> Array:
    """Frames (k, n, 4, 3) along a mode shape (n, 6) from ``frames``, at amplitudes (k,)."""
    return lie.se3_retract(frames, amplitudes[:, np.newaxis, np.newaxis] * shape)

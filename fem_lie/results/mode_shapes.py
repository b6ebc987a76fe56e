"""Shapes of modes: one of them, frames beside a state along it, pictures; those of buckling."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Flags, instance, number
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures import bodies
from fem_lie.pictures.page.content import drawn
from fem_lie.pictures.page.page import Page, Slider, page
from fem_lie.pictures.stage import SI, Canvas, Units

LARGEST_TURN = 0.5
"""Rad: pictures show no more unless they are told to."""

_PHASES = 49  # of one swing in a page
_PART = 0.1  # of the model: the largest displacement in pictures

_Shapes = TypeVar("_Shapes", bound=npt.NDArray[Any])


class ModeLook(NamedTuple):
    """How a mode is drawn.

    Attributes:
        title: Above the picture.
        size: Length of the model.
        parts: Of the amplitude: those at which it is drawn, the last in full colour.
    """

    title: str
    size: float
    parts: Sequence[float] = (1.0,)


class ModeShapes(ABC):
    """Shapes in which a structure becomes unstable.

    Attributes:
        shapes: Local increments (translation, rotation) of all nodes, shape (k, n, 6).
        turns_only: Which of them have no displacement beyond round-off, shape (k,).
        frames: The state beside which they are, shape (n, 4, 3).
        info: Bodies and joints.
    """

    shapes: Array
    turns_only: Flags
    frames: Array
    info: SceneInfo

    def shape(self, mode: int) -> Array:
        """Increments of all nodes, shape (n, 6).

        Raises:
            ValueError: There is no such mode; they are counted from 1.
        """
        return chosen(self.shapes, mode)

    def displacing_shape(self, mode: int) -> Array:
        """Increments of all nodes, shape (n, 6), of a mode whose amplitude is a displacement.

        Raises:
            ValueError: There is no such mode, or it only turns.
        """
        shape = self.shape(mode)
        if self.turns_only[mode - 1]:
            raise ValueError(f"mode {mode} only turns: it has no displacement for an amplitude")
        return shape

    def picture(
        self,
        path: str | os.PathLike[str],
        mode: int = 1,
        *,
        amplitude: float | None = None,
        title: str | None = None,
        units: Units = SI,
    ) -> None:
        """Draw a mode; of a critical point the state, too.

        Args:
            path: Name of the ``.png`` file.
            mode: Counted from 1.
            amplitude: Largest displacement; default: a tenth of the model, less where it would turn
                by more than half a radian, and so much where it only turns.
            title: Above the picture; default: what it is, and the load factor.
            units: For the axes.

        Raises:
            ValueError: There is no such mode, or one that only turns has no such amplitude.
        """
        look = self._look(mode)
        frames = self._frames(mode, amplitude, np.asarray(look.parts))
        name = look.title if title is None else title
        bodies.draw(self.info, frames, path, canvas=Canvas(name, units))

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
        """A page in which a mode swings about its state; see :meth:`StateSeries.page`.

        Args:
            mode: Counted from 1.
            path: Name of the ``.html`` file; a notebook shows the answer without one.
            amplitude: As for :meth:`picture`.
            seconds: How long one swing plays.
            title: Above the page; default: what it is, and the load factor.
            units: For the axes.

        Raises:
            ValueError: As for :meth:`picture`, or the name does not end in ``.html``.
        """
        phases = np.linspace(0.0, 2 * np.pi, _PHASES)
        content = drawn(self.info, self._frames(mode, amplitude, np.sin(phases)), (), (), units)
        slider = Slider(np.degrees(phases), "phase", "°", seconds, plays=True)
        return page(path, content, slider, (), self._look(mode).title if title is None else title)

    def _frames(self, mode: int, amplitude: float | None, parts: Array) -> Array:
        """Frames beside the state at parts of an amplitude."""
        shape = self.shape(mode) if amplitude is None else self.displacing_shape(mode)
        fitting = self._fitting(mode, self._look(mode).size)
        largest = fitting if amplitude is None else number(amplitude, "amplitude")
        return moved_along(shape, self.frames, largest * parts)

    @abstractmethod
    def _look(self, mode: int) -> ModeLook:
        """How a mode is drawn, unless told otherwise."""

    def _fitting(self, mode: int, size: float) -> float:
        """Factor of a shape in a picture of a model with this length."""
        turn = float(np.abs(self.shape(mode)[:, 3:]).max())
        fitting = LARGEST_TURN / turn if turn > 0 else np.inf
        return fitting if self.turns_only[mode - 1] else min(_PART * size, fitting)


@dataclass(frozen=True, eq=False)
class BucklingModes(ModeShapes):
    """Load factors at which an unloaded structure buckles by linear theory, the lowest first.

    Attributes:
        factors: Shape (k,).
        shapes: Local increments (translation, rotation) of all nodes, shape (k, n, 6), the largest
            displacement is 1, or the largest rotation of a mode that only turns.
        turns_only: Which modes have rotations, but no displacement beyond round-off, shape (k,).
        frames: The unloaded configuration, shape (n, 4, 3).
        size: Length of the model.
        info: Bodies and joints.
        seconds: Wall time, without set-up.
    """

    factors: Array
    shapes: Array
    turns_only: Flags
    frames: Array
    size: float
    info: SceneInfo
    seconds: float

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.factors)

    def __str__(self) -> str:
        """One line for each mode."""
        marks = ["  turns only" if turns else "" for turns in self.turns_only]
        rows = enumerate(zip(self.factors, marks, strict=True), start=1)
        lines = [f"{number:4}  {factor:.8g}{mark}" for number, (factor, mark) in rows]
        return "\n".join(["mode  load factor", *lines])

    def displacement(self, mode: int) -> Array:
        """Of all nodes, global components, shape (n, 3).

        Raises:
            ValueError: There is no such mode; they are counted from 1.
        """
        u = self.shape(mode)[:, :3]
        return np.einsum("nij,ni->nj", self.frames[:, 1:], u)

    def _look(self, mode: int) -> ModeLook:
        return ModeLook(f"Mode {mode}: load factor {chosen(self.factors, mode):.5g}", self.size)


def chosen(shapes: _Shapes, mode: int) -> _Shapes:
    """One of the shapes, counted from 1.

    Raises:
        ValueError: There is no such mode.
        TypeError: It is no whole number.
    """
    instance(mode, int | np.integer, "mode", "a whole number")
    if not 1 <= mode <= len(shapes):
        raise ValueError(f"modes are 1 … {len(shapes)}, got {mode}")
    found: _Shapes = shapes[mode - 1]
    return found


def moved_along(shape: Array, frames: Array, amplitudes: Array) -> Array:
    """Frames (k, n, 4, 3) beside ``frames`` along a shape (n, 6), at amplitudes (k,)."""
    return lie.se3_retract(frames, amplitudes[:, np.newaxis, np.newaxis] * shape)

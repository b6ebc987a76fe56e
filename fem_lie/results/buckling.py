"""Linear buckling as a result: load factors, shapes, tables and pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.units import SI, Units

_LARGEST_TURN = 0.5  # rad: pictures show no more unless they are told to
_PART = 0.1  # of the model: the largest displacement in pictures


@dataclass(frozen=True, eq=False)
class BucklingModes:
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
    turns_only: npt.NDArray[np.bool_]
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

    def shape(self, mode: int) -> Array:
        """Increments of all nodes, shape (n, 6).

        Raises:
            ValueError: There is no such mode; they are counted from 1.
        """
        return chosen(self.shapes, mode)

    def displacement(self, mode: int) -> Array:
        """Of all nodes, global components, shape (n, 3).

        Raises:
            ValueError: There is no such mode; they are counted from 1.
        """
        u = self.shape(mode)[:, :3]
        return np.einsum("nij,ni->nj", self.frames[:, 1:], u)

    def picture(
        self,
        path: str | os.PathLike[str],
        mode: int = 1,
        *,
        amplitude: float | None = None,
        title: str | None = None,
        units: Units = SI,
    ) -> None:
        """Draw a mode.

        Args:
            path: Name of the ``.png`` file.
            mode: Counted from 1.
            amplitude: Largest displacement; default: a tenth of the model, less where it would turn
                by more than half a radian, and so much where it only turns.
            title: Above the picture; default: number and load factor.
            units: For the axes.

        Raises:
            ValueError: There is no such mode, or one that only turns has no such amplitude.
        """
        from fem_lie.pictures.bodies import draw

        shape, turns = chosen(self.shapes, mode), bool(self.turns_only[mode - 1])
        largest = shown(shape, turns, mode, self.size, amplitude)
        frames = moved_along(shape, self.frames, [largest])
        name = f"Mode {mode}: load factor {self.factors[mode - 1]:.5g}"
        draw(self.info, frames, path, title=name if title is None else title, units=units)


def chosen(shapes: Array, mode: int) -> Array:
    """One of the shapes, counted from 1.

    Raises:
        ValueError: There is no such mode.
    """
    if not 1 <= mode <= len(shapes):
        raise ValueError(f"modes are 1 … {len(shapes)}, got {mode}")
    return np.asarray(shapes[mode - 1])


def check_displaces(turns_only: bool, mode: int) -> None:
    """Raise ``ValueError`` for a mode without displacements, whose amplitude cannot be one."""
    if turns_only:
        raise ValueError(f"mode {mode} only turns: it has no displacement for an amplitude")


def shown(shape: Array, turns_only: bool, mode: int, size: float, wanted: float | None) -> float:
    """Factor of a shape in pictures.

    Args:
        shape: Increments, shape (n, 6).
        turns_only: Whether it has no displacements.
        mode: Its number.
        size: Length of the model.
        wanted: Largest displacement if it is given.

    Raises:
        ValueError: A displacement is wanted, and the mode has none.
    """
    if wanted is not None:
        check_displaces(turns_only, mode)
        return wanted
    turn = float(np.abs(shape[:, 3:]).max())
    fitting = _LARGEST_TURN / turn if turn > 0 else np.inf
    return fitting if turns_only else min(_PART * size, fitting)


def moved_along(shape: Array, frames: Array, amplitudes: Sequence[float]) -> Array:
    """Frames (k, n, 4, 3) beside ``frames`` along a shape (n, 6)."""
    scales = np.asarray(amplitudes, dtype=np.float64)
    return lie.se3_retract(frames, scales[:, np.newaxis, np.newaxis] * shape)

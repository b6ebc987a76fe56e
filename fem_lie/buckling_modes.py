"""Linear buckling as a result: load factors, shapes, tables and pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie.info import SceneInfo
from fem_lie.plot import SI, Units

Array = npt.NDArray[np.float64]

_LARGEST_TURN = 0.5  # rad: pictures show no more
_SHIFTS = 0.05  # displacement over size per rotation: below, a mode is one of rotations


@dataclass(frozen=True, eq=False)
class BucklingModes:
    """Load factors at which an unloaded structure buckles by linear theory, the lowest first.

    Attributes:
        factors: Shape (k,).
        shapes: Local increments (translation, rotation) of all nodes, shape (k, n, 6), the largest
            displacement is 1; or the largest rotation where there is hardly any displacement.
        frames: The unloaded configuration, shape (n, 4, 3).
        size: Length of the model.
        info: Bodies and joints.
        seconds: Wall time, without set-up.
    """

    factors: Array
    shapes: Array
    frames: Array
    size: float
    info: SceneInfo
    seconds: float

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.factors)

    def __str__(self) -> str:
        """One line for each mode."""
        lines = [f"{number:4}  {factor:.8g}" for number, factor in enumerate(self.factors, 1)]
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
            amplitude: Largest displacement; default: a tenth of the model.
            title: Above the picture; default: number and load factor.
            units: For the axes.

        Raises:
            ValueError: There is no such mode.
        """
        from fem_lie.picture import draw

        largest = 0.1 * self.size if amplitude is None else amplitude
        frames = moved_along(self.shapes, self.frames, mode, [largest])
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


def moved_along(shapes: Array, frames: Array, mode: int, amplitudes: Sequence[float]) -> Array:
    """Frames (k, n, 4, 3) beside ``frames`` along a mode, rotations limited to what looks well.

    Raises:
        ValueError: There is no such mode.
    """
    shape = chosen(shapes, mode)
    turn = float(np.abs(shape[:, 3:]).max()) * max(map(abs, amplitudes))
    factor = min(1.0, _LARGEST_TURN / turn) if turn > 0 else 1.0
    scales = factor * np.asarray(amplitudes, dtype=np.float64)
    return lie.se3_retract(frames, scales[:, np.newaxis, np.newaxis] * shape)


def normalised(shapes: Array, size: float) -> Array:
    """Shapes (k, n, 6) scaled, their largest displacement or rotation positive.

    The largest displacement becomes 1, or the largest rotation where there is hardly any
    displacement over ``size``.
    """
    scaled = []
    for shape in shapes:
        shift = np.linalg.norm(shape[:, :3], axis=1)
        turn = np.linalg.norm(shape[:, 3:], axis=1)
        part = slice(0, 3) if shift.max() >= _SHIFTS * size * turn.max() else slice(3, 6)
        length = shift if part.start == 0 else turn
        node = int(length.argmax())
        largest = shape[node, part]
        sign = np.sign(largest[np.abs(largest).argmax()])
        scaled.append(sign * shape / length[node])
    return np.array(scaled).reshape(shapes.shape)

"""Linear buckling as a result: load factors, shapes, tables and pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.results.mode_shapes import ModeLook, ModeShapes, chosen


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

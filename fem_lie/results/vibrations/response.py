"""Steady-state harmonic motion as a result: complex amplitudes at each frequency."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.diagrams import responses
from fem_lie.pictures.stage import SI, Units
from fem_lie.results.files.tables import Columns
from fem_lie.results.files.written import Rows
from fem_lie.results.mode_shapes import ModeDisplacements
from fem_lie.results.states import label_of
from fem_lie.results.vibrations.modes import Complex

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponse(ModeDisplacements[np.complex128]):
    """Harmonic motion ``H exp(Re(φ exp(i ω t)))`` about an equilibrium at k frequencies.

    :meth:`displacement` has the complex amplitudes of a point: modulus and phase of a component are
    those of its oscillation, relative to the loads in phase. Methods that take the number of a mode
    take that of a frequency, counted from 1.

    Attributes:
        frequencies: Angular frequencies ``ω``, rad per time, shape (k,).
        shapes: Amplitudes ``φ``: local increments (translation, rotation) of all nodes, shape (k,
            n, 6); with base excitation they are relative to the base.
        frames: The equilibrium, shape (n, 4, 3).
        info: Bodies and joints.
        seconds: Wall time.
    """

    frequencies: Array
    shapes: Complex
    frames: Array
    info: SceneInfo
    seconds: float

    @property
    def hertz(self) -> Array:
        """Frequencies, cycles per time, shape (k,)."""
        return np.asarray(self.frequencies / (2 * np.pi))

    def picture(
        self,
        point: Point | str | int,
        path: str | os.PathLike[str] | None = None,
        *,
        units: Units = SI,
    ) -> Figure:
        """Diagram of the displacement of a point: moduli and phases of its components.

        Components below 1e-9 of the largest are left out.

        Args:
            point: As for :meth:`position`.
            path: Name of the file if it is to be saved.
            units: Units, for labels.

        Raises:
            ValueError: There is no such point.
        """
        amplitudes = self.displacement(point)
        return responses(self.frequencies, amplitudes, label_of(point), path, units=units)

    def __str__(self) -> str:
        """One line for each frequency, with the largest displacement of a node."""
        largest = np.linalg.norm(self.shapes[:, :, :3], axis=2).max(axis=1)
        rows: Sequence[str] = [
            f"{ω:17.6g}  {u:20.6g}" for ω, u in zip(self.frequencies, largest, strict=True)
        ]
        return "\n".join(["angular frequency  largest displacement", *rows])

    def _rows(self) -> Rows:
        return Rows("angular frequency", self.frequencies)

    def _quantities(self) -> Columns:
        return {"frequency": self.hertz}

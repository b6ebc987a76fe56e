"""Small vibrations as a result: eigenvalues, shapes, tables and pictures."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Flags, whole
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures import bodies
from fem_lie.pictures.page.content import drawn
from fem_lie.pictures.page.page import Page, Slider, page
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.results.mode_shapes import LARGEST_TURN, chosen

Complex = npt.NDArray[np.complex128]

_GROWS = 1e-6  # real part over absolute value; less is round-off
_PHASES = 49  # of one swing in a page


@dataclass(frozen=True, eq=False)
class Modes:
    """Motions ``H exp(Re(φ exp(s t)))`` about an equilibrium, the slowest first.

    Attributes:
        eigenvalues: ``s``, 1/time, shape (k,); of a pair of conjugates the one that turns forward.
        shapes: ``φ``: local increments (translation, rotation) of all nodes, shape (k, n, 6), the
            largest displacement is ``size``, or the largest rotation of a mode that only turns is
            1, as in torsion.
        turns_only: Which of them have no displacement beyond round-off, shape (k,).
        frames: The equilibrium, shape (n, 4, 3); in steady rotation in the turning frame.
        size: Length of the model.
        residuals: ``|P⁻¹ Q(s) φ|`` over ``|φ|`` in terms of the mass, shape (k,): how much a step
            of inverse iteration changes a mode, with ``P`` the equations at a shift. Modes above
            1e-5 are computed again by another method, or refused.
        info: Bodies and joints.
    """

    eigenvalues: Complex
    shapes: Complex
    turns_only: Flags
    frames: Array
    size: float
    residuals: Array
    info: SceneInfo

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.eigenvalues)

    @property
    def frequencies(self) -> Array:
        """Angular frequencies of the motions, rad per time, shape (k,)."""
        return np.asarray(self.eigenvalues.imag)

    @property
    def hertz(self) -> Array:
        """Cycles per time, shape (k,)."""
        return np.asarray(self.frequencies / (2 * np.pi))

    @property
    def damping_ratios(self) -> Array:
        """``−Re s/|s|``: 1 and more does not swing, less than 0 grows; 0 for rigid motion."""
        size = np.abs(self.eigenvalues)
        return np.asarray(0.0 - self.eigenvalues.real / np.where(size > 0, size, 1.0))

    @property
    def unstable(self) -> Flags:
        """Which of them grow, shape (k,)."""
        return np.asarray(self.eigenvalues.real > _GROWS * np.abs(self.eigenvalues))

    def table(self, *, units: Units = SI) -> str:
        """One line for each mode."""
        lines = [f"mode  frequency [rad/{units.time}]  {cycles(units):>9}  damping ratio"]
        rows = zip(self.frequencies, self.hertz, self.damping_ratios, self.unstable, strict=True)
        for number, (omega, hertz, ratio, grows) in enumerate(rows, start=1):
            mark = "  grows" if grows else ""
            lines.append(f"{number:4}  {omega:17.6g}  {hertz:9.5g}  {ratio:13.3e}{mark}")
        return "\n".join(lines)

    def __str__(self) -> str:
        """The table."""
        return self.table()

    def moved(self, mode: int, amplitude: float, phases: npt.ArrayLike) -> Array:
        """Frames along a mode, shape (k, n, 4, 3).

        Args:
            mode: Counted from 1, as in the table.
            amplitude: Largest displacement over ``size``; or largest rotation where that is more
                than half a radian otherwise.
            phases: Angles of the oscillation, shape (k,).

        Raises:
            ValueError: There is no such mode, or the amplitude is not positive.
        """
        shape = chosen(self.shapes, mode)
        if not 0.0 < amplitude < np.inf:
            raise ValueError(f"amplitude must be positive, got {amplitude!r}")
        turn = np.abs(shape[:, 3:]).max()
        factor = min(amplitude, LARGEST_TURN / turn) if turn > 0 else amplitude
        swing = np.exp(1j * np.asarray(phases, dtype=np.float64))
        increments = factor * (swing[:, np.newaxis, np.newaxis] * shape).real
        return lie.se3_retract(self.frames, increments)

    def picture(
        self,
        path: str | os.PathLike[str],
        mode: int,
        *,
        amplitude: float = 0.1,
        title: str | None = None,
        units: Units = SI,
    ) -> None:
        """Draw half a swing of a mode.

        Args:
            path: Name of the ``.png`` file.
            mode: Counted from 1, as in the table.
            amplitude: See :meth:`moved`.
            title: Above the picture; default: number and frequency.
            units: For the axes.
        """
        frames = self.moved(mode, amplitude, np.linspace(np.pi, 0.0, 7))
        name = self._title(mode, title, units)
        bodies.draw(self.info, frames, path, canvas=Canvas(name, units))

    def animate(
        self,
        path: str | os.PathLike[str],
        mode: int,
        *,
        amplitude: float = 0.1,
        images: int = 40,
        seconds: float = 2.0,
        title: str | None = None,
        units: Units = SI,
    ) -> None:
        """Draw one swing of a mode as an animated picture, without growth or decay.

        Args:
            path: Name of the ``.gif`` file.
            mode: Counted from 1, as in the table.
            amplitude: See :meth:`moved`.
            images: Number of images.
            seconds: How long one swing plays.
            title: Above the picture; default: number and frequency.
            units: For the axes.
        """
        phases = np.linspace(0.0, 2 * np.pi, whole(images, "images"), endpoint=False)
        frames, name = self.moved(mode, amplitude, phases), self._title(mode, title, units)
        canvas = Canvas(name, units, bodies.PLAYED.size)
        bodies.animate(self.info, frames, path, seconds=seconds, canvas=canvas)

    def page(
        self,
        mode: int,
        path: str | os.PathLike[str] | None = None,
        *,
        amplitude: float = 0.1,
        seconds: float = 2.0,
        title: str | None = None,
        units: Units = SI,
    ) -> Page:
        """A page in which a mode swings, without growth or decay; see :meth:`StateSeries.page`.

        Args:
            mode: Counted from 1, as in the table.
            path: Name of the ``.html`` file; a notebook shows the answer without one.
            amplitude: See :meth:`moved`.
            seconds: How long one swing plays.
            title: Above the page; default: number and frequency.
            units: For the axes.
        """
        phases = np.linspace(0.0, 2 * np.pi, _PHASES)
        content = drawn(self.info, self.moved(mode, amplitude, phases), (), (), units)
        slider = Slider(np.degrees(phases), "phase", "°", seconds, plays=True)
        return page(path, content, slider, (), self._title(mode, title, units))

    def _title(self, mode: int, title: str | None, units: Units) -> str:
        if title is not None:
            return title
        return f"Mode {mode}: {self.hertz[mode - 1]:.4g} {cycles(units)[1:-1]}"


def cycles(units: Units) -> str:
    """Heading of frequencies in cycles per time."""
    return "[Hz]" if units.time == "s" else f"[cycles/{units.time}]"

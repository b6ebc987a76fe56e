"""Small vibrations as a result: eigenvalues, mode shapes, tables and pictures."""

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
from fem_lie.results.files.tables import Columns
from fem_lie.results.mode_shapes import LARGEST_ROTATION, ModeDisplacements, chosen, size_colours

Complex = npt.NDArray[np.complex128]

_GROWS = 1e-6  # real part over absolute value; less is round-off
_PHASES = 49  # states of one oscillation in a page


@dataclass(frozen=True, eq=False, repr=False)
class Modes(ModeDisplacements[np.complex128]):
    """Vibration modes ``H exp(Re(φ exp(s t)))`` about an equilibrium, the slowest first.

    Attributes:
        eigenvalues: ``s``, 1/time, shape (k,); of a conjugate pair the one with positive frequency.
        shapes: Mode shapes ``φ``: local increments (translation, rotation) of all nodes, shape (k,
            n, 6). The largest displacement is ``size``; a mode with rotations only, as in torsion,
            has the largest rotation 1.
        rotation_only: Whether each mode has no displacement beyond round-off, shape (k,).
        frames: The equilibrium, shape (n, 4, 3); in a steady rotation, in the rotating frame.
        size: Length of the model.
        residuals: ``|P⁻¹ Q(s) φ|`` over ``|φ|`` in the norm of the mass matrix, shape (k,): the
            change of a mode in a step of inverse iteration, with ``P`` the equations at a shift.
            Modes above 1e-5 are computed again by another method, or rejected.
        info: Bodies and joints.
    """

    eigenvalues: Complex
    shapes: Complex
    rotation_only: Flags
    frames: Array
    size: float
    residuals: Array
    info: SceneInfo

    @property
    def frequencies(self) -> Array:
        """Angular frequencies, rad per time, shape (k,)."""
        return np.asarray(self.eigenvalues.imag + 0.0)  # growth without oscillation is not −0

    @property
    def hertz(self) -> Array:
        """Frequencies, cycles per time, shape (k,)."""
        return np.asarray(self.frequencies / (2 * np.pi))

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios ``−Re s/|s|``: 1 is overdamped, negative grows; 0 for rigid motion."""
        size = np.abs(self.eigenvalues)
        return np.asarray(0.0 - self.eigenvalues.real / np.where(size > 0, size, 1.0))

    @property
    def unstable(self) -> Flags:
        """Whether each mode grows, shape (k,)."""
        return np.asarray(self.eigenvalues.real > _GROWS * np.abs(self.eigenvalues))

    def table(self, *, units: Units = SI) -> str:
        """Table with one line for each mode.

        Args:
            units: Units, for labels.
        """
        lines = [f"mode  frequency [rad/{units.time}]  {cycles(units):>9}  damping ratio"]
        rows = zip(self.frequencies, self.hertz, self.damping_ratios, self.unstable, strict=True)
        for number, (omega, hertz, ratio, grows) in enumerate(rows, start=1):
            mark = "  grows" if grows else ""
            lines.append(f"{number:4}  {omega:17.6g}  {hertz:9.5g}  {ratio:13.3e}{mark}")
        return "\n".join(lines)

    def _quantities(self) -> Columns:
        """Frequencies, damping and errors."""
        return {
            "angular frequency": self.frequencies,
            "frequency": self.hertz,
            "damping ratio": self.damping_ratios,
            "residual": self.residuals,
        }

    def __str__(self) -> str:
        """The table."""
        return self.table()

    def moved(self, mode: int, amplitude: float, phases: npt.ArrayLike) -> Array:
        """Frames along a mode, shape (k, n, 4, 3).

        Args:
            mode: Counted from 1, as in the table.
            amplitude: Largest displacement over ``size``; or the largest rotation if that would
                exceed half a radian.
            phases: Phase angles of the oscillation, shape (k,).

        Raises:
            ValueError: There is no such mode, or the amplitude is not positive.
        """
        shape = chosen(self.shapes, mode)
        if not 0.0 < amplitude < np.inf:
            raise ValueError(f"amplitude must be positive, got {amplitude!r}")
        turn = np.abs(shape[:, 3:]).max()
        factor = min(amplitude, LARGEST_ROTATION / turn) if turn > 0 else amplitude
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
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw half an oscillation of a mode.

        Args:
            path: Name of the ``.png`` file.
            mode: Counted from 1, as in the table.
            amplitude: See :meth:`moved`.
            title: Title of the picture; default: number and frequency.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).
        """
        frames = self.moved(mode, amplitude, np.linspace(np.pi, 0.0, 7))
        name = self._title(mode, title, units)
        bodies.draw(self.info, frames, path, canvas=Canvas(name, units, view=view))

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
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw one oscillation of a mode as an animated picture, without growth or decay.

        Args:
            path: Name of the ``.gif`` file.
            mode: Counted from 1, as in the table.
            amplitude: See :meth:`moved`.
            images: Number of images.
            seconds: Duration of one oscillation.
            title: Title of the picture; default: number and frequency.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).
        """
        phases = np.linspace(0.0, 2 * np.pi, whole(images, "images"), endpoint=False)
        frames, name = self.moved(mode, amplitude, phases), self._title(mode, title, units)
        canvas = Canvas(name, units, bodies.PLAYED.size, view=view)
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
        """HTML page in which a mode oscillates without growth or decay.

        See :meth:`StateSeries.page` for its controls.

        Args:
            mode: Counted from 1, as in the table.
            path: Name of the ``.html`` file; a notebook shows the returned page without one.
            amplitude: See :meth:`moved`.
            seconds: Duration of one oscillation.
            title: Title of the page; default: number and frequency.
            units: Units of the axes.
        """
        phases = np.linspace(0.0, 2 * np.pi, _PHASES)
        frames = self.moved(mode, amplitude, phases)
        colours = size_colours(self.info, chosen(self.shapes, mode), _PHASES)
        content = drawn(self.info, frames, (), colours, units)
        slider = Slider(np.degrees(phases), "phase", "°", seconds, plays=True)
        return page(path, content, slider, (), self._title(mode, title, units))

    def _title(self, mode: int, title: str | None, units: Units) -> str:
        if title is not None:
            return title
        return f"Mode {mode}: {self.hertz[mode - 1]:.4g} {cycles(units)[1:-1]}"


def cycles(units: Units) -> str:
    """Heading of frequencies in cycles per time."""
    return "[Hz]" if units.time == "s" else f"[cycles/{units.time}]"

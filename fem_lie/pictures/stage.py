"""Surroundings of the bodies in a picture: title, axes, units, camera, and a virtual display."""

from __future__ import annotations

import os
import select
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, direction


@dataclass(frozen=True)
class Units:
    """Names of the user's units, for labels of diagrams and pictures.

    Attributes:
        length: Unit of lengths.
        time: Unit of times.
        energy: Unit of energies.
        momentum: Unit of momenta.
        angular_momentum: Unit of angular momenta.
        force: Unit of forces.
    """

    length: str = "m"
    time: str = "s"
    energy: str = "J"
    momentum: str = "kg m/s"
    angular_momentum: str = "kg m²/s"
    force: str = "N"


SI = Units()

_START_SECONDS = 20.0

# if the process is killed, the server ends ten seconds after its last window
_OPTIONS = ("-screen", "0", "64x64x24", "-nolisten", "tcp", "-terminate", "10")


@contextmanager
def display() -> Iterator[None]:
    """Run a virtual X server (Xvfb) within this context, if ``DISPLAY`` is not set.

    Every window must be closed before the end.

    Raises:
        RuntimeError: There is no display, and Xvfb is not installed or does not start.
    """
    if os.environ.get("DISPLAY"):
        yield
        return
    server, number = _start()
    os.environ["DISPLAY"] = f":{number}"
    try:
        yield
    finally:
        os.environ.pop("DISPLAY", None)
        server.terminate()
        server.wait()


def _start() -> tuple[subprocess.Popen[bytes], str]:
    """The server process, and the number of the display that it chose."""
    program = shutil.which("Xvfb")
    if program is None:
        raise RuntimeError(
            "pictures need a display: DISPLAY is not set, and Xvfb, a virtual display, is not "
            "installed (package xvfb)"
        )
    read, write = os.pipe()
    try:
        server = subprocess.Popen(
            [program, "-displayfd", str(write), *_OPTIONS],
            pass_fds=(write,),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # Ctrl-C must not end the server before the windows
            start_new_session=True,
        )
    finally:
        os.close(write)
    with os.fdopen(read, "rb") as answer:
        ready = select.select([answer], [], [], _START_SECONDS)[0]
        number = answer.readline().decode().strip() if ready else ""
    if not number:
        server.kill()
        server.wait()
        raise RuntimeError(f"pictures need a display, and {program} does not start; try it by hand")
    return server, number


INK = "#333333"
_MARGIN, _LINES = 0.045, 4.0  # space for titles of axes: fraction of the width, and lines of text
_ALONG = 0.999  # cosine from which a view is along z
_ACROSS = (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)  # views of planes across an axis
_OBLIQUE = 1.0, 1.0, 1.0
_PER_TEXT = 100  # width of the picture in pixels over the text size


class Canvas(NamedTuple):
    """Title, units and size of a picture.

    Attributes:
        title: Title above the picture.
        units: Units of the axes.
        size: Width and height, pixels.
        text: Text size of the axes; default: a hundredth of the width.
        view: Direction from the scene to the viewer, shape (3,); default: at right angles to a
            plane scene, else (1, 1, 1).
    """

    title: str = ""
    units: Units = SI
    size: tuple[int, int] = (1600, 1200)
    text: int | None = None
    view: npt.ArrayLike | None = None


PLAIN = Canvas()
"""Canvas without a title, in metres."""


def target_of(path: str | os.PathLike[str], suffix: str) -> str:
    """The name of a picture, after a check of its suffix."""
    if Path(path).suffix.lower() != suffix:
        raise ValueError(f"the name of the picture must end in {suffix!r}, got {str(path)!r}")
    return str(path)


@contextmanager
def plotting(paths: Sequence[Array], canvas: Canvas) -> Iterator[Any]:
    """White scene with lines and a title."""
    title, size = canvas.title, canvas.size
    with display():
        import pyvista

        plotter: Any = pyvista.Plotter(
            off_screen=True, window_size=list(size), lighting="light kit"
        )
        try:
            plotter.set_background("white")
            plotter.enable_anti_aliasing("ssaa")
            for line in paths:
                plotter.add_mesh(
                    pyvista.lines_from_points(line), color=INK, line_width=size[0] / 800
                )
            if title:
                plotter.add_text(
                    title,
                    position=(0.02, 0.94),
                    viewport=True,
                    font_size=size[0] // 110,
                    color=INK,
                )
            yield plotter
        finally:
            plotter.close()


def add_frame(
    plotter: Any,
    frames: Array,
    paths: Sequence[Array],
    canvas: Canvas,
    *,
    right_margin: float = 0.0,
) -> None:
    """Axes with round numbers around all configurations, and the camera.

    Args:
        plotter: PyVista plotter.
        frames: Frames of all configurations, shape (..., N, 4, 3) or (..., N, 1, 3).
        paths: Lines, each of shape (k, 3).
        canvas: Title, units, size and view.
        right_margin: Part of the width, on the right, that stays free.

    Raises:
        ValueError: The view of the canvas is not a direction.
    """
    units, size = canvas.units, canvas.size
    from vtkmodules.vtkCommonCore import vtkStringArray

    low, high, step, flat = round_box(frames, paths)
    towards = _view(canvas, flat)
    counts = np.rint((high - low) / step).astype(int) + 1
    bounds = np.column_stack([low, high]).ravel().tolist()
    font = canvas.text or size[0] // _PER_TEXT
    axes = plotter.show_bounds(
        bounds=bounds,
        grid="back",
        location="outer",
        ticks="outside",
        font_size=font,
        color="#777777",
        xtitle=f"x [{units.length}]",
        ytitle=f"y [{units.length}]",
        ztitle=f"z [{units.length}]",
        n_xlabels=counts[0],
        n_ylabels=counts[1],
        n_zlabels=counts[2],
        use_3d_text=False,
    )
    for axis in range(3):
        labels = vtkStringArray()
        for number, value in enumerate(np.rint(low[axis] / step) + np.arange(counts[axis])):
            # from an oblique view the lowest of z and the first of y, and the last of x and the
            # highest of z, would overlap
            hidden = (axis == 2 and number == 0) or (axis == 0 and number == counts[0] - 1)
            shown = "" if hidden and towards.all() else f"{value * step:.6g}"
            labels.InsertNextValue(shown)
        axes.SetAxisLabels(axis, labels)
    plotter.view_vector(towards, _up(towards))
    plotter.enable_parallel_projection()
    plotter.reset_camera(bounds=bounds)
    bodies = np.array(plotter.bounds).reshape(3, 2).T
    corners = np.array([low, high]), bodies
    margins = np.full(4, _MARGIN * size[0] + _LINES * font)
    margins[1] += right_margin * size[0]
    _fit(plotter.camera, np.concatenate(corners), size, margins)
    plotter.reset_camera_clipping_range()


def _view(canvas: Canvas, flat: Indices) -> Array:
    """Unit vector from the scene to the viewer, shape (3,)."""
    default = _ACROSS[flat[0]] if len(flat) == 1 else _OBLIQUE
    return direction(default if canvas.view is None else canvas.view, "view")


def _up(view: Array) -> tuple[float, float, float]:
    """Axis that points upwards in a picture: z, or y where the viewer looks along z."""
    return (0.0, 1.0, 0.0) if abs(view[2]) > _ALONG else (0.0, 0.0, 1.0)


def _fit(camera: Any, corners: Array, size: tuple[int, int], margins: Array) -> None:
    """Set a parallel camera to show boxes, with margins around them.

    Args:
        camera: PyVista camera; its direction is kept.
        corners: Lowest and highest corner of each box, one after the other, shape (2 k, 3).
        size: Width and height of the picture, pixels.
        margins: Left, right, lower and upper margin, pixels.
    """
    forward = np.array(camera.focal_point) - np.array(camera.position)
    distance = float(np.linalg.norm(forward))
    forward /= distance
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    seen = np.array([right, np.cross(right, forward)])
    boxes = corners.reshape(-1, 2, 3)
    picks = np.array(list(np.ndindex(2, 2, 2)))
    points = np.concatenate([box[picks, np.arange(3)] for box in boxes]) @ seen.T
    low, high = points.min(axis=0), points.max(axis=0)
    before, after = margins.reshape(2, 2).T
    available = np.maximum(np.array(size) - before - after, 0.2 * np.array(size))
    per_pixel = float(((high - low) / available).max())
    middle = (0.5 * (low + high) + 0.5 * per_pixel * (after - before)) @ seen
    focus = middle + (np.array(camera.focal_point) @ forward) * forward
    camera.focal_point = focus.tolist()
    camera.position = (focus - distance * forward).tolist()
    camera.parallel_scale = 0.5 * per_pixel * size[1]


def round_box(frames: Array, paths: Sequence[Array]) -> tuple[Array, Array, float, Indices]:
    """Bounding box, with round numbers, of all configurations, shape (..., N, 4, 3), and lines.

    Returns:
        Lowest and highest corner, the distance of grid lines, and the axes along which it is flat.
    """
    x = np.concatenate([frames[..., 0, :].reshape(-1, 3), *paths])
    low, high = x.min(axis=0), x.max(axis=0)
    step = _round_step(float((high - low).max()))
    flat = np.flatnonzero(high - low < 1e-3 * step)
    low, high = np.floor(low / step + 0.1), np.ceil(high / step - 0.1)
    return step * (low - (low >= high)), step * (high + (low >= high)), step, flat


def _round_step(extent: float) -> float:
    """Distance of grid lines, 1, 2 or 5 times a power of ten, for three to seven of them.

    With more of them VTK would use a distance of its own, at which our labels would be wrong.
    """
    power = 10.0 ** np.floor(np.log10(extent or 1.0))
    return float(power * next(k for k in (0.1, 0.2, 0.5, 1.0, 2.0) if extent / (k * power) <= 6.0))

"""Pictures of bodies: superposed states, animations, and surfaces coloured by a quantity."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.pictures.diagrams import COLOURS
from fem_lie.pictures.shapes import Shape, joint_positions, scene_size, shapes, with_sharp_edges
from fem_lie.pictures.stage import INK, PLAIN, Canvas, add_frame, plotting, target_of
from fem_lie.pictures.vtk import CellKind, surface_grid

# values of both signs: blue and red about zero; of one sign: from dark to bright
_SIGNED, _PLAIN = "RdBu_r", "viridis"
_COLOURS = 256

_COLOUR_AMBIENT = 0.7  # large, so that colours are nearly independent of the orientation

_SCALE = 0.09  # part of the width that the colour scale takes
_SUBDIVISION = 2  # subdivision of cells of second degree
_CONSTANT = 1e-6  # range of round-off, relative to the values
_ONE_SIGN = 0.02  # fraction of the largest value below which values of the other sign are ignored


class DrawnSurface(NamedTuple):
    """Cells of a surface.

    Attributes:
        mesh: Shape and degree of the cells.
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        unloaded: Undeformed positions of the points, shape (p, 3).
    """

    mesh: CellKind
    cells: Indices
    unloaded: Array


def draw_values(
    path: str | os.PathLike[str],
    surface: DrawnSurface,
    points: Array,
    values: Array,
    label: str,
    canvas: Canvas,
) -> None:
    """Draw a surface with colours and a colour scale, and the outline of the undeformed surface.

    Args:
        path: Name of the ``.png`` file.
        surface: The surface.
        points: Positions of its points in the picture, shape (p, 3).
        values: Values at the points, shape (p,).
        label: Name of the quantity, and its unit.
        canvas: Title, units and size of the picture.

    Raises:
        ValueError: The name does not end in ``.png``.
        RuntimeError: There is no display, and Xvfb is not available.
    """
    target = target_of(path, ".png")
    mesh, cells, unloaded = surface
    size, grid = canvas.size, surface_grid(points, cells, mesh)
    grid.point_data[label] = values
    drawn = _compat.drawn_surface(grid, _SUBDIVISION)
    # facets of gmsh's tetrahedra turn either way, and each change of side would be an edge
    outline = _compat.drawn_surface(surface_grid(unloaded, cells, mesh), 1)
    rim = outline.compute_normals(consistent_normals=True).extract_feature_edges()
    with plotting((), canvas) as plotter:
        plotter.add_mesh(
            drawn,
            scalars=label,
            clim=_limits(values),
            cmap=_SIGNED if _signed(values) else _PLAIN,
            n_colors=_COLOURS,
            smooth_shading=True,
            split_sharp_edges=True,
            ambient=_COLOUR_AMBIENT,
            diffuse=1.0 - _COLOUR_AMBIENT,
            scalar_bar_args={
                "title": label + "\n",
                "vertical": True,
                "position_x": 0.9,
                "position_y": 0.2,
                "height": 0.6,
                "width": 0.05,
                "color": INK,
                # half of the title must fit between the bar and the right edge
                "title_font_size": size[0] // max(60, round(3.4 * len(label))),
                "label_font_size": size[0] // 70,
                "fmt": "%.3g",
            },
        )
        if rim.n_points:
            plotter.add_mesh(rim, color=INK, line_width=size[0] / 800)
        both = np.stack([unloaded, points])[:, :, np.newaxis]
        add_frame(plotter, both, (), canvas, right_margin=_SCALE)
        plotter.screenshot(target)


def _signed(values: Array) -> bool:
    low, high = float(values.min()), float(values.max())
    return min(-low, high) > _ONE_SIGN * max(-low, high)


def _limits(values: Array) -> tuple[float, float]:
    low, high, largest = float(values.min()), float(values.max()), float(np.abs(values).max())
    if _signed(values):
        return -largest, largest
    if high - low < _CONSTANT * largest:
        return min(low, 0.0), max(high, 0.0)
    return low, high


_PALEST = 0.25
_AMBIENT = 0.45
BALL = 0.008
"""Radius of a joint, relative to the size of the scene."""
_THROUGH = 0.35  # opacity of bodies when nodal frames are drawn
_BEFORE = 0.25  # opacity of earlier states of surfaces, which would otherwise hide the last one
_TRIAD = 0.04  # length of a drawn director, relative to the size of the scene
_TRIAD_COLOURS = {"e1": "#CC0000", "e2": "#008800", "e3": "#0000CC"}

_LONGEST = 0.15
"""Length of the longest arrow of a force, relative to the size of the scene."""
_FORCE_COLOUR = "#CC7700"


class Arrows(NamedTuple):
    """Forces to draw; the length of the largest arrow is a fixed fraction of the scene.

    Attributes:
        at: Points of application, global components, shape (k, 3).
        along: Forces, global components, shape (k, 3).
    """

    at: Array
    along: Array


PLAYED = Canvas(size=(800, 600))
"""Canvas of animations."""


def draw(
    info: SceneInfo,
    frames: Array,
    path: str | os.PathLike[str],
    *,
    paths: Sequence[Array] = (),
    triads: bool = False,
    arrows: Arrows | None = None,
    canvas: Canvas = PLAIN,
) -> None:
    """Draw the bodies in several configurations, the last in full colour, earlier ones paler.

    Beams are swept along geodesics between their nodes; members that are too thin to be visible are
    enlarged.

    Args:
        info: The scene.
        frames: One or several configurations of all nodes, shape (N, 4, 3) or (K, N, 4, 3).
        path: Name of the ``.png`` file.
        paths: Lines to draw, each of shape (T, 3).
        triads: Whether to draw the nodal frames of the last configuration, with transparent bodies.
        arrows: Forces in the last configuration; bodies are transparent, too.
        canvas: Title, units and size of the picture.

    Raises:
        ValueError: The name does not end in ``.png``.
        RuntimeError: There is no display, and Xvfb is not available.
    """
    target = target_of(path, ".png")
    steps = frames.reshape(-1, *frames.shape[-3:])
    with plotting(paths, canvas) as plotter:
        bodies = shapes(info, steps)
        # in reverse order: a single configuration is the last one
        strengths = np.linspace(1.0, _PALEST, len(steps))[::-1]
        opacities = np.full(len(steps), _THROUGH if triads or arrows is not None else 1.0)
        if any(len(body.faces) for body in info.bodies):
            opacities[:-1] = _BEFORE
        for strength, opacity, step in zip(strengths, opacities, steps, strict=True):
            _add(plotter, info, bodies, np.asarray(step), float(strength), float(opacity))
        if triads:
            _add_triads(plotter, steps[-1])
        if arrows is not None:
            _add_arrows(plotter, arrows, scene_size(steps[-1]))
        add_frame(plotter, steps, paths, canvas)
        plotter.screenshot(target)


def animate(
    info: SceneInfo,
    frames: Array,
    path: str | os.PathLike[str],
    *,
    seconds: float = 5.0,
    paths: Sequence[Array] = (),
    canvas: Canvas = PLAYED,
) -> None:
    """Draw an animation of the bodies, one image for each configuration.

    Args:
        info: The scene.
        frames: Configurations, shape (K, N, 4, 3).
        path: Name of the ``.gif`` file.
        seconds: Duration.
        paths: Lines to draw, each of shape (T, 3).
        canvas: Title, units and size of the picture.

    Raises:
        ValueError: The name does not end in ``.gif``, or the duration is not positive.
        RuntimeError: There is no display, and Xvfb is not available.
    """
    from PIL import Image

    target = target_of(path, ".gif")
    if not seconds > 0.0:
        raise ValueError(f"seconds must be positive, got {seconds!r}")
    images = []
    with plotting(paths, canvas) as plotter:
        bodies = shapes(info, frames)
        actors = _add(plotter, info, bodies, frames[0], 1.0)
        add_frame(plotter, frames, paths, canvas)
        for step in frames:
            for actor, surface in zip(actors, _surfaces(info, bodies, step), strict=True):
                actor.mapper.dataset = surface
            plotter.render()
            image = Image.fromarray(plotter.screenshot(return_img=True))
            images.append(
                image.quantize(method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
            )
    duration = max(
        20, round(1000.0 * seconds / len(images))
    )  # the least duration of an image in browsers
    images[0].save(
        target, save_all=True, append_images=images[1:], duration=duration, loop=0, optimize=False
    )


def _add(
    plotter: Any,
    info: SceneInfo,
    bodies: list[Shape],
    frames: Array,
    strength: float,
    opacity: float = 1.0,
) -> list[Any]:
    """Add bodies and joints in one configuration; return their actors."""
    colours = [COLOURS[number % len(COLOURS)] for number in range(len(bodies))] + [INK]
    surfaces = _surfaces(info, bodies, frames)
    return [
        plotter.add_mesh(
            surface,
            color=_paler(colour, strength),
            opacity=opacity,
            smooth_shading=True,
            ambient=_AMBIENT,
            diffuse=1.1 - _AMBIENT,
            render=False,
            reset_camera=False,
        )
        for surface, colour in zip(surfaces, colours, strict=False)
    ]


def _add_triads(plotter: Any, frames: Array) -> None:
    """Directors of all nodes as arrows, with a legend."""
    import pyvista

    arrow = pyvista.Arrow(tip_length=0.3, tip_radius=0.08, shaft_radius=0.03)
    for k, colour in enumerate(_TRIAD_COLOURS.values(), 1):
        nodes = pyvista.PolyData(frames[:, 0])
        nodes.point_data["along"] = frames[:, k]
        arrows = nodes.glyph(
            geom=arrow, orient="along", scale=False, factor=_TRIAD * scene_size(frames)
        )
        plotter.add_mesh(arrows, color=colour, ambient=_AMBIENT, reset_camera=False)
    plotter.add_legend(list(map(list, _TRIAD_COLOURS.items())), size=(0.08, 0.1), face="-")


def _add_arrows(plotter: Any, arrows: Arrows, size: float) -> None:
    """Forces as arrows whose heads are at the end they point to."""
    import pyvista

    lengths = np.linalg.norm(arrows.along, axis=1)
    if not len(lengths) or not lengths.max() > 0.0:
        return
    points = pyvista.PolyData(arrows.at)
    points.point_data["along"] = arrows.along
    points.point_data["length"] = lengths
    drawn = points.glyph(
        geom=pyvista.Arrow(tip_length=0.25, tip_radius=0.08, shaft_radius=0.03),
        orient="along",
        scale="length",
        factor=_LONGEST * size / lengths.max(),
    )
    plotter.add_mesh(drawn, color=_FORCE_COLOUR, ambient=_AMBIENT, reset_camera=False)


def _surfaces(info: SceneInfo, bodies: list[Shape], frames: Array) -> list[Any]:
    """Surfaces of all bodies, and one of all joints if there are any, with normals."""
    import pyvista

    surfaces = [
        with_sharp_edges(pyvista.PolyData(shape.points(frames), shape.faces)) for shape in bodies
    ]
    positions = joint_positions(info, frames)
    if len(positions):
        ball = pyvista.Sphere(radius=BALL * scene_size(frames))
        surfaces.append(pyvista.PolyData(positions).glyph(geom=ball, scale=False, orient=False))
    return surfaces


def _paler(colour: str, strength: float) -> tuple[float, float, float]:
    """Mix with white instead of transparency, so that the order of depth does not matter."""
    rgb = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    r, g, b = (1.0 - strength * (1.0 - c) for c in rgb)
    return r, g, b

"""Lines of gmsh models: first-order line cells, CAD tangents, named groups."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices, whole_number
from fem_lie.mesh.curves import Spline
from fem_lie.mesh.gmsh_session import (
    GmshScript,
    chosen_entities,
    logged,
    named_points,
    opened,
    physical,
)
from fem_lie.mesh.tangents import circle_tangents, flipped

_log = logging.getLogger(__name__)

_STRAIGHT = 1e-6  # rad, as two tangents that agree
_LINE_2 = 1  # gmsh's element type


@dataclass(frozen=True, eq=False)
class RawLines:
    """Line cells as gmsh has them; points without cells are dropped.

    Attributes:
        points: Coordinates, shape (n, 3).
        cells: Pairs of points, shape (m, 2).
        tangents: Unit tangents from CAD curves, or of circles through a curve's points where there
            is no CAD, shape (m, 2, 3).
        groups: Cells of each physical group of curves.
        named_points: Points of each physical group of points.
    """

    points: Array
    cells: Indices
    tangents: Array
    groups: dict[str, Indices]
    named_points: dict[str, Indices]


def read_lines(path: str | os.PathLike[str] | GmshScript, kink_angle: float) -> RawLines:
    """Lines of a file, in a model of its own that is removed afterwards.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: gmsh cannot read it, a parameter is not in it, or it has no lines.
    """
    with opened(path) as (gmsh, file):
        if gmsh.model.mesh.getNodes()[0].size == 0:
            logged(gmsh, file, lambda: gmsh.model.mesh.generate(1))
        return model_lines(str(file), kink_angle)


def read_curve(
    path: str | os.PathLike[str] | GmshScript,
    cells: int,
    *,
    curve: int | None = None,
) -> Spline:
    """A curve of a CAD file (STEP, IGES, BREP) or of a script, rational ones (NURBS) too.

    gmsh evaluates it, so that places and slopes are those of the curve itself. Between them the
    cubic follows it to fourth order; with the knots of a cubic spline among ``u`` it is the curve.

    Args:
        path: The file, or a script (:func:`~fem_lie.run_gmsh_script`).
        cells: Equal parts of the curve's parameter.
        curve: gmsh's number of the curve; default: the only one.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is neither CAD nor a mesh, gmsh cannot read it, there is no such curve
            or several and no number, or there are no cells.
    """
    count = whole_number(cells) + 1
    with opened(path) as (gmsh, file):
        known = [tag for _, tag in gmsh.model.getEntities(1)]
        wanted = known[0] if curve is None and len(known) == 1 else curve
        if wanted not in known:
            raise ValueError(
                f"{str(file)!r} has the curves {known}, and read_curve takes one of them, got "
                f"curve = {curve}"
            )
        (begin,), (end,) = gmsh.model.getParametrizationBounds(1, wanted)
        u = np.linspace(begin, end, count)
        places = np.reshape(gmsh.model.getValue(1, wanted, u), (-1, 3))
        slopes = np.reshape(gmsh.model.getDerivative(1, wanted, u), (-1, 3))
    return Spline(u, places, slopes)


def model_lines(what: str, kink_angle: float) -> RawLines:
    """Lines of the current gmsh model; ``what`` is its name in messages.

    Curves without geometry are smooth where they turn by no more than ``kink_angle``, rad.
    """
    import gmsh

    curves = chosen_entities(gmsh, 1, what)
    cells, tangents, owner = [], [], []
    for curve in curves:
        ends = _line_cells(gmsh, curve, what)
        cells.append(ends)
        known = _cad_tangents(gmsh, curve, ends)
        if len(ends) and np.isnan(known).all():
            known = _circle_tangents(gmsh, ends, kink_angle, f"{what}: curve {curve}")
        tangents.append(known)
        owner.append(np.full(len(ends), curve))
    if not cells or not sum(map(len, cells)):
        raise ValueError(f"{what} has no line cells; give the curves a mesh and a physical group")
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    used, local = np.unique(np.concatenate(cells), return_inverse=True)
    order = np.argsort(tags)
    rows = order[np.searchsorted(tags, used, sorter=order)]
    of_curve = np.concatenate(owner)
    return RawLines(
        points=coordinates.reshape(-1, 3)[rows],
        cells=local.reshape(-1, 2).astype(np.int64),
        tangents=np.concatenate(tangents),
        groups={
            name: np.flatnonzero(np.isin(of_curve, entities))
            for name, entities in physical(gmsh, 1).items()
        },
        named_points=named_points(gmsh, used),
    )


def _line_cells(gmsh: Any, curve: int, what: str) -> Indices:
    types, _, nodes = gmsh.model.mesh.getElements(1, curve)
    for kind in types:
        if kind != _LINE_2:
            name = gmsh.model.mesh.getElementProperties(kind)[0]
            raise ValueError(
                f"{what}: curve {curve} has cells of type {name!r}; wanted are lines of order 1"
            )
    return nodes[0].astype(np.int64).reshape(-1, 2) if len(nodes) else np.empty((0, 2), np.int64)


def _cad_tangents(gmsh: Any, curve: int, cells: Indices) -> Array:
    """Unit tangents at both ends of each cell, (m, 2, 3); nan if the curve has no geometry."""
    unknown = np.full((len(cells), 2, 3), np.nan)
    if gmsh.model.getType(1, curve) == "Discrete curve":
        return unknown
    tags, coordinates, parameter = gmsh.model.mesh.getNodes(1, curve, True, True)
    if len(parameter) != len(tags):
        return unknown
    derivative = np.array(gmsh.model.getDerivative(1, curve, parameter)).reshape(-1, 3)
    size = np.linalg.norm(derivative, axis=1, keepdims=True)
    unit = np.divide(derivative, size, where=size > 0, out=np.full_like(derivative, np.nan))
    order = np.argsort(tags)
    rows = order[np.searchsorted(tags, cells, sorter=order)]
    chord = np.diff(coordinates.reshape(-1, 3)[rows], axis=1)
    return unit[rows] * np.where((unit[rows] * chord).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)


def _circle_tangents(gmsh: Any, cells: Indices, kink_angle: float, what: str) -> Array:
    """Unit tangents of circles through successive points of one curve, shape (m, 2, 3)."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    used, local = np.unique(cells, return_inverse=True)
    order = np.argsort(tags)
    points = coordinates.reshape(-1, 3)[order[np.searchsorted(tags, used, sorter=order)]]
    local = local.reshape(-1, 2)
    flip = flipped(local, len(used))[:, np.newaxis]
    # cells without length are refused with the mesh
    with np.errstate(divide="ignore", invalid="ignore"):
        found = circle_tangents(points, np.where(flip, local[:, ::-1], local), kink_angle)
    turns = np.linalg.norm(found[:, 1] - found[:, 0], axis=1).max()
    if turns > _STRAIGHT:
        angle = np.degrees(kink_angle)
        _log.info("%s has no CAD: it is smooth where it turns by less than %.0f°", what, angle)
    return np.where(flip[..., np.newaxis], -found[:, ::-1], found)

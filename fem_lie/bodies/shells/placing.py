"""Sections, directors and frames of a shell, from what is given."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, degrees, pi

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, instance, vectors_at
from fem_lie.bodies.per_cell import of_groups
from fem_lie.mesh.patches import Patches
from fem_lie.mesh.surfaces import Surface, SurfaceMesh
from fem_lie.sections.shell_section import ShellSection

ShellSections = ShellSection | Mapping[str, ShellSection] | Callable[[Array], ShellSection]
Director = Callable[[Array], npt.ArrayLike]

_EQUAL = 1e-6  # components of unit vectors that are meant to be equal


def section_per_cell(mesh: Surface, centres: Array, section: ShellSections) -> list[ShellSection]:
    """Section of each cell.

    Raises:
        ValueError: A cell has no section.
        TypeError: An entry is not a section.
    """
    if isinstance(section, ShellSection):
        return [section] * len(centres)
    if not isinstance(section, Mapping):
        found = [section(centre) for centre in centres]
        for value in found:
            instance(value, ShellSection, "the section at a position", "a ShellSection")
        return found
    return of_groups(section, ShellSection, "a ShellSection", len(centres), mesh.group)


def axes_along(mesh: Surface, centres: Array, along: npt.ArrayLike | Director | None) -> Array:
    """First axes of the sections before projection onto the surface, shape (m, 3)."""
    if along is None:
        first, second = (
            np.concatenate([block.cells[:, i] for block in mesh.blocks]) for i in (0, 1)
        )
        return np.asarray(mesh.points[second] - mesh.points[first])
    values = [along(centre) for centre in centres] if callable(along) else [along] * len(centres)
    axes = np.array([direction(value, "along") for value in values])
    normals = np.concatenate([block.normals.mean(axis=1) for block in mesh.blocks])
    across = np.linalg.norm(np.cross(normals, axes), axis=1)
    bad = np.flatnonzero(~(across > 1e-6 * np.linalg.norm(normals, axis=1)))
    if len(bad):
        raise ValueError(
            f"along must not be normal to the surface; in cell {bad[0]}, at {centres[bad[0]]}, "
            f"it is {axes[bad[0]]}"
        )
    return axes


def cut_mesh(mesh: SurfaceMesh, patches: Patches) -> SurfaceMesh:
    """Surface mesh cut along kinks and branches."""
    if not len(patches.split):
        return mesh
    return SurfaceMesh(
        mesh.points[patches.masters], patches.cells[0], mesh.cell, mesh.normals, groups=mesh.groups
    )


def given_directors(
    mesh: Surface, director: Director, patches: Patches, kink_angle: float
) -> Array:
    """Directors from the user's function, checked against the cells' normals."""
    if len(patches.split):
        raise ValueError(
            "a director as a function of the position needs a surface without branches; it "
            f"branches at {mesh.points[patches.split[0]]}"
        )
    found = vectors_at(director, mesh.points, 3, "director")
    size = np.linalg.norm(found, axis=1, keepdims=True)
    bad = np.flatnonzero(np.abs(size - 1.0) > 1e-6)
    if len(bad):
        raise ValueError(
            f"a director must be a unit vector; at {mesh.points[bad[0]]} it is {found[bad[0]]}"
        )
    found, edges = found / size, mesh.edges
    cosine = np.einsum("cj,cj->c", edges.normals, found[edges.points])
    if cosine.min() < cos(min(kink_angle, 0.47 * pi)):
        point = edges.points[cosine.argmin()]
        off = degrees(np.arccos(np.clip(cosine.min(), -1.0, 1.0)))
        raise ValueError(
            f"the director at {mesh.points[point]} is {found[point]}: it must point to the side of "
            f"the cells' normals and be normal to the surface, but is {off:.0f}° off one of them, "
            f"more than the kink angle of {degrees(kink_angle):.0f}°. Reverse the director or the "
            "cells, or use smaller cells"
        )
    return np.asarray(found[patches.masters])


def frames_with(points: Array, directors: Array) -> Array:
    """Frames with given third axes; e₁ is closest to the global axis least parallel to it.

    Of axes that are equal up to round-off the first is taken.
    """
    H = np.empty((len(points), 4, 3))
    H[:, 0], H[:, 3] = points, directors
    along = np.abs(directors)
    axis = np.eye(3)[(along <= along.min(axis=1, keepdims=True) + _EQUAL).argmax(axis=1)]
    e1 = axis - np.einsum("nj,nj->n", axis, directors)[:, np.newaxis] * directors
    H[:, 1] = e1 / np.linalg.norm(e1, axis=1, keepdims=True)
    H[:, 2] = np.cross(directors, H[:, 1])
    return H

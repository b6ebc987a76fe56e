"""Sections of a beam as they are given: one, by groups of cells, or by arc length."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.beams.orientation import Chains
from fem_lie.bodies.per_cell import of_groups
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.section import Section

Sections = Section | Mapping[str, Section] | Callable[[float], Section]


def section_per_cell(mesh: LineMesh, chains: Chains, section: Sections) -> list[Section]:
    """The section of each cell.

    Raises:
        ValueError: A cell has none, or several pieces share a function of arc length.
        TypeError: Something given is no section.
    """
    if isinstance(section, Section):
        return [section] * len(mesh.cells)
    if not isinstance(section, Mapping):
        chains.require_one("a section")
        found = [section(float(s)) for s in chains.arc.mean(axis=1)]
        for value in found:
            instance(value, Section, "the section at an arc length", "a Section")
        return found
    return of_groups(section, Section, "a Section", len(mesh.cells), mesh.group)


def outline_of(sections: Sequence[Section], pieces: int) -> Array | None:
    """Outline of all cells, or one for each piece of them, (m, k, 2): for drawing.

    Those with fewer corners repeat their last one.
    """
    given = [section.outline for section in sections]
    if all(outline is given[0] for outline in given):
        return given[0]
    corners = max(0 if outline is None else len(outline) for outline in given)
    outlines = np.full((len(given), corners, 2), np.nan)
    for padded, outline in zip(outlines, given, strict=True):
        if outline is not None:
            padded[:] = outline[-1]
            padded[: len(outline)] = outline
    return np.repeat(outlines, pieces, axis=0)


def without_rotary_inertia(density: Array) -> Array:
    """The same centre of mass and polar inertia J₁ about it, but J₂ = J₃ = 0.

    ``G_kl = ½ tr(J) δ_kl − J_kl`` about the centre of mass.
    """
    mass = density[:, 0, 0]
    centre = density[:, 0] / np.where(mass > 0, mass, 1.0)[:, np.newaxis]
    reduced = np.einsum("m,mk,ml->mkl", mass, centre, centre)
    about_centre = density - reduced
    polar = about_centre[:, 2, 2] + about_centre[:, 3, 3]
    for k, factor in ((1, -0.5), (2, 0.5), (3, 0.5)):
        reduced[:, k, k] += factor * polar
    return reduced

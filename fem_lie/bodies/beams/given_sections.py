"""Sections of a beam as they are given: one, by groups of cells, or by arc length."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.beams.orientation import Chains
from fem_lie.bodies.per_cell import of_groups
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.section import Section

_log = logging.getLogger(__name__)
_OPEN = 2.0  # warping length over polar radius: of solid, closed and angle sections about 1 at most
_FELT = 0.01  # of the length of a beam

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


def log_open_profiles(label: str, sections: Sequence[Section], length: float) -> None:
    """Say in the log which open thin-walled sections would resist twist by warping, too.

    Args:
        label: What the beam is called.
        sections: Of its cells.
        length: Of all of it.
    """
    for section in {id(each): each for each in sections}.values():
        known = section.properties
        if known is None or known.warping_length <= max(_OPEN * known.polar_radius, _FELT * length):
            continue
        assert known.warping_constant is not None
        _log.warning(
            "%s has an open thin-walled section and no stiffness against warping: where warping is "
            "held or changes along the beam it is too soft in torsion, up to %.2g from there "
            "(√(EI_ω/GJ)); AncfBeam(warping=%.4g) has the EI_ω of this section",
            label,
            known.warping_length,
            known.E * known.warping_constant,
        )


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

"""Sections of the cells of thin shells."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from fem_lie._arrays import Array, Indices, instance
from fem_lie.sections.shell_section import ShellSection

ThinSections = ShellSection | Mapping[str, ShellSection] | Callable[[Array], ShellSection]


def section_per_cell(
    section: ThinSections, middles: Array, cells_of: Callable[[str], Indices], label: str
) -> list[ShellSection]:
    """Section of each cell.

    Args:
        section: One for all cells, one for each patch, or a function of the centre of a cell.
        middles: Centres of the cells, shape (m, 3).
        cells_of: Function that returns the cells of a named patch.
        label: Label of the body, for messages.

    Raises:
        ValueError: A cell has no section.
        TypeError: An entry has an unexpected type.
    """
    known = "a ShellSection, a dict of them by patches or a function of the position"
    instance(section, ShellSection | Mapping | Callable, "ThinShell: section", known)
    if isinstance(section, ShellSection):
        return [section] * len(middles)
    if isinstance(section, Mapping):
        found: list[ShellSection | None] = [None] * len(middles)
        for key, value in section.items():
            for cell in cells_of(key):
                found[cell] = value
    else:
        found = [section(middle) for middle in middles]
    for middle, chosen in zip(middles, found, strict=True):
        if chosen is None:
            raise ValueError(f"{label} has no section for the cell at {middle}")
        instance(chosen, ShellSection, "the section of a cell", "a ShellSection")
    return [chosen for chosen in found if chosen is not None]

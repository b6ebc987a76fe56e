"""Sections of each cell from those of named groups of cells."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from fem_lie._arrays import Indices, instance

Given = TypeVar("Given")


def of_groups(
    given: Mapping[str, Given],
    kind: type[Given],
    expected: str,
    count: int,
    group: Callable[[str], Indices],
) -> list[Given]:
    """Section of each cell; where groups overlap, the last one is used.

    Args:
        given: Sections of named groups.
        kind: Class of the sections.
        expected: The class in words, as "a Section".
        count: Number of cells.
        group: Function that returns the cells of a group.

    Raises:
        ValueError: A cell has no section, or there is no such group.
        TypeError: A section is of another class.
    """
    chosen: dict[int, Given] = {}
    for name, value in given.items():
        instance(value, kind, f"the section of {name!r}", expected)
        chosen |= {int(cell): value for cell in group(name)}
    missing = [cell for cell in range(count) if cell not in chosen]
    if missing:
        raise ValueError(f"{len(missing)} cells have no section, the first is cell {missing[0]}")
    return [chosen[cell] for cell in range(count)]

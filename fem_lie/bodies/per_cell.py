"""Sections of each cell from those of named groups of cells."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices, instance

Given = TypeVar("Given")


def of_sections(given: Sequence[Given], value: Callable[[Given], Array]) -> Array:
    """Value of the section of each cell, shape (m, …), read only if all have one section.

    That value is then stored once: each rank has the sections of all cells.

    Args:
        given: Section of each cell.
        value: Returns the value of a section.
    """
    first = given[0]
    if all(each is first for each in given):
        one = np.asarray(value(first), dtype=np.float64)
        return np.broadcast_to(one, (len(given), *one.shape))
    return np.array([value(each) for each in given], dtype=np.float64)


def of_cells(values: Array, cells: Indices) -> Array:
    """Values of some cells, stored once if those of all cells are.

    Args:
        values: Value of each cell, as of :func:`of_sections`, shape (m, …).
        cells: Indices of the cells, shape (s,).
    """
    if values.strides[0] == 0 and len(cells):
        return np.broadcast_to(values[0], (len(cells), *values.shape[1:]))
    return values[cells]


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

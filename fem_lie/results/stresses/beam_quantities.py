"""What can be asked of section forces by name: components, amounts, axial stresses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie.pictures.units import Units
from fem_lie.sections.section import Section

COMPONENTS = ("N", "Vy", "Vz", "T", "My", "Mz")
QUANTITIES = (*COMPONENTS, "V", "M", "stress max", "stress min")


def of_forces(name: str, values: Array, sections: Sequence[Section]) -> Array:
    """A quantity, shape (T, m, e).

    Args:
        name: One of :data:`QUANTITIES`: "V" and "M" are the amounts of shear and of bending.
        values: Force and moment at e places of each element, shape (T, m, e, 6).
        sections: Of each element.

    Raises:
        ValueError: There is no such quantity, or no such stress.
    """
    if name not in QUANTITIES:
        raise ValueError(f"there is no section force {name!r}; there are: {', '.join(QUANTITIES)}")
    if name in COMPONENTS:
        return values[..., COMPONENTS.index(name)]
    if name in ("V", "M"):
        first = 1 if name == "V" else 4
        return np.hypot(values[..., first], values[..., first + 1])
    return outer_stress(values, sections)[..., 0 if name == "stress max" else 1]


def outer_stress(values: Array, sections: Sequence[Section]) -> Array:
    """Largest and smallest axial stress at the corners of the outline, shape (T, m, e, 2).

    Args:
        values: As in :func:`of_forces`.
        sections: Of each cell, m of them.

    Raises:
        ValueError: A section has no properties or no outline.
    """
    cells: dict[Section, list[int]] = {}
    for cell, section in enumerate(sections):
        cells.setdefault(section, []).append(cell)
    found = np.empty((*values.shape[:-1], 2))
    for section, which in cells.items():
        stress = values[:, which][..., [0, 4, 5]] @ section.axial_stress().T
        found[:, which] = np.stack([stress.max(axis=-1), stress.min(axis=-1)], axis=-1)
    return found


def unit(name: str, units: Units) -> str:
    """Unit of a quantity."""
    if name in ("N", "Vy", "Vz", "V"):
        return units.force
    if name.startswith("stress"):
        return f"{units.force}/{units.length}²"
    return f"{units.force} {units.length}"

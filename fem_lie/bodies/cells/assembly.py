"""Assembly of all bodies of one element of the small-energy kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.assembly import NodalInertia
from fem_lie.forms.small_energy.assembly import (
    CellFunctions,
    ElementAssembly,
    ViscousElementAssembly,
)
from fem_lie.forms.small_energy.element import Element
from fem_lie.sections.material import Damping


class ElementCells(Protocol):
    """Data of a body that the assembly reads."""

    frames: Array
    damping: Damping
    has_mass: bool

    @property
    def element_nodes(self) -> Indices:
        """Nodes of each cell, shape (m, k)."""

    def element_data(self) -> Array:
        """Data of the cells, see :func:`~fem_lie.forms.small_energy.element.cell_data`."""

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each cell, shape (m, k, 4, k, 4)."""


def assemble_cells(
    of: Element,
    functions: CellFunctions,
    bodies: Sequence[ElementCells],
    constants: Array | None = None,
) -> ElementAssembly:
    """Assembly of the cells of bodies, one body after the other; coincident nodes stay separate.

    Args:
        of: Element of all bodies.
        functions: Compiled functions of the element.
        bodies: The bodies; inertia is assembled if all of them have mass.
        constants: Constants for the functions, if they do not include them; default: none.
    """
    starts = np.cumsum([0] + [len(body.frames) for body in bodies])
    pairs = zip(bodies, starts[:-1], strict=True)
    cells = np.concatenate([body.element_nodes + start for body, start in pairs])
    data = np.concatenate([body.element_data() for body in bodies])
    kind = ViscousElementAssembly if of.cells.viscosities else ElementAssembly
    assembly = kind(of, functions, cells, data, int(starts[-1]), constants)
    if all(body.has_mass for body in bodies):
        parts = [body.element_inertia() for body in bodies]
        rates = [body.damping.mass for body in bodies]
        damped = [rate * part for rate, part in zip(rates, parts, strict=True)]
        damping = assembly.summed(np.concatenate(damped)) if any(rates) else None
        assembly.inertia = NodalInertia(assembly.summed(np.concatenate(parts)), damping)
    return assembly

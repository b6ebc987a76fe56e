"""All bodies of one element of the small-energy kernel, assembled together."""

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
    """What a body gives for its assembly."""

    frames: Array
    damping: Damping
    has_mass: bool

    @property
    def element_nodes(self) -> Indices:
        """Nodes of each cell, shape (m, k)."""

    def element_data(self) -> Array:
        """Data of the cells, see :func:`~fem_lie.forms.small_energy.element.cell_data`."""

    def element_inertia(self) -> Array:
        """Constant matrix of the rows of each cell's nodes, shape (m, k, 4, k, 4)."""


def assemble_cells(
    of: Element, functions: CellFunctions, bodies: Sequence[ElementCells]
) -> ElementAssembly:
    """The cells of bodies on their nodes, one body after the other; coincident nodes stay apart.

    Args:
        of: The element of all of them.
        functions: Its functions.
        bodies: With mass, all or none of them.
    """
    starts = np.cumsum([0] + [len(body.frames) for body in bodies])
    pairs = zip(bodies, starts[:-1], strict=True)
    cells = np.concatenate([body.element_nodes + start for body, start in pairs])
    data = np.concatenate([body.element_data() for body in bodies])
    kind = ViscousElementAssembly if of.cells.viscosities else ElementAssembly
    assembly = kind(of, functions, cells, data, int(starts[-1]))
    if all(body.has_mass for body in bodies):
        parts = [body.element_inertia() for body in bodies]
        rates = [body.damping.mass for body in bodies]
        damped = [rate * part for rate, part in zip(rates, parts, strict=True)]
        damping = assembly.summed(np.concatenate(damped)) if any(rates) else None
        assembly.inertia = NodalInertia(assembly.summed(np.concatenate(parts)), damping)
    return assembly

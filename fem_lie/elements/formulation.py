"""What a beam element family must provide: nodes per cell, and the forms of its energy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import basix.ufl
import dolfinx
from dolfinx import fem

from fem_lie._jit import Array
from fem_lie.frames import NodalFrames
from fem_lie.kernel import LocalFrameForms


@dataclass(frozen=True, eq=False)
class CellData:
    """What the cells of one line mesh are made of, in the mesh's order.

    Attributes:
        lengths: Arc length of each unloaded cell, shape (m,).
        stiffness: Section stiffness on (Γ, κ), shape (m, 6, 6).
        eigenstrain: Strain without stress, a DG0 function of shape (6,) that changes with time.
        viscosity: Stress per strain rate (Γ̇, κ̇), shape (m, 6, 6), or ``None``.
    """

    lengths: Array
    stiffness: Array
    eigenstrain: fem.Function
    viscosity: Array | None


class Formulation(ABC):
    """A beam element: subclass it in one file, as a frozen dataclass of its options.

    Attributes:
        degree: Of the nodal interpolation; a cell has ``degree + 1`` nodes.
    """

    degree: int

    def effective_stiffness(self, stiffness: Array, relative: Array) -> Array:
        """What the element takes for the section stiffness of its cells, shape (m, 6, 6).

        Args:
            stiffness: Of the section, shape (m, 6, 6).
            relative: Relative motion of the cells' ends, unloaded, shape (m, 6).
        """
        return stiffness

    @abstractmethod
    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """Energy, forces and tangent.

        Args:
            nodal: Frames of ``degree`` on a line mesh, in the unloaded configuration.
            cells: What the cells are made of.
        """


def cellwise(mesh: dolfinx.mesh.Mesh, values: Array) -> fem.Function:
    """Values of any shape, one for each cell, as a DG0 function."""
    element = basix.ufl.element("DG", mesh.basix_cell(), 0, shape=values.shape[1:])
    f = fem.Function(fem.functionspace(mesh, element))
    f.x.array[:] = values.ravel()
    return f

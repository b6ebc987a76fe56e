"""What a beam element family must provide: nodes per cell, and the forms of its energy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import basix.ufl
import dolfinx
import numpy as np
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


def with_bending_flexibility(stiffness: Array, lengths: Array) -> Array:
    """Section stiffness with the residual bending flexibility of elements of given length.

    With a moment that varies linearly, ``M(s) = M̄ − s e₁ × N``, the complementary energy has the
    additional shear compliance ``ℓ²/12 ê₁ᵀ C_κκ ê₁``, for a diagonal section
    ``1/GA* = 1/GA + ℓ²/(12 EI)``. (MacNeal, Comput. Struct. 8 (1978) 175.)

    Args:
        stiffness: Section stiffness per cell, shape (m, 6, 6).
        lengths: Length ℓ per cell, shape (m,).
    """
    effective = _inverse(_with_lever(_inverse(stiffness), lengths))
    return 0.5 * (effective + effective.transpose(0, 2, 1))


def flexible_cells(cells: CellData) -> CellData:
    """The cells with the residual bending flexibility in stiffness and viscosity.

    Parts in series add their compliances ``C`` and, for slow motion, the products ``C η C`` with
    their viscosities; a viscosity ``τ D`` of the section becomes τ times the new stiffness.
    """
    stiffness = with_bending_flexibility(cells.stiffness, cells.lengths)
    viscosity = cells.viscosity
    if viscosity is not None:
        C = _inverse(cells.stiffness)
        viscosity = stiffness @ _with_lever(C @ viscosity @ C, cells.lengths) @ stiffness
    return replace(cells, stiffness=stiffness, viscosity=viscosity)


def _inverse(matrices: Array) -> Array:
    return np.asarray(np.linalg.inv(matrices), dtype=np.float64)


def _with_lever(compliance: Array, lengths: Array) -> Array:
    """Add ``ℓ²/12 ê₁ᵀ C_κκ ê₁`` to the shear compliance."""
    lever = np.array([[0.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    added = lengths[:, np.newaxis, np.newaxis] ** 2 / 12 * (lever.T @ compliance[:, 3:, 3:] @ lever)
    compliance[:, :3, :3] += added
    return compliance

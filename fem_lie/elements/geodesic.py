"""Two-node beam along the geodesic of SE(3) that joins its nodal frames.

Flat coordinate: the relative motion ``d = log(H_A⁻¹ H_B)``, shape ``(6,)``; strain
``ε = (d − d₀)/ℓ``, constant along the element; nothing locks at any slenderness. The map to the
nodes is ``δd = [−T₆⁻¹(−d), T₆⁻¹(d)] (h_A, h_B)``. (Sonneville, Cardona & Brüls, CMAME 268
(2014) 451.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numba
import ufl
from ufl.core.expr import Expr

from fem_lie import lie
from fem_lie.elements.formulation import (
    CellData,
    Formulation,
    cellwise,
    flexible_cells,
)
from fem_lie.frames import NodalFrames
from fem_lie.kernel import FrameMap, LocalFrameForms, StrainEnergy, frame_function, stack


@frame_function
def _coordinates(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    H = numba.carray(state, (2, 4, 3))
    lie.relative(H[0], H[1], numba.carray(y, (6,)))


@frame_function
def _pull(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    d, N = numba.carray(y, (6,)), numba.carray(given, (6,))
    r = numba.carray(out, (2, 6))
    g = numba.carray(stack(6), (6,))
    lie.apply_tangent_inverse_transposed_minus(d, N, g)
    for i in range(6):
        r[0, i] -= g[i]
    lie.apply_tangent_inverse_transposed(d, N, g)
    for i in range(6):
        r[1, i] += g[i]


@frame_function
def _push(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    d, h, dd = numba.carray(y, (6,)), numba.carray(given, (2, 6)), numba.carray(out, (6,))
    g = numba.carray(stack(6), (6,))
    lie.apply_tangent_inverse_minus(d, h[0], g)
    lie.apply_tangent_inverse(d, h[1], dd)
    for i in range(6):
        dd[i] -= g[i]


@frame_function
def _geometric(state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    """``[G(−d, N); G(d, N)] P`` with ``G(d, N) = ∂(T₆⁻ᵀ(d) N)/∂d`` and ``δd = P h``."""
    d, N = numba.carray(y, (6,)), numba.carray(given, (6,))
    A = numba.carray(out, (12, 12))
    G = numba.carray(stack(72), (2, 6, 6))
    unit, column = numba.carray(stack(6), (6,)), numba.carray(stack(6), (6,))
    lie.tangent_inverse_transposed_derivative_minus(d, N, G[0])
    lie.tangent_inverse_transposed_derivative(d, N, G[1])
    for j in range(12):
        for i in range(6):
            unit[i] = 1.0 if i == j % 6 else 0.0
        if j < 6:
            lie.apply_tangent_inverse_minus(d, unit, column)
        else:
            lie.apply_tangent_inverse(d, unit, column)
        sign = -1.0 if j < 6 else 1.0
        for i in range(12):
            for k in range(6):
                A[i, j] += sign * G[i // 6, i % 6, k] * column[k]


GEODESIC = FrameMap(
    coordinates=_coordinates, pull=_pull, push=_push, geometric=_geometric, values=12, unknowns=6
)


@dataclass(frozen=True)
class Geodesic(Formulation):
    """The SE(3) geodesic element: the default for beams.

    Attributes:
        bending_flexibility: Add the residual bending flexibility (MacNeal 1978) to the shear
            flexibility: exact for small deflections with one element, more accurate beyond.
    """

    bending_flexibility: bool = True
    degree: ClassVar[int] = 1  # type: ignore[misc]

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """See the base class."""
        mesh = nodal.function.function_space.mesh
        if self.bending_flexibility:
            cells = flexible_cells(cells)
        ends = nodal.frames[nodal.function.function_space.dofmap.list]
        unloaded = lie.se3_relative(ends[:, 0], ends[:, 1])
        d, d0, length = (cellwise(mesh, a) for a in (unloaded, unloaded, cells.lengths))
        viscosity = None if cells.viscosity is None else cellwise(mesh, cells.viscosity)
        energy = geodesic_energy(
            d, d0, length, cellwise(mesh, cells.stiffness), mesh, cells.eigenstrain, viscosity
        )
        return LocalFrameForms(energy, nodal.function, nodal.increment, GEODESIC, coordinates=d)


def geodesic_energy(
    d: Expr,
    d0: Expr,
    length: Expr,
    D: Expr,
    domain: ufl.Mesh,
    eigenstrain: Expr | None = None,
    viscosity: Expr | None = None,
) -> StrainEnergy:
    """``½ ε·Dε ℓ`` of every element, ``ε = (d − d₀)/ℓ − ε*``.

    Args:
        d: Relative motion, shape ``(6,)``, a DG0 function.
        d0: The same, unloaded.
        length: Arc length ℓ of the unloaded element.
        D: Section stiffness, shape ``(6, 6)``, see
            :func:`~fem_lie.elements.formulation.with_bending_flexibility`.
        domain: The line mesh.
        eigenstrain: ``ε*``, shape ``(6,)``; default: none.
        viscosity: Stress per strain rate, shape ``(6, 6)``; default: none.
    """
    strain = (d - d0) / length
    return StrainEnergy(
        strain=strain if eigenstrain is None else strain - eigenstrain,
        law=lambda strain: 0.5 * ufl.inner(strain, D * strain),
        dx=ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 0}),
        weight=length / ufl.CellVolume(domain),
        viscosity=viscosity,
    )

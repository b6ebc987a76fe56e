"""Kirchhoff rod: two nodes with frames, a cubic between them whose tangents are their first axes.

No shear: ``e₁`` of a node *is* the tangent there. With ``ℓ`` the unstretched length, ``c`` the
chord and ``t`` the tangents, all along the axes half-way between the nodes, the axis is the cubic
with end slopes ``m t_A`` and ``m t_B``, as fast in its middle as there::

    |3/2 c/ℓ − m (t_A + t_B)/4| = m,

so that the strain ``ε = m − 1`` is constant, and an inextensible rod can bend: nothing locks. (The
family is that of Meier, Popp & Wall, *Arch. Comput. Methods Eng.* 26 (2019) 163; the condition on
the slopes takes the place of their unknown lengths.) Axes within are those of the geodesic
rotation, whose first one is ``D``, turned on to the tangent by the smallest rotation. They bend by
the components of ``t′`` and are twisted by::

    τ = θ₁/ℓ − (D × t)·(D′ + t′)/(1 + D·t)

All are functions of the relative motion ``log(H_A⁻¹ H_B)`` alone, hence invariant under superposed
rigid motion, and are counted from their values unloaded. Bending is of fourth order; torsion that
varies along an element, as it does where a bent rod is bent further, is of second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial
from typing import ClassVar

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.elements.beams.element import CellData, Formulation, cellwise, present_values
from fem_lie.elements.beams.geodesic import GEODESIC, smooth_inertia
from fem_lie.elements.rods.kirchhoff_forces import force_kernel
from fem_lie.forms.energy import Forces, StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.grips.geodesic import on_geodesic
from fem_lie.grips.grip import Grip

_TERMS = 9  # of the series below: 1e-14 up to a turn of π from end to end
_POINTS = 3  # degree to which two Gauss points are exact
_SHEAR = (1, 2)  # where it is in a section's stiffness
_FOLDS = 2.7  # rad: from end to end of an arc, beyond which its moment falls


@dataclass(frozen=True)
class Kirchhoff(Formulation):
    """Rod element without shear: cubic between two frames.

    Shear stiffness of the section is not used, and the shear force is that of the balance. A place
    within an element is held on the geodesic between its ends.
    """

    degree: ClassVar[int] = 1  # type: ignore[misc]
    bows: ClassVar[bool] = True

    @property
    def largest_turn(self) -> float:
        """Less than π: the cubic of a tighter arc has a moment that falls."""
        return _FOLDS

    def place(self, nodes: Sequence[int], ξ: float) -> Grip:
        """On the geodesic from end to end."""
        a, b = nodes
        return on_geodesic(int(a), int(b), ξ)

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """Energy, forces and tangent."""
        mesh = nodal.function.function_space.mesh
        ends = nodal.frames[nodal.function.function_space.dofmap.list]
        d = cellwise(mesh, lie.se3_relative(ends[:, 0], ends[:, 1]))
        length, stiffness = cellwise(mesh, cells.lengths), cellwise(mesh, cells.stiffness)
        viscosity = None if cells.viscosity is None else cellwise(mesh, cells.viscosity)
        energy = rod_energy(d, length, stiffness, cells.eigenstrain, viscosity)
        return LocalFrameForms(energy, nodal.function, nodal.increment, GEODESIC, coordinates=d)

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """That of the geodesic beam with the same bending, which has no shear either."""
        stiffness = cells.stiffness.copy()
        stiffness[:, _SHEAR, _SHEAR] = np.inf
        slope = np.tile(np.eye(1, 3), (len(cells.lengths), 1))
        return smooth_inertia(cells.density, stiffness, cells.lengths, slope)


def rod_energy(
    d: fem.Function,
    length: fem.Function,
    stiffness: fem.Function,
    eigenstrain: fem.Function | None = None,
    viscosity: Expr | None = None,
) -> StrainEnergy:
    """``½ ∫ ε·Dε ds`` of every element; as they are now they are unloaded.

    Args:
        d: Relative motion of both ends, unloaded, shape ``(6,)``, a DG0 function.
        length: Arc length, unstretched, a DG0 function as the next two.
        stiffness: Of the section, shape ``(6, 6)``.
        eigenstrain: Strain without stress, shape ``(6,)``; default: none.
        viscosity: Stress per strain rate, shape ``(6, 6)``; default: none.
    """
    mesh = d.function_space.mesh
    along = fem.Function(fem.functionspace(mesh, ("DG", 1)))
    along.x.array[along.function_space.dofmap.list] = [-0.5, 0.5]
    z = ufl.variable(d)
    strain = rod_strains(z, length, along)
    unloaded = present_values(strain, mesh, _POINTS)
    if eigenstrain is None:
        cells = mesh.topology.index_map(mesh.topology.dim)
        eigenstrain = cellwise(mesh, np.zeros((cells.size_local + cells.num_ghosts, 6)))
    return StrainEnergy(
        strain=strain - unloaded - eigenstrain,
        law=lambda strain: 0.5 * ufl.inner(strain, stiffness * strain),
        dx=ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": _POINTS}),
        weight=length / ufl.CellVolume(mesh),
        viscosity=viscosity,
        through=z,
        forces=Forces(force_kernel, [length, stiffness, eigenstrain, unloaded]),
    )


def rod_strains(d: Expr, length: Expr, along: Expr) -> Expr:
    """``(m, 0, 0, τ, κ₂, κ₃)``, shape ``(6,)``; the first is one where nothing is strained.

    Args:
        d: Relative motion of both ends, shape ``(6,)``.
        length: Arc length, unstretched.
        along: Place, −½ to ½ from end to end.
    """
    u, θ = (ufl.as_vector([d[k + i] for i in range(3)]) for k in (0, 3))
    x = ufl.dot(θ, θ)
    chord = (_series(x / 4, 1) * u + _series(x / 4, 3) / 4 * ufl.dot(θ, u) * θ) / length
    first = [ufl.as_vector([float(i == k) for i in range(3)]) for k in range(3)]
    start, end = (_turned(factor * θ, first[0]) for factor in (-0.5, 0.5))
    m = _speed(chord, start + end)
    ξ = along + 0.5
    slope = 6 * ξ * (1 - ξ) * chord + m * (
        (1 - 4 * ξ + 3 * ξ**2) * start + (3 * ξ**2 - 2 * ξ) * end
    )
    bend = ((6 - 12 * ξ) * chord + m * ((6 * ξ - 4) * start + (6 * ξ - 2) * end)) / length
    size = ufl.sqrt(ufl.dot(slope, slope))
    t = slope / size
    dt = (bend - ufl.dot(t, bend) * t) / size
    D, second, third = (_turned(along * θ, e) for e in first)
    dD, near = ufl.cross(θ, D) / length, 1 + ufl.dot(D, t)
    twist = θ[0] / length - ufl.dot(ufl.cross(D, t), dD + dt) / near
    # t′ is across t, so of the smallest rotation only what is along D counts
    across = dt - ufl.dot(D, dt) / near * (D + t)
    return ufl.as_vector([m, 0, 0, twist, -ufl.dot(across, third), ufl.dot(across, second)])


def _speed(chord: Expr, tangents: Expr) -> Expr:
    """``m`` of the chord over the length, and the sum of both tangents."""
    square = 1 - ufl.dot(tangents, tangents) / 16
    half = 3 * ufl.dot(chord, tangents) / 8
    return (ufl.sqrt(half**2 + 9 * square * ufl.dot(chord, chord) / 4) - half) / square


def _turned(φ: Expr, e: Expr) -> Expr:
    """``exp(φ̂) e``."""
    x, across = ufl.dot(φ, φ), ufl.cross(φ, e)
    return e + _series(x, 1) * across + _series(x, 2) * ufl.cross(φ, across)


def _series(x: Expr, order: int) -> Expr:
    """``Σ (−x)ᵏ/(2k + order)!``: sin φ/φ, (1 − cos φ)/φ², (φ − sin φ)/φ³ of ``x = φ²``."""
    value: Expr | float = 0.0
    for k in reversed(range(_TERMS)):
        value = 1.0 / factorial(2 * k + order) - x * value
    return value

"""Two-node beam along the geodesic of SE(3) that joins its nodal frames.

The flat coordinate is the relative motion ``d = log(H_A⁻¹ H_B)``, shape ``(6,)``; the strain
``ε = (d − d₀)/ℓ`` is constant along the element, which does not lock at any slenderness. The map to
the nodes is ``δd = [−T₆⁻¹(−d), T₆⁻¹(d)] (h_A, h_B)``. (Sonneville, Cardona & Brüls, CMAME 268
(2014) 451.)

With the residual bending flexibility, mean shear is mostly bending between the ends.
:func:`geodesic_strain` adds its two terms of second order.

Forces and energy are hand-written. With the strain ``ε(d) − ε*`` of :func:`geodesic_strain` and the
stress ``σ = D (ε − ε*)`` the energy is ``½ ℓ (ε − ε*)·σ``. With ``N = ℓ (∂ε/∂d)ᵀ σ`` the forces on
the nodes are ``(−T₆⁻ᵀ(−d) N, T₆⁻ᵀ(d) N)``. All terms of ``T₆⁻ᵀ`` except the cross products are even
in ``d``: both nodes share one set of coefficients and one sum of even terms. UFL and the element's
map give the same, but compute coefficients twice, and coordinates again for the energy: that takes
1.3 to 1.5 times as long for forces, and 2.2 times for forces and energy, which conserving schemes
need together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import ClassVar

import numba
import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import callback, inlined
from fem_lie._jit.stack import stack
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.between_frames import on_geodesic
from fem_lie.elements.beams.element import (
    S_SHAPE,
    BeamFormulation,
    CellData,
    bending_share,
    cellwise,
    flexible_cells,
    with_bending_flexibility,
    with_elongation,
)
from fem_lie.forms.energy import Forces, StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, FrameMap, Pointer, frame_function
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.series import inverse_coefficients
from fem_lie.lie.tuples import Vector, combined, cross, dot, load, minus, plus, scaled, store

_Y, _LENGTH, _D, _EIGENSTRAIN, _UNLOADED, _SHARE, _ENERGY = 24, 30, 31, 67, 73, 79, 83
"""Offsets of the data of a cell, behind the coordinates of both nodes."""
_SIZE = 84
_ARC = 1 / 60  # see geodesic_strain


@inlined
def set_stress(data: Array, N: Array) -> float:
    """Set the forces ``N`` (6,) conjugate to the relative motion; return the energy."""
    e, length = numba.carray(stack(6), (6,)), data[_LENGTH]
    d, d0, inverse = data[_Y:_LENGTH], data[_UNLOADED:_SHARE], 1.0 / length
    for i in range(6):
        e[i] = (d[i] - d0[i]) * inverse
    F22, F23, F32, F33 = data[_SHARE], data[_SHARE + 1], data[_SHARE + 2], data[_SHARE + 3]
    β2, β3 = F22 * e[1] + F23 * e[2], F32 * e[1] + F33 * e[2]
    # θ = (d[5], −d[4]) and θ₀, their components along β
    p, p0 = d[5] * β2 - d[4] * β3, d0[5] * β2 - d0[4] * β3
    X, square = 1.0 + e[0], β2 * β2 + β3 * β3
    C = sqrt(X * X + square)
    per_C = 1.0 / C
    excess = S_SHAPE * square * per_C * per_C
    e[0] += square / (C + abs(X)) + excess * C
    if F22 != 0.0 or F33 != 0.0:
        e[0] += abs(X) - X
    e[1] -= _ARC * (d[5] * p - d0[5] * p0)
    e[2] += _ARC * (d[4] * p - d0[4] * p0)
    work = 0.0
    for i in range(6):
        e[i] -= data[_EIGENSTRAIN + i]
    for i in range(6):
        N[i] = 0.0
        for j in range(6):
            N[i] += data[_D + 6 * i + j] * e[j]
        work += N[i] * e[i]
    # forces conjugate to β and to θ
    q, q0 = d[5] * N[1] - d[4] * N[2], d0[5] * N[1] - d0[4] * N[2]
    across = N[0] * per_C * (1.0 + 2.0 * S_SHAPE - excess)
    m2 = across * β2 - _ARC * (d[5] * q - d0[5] * q0)
    m3 = across * β3 + _ARC * (d[4] * q - d0[4] * q0)
    N[4] += length * _ARC * (N[2] * p + β3 * q)
    N[5] -= length * _ARC * (N[1] * p + β2 * q)
    if F22 != 0.0 or F33 != 0.0:
        N[0] *= X * per_C * (1.0 - excess)
    N[1] += F22 * m2 + F32 * m3
    N[2] += F23 * m2 + F33 * m3
    return 0.5 * length * work


@inlined
def both_ends(d: Array, N: Array) -> tuple[Vector, Vector, Vector, Vector]:
    """Parts of ``T₆⁻ᵀ(±d) N`` that are even and odd in ``d``, forces and then moments."""
    u, θ, f, m = load(d, 0), load(d, 3), load(N, 0), load(N, 3)
    (α, _, γ), (dα, _, dγ) = inverse_coefficients(dot(θ, θ))
    s, p = 2.0 * dot(θ, u), dot(θ, f)
    along = s * dγ * p + γ * (dot(u, f) + dot(θ, m))
    moment = plus(combined(s * dα, f, α, m), combined(along, θ, γ * p, u))
    odd = scaled(0.5, plus(cross(u, f), cross(θ, m)))
    return combined(α, f, γ * p, θ), moment, scaled(0.5, cross(θ, f)), odd


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add forces and moments on both nodes along their frames, and store the energy."""
    H, data = numba.carray(w, (2, 4, 3)), numba.carray(w, (_SIZE,))
    N, d = numba.carray(stack(6), (6,)), data[_Y:_LENGTH]
    lie.relative(H[0], H[1], d)
    data[_ENERGY] = set_stress(data, N)
    force, moment, odd_force, odd_moment = both_ends(d, N)
    r = numba.carray(A, (12,))
    store(r, 0, minus(load(r, 0), plus(force, odd_force)))
    store(r, 3, minus(load(r, 3), plus(moment, odd_moment)))
    store(r, 6, plus(load(r, 6), minus(force, odd_force)))
    store(r, 9, plus(load(r, 9), minus(moment, odd_moment)))


@frame_function
def _coordinates(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H = numba.carray(state, (2, 4, 3))
    lie.relative(H[0], H[1], numba.carray(y, (6,)))


@frame_function
def _pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
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
def _push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    d, h, dd = numba.carray(y, (6,)), numba.carray(given, (2, 6)), numba.carray(out, (6,))
    g = numba.carray(stack(6), (6,))
    lie.apply_tangent_inverse_minus(d, h[0], g)
    lie.apply_tangent_inverse(d, h[1], dd)
    for i in range(6):
        dd[i] -= g[i]


@frame_function
def _geometric(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
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
    coordinates=_coordinates,
    pull_back=_pull,
    push_forward=_push,
    geometric=_geometric,
    values=12,
    unknowns=6,
)


@dataclass(frozen=True)
class GeodesicBeam(BeamFormulation):
    """Beam element along the SE(3) geodesic: the default for beams.

    Attributes:
        bending_flexibility: Account for stress that varies within an element, see
            :func:`with_bending_flexibility`: exact for small deflections of a single straight,
            circular or helical element, and more accurate for large ones.
    """

    bending_flexibility: bool = True
    degree: ClassVar[int] = 1  # type: ignore[misc]
    bows: ClassVar[bool] = True

    def attachment_frame(self, nodes: Sequence[int], ξ: float) -> AttachmentFrame:
        """Attachment frame on the geodesic from end to end."""
        a, b = nodes
        return on_geodesic(int(a), int(b), ξ)

    def effective_stiffness(self, stiffness: Array, relative: Array) -> Array:
        """Section stiffness, with the bending flexibility along the screw axis, (m, 6, 6)."""
        if not self.bending_flexibility:
            return stiffness
        return with_bending_flexibility(stiffness, relative)

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent of the screw motion from end to end."""
        mesh = nodal.function.function_space.mesh
        unloaded = _relative(nodal)
        section = cells.stiffness
        share: Array = np.zeros((len(unloaded), 2, 2))
        if self.bending_flexibility:
            cells = flexible_cells(cells, unloaded)
            share = bending_share(section, cells.stiffness)
        d, d0, length, F, found = (
            cellwise(mesh, a)
            for a in (unloaded, unloaded, cells.lengths, share, np.zeros(len(unloaded)))
        )
        viscosity = None if cells.viscosity is None else cellwise(mesh, cells.viscosity)
        D, eigenstrain = cellwise(mesh, cells.stiffness), cells.eigenstrain
        shared = F if self.bending_flexibility else None
        energy = geodesic_energy(d, d0, length, D, mesh, eigenstrain, viscosity, shared)
        forces = Forces(force_kernel, [length, D, eigenstrain, d0, F, found], found)
        energy = replace(energy, forces=forces)
        return LocalFrameForms(energy, nodal.function, nodal.increment, GEODESIC, coordinates=d)

    def mean_stress(self, stress: Array, frames: Array, ends: Array) -> Array:
        """Mean along the element, ``T₆ᵀ(d) σ_B``, in axes that rotate with the geodesic."""
        d = lie.se3_relative(frames[:, 0], frames[:, 1])
        return np.einsum("mji,mj->mi", lie.se3_tangent(d), ends[:, 1])[:, np.newaxis]

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Mass matrix of :func:`smooth_inertia`, as accurate in waves as the stiffness."""
        slope = _relative(nodal)[:, :3] / cells.lengths[:, np.newaxis]
        return smooth_inertia(cells.density, cells.stiffness, cells.lengths, slope)


def _relative(nodal: NodalFrames) -> Array:
    """``log(H_A⁻¹ H_B)`` of each cell, shape (m, 6)."""
    ends = nodal.frames[nodal.function.function_space.dofmap.list]
    return lie.se3_relative(ends[:, 0], ends[:, 1])


def smooth_inertia(density: Array, stiffness: Array, lengths: Array, slope: Array) -> Array:
    """Mass matrix in (x, d₁, d₂, d₃) of both nodes that is as accurate in waves as the stiffness.

    The axis is quadratic like the geodesic, and the directors are linear::

        x(s) = (1 − s) x_A + s x_B + ½ (s − s²) (t_A − t_B),    t = ℓ Σ slope_k d_k,  0 ≤ s ≤ 1,

    so that the matrix is constant. A kinetic energy that vanishes in rigid motion is added to it,

        (ρA ℓ/24) |ė|² + ½ Σ_k a_k |ḋ_kB − ḋ_kA|²,    e = x_B − x_A − ½ (t_A + t_B),
        a₂ + a₃ = ρJ ℓ/12,    a₁ + a₃ = ρI₂ ℓ/6 + ρA ℓ³/240 + ρA ℓ EI₂/(12 GA₃),    a₁ + a₂ alike,

    the only choice with which waves ``exp(iθs)`` have relative frequency errors of order θ⁴ in
    axial and torsional and θ⁶ in bending motion of Timoshenko beams, instead of θ² (dispersion
    relation of the element with bending flexibility). In bending an error (γ/x')² θ²/100 remains,
    with γ the shear, which is small unless waves are as short as the section is high. Mass, centre
    and moments of inertia of straight elements are exact.

    No ``a_k`` is negative, so that the kinetic energy is positive for any rates of the directors.
    Therefore, if a section is wider than high by more than a fifth, the larger of ``a₁ + a₃`` and
    ``a₁ + a₂`` is limited by the other two moments: in bending within the plane of its width an
    error (kr)² θ²/10 remains, with r its radius of gyration and k the wave number.

    Args:
        density: Mass matrix of (x, d₁, d₂, d₃) per length, shape (m, 4, 4).
        stiffness: Section stiffness, shape (m, 6, 6).
        lengths: Length ℓ of the elements, shape (m,).
        slope: Derivative of ``x`` by arc length in the nodal frames, shape (m, 3).

    Returns:
        Shape (m, 2, 4, 2, 4).
    """
    ends, bubble = np.array([1 - _POINTS, _POINTS]), 0.5 * _POINTS * (1 - _POINTS)
    tangent = lengths[:, np.newaxis] * slope
    shapes = np.einsum("e,np,ab->epanb", np.ones(len(lengths)), ends, np.eye(4))
    shapes[:, :, 0, :, 1:] = np.einsum("p,n,ek->epnk", bubble, [1, -1], tangent)
    weighted = np.einsum("p,e,eab->epab", _WEIGHTS, lengths, density)
    G = np.einsum("epaic,epab,epbjd->eicjd", shapes, weighted, shapes, optimize=True)
    e = np.zeros((len(lengths), 2, 4))
    e[:, :, 0] = [-1, 1]
    e[:, :, 1:] = -0.5 * tangent[:, np.newaxis]
    G += np.einsum("e,eia,ejb->eiajb", density[:, 0, 0] * lengths / 12, e, e)
    a = _difference_inertia(density, stiffness, lengths)
    G[:, :, 1:, :, 1:] += np.einsum("ij,ekl->eikjl", [[1, -1], [-1, 1]], a)
    return np.asarray(G)


_GAUSS = np.polynomial.legendre.leggauss(3)
_POINTS, _WEIGHTS = 0.5 * (_GAUSS[0] + 1), 0.5 * _GAUSS[1]


def _difference_inertia(density: Array, stiffness: Array, lengths: Array) -> Array:
    """``a`` of :func:`smooth_inertia` as a mass matrix of (d₁, d₂, d₃), shape (m, 3, 3)."""
    mass, E = density[:, 0, 0], density[:, 1:, 1:]
    tensor = np.trace(E, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(3) - E
    weight = np.sqrt([1 / 12, 1 / 6, 1 / 6])
    tensor = lengths[:, np.newaxis, np.newaxis] * tensor * np.outer(weight, weight)
    for bending, shear in ((1, 2), (2, 1)):
        ratio = stiffness[:, 3 + bending, 3 + bending] / stiffness[:, shear, shear]
        tensor[:, bending, bending] += mass * lengths * (lengths**2 / 240 + ratio / 12)
    moments, axes = np.linalg.eigh(tensor)
    moments[:, 2] = np.minimum(moments[:, 2], moments[:, 0] + moments[:, 1])
    euler = 0.5 * moments.sum(axis=1, keepdims=True) - moments
    return np.einsum("eik,ek,ejk->eij", axes, euler, axes)


def geodesic_strain(d: Expr, d0: Expr, length: Expr, share: Expr) -> Expr:
    """Mean strain of an element whose axis bends between its ends, shape (6,).

    ``ε = (d − d₀)/ℓ``, with ``β = F Γ_t`` the part of the mean shear that is bending::

        Γ₁ → Γ₁ + 3/5 β² + …,    Γ_t → Γ_t − (θ (θ·β) − θ₀ (θ₀·β))/60,    θ = (d₆, −d₅).

    The first term is the length of a bent axis, see
    :func:`~fem_lie.elements.beams.element.with_elongation`. The second gives the bending
    flexibility of an arc with the current angle θ, to second order: for bending within its plane,
    ``12 EI/ℓ² (1 − θ²/30)`` for any section, as
    :func:`~fem_lie.elements.beams.element.with_bending_flexibility` has it for unloaded arcs.

    Args:
        d: Relative motion, shape (6,).
        d0: Unloaded relative motion.
        length: Arc length ℓ of the unloaded element.
        share: ``F`` of :func:`~fem_lie.elements.beams.element.bending_share`, shape (2, 2).
    """
    strain = (d - d0) / length
    Γ = ufl.as_vector([strain[1], strain[2]])
    arcs = sum(s * ufl.outer(θ, θ) for s, θ in ((-1 / 60, _bend(d)), (1 / 60, _bend(d0))))
    change = arcs * (share * Γ)
    return with_elongation(strain, Γ, share) + ufl.as_vector([0, *change, 0, 0, 0])


def _bend(d: Expr) -> Expr:
    """Deflections across the axis by bending ``d``, per length, times two, (2,)."""
    return ufl.as_vector([d[5], -d[4]])


def geodesic_energy(
    d: Expr,
    d0: Expr,
    length: Expr,
    D: Expr,
    domain: ufl.Mesh,
    eigenstrain: Expr | None = None,
    viscosity: Expr | None = None,
    share: Expr | None = None,
) -> StrainEnergy:
    """Energy ``½ ε·Dε ℓ`` of every element, ``ε = (d − d₀)/ℓ − ε*``.

    Args:
        d: Relative motion, shape ``(6,)``, a DG0 function.
        d0: Unloaded relative motion.
        length: Arc length ℓ of the unloaded element.
        D: Section stiffness, shape ``(6, 6)``, see
            :func:`~fem_lie.elements.beams.element.with_bending_flexibility`.
        domain: Line mesh.
        eigenstrain: ``ε*``, shape ``(6,)``; default: none.
        viscosity: Viscosity, shape ``(6, 6)``; default: none.
        share: Fraction of the mean shear that is bending, see :func:`geodesic_strain`; default:
            none.
    """
    strain = (d - d0) / length if share is None else geodesic_strain(d, d0, length, share)
    return StrainEnergy(
        strain=strain if eigenstrain is None else strain - eigenstrain,
        law=lambda strain: 0.5 * ufl.inner(strain, D * strain),
        dx=ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 0}),
        weight=length / ufl.CellVolume(domain),
        viscosity=viscosity,
    )

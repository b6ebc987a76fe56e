"""Four-node shell whose edges are geodesics of SE(3): pure bending is exact in one element.

The frames of a cell's nodes, turned about their directors so that their first axes are along the
first axis of the cell, are ``H_a``. The flat coordinates are the relative motions of the nodes of
each edge, ``d = log(H_a⁻¹ H_b) = (u, θ)``, as of :mod:`fem_lie.elements.beams.geodesic`: an edge is
an arc of the length of ``u``, not its chord. With ``Δ = d − d₀`` of the edges along ξ and η::

    G₁ = (1 − η) Δ₀₁ + η Δ₂₃,    G₂ = (1 − ξ) Δ₀₂ + ξ Δ₁₃,    (Γᵢ, κᵢ) = (J⁻¹)ᵢα Gα

``J`` is made of ``u₀`` of the edges in the same way, so that arcs of the unloaded surface have
their length, too. The strains are::

    E = (Γ₁·e₁, Γ₂·e₂, Γ₁·e₂ + Γ₂·e₁)    K = (κ₁·e₂, −κ₂·e₁, κ₂·e₂ − κ₁·e₁)    γᵢ = Γᵢ·e₃
    c = Γ₁·e₂ − Γ₂·e₁                     κᵢ·e₃

Membrane strain, shear and curvature along an edge are those of the edge: nothing locks, and states
of constant strain are exact on distorted cells. The drilling strain ``c`` has the stiffness ``G t``
of membrane shear. Without the last two, nodes that rotate alternately about their directors would
have no strain; their stiffness is that of twist, ``G t³/12``, which adds ``(t/b)²`` to the bending
stiffness of a strip of width b in its plane.

Strains depend on the relative motion of frames only, and do not change in any rigid motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar

import numba
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie._jit.stack import stack
from fem_lie.elements.shells.cells import ShellCells
from fem_lie.elements.shells.decoupled import EDGES
from fem_lie.elements.shells.drilling import MEMBRANE_SHEAR, TWIST
from fem_lie.elements.shells.element import ShellFormulation
from fem_lie.elements.shells.measures import MITC4, StrainMeasures
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.kernels.addresses import FrameMap, Pointer, frame_function
from fem_lie.forms.local_forms import LocalFrameForms

_EDGES = np.array(EDGES)
_MOTIONS, _TURNS, _SIZE = 24, 24, 32
"""Number of relative motions; where cosines and sines of the nodes' turns begin; size."""


@compiled
def _turn(cosine: float, sine: float, v: Array) -> None:
    """Components (…, 6) along axes turned about the third, of components along nodal axes."""
    for at in (0, 3):
        a, b = v[at], v[at + 1]
        v[at], v[at + 1] = cosine * a + sine * b, cosine * b - sine * a


@compiled
def _turned_frame(H: Array, cosine: float, sine: float, out: Array) -> None:
    """Frame turned about its third axis."""
    for j in range(3):
        out[0, j], out[3, j] = H[0, j], H[3, j]
        out[1, j] = cosine * H[1, j] + sine * H[2, j]
        out[2, j] = cosine * H[2, j] - sine * H[1, j]


@frame_function
def _coordinates(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, all_of = numba.carray(state, (4, 4, 3)), numba.carray(y, (_SIZE,))
    frames = numba.carray(stack(48), (4, 4, 3))
    for i in range(4):
        _turned_frame(H[i], all_of[_TURNS + 2 * i], all_of[_TURNS + 2 * i + 1], frames[i])
    for e in range(4):
        a, b = _EDGES[e, 0], _EDGES[e, 1]
        lie.relative(frames[a], frames[b], all_of[6 * e : 6 * e + 6])


@frame_function
def _pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    all_of, N = numba.carray(y, (_SIZE,)), numba.carray(given, (_SIZE,))
    r, g = numba.carray(out, (4, 6)), numba.carray(stack(6), (6,))
    for e in range(4):
        own = slice(6 * e, 6 * e + 6)
        for side in range(2):
            if side == 0:
                lie.apply_tangent_inverse_transposed_minus(all_of[own], N[own], g)
            else:
                lie.apply_tangent_inverse_transposed(all_of[own], N[own], g)
            i = _EDGES[e, side]
            _turn(all_of[_TURNS + 2 * i], -all_of[_TURNS + 2 * i + 1], g)
            for k in range(6):
                r[i, k] += g[k] if side == 1 else -g[k]


@frame_function
def _push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    all_of, h = numba.carray(y, (_SIZE,)), numba.carray(given, (4, 6))
    change = numba.carray(out, (_SIZE,))
    turned, g = numba.carray(stack(24), (4, 6)), numba.carray(stack(6), (6,))
    for i in range(4):
        for k in range(6):
            turned[i, k] = h[i, k]
        _turn(all_of[_TURNS + 2 * i], all_of[_TURNS + 2 * i + 1], turned[i])
    for e in range(4):
        d, own = all_of[6 * e : 6 * e + 6], change[6 * e : 6 * e + 6]
        lie.apply_tangent_inverse_minus(d, turned[_EDGES[e, 0]], g)
        lie.apply_tangent_inverse(d, turned[_EDGES[e, 1]], own)
        for k in range(6):
            own[k] -= g[k]
    for k in range(_MOTIONS, _SIZE):
        change[k] = 0.0


@frame_function
def _geometric(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    """As of a beam, edge by edge, in turned axes; then along the axes of the nodes."""
    all_of, N = numba.carray(y, (_SIZE,)), numba.carray(given, (_SIZE,))
    A, G = numba.carray(out, (4, 6, 4, 6)), numba.carray(stack(72), (2, 6, 6))
    unit, column = numba.carray(stack(6), (6,)), numba.carray(stack(6), (6,))
    row = numba.carray(stack(6), (6,))
    for e in range(4):
        d, f = all_of[6 * e : 6 * e + 6], N[6 * e : 6 * e + 6]
        lie.tangent_inverse_transposed_derivative_minus(d, f, G[0])
        lie.tangent_inverse_transposed_derivative(d, f, G[1])
        for other in range(2):
            j = _EDGES[e, other]
            for n in range(6):
                for k in range(6):
                    unit[k] = 1.0 if k == n else 0.0
                _turn(all_of[_TURNS + 2 * j], all_of[_TURNS + 2 * j + 1], unit)
                if other == 0:
                    lie.apply_tangent_inverse_minus(d, unit, column)
                else:
                    lie.apply_tangent_inverse(d, unit, column)
                sign = -1.0 if other == 0 else 1.0
                for side in range(2):
                    i = _EDGES[e, side]
                    for m in range(6):
                        row[m] = 0.0
                        for k in range(6):
                            row[m] += G[side, m, k] * column[k]
                    _turn(all_of[_TURNS + 2 * i], -all_of[_TURNS + 2 * i + 1], row)
                    for m in range(6):
                        A[i, m, j, n] += sign * row[m]


EDGE_MOTIONS = FrameMap(
    coordinates=_coordinates,
    pull_back=_pull,
    push_forward=_push,
    geometric=_geometric,
    values=12,
    unknowns=6,
)
"""Relative motions of the four edges of a cell, (24,), and the constant turns of its nodes."""


@dataclass(frozen=True)
class GeodesicShell(ShellFormulation):
    """Four-node quadrilateral whose edges are geodesics of SE(3), with drilling rotations.

    Pure bending of a plate is exact in one element, rotation and position, up to 180°. Nodes have
    whole frames, so that beams and joints need nothing else.

    Example:
        >>> layer = fl.ShellSection.layer(0.01, fl.Material(2.1e11, 0.3, 7800.0))
        >>> strip = fl.mesh.parametric_surface(lambda a, b: (a, 0.1 * b, 0.0), (1, 1))
        >>> shell = fl.Shell(strip, layer, formulation=fl.elements.GeodesicShell())
        >>> shell.model.has_drilling()
        True
    """

    whole_frames: ClassVar[bool] = True

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """Quadrature and limits of rotations of four-node quadrilaterals."""
        return _MEASURES

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent of the relative motions of all edges."""
        nodal = cells.frames
        V = nodal.function.function_space
        frames = nodal.frames[V.dofmap.list]
        turns = _turns(frames, cells.axes)
        turned = _turned(frames, turns)
        d0 = lie.se3_relative(
            turned[:, _EDGES[:, 0]].reshape(-1, 4, 3), turned[:, _EDGES[:, 1]].reshape(-1, 4, 3)
        ).reshape(-1, _MOTIONS)
        y = cells.cellwise(np.concatenate([d0, turns.reshape(-1, 8)], axis=1))
        unloaded = cells.cellwise(d0)
        J = ufl.as_matrix([[g[0], g[1]] for g in _along(unloaded, cells.point)])
        inverse = cells.at_points(ufl.inv(J))
        weight = cells.at_points(ufl.det(J) / ufl.det(cells.jacobian_at_points))
        G = [
            now - then
            for now, then in zip(_along(y, cells.point), _along(unloaded, cells.point), strict=True)
        ]
        D = cells.cellwise(_with_drilling(stiffness))
        energy = StrainEnergy(
            strain=_strain([inverse[i, 0] * G[0] + inverse[i, 1] * G[1] for i in (0, 1)]),
            law=lambda e: 0.5 * ufl.inner(e, D * e),
            dx=cells.dx,
            weight=weight,
        )
        return LocalFrameForms(energy, nodal.function, nodal.increment, EDGE_MOTIONS, coordinates=y)


_MEASURES = {("quadrilateral", 1): replace(MITC4, largest_turn=pi)}


def _turns(frames: Array, axes: Array) -> Array:
    """Cosine and sine of the turn of each node's first axis to that of the cell, (m, 4, 2)."""
    along = np.einsum("mnkj,mj->mnk", frames[:, :, 1:3], axes)
    return np.asarray(along / np.linalg.norm(along, axis=2, keepdims=True))


def _turned(frames: Array, turns: Array) -> Array:
    """Frames turned about their third axes, (m, 4, 4, 3)."""
    out, (c, s) = frames.copy(), np.moveaxis(turns, 2, 0)[..., np.newaxis]
    out[:, :, 1] = c * frames[:, :, 1] + s * frames[:, :, 2]
    out[:, :, 2] = c * frames[:, :, 2] - s * frames[:, :, 1]
    return out


def _along(d: fem.Function, point: tuple[Expr, Expr]) -> list[Expr]:
    """Relative motions along ξ and along η at a point, shape (6,) each."""
    ξ, η = point
    edge = [ufl.as_vector([d[6 * e + k] for k in range(6)]) for e in range(4)]
    return [(1 - η) * edge[0] + η * edge[1], (1 - ξ) * edge[2] + ξ * edge[3]]


def _strain(g: list[Expr]) -> Expr:
    """The eight strains, the drilling strain and the curvatures in the surface, shape (11,)."""
    a, b = g
    membrane = [a[0], b[1], a[1] + b[0]]
    bending = [a[4], -b[3], b[4] - a[3]]
    return ufl.as_vector([*membrane, *bending, a[2], b[2], a[1] - b[0], a[5], b[5]])


def _with_drilling(stiffness: Array) -> Array:
    """Section stiffness with that of drilling strain and of curvatures, shape (m, 11, 11)."""
    D = np.zeros((len(stiffness), 11, 11))
    D[:, :8, :8] = stiffness
    D[:, 8, 8] = stiffness[:, MEMBRANE_SHEAR, MEMBRANE_SHEAR]
    D[:, 9, 9] = D[:, 10, 10] = stiffness[:, TWIST, TWIST]
    return D

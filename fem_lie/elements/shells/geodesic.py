"""Four-node shell whose edges are geodesics of SE(3): pure bending is exact in one element.

The frames of a cell's nodes, turned about their directors so that their first axes are along the
first axis of the cell, are ``H_a``. The flat coordinates are the relative motions of the nodes of
each edge, ``d = log(H_a⁻¹ H_b) = (u, θ)``, as of :mod:`fem_lie.elements.beams.geodesic`: an edge is
an arc of the length of ``u``, not its chord. With ``Δ = d − d₀`` of the edges along ξ and η::

    G₁ = (1 − η) Δ₀₁ + η Δ₂₃,    G₂ = (1 − ξ) Δ₀₂ + ξ Δ₁₃,    (Γᵢ, κᵢ) = (J⁻¹)ᵢα Gα

``J`` is made of ``u₀`` of the edges in the same way, so that arcs of the unloaded surface have
their length, too. The strains are::

    E = (Γ₁·e₁, Γ₂·e₂, Γ₁·e₂ + Γ₂·e₁)    K = (κ₁·e₂, −κ₂·e₁, κ₂·e₂ − κ₁·e₁)    γᵢ = Γᵢ·e₃
    c = Γ₁·e₂ − Γ₂·e₁                     Δκᵢ·e₃

Membrane strain, shear and curvature along an edge are those of the edge: nothing locks, and states
of constant strain are exact on distorted cells. As in :class:`HellingerReissner` elements, a cell
has a stress field of 14 parameters. Strains are linear in ``Δ``, so that it is condensed once, and
the energy of a cell is a constant quadratic form of ``Δ``.

The drilling strain ``c`` has the stiffness ``G t`` of membrane shear. Without the last two, nodes
that rotate alternately about their directors, by ±θ, would have no strain: ``Δκ``, the changes of
``κ`` within a cell of area A, have the stiffness ``0.005 G t A``. In such a rotation edges are
arcs, longer by ``θ²/6``, on which compressive forces do work: it buckles at a membrane strain of
about −1.5 %, whatever the thickness and the size of the cells. Bending in the plane, and any other
state of constant strain, has no part of this stiffness.

Strains depend on the relative motion of frames only, and do not change in any rigid motion.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar, NamedTuple

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
from fem_lie.elements.shells.drilling import MEMBRANE_SHEAR
from fem_lie.elements.shells.element import ShellFormulation
from fem_lie.elements.shells.measures import MITC4, StrainMeasures
from fem_lie.elements.shells.stress_modes import QUADRILATERAL
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.kernels.addresses import FrameMap, Pointer, frame_function
from fem_lie.forms.local_forms import LocalFrameForms

_EDGES = np.array(EDGES)
_MOTIONS, _TURNS, _SIZE = 24, 24, 32
"""Number of relative motions; where cosines and sines of the nodes' turns begin; size."""
_FIELD = 14
"""Number of parameters of the stress field."""
_ALTERNATING = 0.005
"""Stiffness of the changes of ``κᵢ·e₃`` within a cell, over that of membrane shear and its area."""


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
        frames = nodal.frames[nodal.function.function_space.dofmap.list]
        turns = _turns(frames, cells.axes)
        d0 = _edge_motions(frames, turns)
        y = cells.cellwise(np.concatenate([d0, turns.reshape(-1, 8)], axis=1))
        unloaded = cells.cellwise(d0)
        K = cells.cellwise(Edges.of(d0).stiffness(stiffness))
        mesh = nodal.function.function_space.mesh
        energy = StrainEnergy(
            strain=ufl.as_vector([y[k] - unloaded[k] for k in range(_MOTIONS)]),
            law=lambda Δ: 0.5 * ufl.inner(Δ, K * Δ),
            dx=ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 0}),
            weight=1.0 / ufl.det(cells.jacobian),  # one point, at the centre of the unit square
        )
        state = nodal.function, nodal.increment, EDGE_MOTIONS
        return LocalFrameForms(energy, *state, coordinates=y, relaxation=cells.relaxation)

    def stress(self, cells: ShellCells, forms: LocalFrameForms, stiffness: Array) -> Expr:
        """Stress resultants ``(N, M, Q)`` of the stress field of a cell, shape (8,)."""
        nodal, forces = cells.frames, forms.stress
        assert forces is not None
        frames = nodal.frames[nodal.function.function_space.dofmap.list]
        edges = Edges.of(_edge_motions(frames, _turns(frames, cells.axes)))
        # the same numbers, constant in each cell instead of at its only point
        constant = cells.cellwise(np.zeros((len(frames), _MOTIONS))).function_space
        forces = fem.Function(constant, x=forces.x)
        parameters = cells.cellwise(edges.parameters(stiffness)) * forces
        centroid, J = cells.cellwise(edges.centroid), cells.cellwise(edges.centre)
        return QUADRILATERAL.field([*parameters], cells.point, centroid, J)


_MEASURES = {("quadrilateral", 1): replace(MITC4, largest_turn=pi)}


def _turns(frames: Array, axes: Array) -> Array:
    """Cosine and sine of the turn of each node's first axis to that of the cell, (m, 4, 2)."""
    along = np.einsum("mnkj,mj->mnk", frames[:, :, 1:3], axes)
    return np.asarray(along / np.linalg.norm(along, axis=2, keepdims=True))


def _edge_motions(frames: Array, turns: Array) -> Array:
    """Relative motions of the edges of all cells, in axes of the cells, (m, 24)."""
    turned, (c, s) = frames.copy(), np.moveaxis(turns, 2, 0)[..., np.newaxis]
    turned[:, :, 1] = c * frames[:, :, 1] + s * frames[:, :, 2]
    turned[:, :, 2] = c * frames[:, :, 2] - s * frames[:, :, 1]
    ends = (turned[:, _EDGES[:, side]].reshape(-1, 4, 3) for side in (0, 1))
    return lie.se3_relative(*ends).reshape(-1, _MOTIONS)


class Edges(NamedTuple):
    """Geometry of cells from their edges, at four quadrature points.

    Attributes:
        points: Reference coordinates of the points, (4, 2).
        weights: Areas of the points, (m, 4).
        inverse: Inverse Jacobians, (m, 4, 2, 2).
        centre: Jacobians of the centres, (m, 2, 2).
        centroid: Reference coordinates of the centroids, (m, 2).
    """

    points: Array
    weights: Array
    inverse: Array
    centre: Array
    centroid: Array

    @classmethod
    def of(cls, d0: Array) -> Edges:
        """Geometry from the unloaded relative motions of the edges, (m, 24)."""
        u = d0.reshape(-1, 4, 6)[:, :, :2]
        J = np.einsum("pae,mek->mpak", _along(_POINTS), u)
        area = np.linalg.det(J)
        centroid = np.einsum("mp,pk->mk", area, _POINTS) / area.sum(axis=1, keepdims=True)
        centre = np.einsum("pae,mek->mpak", _along(np.array([[0.5, 0.5]])), u)[:, 0]
        return cls(_POINTS, 0.25 * area, np.linalg.inv(J), centre, centroid)

    @property
    def _gradients(self) -> Array:
        """``(Γᵢ, κᵢ)`` at the points, of relative motions of the edges, (m, 4, 2, 6, 24)."""
        found = np.einsum("mpia,pae,kl->mpikel", self.inverse, _along(self.points), np.eye(6))
        return found.reshape(*found.shape[:4], _MOTIONS)

    @property
    def _modes(self) -> Array:
        """Stress resultants at the points of the 14 parameters of a cell, (m, 4, 8, 14)."""
        m, J = len(self.centre), self.centre
        ξ, η = np.moveaxis(self.points - self.centroid[:, np.newaxis], 2, 0)
        P = np.zeros((m, 4, 8, _FIELD))
        for first, columns in ((0, 0), (3, 5)):
            for k, (i, j) in enumerate(((0, 0), (1, 1), (0, 1))):
                P[:, :, first + k, columns + k] = 1.0
                P[:, :, first + k, columns + 3] = η * (J[:, 0, i] * J[:, 0, j])[:, np.newaxis]
                P[:, :, first + k, columns + 4] = ξ * (J[:, 1, i] * J[:, 1, j])[:, np.newaxis]
        for i in (0, 1):
            P[:, :, 6 + i, 10 + i] = 1.0
            P[:, :, 6 + i, 12] = η * J[:, 0, i, np.newaxis]
            P[:, :, 6 + i, 13] = ξ * J[:, 1, i, np.newaxis]
        return P

    def stiffness(self, section: Array) -> Array:
        """Stiffness of a cell in relative motions of its edges, (m, 24, 24).

        Args:
            section: Section stiffness of each cell, (m, 8, 8).
        """
        a, b = np.moveaxis(self._gradients, 2, 0)
        B, S = self._work(), self._stiffness_of_field(section)
        G, areas = section[:, MEMBRANE_SHEAR, MEMBRANE_SHEAR], self.weights.sum(axis=1)
        K = np.einsum("mji,mjk,mkl->mil", B, S, B, optimize=True)
        drilling = [(G, a[:, :, 1] - b[:, :, 0])]
        drilling += [(_ALTERNATING * G * areas, self._deviation(k[:, :, 5])) for k in (a, b)]
        for k, c in drilling:
            K += np.einsum("m,mp,mpi,mpj->mij", k, self.weights, c, c, optimize=True)
        return K

    def _deviation(self, values: Array) -> Array:
        """Values at the points (m, 4, k) less their means over the cells."""
        mean = np.einsum("mp,mpk->mk", self.weights, values) / self.weights.sum(axis=1)[:, None]
        return np.asarray(values - mean[:, np.newaxis])

    def parameters(self, section: Array) -> Array:
        """Parameters of the stress field per force conjugate to relative motions, (m, 14, 24).

        Args:
            section: Section stiffness of each cell, (m, 8, 8).
        """
        K = self.stiffness(section)
        # membrane and bending stiffness differ by (L/t)², which digits of the inverse would pay for
        scale = 1.0 / np.sqrt(np.diagonal(K, axis1=1, axis2=2))
        inverse = np.linalg.pinv(
            scale[:, :, np.newaxis] * K * scale[:, np.newaxis], rcond=1e-12, hermitian=True
        )
        work = self._work() * scale[:, np.newaxis]
        return self._stiffness_of_field(section) @ work @ inverse * scale[:, np.newaxis]

    def _work(self) -> Array:
        """Strains that do work on the parameters, per relative motion of the edges, (m, 14, 24)."""
        a, b = np.moveaxis(self._gradients, 2, 0)
        membrane = [a[:, :, 0], b[:, :, 1], a[:, :, 1] + b[:, :, 0]]
        bending = [a[:, :, 4], -b[:, :, 3], b[:, :, 4] - a[:, :, 3]]
        ε = np.stack([*membrane, *bending, a[:, :, 2], b[:, :, 2]], axis=2)
        return np.einsum("mp,mpij,mpik->mjk", self.weights, self._modes, ε, optimize=True)

    def _stiffness_of_field(self, section: Array) -> Array:
        """Parameters of the stress field per strain that does work on them, (m, 14, 14)."""
        P, C = self._modes, np.linalg.inv(section)
        flexibility = np.einsum("mp,mpij,mik,mpkl->mjl", self.weights, P, C, P, optimize=True)
        return np.asarray(np.linalg.inv(flexibility))


_SIDE = 0.5 / np.sqrt(3.0)
_POINTS = 0.5 + _SIDE * np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])


def _along(points: Array) -> Array:
    """Weights of the edges in the motions along ξ and η at points (p, 2), shape (p, 2, 4)."""
    ξ, η = points.T
    out = np.zeros((len(points), 2, 4))
    out[:, 0, 0], out[:, 0, 1] = 1.0 - η, η
    out[:, 1, 2], out[:, 1, 3] = 1.0 - ξ, ξ
    return out

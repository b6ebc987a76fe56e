"""Residual error estimates: residuals of equilibrium in elements, and stress jumps between them.

*Boundary layers along edges of plates and shells*, which are as wide as the thickness and not
resolved by cells. Where no couple about its normal acts on an edge, the twisting moment ``M_ντ``
vanishes there. In a thin shell this happens within a layer of the width ``λ = √(B/S)``, with the
twisting stiffness B and the shear stiffness S, t/√10 for a homogeneous section: ``M = m exp(−x/λ)``
and ``Q = M′``. Cells that are wider have some ``M_ντ = m`` at the edge instead. The error per
length of the edge is::

    ∫ M²/B + Q²/S dx = m² λ / B

(D. N. Arnold & R. S. Falk, SIAM J. Numer. Anal. 27 (1990) 281, on the layer.) Cells of a size h,
``z = h/λ``, represent a part of it. Linear elements for rotations across the edge have the energy
of the layer times ``1/√(1 + z²/12)``, by their difference equation, and the rest is missing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import basix
import numpy as np
from numpy.polynomial import legendre
from scipy.sparse import csr_matrix

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adaptivity.estimates.cut import border_shares
from fem_lie.adaptivity.estimates.estimate import ElementErrors, ErrorEstimate, Estimator
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.surfaces import KINK_ANGLE
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.element_forces import neighbours
from fem_lie.results.stresses.nodal_values import axes_along, extrapolation, slopes_along, unit
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.results.stresses.shell_stress import (
    ShellStress,
    StressPoints,
    between,
    integration,
    rotated,
)
from fem_lie.scene import Scene

_TWIST, _SHEAR = 5, 6  # indices of stress components along an edge
_ACROSS = {"quadrilateral": 1.0, "triangle": 2.0}  # size across an edge, over area per length


@dataclass(frozen=True, eq=False)
class EdgeLayers:
    """State-independent data of the boundary layers at b edges without a neighbour.

    Attributes:
        edges: Numbers (m c) of the edges, shape (b,).
        sides: 1 where the second axis of the edge points outward, −1 elsewhere, shape (b,).
        couples: Matrix from stress at the integration points, (m g 8,), to the couple per length
            about the normal on the edge, shape (b, m g 8).
        factors: Length of the edge times ``λ/B``, zero at corners, over the square of the part of
            m that the cell has, shape (b,).
        ratios: Size of the cell across the edge over λ, shape (b,).
    """

    edges: Indices
    sides: Array
    couples: csr_matrix
    factors: Array
    ratios: Array

    @classmethod
    def of(
        cls, shell: Shell, positions: StressPoints, ends: Indices, edges: Indices, turns: Array
    ) -> EdgeLayers:
        """Boundary layers of a shell.

        Args:
            shell: The shell.
            positions: Points at which its stress is evaluated.
            ends: Both ends of the c edges of a cell, as local nodes, shape (c, 2).
            edges: Numbers (m c) of the edges without a neighbour.
            turns: Rotation of stress from axes of the sections to axes of the edges, shape (m, c,
                8, 8).
        """
        mesh, c = shell.model.cut_mesh, len(ends)
        cell, side = np.divmod(edges, c)
        nodes, x = mesh.cells[cell], mesh.points
        pair = np.take_along_axis(nodes, ends[side], axis=1)
        pair.sort(axis=1)  # the direction of the axes
        along = x[pair[:, 1]] - x[pair[:, 0]]
        length = np.linalg.norm(along, axis=1)
        along /= length[:, np.newaxis]
        outward = x[pair].mean(axis=1) - x[nodes].mean(axis=1)
        second = np.cross(mesh.normals[cell].mean(axis=1), along)
        sides = np.sign(np.einsum("bj,bj->b", second, outward))
        number = np.take_along_axis(positions.patches.number[cell], ends[side], axis=1)
        share, straight = border_shares(number, along, length)
        weight = np.divide(straight, share, out=np.zeros_like(share), where=straight > 0)
        weight /= np.maximum(straight.sum(axis=1, keepdims=True), 1.0)
        couples = sum(
            _couples(shell, positions, number[:, k], along, weight[:, k]) for k in range(2)
        )
        turn = turns[cell, side]
        D = turn @ shell.model.stiffness[cell] @ np.swapaxes(turn, 1, 2)
        twist, shear = D[:, _TWIST, _TWIST], D[:, _SHEAR, _SHEAR]
        factors = length * straight.any(axis=1) / np.sqrt(twist * shear)
        across = positions.areas[cell].sum(axis=1) / length * _ACROSS[mesh.cell]
        ratios = across * np.sqrt(shear / twist)
        return cls(edges, sides, couples, factors / _represented(ratios) ** 2, ratios)

    def squares(
        self, stress: Array, at_edges: Array, jumps: Array, missing: Callable[[Array], Array]
    ) -> Array:
        """Squared errors of boundary layers, in addition to those of jumps, shape (m,).

        Args:
            stress: Stress at the integration points, shape (m, g, 8).
            at_edges: Stress at the midpoints of edges, in their axes, shape (m, c, 8).
            jumps: Stress jumps at the midpoints, shape (m, c, 8).
            missing: Part of the energy of a layer that is an error, of ``ratios``.
        """
        m, c = at_edges.shape[:2]
        cell = self.edges // c
        own = self.sides * at_edges.reshape(-1, 8)[self.edges, _TWIST]
        missed = np.abs(own - self.couples @ stress.ravel())
        smooth = 0.5 * np.abs(jumps[cell, :, _TWIST]).max(axis=1)
        square = self.factors * missing(self.ratios) * np.maximum(missed - smooth, 0.0) ** 2
        return np.asarray(np.bincount(cell, square, minlength=m), dtype=np.float64)


def unresolved(ratio: Array) -> Array:
    """Part of the energy of a boundary layer that cells do not represent.

    Args:
        ratio: Size of the cells over the width of the layer.
    """
    return np.asarray(1.0 - 1.0 / np.sqrt(1.0 + ratio**2 / 12.0))


def _represented(ratio: Array) -> Array:
    """Part of m that the twisting moment of the cell at the edge has.

    With ``c = z²/6`` the rotations of successive nodes have the ratio r.
    """
    c = ratio**2 / 6.0
    stiffness = np.sqrt(3.0 * c**2 + 6.0 * c)
    r = (1.0 - c) / (1.0 + 2.0 * c + stiffness)
    return np.asarray(1.0 - (1.0 - r) / stiffness)


def _couples(
    shell: Shell, positions: StressPoints, number: Indices, along: Array, weight: Array
) -> csr_matrix:
    """``∫ M_ij N,i τ_j + Q_i τ_i N`` with the shape function N of one end of an edge, weighted."""
    m, k = positions.patches.number.shape
    g = positions.areas.shape[1]
    corner = np.argsort(positions.patches.number.ravel(), kind="stable")
    sorted_ = positions.patches.number.ravel()[corner]
    first, last = np.searchsorted(sorted_, number), np.searchsorted(sorted_, number, "right")
    row = np.repeat(np.arange(len(number)), last - first)
    offset = np.arange(len(row)) - np.repeat(np.cumsum(last - first) - (last - first), last - first)
    cell, node = np.divmod(corner[first[row] + offset], k)
    mesh = shell.model.cut_mesh
    tangents = positions.points.tangents(mesh.points[mesh.cells])[cell]
    slopes = np.broadcast_to(
        np.moveaxis(positions.points.slopes[:, :, node], 2, 0).swapaxes(1, 2)[..., np.newaxis],
        (len(row), g, 2, 1),
    )
    N1, N2 = np.moveaxis(slopes_along(positions.section[cell], tangents, slopes)[..., 0], -1, 0)
    N = positions.points.shapes[:, node].T
    t1, t2 = np.einsum("pgij,pj->ipg", positions.section[cell][:, :, :2], along[row])
    found = np.stack([N1 * t1, N2 * t2, N1 * t2 + N2 * t1, N * t1, N * t2], axis=-1)
    found *= (positions.areas[cell] * weight[row][:, np.newaxis])[..., np.newaxis]
    columns = (cell[:, np.newaxis] * g + np.arange(g))[..., np.newaxis] * 8 + np.arange(3, 8)
    rows = np.broadcast_to(row[:, np.newaxis, np.newaxis], columns.shape)
    shape = (len(number), m * g * 8)
    return csr_matrix((found.ravel(), (rows.ravel(), columns.ravel())), shape=shape)


def beam_residual(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the residual of the balance of forces and moments in the frame of the section.

    The residual is::

        r = (N′ + κ × N + n,  M′ + κ × M + Γ × N + m)

    with the present strains Γ, κ including the tangent. The distributed loads n and m are recovered
    from the jumps of forces at nodes, divided by tributary length; they include inertia. At a node
    with a possible point force, the value of the other end is used.

    The stress of an element is exact at its g Gauss points, and its error is a multiple of the
    Legendre polynomial of degree g, ``τ′ = −r``. So the part of r of degree g − 1 is relevant, to
    which the derivative of the stress does not contribute. With its coefficient r̂::

        τ̂ = ℓ r̂ / (2 (2g − 1)),    η² = ℓ τ̂·D⁻¹τ̂ / (2g + 1),

    which is ``ℓ³ r·D⁻¹r / 12`` for one point. Jumps at nodes have no term of their own, because the
    error of the displacement vanishes at the nodes.

    Raises:
        ValueError: See :func:`~fem_lie.results.stresses.section_forces.section_forces`; or the
            energy of the element is not a strain energy.
    """
    found = section_forces(result, beam, scene, states=steps)
    return [_errors(found, k) for k in range(len(steps))]


def _errors(found: SectionForces, k: int) -> ElementErrors:
    beam, stress = found.beam, found.at_points(k)
    g, compliance = stress.shape[1], np.linalg.inv(beam.model.stiffness)
    x, w = legendre.leggauss(g)
    shape = legendre.legval(x, np.eye(g)[-1])
    balance = _turning(_rates(beam, found.frames[k], x), stress)
    residual = (g - 0.5) * np.einsum("q,q,mqb->mb", w, shape, balance)
    residual = residual + along_the_line(found, k, g - 1)
    missing = beam.model.lengths[:, np.newaxis] * residual / (2.0 * (2 * g - 1))
    squares = (
        np.einsum("mi,mij,mj->m", missing, compliance, missing) * beam.model.lengths / (2 * g + 1)
    )
    energy = np.einsum("q,mqi,mij,mqj,m->", 0.5 * w, stress, compliance, stress, beam.model.lengths)
    return ElementErrors(squares, float(energy))


def _turning(rates: Array, stress: Array) -> Array:
    """``(κ × N, κ × M + Γ × N)``, shape (m, q, 6)."""
    stretch, curvature, force = rates[..., :3], rates[..., 3:], stress[..., :3]
    moment = np.cross(curvature, stress[..., 3:]) + np.cross(stretch, force)
    return np.concatenate([np.cross(curvature, force), moment], axis=-1)


def _rates(beam: Beam, frames: Array, x: Array) -> Array:
    """``H⁻¹H′`` in undeformed arc length at points −1 ≤ x ≤ 1, shape (m, q, 6)."""
    ends, unloaded = frames[beam.model.elements], beam.frames[beam.model.elements]
    if beam.model.elements.shape[1] == 2:
        moved = lie.se3_relative(ends[:, 0], ends[:, 1]) / beam.model.lengths[:, np.newaxis]
        return np.repeat(moved[:, np.newaxis], len(x), axis=1)
    shapes = np.stack([0.5 * x * (x - 1), 0.5 * x * (x + 1), 1 - x * x], axis=1)
    slopes = np.stack([x - 0.5, x + 0.5, -2 * x], axis=1)
    arc = np.linalg.norm(np.einsum("qk,mkj->mqj", slopes, unloaded[:, :, 0]), axis=2)
    d = np.einsum("qk,mkij->mqij", shapes, ends[:, :, 1:])
    change = np.einsum("qk,mkij->mqij", slopes, ends)
    stretch = np.einsum("mqij,mqj->mqi", d, change[:, :, 0])
    turn = np.einsum("mqaj,mqbj->mqab", d, change[:, :, 1:])
    turn = 0.5 * (turn - np.swapaxes(turn, 2, 3))
    curvature = np.stack([turn[..., 2, 1], turn[..., 0, 2], turn[..., 1, 0]], axis=-1)
    # with orthonormal directors, as in the element
    E = 0.5 * (np.eye(3) - np.einsum("mqij,mqkj->mqik", d, d))
    stretch = stretch + np.einsum("mqij,mqj->mqi", E, stretch)
    trace = np.trace(E, axis1=2, axis2=3)[..., np.newaxis]
    curvature = curvature + trace * curvature - np.einsum("mqij,mqj->mqi", E, curvature)
    return np.asarray(np.concatenate([stretch, curvature], axis=-1) / arc[..., np.newaxis])


def along_the_line(found: SectionForces, k: int, degree: int) -> Array:
    """Distributed force and moment: the mean or, for degree 1, half of the change, shape (m, 6)."""
    beam = found.beam
    # what is viscous is no elastic stress
    ends = found.elements.at_ends(found.frames[k])
    shares = beam.model.line_quadrature().lengths
    before, behind = neighbours(beam.model.elements, found.single)
    carried = shares[before, 1] + shares[behind, 0]
    density = (ends[before, 1] - ends[behind, 0]) / carried[:, np.newaxis]
    known, count = np.zeros_like(ends), np.zeros((len(ends), 2))
    known[before, 1], known[behind, 0] = density, density
    count[before, 1], count[behind, 0] = 1.0, 1.0
    if degree == 0:
        each = np.maximum(count.sum(axis=1), 1.0)
        return np.asarray(known.sum(axis=1) / each[:, np.newaxis])
    both = count.min(axis=1, keepdims=True)
    return np.asarray(0.5 * both * (known[:, 1] - known[:, 0]))


_OPPOSITE = {"quadrilateral": (3, 2, 1, 0)}  # opposite edges in basix's order
_SHARE = {"quadrilateral": 1 / 24, "triangle": 1 / 12}
"""Factor of area times squared jump: exact where the error of the stress is linear."""


def shell_residual(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the stress jumps J at the midpoints of edges, in the axes of each edge.

    They are::

        η² = c A Σ_edges J·D⁻¹J,    c = 1/24 for quadrilaterals, 1/12 for triangles.

    In elements of first degree the jumps at edges dominate the residuals inside (C. Carstensen & R.
    Verfürth, SIAM J. Numer. Anal. 36 (1999) 1571). On regular meshes jumps give the error exactly
    (I. Babuška & D.-H. Yu, RAIRO 21 (1987)): c makes η the error for a solution of second degree,
    on rectangles, and on triangles with edges in three directions.

    In local frames the resultants of both sides are along axes that move with them, so jumps across
    a bend are meaningful, and rigid motion does not enter. At a border, at a kink or where the
    section changes, an edge has no neighbour; then the opposite edge counts twice, or on triangles
    the remaining edges count for all. The error of boundary layers is added, see
    :class:`EdgeLayers`.

    Raises:
        ValueError: The cells are not of degree 1, or have no common edges; the shell is not in that
            result, or there is no such state.
    """
    edges, stress = ShellEdges.of(shell), ShellStress.of(shell)
    edges.require_neighbours(shell.label)
    nodes = nodes_in(result.info, shell)
    return [edges.errors(stress(result.frames[step][nodes])) for step in steps]


@dataclass(frozen=True, eq=False)
class ShellEdges:
    """State-independent data of the edges of a shell.

    Attributes:
        to_edges: Interpolation from integration points to the midpoints of c edges, (c, g).
        turns: Rotation to the axes of the edges, shape (m, c, 8, 8).
        compliance: ``D⁻¹`` along these axes, shape (m, c, 8, 8).
        a: Number (m c) of the edge on one side of each common edge, shape (e,).
        b: Number on the other side.
        areas: Integration weights (areas), shape (m, g).
        shares: Factors of squared jumps, shape (m, c).
        plain: ``D⁻¹`` of each cell, shape (m, 8, 8).
        layers: Boundary layers of the edges without a neighbour.
    """

    to_edges: Array
    turns: Array
    compliance: Array
    a: Indices
    b: Indices
    areas: Array
    shares: Array
    plain: Array
    layers: EdgeLayers

    @classmethod
    def of(cls, shell: Shell) -> ShellEdges:
        """Data of a shell, computed once."""
        if shell not in _EDGES:
            _EDGES[shell] = cls._found(shell)
        return _EDGES[shell]

    @classmethod
    def _found(cls, shell: Shell) -> ShellEdges:
        mesh = shell.model.cut_mesh
        if mesh.degree != 1:
            raise ValueError(
                f"residual errors need cells of degree 1, those of {shell.label} are of degree "
                f"{mesh.degree}: use RecoveryEstimate()"
            )
        ends = np.array(basix.topology(basix.CellType[mesh.cell])[1], dtype=np.int64)
        positions = StressPoints.in_sections(shell, KINK_ANGLE)
        a, b = _common(positions.patches.number, ends)
        m, c = len(mesh.cells), len(ends)
        known = np.isin(np.arange(m * c), [a, b])
        shares = _shares(mesh.cell, known.reshape(m, c))
        turns = _turns(shell, ends)
        plain = np.asarray(np.linalg.inv(shell.model.stiffness), dtype=np.float64)
        inverse = np.linalg.inv(turns)
        compliance = np.einsum("mcki,mkl,mclj->mcij", inverse, plain, inverse)
        rule, _ = integration(shell)
        to_edges = extrapolation(mesh, rule)[ends].mean(axis=1)
        layers = EdgeLayers.of(shell, positions, ends, np.flatnonzero(~known), turns)
        return cls(to_edges, turns, compliance, a, b, positions.areas, shares, plain, layers)

    def require_neighbours(self, label: str) -> None:
        """Raise ``ValueError`` if a cell of a shell, named in the message, has no neighbour."""
        none = np.flatnonzero(~self.shares.any(axis=1))
        if len(none):
            raise ValueError(
                f"residual errors need cells with smooth neighbours, cell {none[0]} of {label} has "
                "none"
            )

    def _at_edges(self, stress: Array) -> tuple[Array, Array]:
        """Stress at the midpoints of the edges, in their axes, and its jumps, (m, c, 8)."""
        m, c = self.shares.shape
        at_edges = np.matmul(self.turns, (self.to_edges @ stress)[..., np.newaxis])[..., 0]
        flat, jumps = at_edges.reshape(m * c, 8), np.zeros((m * c, 8))
        jumps[self.a] = flat[self.b] - flat[self.a]
        jumps[self.b] = jumps[self.a]
        return at_edges, jumps.reshape(m, c, 8)

    def layer_squares(self, stress: Array, missing: Callable[[Array], Array] = unresolved) -> Array:
        """Squared errors of boundary layers, shape (m,), for stress as in :meth:`errors`."""
        return self.layers.squares(stress, *self._at_edges(stress), missing)

    def errors(self, stress: Array) -> ElementErrors:
        """Errors from stress at the integration points, in the axes of the sections, (m, g, 8)."""
        at_edges, jumps = self._at_edges(stress)
        rows = jumps[:, :, np.newaxis]
        squares = ((rows @ self.compliance) * rows).sum(axis=(2, 3))
        energy = ((stress @ self.plain) * stress).sum(axis=2)
        layers = self.layers.squares(stress, at_edges, jumps, unresolved)
        return ElementErrors(
            self.areas.sum(axis=1) * (squares * self.shares).sum(axis=1) + layers,
            float((energy * self.areas).sum()),
        )


_EDGES: WeakKeyDictionary[Shell, ShellEdges] = WeakKeyDictionary()


def _common(number: Indices, ends: Indices) -> tuple[Indices, Indices]:
    """Pairs of edges of cells (numbers in m c) between smooth neighbours."""
    pairs = np.sort(number[:, ends], axis=2).reshape(-1, 2)
    _, edge, met = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(edge.ravel(), kind="stable")
    twice = order[met[edge.ravel()[order]] == 2].reshape(-1, 2)
    return twice[:, 0], twice[:, 1]


def _shares(cell: str, known: Flags) -> Array:
    """Factor of each edge (m, c), where some have no neighbour."""
    if cell in _OPPOSITE:
        shares = known * (2.0 - known[:, _OPPOSITE[cell]])
    else:
        shares = known.astype(np.float64)
    total = shares.sum(axis=1, keepdims=True)
    scale = np.divide(known.shape[1], total, out=np.zeros_like(total), where=total > 0)
    return np.asarray(_SHARE[cell] * shares * scale)


def _turns(shell: Shell, ends: Indices) -> Array:
    """Rotation of components from the axes of the sections to those of edges, (m, c, 8, 8)."""
    mesh = shell.model.cut_mesh
    normals = unit(mesh.normals[:, ends].sum(axis=2))
    along = np.diff(mesh.points[mesh.cells[:, ends]], axis=2)[:, :, 0]
    # the same direction on both sides
    first, second = np.moveaxis(mesh.cells[:, ends], 2, 0)
    along[first > second] *= -1.0
    section = axes_along(normals, shell.model.axes[:, np.newaxis])
    cosine, sine = between(section, axes_along(normals, along))
    basis = rotated(np.eye(8), cosine[..., np.newaxis], sine[..., np.newaxis])
    return np.asarray(np.swapaxes(basis, 2, 3), dtype=np.float64)


@dataclass(frozen=True)
class ResidualEstimate(ErrorEstimate):
    """Error estimate from the residuals of equilibrium in local frames, with exact constants.

    For beams it is the residual of the balance within elements, for shells of first degree the
    stress jumps between cells; see :func:`~fem_lie.adaptivity.estimates.residual.beam_residual` and
    :func:`~fem_lie.adaptivity.estimates.residual.shell_residual`.

    Example:
        >>> found = fl.adaptivity.ResidualEstimate()
        >>> isinstance(found, fl.adaptivity.ErrorEstimate)
        True
    """

    def estimators(self) -> Mapping[type, Estimator]:
        """Functions for beams and shells."""
        return {Beam: beam_residual, Shell: shell_residual}

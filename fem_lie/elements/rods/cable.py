"""Cable element with positions and position gradients: cubic Hermite, axial and bending strain.

With the unstretched arc length ``s``, ``ε = |x′| − 1`` and ``κ = |x′ × x″|/|x′|²``, the rotation of
the tangent per unstretched length; naturally straight, without shear or torsion::

    W = ∫ ½ EA ε² ds + ∫ ½ EI κ² ds

The first term is integrated at three Lobatto points, the second at three Gauss points. In a slender
cable that bends without stretch, ``|x′|`` of a cubic cannot be one everywhere. It can be one at the
Lobatto points, two of which are the nodes, so that the element does not lock; with five Gauss
points it does. The direction of a free end without tension is determined by its bending stiffness
only. For compression see :mod:`.cable_law`.

(Gerstmayr & Irschik, *J. Sound Vib.* 318 (2008) 461: the strains; Gerstmayr & Shabana, *Nonlinear
Dyn.* 45 (2006) 109: reduced integration of the axial strain.)

Forces are hand-written, as the gradient of the energy in closed form. With the chord ``c`` over the
length, ``T = A + B`` and ``D = B − A`` of the end gradients ``A`` and ``B``, the first derivative
of the cubic and the second one times the length are, with ``σ`` from the midpoint::

    f = (3/2 − 6 σ²) c + (3 σ² − ¼) T + σ D,    g = D − σ (12 c − 6 T).

Axial strain is sampled at the Lobatto points, where ``f`` is ``A``, ``3/2 c − T/4`` and ``B``;
bending at the Gauss points, ``½ β |f × g|²/|f|⁴`` each, whose gradients are with ``ρ = f·g/|f|²``::

    ∂f = β/|f|² ((2 ρ² − |g|²/|f|²) f − ρ g),    ∂g = β/|f|² (g − ρ f).

UFL's code for the same takes six times as long. The small-energy kernel
(``docs/how_to/gradient_element.py``) takes 2.15 times as long for forces, which an explicit step
needs, 1.2 times for forces and energy, and half as long for forces and tangent.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import basix.ufl
import dolfinx
import numba
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie._arrays import Array, Indices, positive
from fem_lie._jit import callback, inlined
from fem_lie.attachments.at_nodes import along_tangent
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.elements.beams.element import (
    POINTS,
    WEIGHTS,
    BeamFormulation,
    CellData,
    LineShapes,
    cellwise,
)
from fem_lie.elements.rods.cable_law import (
    check_section,
    stress_over_stiffness,
    stretch_energy,
)
from fem_lie.forms.energy import Forces, StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, FrameMap, Pointer, frame_function
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie.node_types import (
    POSITION_GRADIENT,
    NodeType,
    axes,
    pull_back,
    pull_back_derivative,
    push_forward,
)
from fem_lie.lie.tuples import (
    Vector,
    combined,
    dot,
    load_row,
    minus,
    negative,
    plus,
    rotate_back,
    scaled,
)

_SIGMA = 0.5 * sqrt(0.6)

_LENGTH, _STRETCH_AT, _SPEED, _BENDING_AT, _SLACK, _SIZE = 24, 25, 28, 31, 34, 35

"""Offsets of the data of a cell, behind the coordinates of both nodes; and their number."""


def packed(lengths: Array, stiffness: Array, speeds: Array | None, slack: float | None) -> Array:
    """Data of each cell for the kernel, shape (m, 11).

    Args:
        lengths: Parameter length, negative if gradients point from the second end to the first,
            shape (m,).
        stiffness: Section stiffness, shape (m, 6, 6).
        speeds: Unstretched arc length per parameter at the points of both rules, in order, shape
            (m, 5), or ``None`` if it is one.
        slack: See :class:`~fem_lie.elements.HermiteCable`.
    """
    J = np.ones((len(lengths), 5)) if speeds is None else speeds
    EA, EI = (stiffness[:, k, k, np.newaxis] for k in (0, 4))
    along = lengths[:, np.newaxis]
    stretch = EA * np.abs(along) * np.array([1.0, 4.0, 1.0]) / 6
    bending = EI / np.abs(along) * np.array([5.0, 8.0, 5.0]) / 18 / J[:, 1:4]
    limit = np.full(len(along), -inf if slack is None else slack)
    return np.column_stack([lengths, stretch, 1 / J[:, ::2], bending, limit])


@inlined
def _stress(ε: float, slack: float) -> float:
    """Axial force over ``EA``; see :mod:`.cable_law`."""
    width, beyond = 0.5 * slack, ε - slack
    if ε > slack + width:
        return ε
    weak = slack / (1.0 + slack)
    between = 0.0 if beyond < -width else (beyond + width) ** 2 / (4.0 * width)
    return weak * (1.0 + ε) + (1.0 - weak) * between


@inlined
def _pulled(data: Array, k: int, f: Vector) -> Vector:
    """Gradient in the first derivative at the ``k``-th Lobatto point."""
    n = sqrt(dot(f, f))
    return scaled(data[_STRETCH_AT + k] * _stress(n * data[_SPEED + k] - 1.0, data[_SLACK]) / n, f)


@inlined
def _bent(data: Array, k: int, f: Vector, g: Vector) -> tuple[Vector, Vector]:
    """Gradients in the first and second derivative at the ``k``-th Gauss point."""
    inverse = 1.0 / dot(f, f)
    scale, ρ = data[_BENDING_AT + k] * inverse, dot(f, g) * inverse
    own = 2.0 * ρ * ρ - dot(g, g) * inverse
    return combined(scale * own, f, -scale * ρ, g), combined(scale, g, -scale * ρ, f)


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on positions and gradients of both nodes, along their axes."""
    H, data = numba.carray(w, (2, 4, 3)), numba.carray(w, (_SIZE,))
    out = numba.carray(A, (2, 6))
    first, last = load_row(H[0], 1), load_row(H[1], 1)
    inverse = 1.0 / data[_LENGTH]
    chord = scaled(inverse, minus(load_row(H[1], 0), load_row(H[0], 0)))
    T, D = plus(first, last), minus(last, first)
    middle = combined(1.5, chord, -0.25, T)
    P, Q = combined(0.6, chord, 0.2, T), scaled(_SIGMA, combined(12.0, chord, -6.0, T))
    side = scaled(_SIGMA, D)
    f1, g1 = _bent(data, 0, minus(P, side), plus(D, Q))
    f2, g2 = _bent(data, 1, middle, D)
    f3, g3 = _bent(data, 2, plus(P, side), minus(D, Q))
    f2, on_P = plus(f2, _pulled(data, 1, middle)), plus(f1, f3)
    on_Q = scaled(_SIGMA, minus(g1, g3))
    on_D = plus(combined(_SIGMA, minus(f3, f1), 1.0, g2), plus(g1, g3))
    on_T = combined(1.0, combined(0.2, on_P, -0.25, f2), -6.0, on_Q)
    on_chord = combined(1.0, combined(0.6, on_P, 1.5, f2), 12.0, on_Q)
    force = scaled(inverse, on_chord)
    slopes = (
        plus(minus(on_T, on_D), _pulled(data, 0, first)),
        plus(plus(on_T, on_D), _pulled(data, 2, last)),
    )
    forces = negative(force), force
    for i in range(2):
        e1, e2, e3 = axes(POSITION_GRADIENT, H[i])
        for j in range(3):
            out[i, j] += rotate_back(e1, e2, e3, forces[i])[j]
            out[i, 3 + j] += rotate_back(e1, e2, e3, slopes[i])[j]


_STRETCH, _BENDING = 0, 4
"""Indices of ``EA`` and ``EI`` in the section stiffness on (Γ, κ)."""
_THIN = 1e-12
"""Least relative metric of rotations; below it all of a cell is along one axis."""


@frame_function
def pull_back_vectors(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    """Forces on positions and gradients, along the axes of their nodes."""
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 4, 3))
    r = numba.carray(out, (nodes, 6))
    for i in range(nodes):
        pull_back(POSITION_GRADIENT, H[i], f[i], 1.0, r[i])


@frame_function
def push_forward_vectors(
    state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int
) -> None:
    """Increments of positions and gradients from those along nodal axes."""
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 6))
    rates = numba.carray(out, (nodes, 4, 3))
    for i in range(nodes):
        push_forward(POSITION_GRADIENT, H[i], h[i], rates[i])


@frame_function
def _geometric(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 4, 3))
    A = numba.carray(out, (nodes, 6, nodes, 6))
    for i in range(nodes):
        pull_back_derivative(POSITION_GRADIENT, H[i], f[i], 1.0, A[i, :, i])


_SLOPES = FrameMap(
    coordinates=None,
    pull_back=pull_back_vectors,
    push_forward=push_forward_vectors,
    geometric=_geometric,
    values=12,
    unknowns=6,
)
"""Map with position and gradient of each node, the first two of its four vectors."""


@dataclass(frozen=True)
class HermiteCable(BeamFormulation):
    """Cable element with two nodes that have a position and a position gradient.

    Attributes:
        degree: One: there are no nodes inside.
        slack: Strain below which it is a weak spring instead of resisting compression; default: it
            resists compression.

    Raises:
        ValueError: ``slack`` is not positive.
    """

    node_type = NodeType.POSITION_GRADIENT
    degree: int = 1
    slack: float | None = None

    def __post_init__(self) -> None:
        """Raise ``ValueError`` if ``slack`` is not positive, ``TypeError`` if no number."""
        if self.slack is not None:
            positive(self.slack, "HermiteCable: slack")

    @property
    def tension_only(self) -> bool:
        """Whether it is tension-only: with ``slack``."""
        return self.slack is not None

    def check(self, stiffness: Array) -> None:
        """Raise ``ValueError`` for coupled axial strain and bending, or unequal bending stiffness.

        Args:
            stiffness: Section stiffness, shape (6, 6).
        """
        check_section(stiffness)

    def placed(self, frames: Array, stretch: float) -> Array:
        """Coordinates whose gradients are as long as the ratio of line and cable."""
        coordinates = frames.copy()
        coordinates[:, 1] *= stretch
        return coordinates

    def attachment(self, node: int) -> AttachmentFrame:
        """Attachment frame with position and tangent, without rotation about the tangent.

        Args:
            node: Number of the node.
        """
        return along_tangent(node)

    def line_shapes(self, ends: Array, lengths: Array) -> LineShapes:
        """Cubics of positions and gradients at integration points.

        Args:
            ends: Coordinates of both ends, shape (m, 2, 4, 3).
            lengths: Parameter lengths of the cells, shape (m,).
        """
        speeds = self.speeds(ends, lengths, POINTS)
        return hermite_shapes(lengths, signs(ends), 1.0 if speeds is None else speeds)

    def speeds(self, ends: Array, lengths: Array, along: Array) -> Array | None:
        """Unstretched arc length per parameter, shape (m, p), or ``None`` if it is one.

        Args:
            ends: Unloaded coordinates of both ends of the cells, shape (m, 2, 4, 3).
            lengths: Parameter lengths of the cells, shape (m,).
            along: Parameters in a cell from 0 to 1, shape (p,).
        """
        return None

    def axial_strain(self, unloaded: Array, ends: Array, lengths: Array, along: Array) -> Array:
        """Axial force over ``EA``: the parabola through its values at the Lobatto points, (m, p).

        Args:
            unloaded: Unloaded coordinates of both ends of the cells, shape (m, 2, 4, 3).
            ends: Coordinates of the ends, shape (m, 2, 4, 3).
            lengths: Parameter lengths of the cells, shape (m,).
            along: Parameters in a cell from 0 to 1, shape (p,).
        """
        signed, sampled = signs(unloaded) * lengths, np.array([0.0, 0.5, 1.0])
        sizes = self.speeds(unloaded, lengths, sampled)
        stretch = np.linalg.norm(derivatives(ends, signed, sampled)[0], axis=-1)
        ε = stress_over_stiffness(stretch / (1.0 if sizes is None else sizes) - 1.0, self.slack)
        parabolas = np.array(
            [(1 - along) * (1 - 2 * along), 4 * along * (1 - along), along * (2 * along - 1)]
        )
        return np.asarray(ε @ parabolas)

    def curvature(self, unloaded: Array, ends: Array, lengths: Array, along: Array) -> Array:
        """Curvature, global components, shape (m, p, 3).

        Args:
            unloaded: Unloaded coordinates of both ends of the cells, shape (m, 2, 4, 3).
            ends: Coordinates of the ends, shape (m, 2, 4, 3).
            lengths: Parameter lengths of the cells, shape (m,).
            along: Parameters in a cell from 0 to 1, shape (p,).
        """
        at = self.speeds(unloaded, lengths, along)
        first, second = derivatives(ends, signs(unloaded) * lengths, along)
        κ = np.cross(first, second) / (first**2).sum(axis=-1, keepdims=True)
        return np.asarray(κ / (1.0 if at is None else at[..., np.newaxis]))

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent; only ``EA`` and ``EI`` are used."""
        mesh = nodal.function.function_space.mesh
        first, second, arms = _hermite(nodal, cells)
        EA, EI = (cellwise(mesh, cells.stiffness[:, k, k]) for k in (_STRETCH, _BENDING))
        squared = ufl.dot(first, first)
        stretch, turn = ufl.sqrt(squared), ufl.cross(first, second) / squared
        points, *rules = _both_rules()
        ends = nodal.frames[_nodes(nodal)]
        given = self.speeds(ends, cells.lengths, points[:, 0])
        reads = packed(signs(ends) * cells.lengths, cells.stiffness, given, self.slack)
        if given is not None:
            speed = _at_points(mesh, points, given)
            stretch, turn = stretch / speed, turn / speed
            rules = [weights * given for weights in rules]
        strain = [stretch - 1, *turn]
        shares = [_at_points(mesh, points, weights) for weights in rules]
        metadata = {
            "quadrature_rule": "custom",
            "quadrature_points": tuple((float(point),) for point in points.ravel()),
            "quadrature_weights": (1.0,) * len(points),
            "quadrature_degree": 5,
        }
        energy = _CableEnergy(
            strain=ufl.as_vector(strain),
            law=lambda ε: shares[0] * EA * stretch_energy(ε[0], self.slack)
            + 0.5 * shares[1] * EI * (ε[1] ** 2 + ε[2] ** 2 + ε[3] ** 2),
            dx=ufl.Measure("dx", mesh, metadata=metadata),
            viscosity=_viscosity(mesh, cells.viscosity, shares),
            weight=cellwise(mesh, cells.lengths) / ufl.CellVolume(mesh),
            forces=Forces(force_kernel, [cellwise(mesh, reads)]),
            arms=arms,
        )
        return LocalFrameForms(energy, nodal.function, nodal.increment, _SLOPES)

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Mass matrix of the interpolated line, ``∫ ρA Nᵢ Nⱼ ds``, without rotary inertia."""
        slopes = signs(nodal.frames[_nodes(nodal)]) * cells.lengths
        found = np.zeros((len(slopes), 2, 4, 2, 4))
        scale = np.stack([np.ones_like(slopes), slopes, np.ones_like(slopes), slopes], axis=1)
        weights = (cells.lengths * cells.density[:, 0, 0])[:, np.newaxis, np.newaxis]
        blocks = weights * scale[:, :, np.newaxis] * scale[:, np.newaxis] * _SQUARES
        found[:, :, :2, :, :2] = blocks.reshape(-1, 2, 2, 2, 2)
        return found


def _viscosity(
    mesh: dolfinx.mesh.Mesh, viscosity: Array | None, shares: list[fem.Function]
) -> Expr | None:
    """Viscosity on the rates of ``(ε, κ)``, each at the points of its rule."""
    if viscosity is None:
        return None
    stretch, bending = (
        share * cellwise(mesh, viscosity[:, k, k])
        for share, k in zip(shares, (_STRETCH, _BENDING), strict=True)
    )
    return ufl.diag(ufl.as_vector([stretch, bending, bending, bending]))


@dataclass(frozen=True)
class _CableEnergy(StrainEnergy):
    """Strain energy with its own quadrature points.

    Attributes:
        arms: Vectors that rotate with a cell: chord and gradients, scaled to its length.
    """

    arms: tuple[Expr, ...] = ()

    def rate(self, y: fem.Function, dy: fem.Function | ufl.Argument) -> Expr:
        """Strain rate; from the rate of curvature, a vector, the cell's rotation is removed."""
        spin, moments = ufl.as_vector([0.0] * 3), 0.0 * ufl.Identity(3)
        for arm in self.arms:
            spin += ufl.cross(arm, ufl.derivative(arm, y, dy))
            moments += ufl.dot(arm, arm) * ufl.Identity(3) - ufl.outer(arm, arm)
        # no spin about a straight line
        metric = moments + _THIN * ufl.tr(moments) * ufl.Identity(3)
        turned = ufl.cross(
            ufl.inv(metric) * spin, ufl.as_vector([self.strain[k] for k in (1, 2, 3)])
        )
        return self.change(y, dy) - ufl.as_vector([0.0, *turned])

    def quadrature_element(self) -> basix.ufl._ElementBase:
        """Quadrature element with the points of both rules."""
        points = np.array(self.dx.metadata()["quadrature_points"])
        return _element_of(points, self.strain.ufl_shape)


def _both_rules() -> tuple[Array, Array, Array]:
    """Points of the Lobatto and Gauss rules on (0, 1), shape (5, 1), and weights of each."""
    outer = 0.5 * np.sqrt(0.6)
    points = np.array([[0.0], [0.5 - outer], [0.5], [0.5 + outer], [1.0]])
    return points, np.array([1.0, 0, 4, 0, 1]) / 6, np.array([0.0, 5, 8, 5, 0]) / 18


def _element_of(points: Array, shape: tuple[int, ...]) -> basix.ufl._ElementBase:
    weights = np.ones(len(points))
    return basix.ufl.quadrature_element("interval", shape, points=points, weights=weights)


def _at_points(mesh: dolfinx.mesh.Mesh, points: Array, values: Array) -> fem.Function:
    """Values per cell as a function at the quadrature points."""
    f = fem.Function(fem.functionspace(mesh, _element_of(points, ())))
    f.x.array[f.function_space.dofmap.list] = values
    return f


_SQUARES = (
    np.array([[156.0, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
)
"""Integrals of products of the cubics of position and gradient of one end, then of the other."""


def _nodes(nodal: NodalFrames) -> Indices:
    """Both end nodes of each cell, shape (m, 2)."""
    return np.asarray(nodal.function.function_space.dofmap.list, dtype=np.int64)


def hermite_shapes(
    lengths: Array, sides: Array | float = 1.0, speeds: Array | float = 1.0
) -> LineShapes:
    """Cubics of positions and first gradients at integration points of m cells.

    Args:
        lengths: Parameter lengths, shape (m,).
        sides: Sign of each cell, see :func:`signs`, shape (m,).
        speeds: Unloaded length per parameter, shape (m, g).
    """
    ξ, slope = POINTS, (sides * lengths)[:, np.newaxis]
    positions = np.stack([(1 - ξ) ** 2 * (1 + 2 * ξ), ξ**2 * (3 - 2 * ξ)], axis=1)
    on_gradients = np.zeros((len(lengths), len(ξ), 2, 3))
    on_gradients[:, :, 0, 0] = slope * ξ * (1 - ξ) ** 2
    on_gradients[:, :, 1, 0] = slope * ξ**2 * (ξ - 1)
    weights = speeds * (lengths[:, np.newaxis] * WEIGHTS)
    return LineShapes(weights, np.broadcast_to(positions, on_gradients.shape[:3]), on_gradients)


def signs(ends: Array) -> Array:
    """Sign of each cell: 1 if gradients point from its first end to its second one, else −1.

    Args:
        ends: Rows of both ends, shape (m, 2, 4, 3).
    """
    a, b = ends.swapaxes(0, 1)
    return np.sign(np.einsum("mj,mj->m", b[:, 0] - a[:, 0], a[:, 1] + b[:, 1]))


def derivatives(ends: Array, lengths: Array, along: Array) -> tuple[Array, Array]:
    """``x′`` and ``x″`` of the cubics, shape (m, p, 3).

    Args:
        ends: Coordinates of both ends of the cells, shape (m, 2, 4, 3).
        lengths: Parameter lengths, with their :func:`signs`, shape (m,).
        along: Parameters in a cell from 0 to 1, shape (p,).
    """
    ξ, length = along[:, np.newaxis], lengths[:, np.newaxis, np.newaxis]
    (x0, x1), (a, b) = (ends[:, :, k].swapaxes(0, 1)[:, :, np.newaxis] for k in (0, 1))
    chord = (x1 - x0) / length
    first = 6 * ξ * (1 - ξ) * chord + (1 - 4 * ξ + 3 * ξ**2) * a + (3 * ξ**2 - 2 * ξ) * b
    second = 6 * (1 - 2 * ξ) * chord + (6 * ξ - 4) * a + (6 * ξ - 2) * b
    return first, second / length


def _hermite(nodal: NodalFrames, cells: CellData) -> tuple[Expr, Expr, tuple[Expr, ...]]:
    """``x′`` and ``x″`` of the Hermite cubic; chord and end gradients."""
    mesh = nodal.function.function_space.mesh
    space = fem.functionspace(mesh, ("DG", 1))
    along = fem.Function(space)
    along.x.array[space.dofmap.list] = [0.0, 1.0]
    ξ, length = along, cellwise(mesh, signs(nodal.frames[_nodes(nodal)]) * cells.lengths)
    chord, turn = (
        ufl.dot(ufl.grad(f), ufl.Jacobian(mesh)[:, 0]) for f in (nodal.position, nodal.directors[0])
    )
    a = nodal.directors[0] - ξ * turn
    b = a + turn
    first = 6 * ξ * (1 - ξ) * chord / length + (1 - 4 * ξ + 3 * ξ**2) * a + (3 * ξ**2 - 2 * ξ) * b
    second = 6 * (1 - 2 * ξ) * chord / length + (6 * ξ - 4) * a + (6 * ξ - 2) * b
    return first, second / length, (chord, length * a, length * b)

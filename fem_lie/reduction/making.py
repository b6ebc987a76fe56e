"""Reduced-order bodies for scenes, made from full bodies.

*Quadratic strains.* They represent how modes strain each other: tension stiffens bending, and
bending draws the ends together. The third derivative ``C`` of the full body's energy in modal
coordinates is computed by finite differences of its forces. Many energies ``½ eᵀ K e`` with
``e_a = z_a + ½ Q_abc z_b z_c`` have this derivative; they differ in which of three modes contains
the quadratic term. Slender bodies bend without stretching: with modes in which ``K`` and the matrix
of squared nodal *rotations* are diagonal, stretching is much stiffer than bending, and
``Q = C / (k_a + k_b + k_c)`` is the least ``Q`` that gives ``C``. (With mass instead of rotations,
short bending waves are as stiff as long stretching waves, and a soft cantilever bends by a fifth
too much at a tenth of its length.)

Third derivatives without the fourth would make slender bodies buckle by bending. With the fourth
derivatives of the full energy they would lock, because modes that shorten each part of a line as
its bending requires are not in the basis.

*Inertial modes.* Normal modes are completed by the static responses to inertia of rigid motion. A
few normal modes represent the motion well, but not the moments next to a fixed edge, to which all
modes contribute. The response to the body's own weight and to slow accelerations of its frame is
exact with one more mode for each, the static response to that load (E. L. Wilson, M.-W. Yuan & J.
M. Dickens, Earthq. Eng. Struct. Dyn. 10 (1982) 813).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.reduced.reduced_body import ReducedOrderBody
from fem_lie.lie.node_types import rigid_motions
from fem_lie.reduction.bases import interface_modes
from fem_lie.reduction.basis import Basis
from fem_lie.reduction.linearised import LinearisedBody
from fem_lie.scene import Scene
from fem_lie.system.equations import TimeState

_STRAIGHT = 1e-3  # weight of displacements over the body's size, relative to rotations
_STEP = 4e-3  # increment of a mode in differences, relative to the size of the body
_WEIGHTS = {1.0: 4.0 / 3.0, 2.0: -1.0 / 12.0}
"""Weights of ``f(k s) + f(−k s)`` in the second derivative along ``s``, of fourth order where
``f(0) = 0``. Second-order differences would leave 1e-8 of it in round-off or in higher terms, for
any step."""


def quadratic_strains(rest: LinearisedBody, frame: Array, mode_vectors: Array, K: Array) -> Array:
    """Coefficients ``Q`` (m, m, m) of quadratic strains.

    See :class:`~fem_lie.reduction.ReducedOrderBody`.

    Args:
        rest: The linearised full body.
        frame: Floating frame, (4, 3).
        mode_vectors: Displacement and rotation of all nodes in each mode, components along the
            frame, (m, n, 6).
        K: Stiffness in modal coordinates, (m, m).
    """
    C = _third_derivative(_Within(rest, frame, mode_vectors))
    flat = mode_vectors * np.repeat([_STRAIGHT / rest.body.model.size, 1.0], 3)
    k, V, back = _principal_modes(K, flat.reshape(len(flat), -1))
    own = np.einsum("abc,ai,bj,ck->ijk", C, V, V, V, optimize=True)
    own /= k[:, np.newaxis, np.newaxis] + k[:, np.newaxis] + k
    return np.asarray(np.einsum("ijk,ai,jb,kc->abc", own, V, back, back, optimize=True))


def _principal_modes(K: Array, rows: Array) -> tuple[Array, Array, Array]:
    """``k``, ``V`` and ``V⁻¹`` with ``VᵀKV = k`` and ``VᵀRV = 1``, ``R = rows rowsᵀ`` (m, m).

    Stretching is 1e8 times as stiff as bending in ``R``, so eight digits would be lost in its
    eigenvalues; the singular values of ``rows`` are their square roots.
    """
    L = np.linalg.cholesky(K)
    U, s, _ = np.linalg.svd(scipy.linalg.solve_triangular(L, rows, lower=True), full_matrices=False)
    V = scipy.linalg.solve_triangular(L, U / s, lower=True, trans="T")
    return 1.0 / s**2, np.asarray(V), (s[:, np.newaxis] * U.T) @ L.T


class _Within:
    """Forces of the full body with a fixed floating frame at the origin, for least round-off."""

    def __init__(self, rest: LinearisedBody, frame: Array, mode_vectors: Array) -> None:
        self._equations, body, leads = rest.equations, rest.body, rest.leads
        self._modes = mode_vectors[:, leads]
        self._inside = lie.se3_compose(lie.se3_inverse(frame), body.frames[leads])
        self._r = np.empty(self._equations.unknowns.size)
        self._still = np.zeros((len(leads), 6))
        reach = np.abs(mode_vectors * np.repeat([1.0, body.model.size], 3)).max(axis=(1, 2))
        self.steps = np.diag(_STEP * body.model.size / reach)

    def forces(self, z: Array) -> Array:
        """Forces on modal coordinates, (m,)."""
        h = np.einsum("m,mni->ni", z, self._modes)
        turned = lie.so3_exp(h[:, 3:])
        H = self._inside.copy()
        H[:, 0] += h[:, :3]
        H[:, 1:] = np.einsum("nij,nkj->nki", turned, H[:, 1:])
        axes = H[:, 1:].copy()
        frames = self._equations.start.frames.copy()
        frames[: len(H)] = H
        state = TimeState(frames, self._still, self._still, np.zeros(0))
        self._equations.residual(state, np.zeros(0), self._r)
        f = self._r.reshape(-1, 2, 3)
        force, moment = np.einsum("nki,nhk->hni", axes, f)
        moment = np.einsum("nij,ni->nj", lie.so3_tangent(-h[:, 3:]), moment)
        dual = np.concatenate([force, moment], axis=1)
        return np.asarray(np.einsum("mni,ni->m", self._modes, dual))


def _second_derivative(within: _Within, step: Array) -> Array:
    """Second derivative of the forces along ``step``, (m,)."""
    pairs = (w * (within.forces(k * step) + within.forces(-k * step)) for k, w in _WEIGHTS.items())
    return np.asarray(sum(pairs), dtype=np.float64)


def _third_derivative(within: _Within) -> Array:
    """Third derivative of the energy, (m, m, m), symmetric."""
    steps = within.steps
    m = len(steps)
    own = [_second_derivative(within, step) for step in steps]
    C: Array = np.empty((m, m, m))
    for b in range(m):
        C[:, b, b] = own[b]
        for c in range(b):
            both = _second_derivative(within, steps[b] + steps[c])
            C[:, b, c] = C[:, c, b] = 0.5 * (both - own[b] - own[c])
    sizes = steps.diagonal()
    C /= sizes[:, np.newaxis] * sizes
    return np.asarray((C + C.transpose(1, 2, 0) + C.transpose(2, 0, 1)) / 3.0, np.float64)


_NEW = 1e-10  # least squared relative norm of a mode orthogonal to the others


def inertial_modes(
    scene: Scene, interfaces: Sequence[Point], modes: int, *, spinning: bool = False
) -> Basis:
    """Modes with fixed interfaces: static responses to inertia, and vibration modes.

    They are the inner modes of a :func:`reduced_order_body`, whose response to weight and
    accelerations is then that of the full body. Modes have unit mass and are ordered by stiffness.

    Args:
        scene: The body alone, free to move, as for :func:`craig_bampton`.
        interfaces: Nodes at which joints, loads and the like will act.
        modes: Number of vibration modes, in addition to six responses to accelerations of
            translation and rotation.
        spinning: Whether to add the responses to centrifugal forces, six more for rotations about
            any axes; linearly dependent ones are omitted.

    Raises:
        ValueError: As for :func:`craig_bampton`.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> part, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = part.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=8, name="arm"))
        >>> ends = [beam.point("start"), beam.point("end")]
        >>> inner = fl.reduction.inertial_modes(part, ends, modes=4)
        >>> len(inner), len(fl.reduction.reduced_order_body(part, ends, inner).stiffness)
        (10, 16)
    """
    return answers_to_inertia(LinearisedBody(scene, None), interfaces, modes, spinning=spinning)


def answers_to_inertia(
    rest: LinearisedBody, interfaces: Sequence[Point], modes: int, *, spinning: bool = False
) -> Basis:
    """:func:`inertial_modes` for a linearised body."""
    normal = interface_modes(rest, interfaces, modes).modes[6 * len(interfaces) :]
    inside = rest.free.copy()
    inside[[rest.index_of(point.node) for point in interfaces]] = False
    inner = np.flatnonzero(inside[rest.free])
    K, M = rest.pencil.K.tocsc()[inner][:, inner], rest.pencil.M.tocsc()
    moved = _accelerations(rest.body, spinning)[:, rest.leads] / rest.weight
    loads = M @ moved[:, rest.free].T
    answers = rest.factor(inner).solve(loads[inner])
    X = np.hstack([answers, rest.unknowns_of(normal)[:, inner].T])
    M = M[inner][:, inner]
    sizes = np.sqrt(np.einsum("ij,ij->j", X, M @ X))
    X = X[:, sizes > 0.0] / sizes[sizes > 0.0]
    w, V = np.linalg.eigh(X.T @ (M @ X))
    new = w > _NEW
    X = X @ (V[:, new] / np.sqrt(w[new]))
    X = X @ scipy.linalg.eigh(X.T @ (K @ X))[1]
    vectors = np.zeros((X.shape[1], rest.pencil.K.shape[0]))
    vectors[:, inner] = X.T
    return Basis(rest.body, rest.modes_of(vectors))


def _accelerations(body: Body, spinning: bool) -> Array:
    """Accelerations of all nodes in their axes, (6 or 12, n, 6): rigid and centripetal."""
    middle = body.frames[:, 0].mean(axis=0)
    rigid = rigid_motions(body.model.node_types, body.frames, middle).transpose(2, 0, 1)
    if not spinning:
        return np.asarray(rigid)
    towards = np.zeros((6, len(body.frames), 6))
    for number, (i, j) in enumerate(zip(*np.triu_indices(3), strict=True)):
        S = np.zeros((3, 3))
        S[i, j] = S[j, i] = 1.0
        pulled = (body.frames[:, 0] - middle) @ S
        towards[number, :, :3] = np.einsum("nki,ni->nk", body.frames[:, 1:], pulled)
    return np.concatenate([rigid, towards])


_SIX = 6  # unknowns of a node


def reduced_order_body(
    scene: Scene,
    interfaces: Sequence[Point],
    modes: int | Basis,
    *,
    stretching: bool = True,
    name: str = "",
) -> ReducedOrderBody:
    """A reduced-order body, with the frame of its first interface as floating frame.

    Its modes are the interface modes of :func:`craig_bampton`, and inner modes: those of
    :func:`inertial_modes` or of another basis. The modes of the first interface are omitted,
    because together with the others they are rigid motions. Strains and rotations relative to the
    first interface must be small. For fast rotation use ``inertial_modes(…, spinning=True)``.

    Args:
        scene: The full body alone, free to move, without joints and loads.
        interfaces: Nodes at which joints, loads and the like will act; the first is the floating
            frame.
        modes: Number of vibration modes with fixed interfaces, in addition to six responses to
            inertia; or a basis of other inner modes, from which the interface modes are projected
            out.
        stretching: Whether to include quadratic strains, so that tension stiffens bending and
            bending draws the ends together; otherwise the stiffness is constant.
        name: Name of the new body; default: that of the full one.

    Raises:
        ValueError: There is no interface, the basis is of another body, the body has fixed degrees
            of freedom or damping, or as for :func:`craig_bampton`.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> part, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = part.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=8, name="arm"))
        >>> arm = fl.reduction.reduced_order_body(part, [beam.point("start"), beam.point("end")],
        ...     modes=6)
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> hinge = fl.joints.Revolute(fl.ground(), arm.point("start"), axis=(0, 1, 0))
        >>> _ = scene.add(arm), scene.add(hinge)
        >>> result = fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01)
        >>> fl.reduction.recover_full_motion(result, arm).position(beam.point(4)).shape
        (11, 3)
    """
    if not len(interfaces):
        raise ValueError(
            "reduced_order_body: interfaces: expected at least one, for the floating frame"
        )
    rest = LinearisedBody(scene, None)
    body = rest.body
    if not rest.free[:, :5].all():
        raise ValueError(
            f"{body.label} has fixed degrees of freedom: expected a free body, held by its "
            "interfaces"
        )
    if rest.pencil.C is not None:
        raise ValueError(f"{body.label} has damping, which reduced-order bodies do not support yet")
    mode_vectors = _mode_vectors(rest, interfaces, modes)
    nodes = [point.node for point in interfaces]
    V, K = rest.unknowns_of(mode_vectors), rest.pencil.K
    stiffness = V @ (K @ V.T)
    turn = _turn(body, nodes[0])
    along = np.einsum("nij,mnhj->mnhi", turn, mode_vectors.reshape(*mode_vectors.shape[:2], 2, 3))
    along = along.reshape(mode_vectors.shape)
    frame = body.frames[nodes[0]]
    density, quadratic = _density(rest, along, frame), None
    if stretching:
        quadratic = quadratic_strains(rest, frame, along, stiffness)
    points = {point.name: number for number, point in enumerate(interfaces)}
    label = name or body.name
    matrices = stiffness, density, along
    return ReducedOrderBody(nodes, *matrices, body, points=points, quadratic=quadratic, name=label)


def _mode_vectors(rest: LinearisedBody, interfaces: Sequence[Point], modes: int | Basis) -> Array:
    """Modes of the other interfaces, in axes of the first, and inner modes, in nodal axes."""
    body, nodes = rest.body, [point.node for point in interfaces]
    static: Array = interface_modes(rest, interfaces, 0).modes.reshape(len(nodes), _SIX, -1, _SIX)
    own = static[np.arange(len(nodes)), :, nodes].diagonal(axis1=1, axis2=2)
    static /= own[:, :, np.newaxis, np.newaxis].copy()
    within = modes if isinstance(modes, Basis) else answers_to_inertia(rest, interfaces, modes)
    if within.body is not body:
        raise ValueError(
            f"the basis belongs to {within.body.label}, which is not the body of the scene"
        )
    inner = within.modes - np.einsum("mik,iknj->mnj", within.modes[:, nodes], static)
    outer = np.einsum("iab,ibnj->ianj", turns(_turn(body, nodes[0])[nodes[1:]]), static[1:])
    return np.concatenate([outer.reshape(-1, *inner.shape[1:]), _scaled(inner, body.model.size)])


def _turn(body: Body, first: int) -> Array:
    """Rotations from the axes of all nodes to those of the first interface, (n, 3, 3)."""
    return np.asarray(body.frames[first, 1:] @ body.frames[:, 1:].swapaxes(1, 2))


def turns(R: Array) -> Array:
    """Block-diagonal rotations of twists, shape (n, 6, 6), for rotations (n, 3, 3)."""
    found = np.zeros((len(R), _SIX, _SIX))
    found[:, :3, :3] = found[:, 3:, 3:] = R
    return found


def _scaled(mode_vectors: Array, size: float) -> Array:
    """Modes scaled as nodal unknowns are: three times to a length, three times to an angle."""
    largest = np.abs(mode_vectors * np.repeat([1.0, size], 3)).max(axis=(1, 2))
    unit = np.where(np.arange(len(mode_vectors)) % _SIX < 3, 1.0, size)
    return np.asarray(mode_vectors * (unit / largest)[:, np.newaxis, np.newaxis])


def _density(rest: LinearisedBody, mode_vectors: Array, frame: Array) -> Array:
    """Mass matrix of ``(x, d_k, z_a d_k)``, in which the coordinates of all nodes are linear."""
    leads, m = rest.leads, len(mode_vectors)
    inside = lie.se3_compose(lie.se3_inverse(frame), rest.body.frames[leads])
    P = np.zeros((len(leads), 4, 4 + 3 * m))
    P[:, 0, 0] = 1.0
    P[:, :, 1:4] = inside
    own = mode_vectors[:, leads]
    P[:, 0, 4:] = own[:, :, :3].swapaxes(0, 1).reshape(len(leads), -1)
    for k in range(3):
        turned = np.cross(own[:, :, 3:], inside[:, 1 + k])
        P[:, 1 + k, 4:] = turned.swapaxes(0, 1).reshape(len(leads), -1)
    G = rest.inertia
    size = 4 * len(leads)
    mass = sp.bsr_matrix((G.blocks, G.indices, G.indptr), shape=(size, size))
    flat = P.reshape(size, -1)
    return np.asarray(flat.T @ (mass @ flat))

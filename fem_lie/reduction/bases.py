"""Reduction bases: POD, Krylov subspaces, Craig-Bampton modes, and modal derivatives.

*Krylov modes* represent the response to loads at given points, at low frequencies. With the vectors
``K⁻¹f, K⁻¹MK⁻¹f, …`` the response to a harmonic load matches the leading terms of its power series
in the squared frequency: as many as there are vectors for each load, and twice as many at the point
of the load (T.-J. Su & R. R. Craig, AIAA J. 29 (1991) 2121).

*Craig-Bampton modes* are interface modes and normal modes with fixed interfaces (R. R. Craig & M.
C. C. Bampton, AIAA J. 6 (1968) 1313). The matrices are those of nodal increments in local frames,
so that modes rotate with the body.

*Modal derivatives* are the second-order response to large amplitudes of modes, such as
foreshortening (S. R. Idelsohn & A. Cardona, Comput. Methods Appl. Mech. Engrg. 49 (1985) 253),
without inertia: ``K θᵢⱼ = −∂²f/∂ηᵢ∂ηⱼ``.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

import numpy as np
import numpy.typing as npt
import scipy.interpolate
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, instance, vector, whole
from fem_lie.bodies.body import Body, Point
from fem_lie.reduction.axes import Axes, MeanAxes, frames_of, local_motion
from fem_lie.reduction.basis import Basis
from fem_lie.reduction.linearised import LinearisedBody, ReducedForces
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.states import StateSeries
from fem_lie.scene import Scene


def pod(
    result: StateSeries | Sequence[StateSeries],
    body: Body | Sequence[Body],
    modes: int,
    *,
    axes: Axes | None = None,
) -> Basis:
    """Proper orthogonal decomposition (POD) of the local motion in all states of results.

    The modes are left singular vectors of the snapshots: displacements over the size of the body,
    and rotations. Several results, such as those of a body with other dimensions or loads, give one
    basis for all of them (global POD), in which each state has the same weight.

    Args:
        result: The states, or several results.
        body: A body of the scene, or the body of each result: all with as many nodes.
        modes: Number of modes.
        axes: Floating frame; default: :class:`MeanAxes`.

    Returns:
        A basis of the first body; see :meth:`Basis.transferred` for the others.

    Raises:
        ValueError: A result has no such body, the numbers of bodies and results differ, or there
            are fewer independent states than ``modes``.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> square = fl.Section.rectangle(0.02, 0.02, steel)
        >>> bodies, results = [], []
        >>> for length in (1.0, 2.0):
        ...     scene = fl.Scene()
        ...     beam = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), square, cells=8))
        ...     clamp = scene.add(fl.Clamp(beam.point("start")))
        ...     load = scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 100 / length**2)))
        ...     bodies.append(beam)
        ...     results.append(fl.statics(scene))
        >>> basis = fl.reduction.pod(results, bodies, 1, axes=fl.reduction.FixedAxes())
        >>> len(basis.transferred(bodies[1]))
        1
    """
    whole(modes, "modes")
    results = [result] if isinstance(result, StateSeries) else list(result)
    bodies = [body] * len(results) if isinstance(body, Body) else list(body)
    if not results or len(results) != len(bodies):
        raise ValueError(
            f"pod: expected a body for each result, got {len(results)} results and {len(bodies)} "
            "bodies"
        )
    snapshots = []
    for states, each in zip(results, bodies, strict=True):
        _check_nodes(bodies[0], each)
        frames = frames_of(states, each)
        motion = local_motion(each, frames, MeanAxes() if axes is None else axes)
        snapshots.append((motion.increments / _dimensions(each)).reshape(len(frames), -1))
    _, sizes, mode_vectors = np.linalg.svd(np.concatenate(snapshots), full_matrices=False)
    rank = int((sizes > 1e-12).sum())
    if modes > rank:
        raise ValueError(
            f"modes must be at most {rank}, the number of independent states of {bodies[0].label} "
            f"in the result, got {modes}"
        )
    return _unit_basis(bodies[0], mode_vectors[:modes])


def interpolated_basis(
    bases: Sequence[Basis], parameters: npt.ArrayLike, at: npt.ArrayLike, body: Body | None = None
) -> Basis:
    """Basis at other parameters, between bases that were computed at some.

    Interpolated are the subspaces, not the modes, whose order and signs are arbitrary: in the
    tangent space of the Grassmann manifold at the nearest one (D. Amsallem & C. Farhat, AIAA J. 46
    (2008) 1803), by cubic radial functions, which are splines for one parameter.

    Args:
        bases: Bases with as many modes, of bodies with as many nodes.
        parameters: Parameters of each, shape (k, p), or (k,) for one parameter.
        at: Parameters at which a basis is wanted, shape (p,), or a number.
        body: The body there; default: that of the nearest basis.

    Raises:
        ValueError: Shapes differ, there are fewer than p + 1 bases, their parameters lie in a line
            or plane, or two subspaces are nearly orthogonal.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> square, lengths, bases = fl.Section.rectangle(0.02, 0.02, steel), (1.0, 1.5), []
        >>> for length in lengths:
        ...     part = fl.Scene()
        ...     beam = part.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), square, cells=8))
        ...     clamp = part.add(fl.Clamp(beam.point("start")))
        ...     bases.append(fl.reduction.craig_bampton(part, interfaces=[], modes=4))
        >>> len(fl.reduction.interpolated_basis(bases, lengths, 1.2))
        4
    """
    instance(bases, Sequence, "interpolated_basis: bases", "a sequence of bases")
    for each in bases:
        instance(each, Basis, "interpolated_basis: bases", "bases such as those of pod")
    x, wanted = np.asarray(parameters, dtype=np.float64), np.atleast_1d(np.asarray(at, np.float64))
    x = x[:, np.newaxis] if x.ndim == 1 else x
    if x.shape != (len(bases), len(wanted)) or not np.isfinite(x).all():
        raise ValueError(
            f"interpolated_basis: parameters: expected shape ({len(bases)}, {len(wanted)}), for "
            f"{len(bases)} bases and {len(wanted)} parameters at which one is wanted, got {x.shape}"
        )
    ranges = np.ptp(x, axis=0)
    if len(bases) <= len(wanted) or np.linalg.matrix_rank(x - x[0]) < len(wanted):
        raise ValueError(
            f"interpolated_basis: expected at least {len(wanted) + 1} bases whose parameters do "
            f"not lie in a line or plane, got {x.tolist()}"
        )
    x, wanted = x / ranges, wanted / ranges
    origin = int(np.linalg.norm(x - wanted, axis=1).argmin())
    for each in bases:
        _check_nodes(bases[origin].body, each.body)
        if len(each) != len(bases[origin]):
            raise ValueError(
                f"interpolated_basis: expected bases with as many modes, got {len(each)} and "
                f"{len(bases[origin])}"
            )
    subspaces = [
        np.linalg.qr((each.modes / _dimensions(each.body)).reshape(len(each), -1).T)[0]
        for each in bases
    ]
    V0 = subspaces[origin]
    tangents = np.array([_tangent(V0, V) for V in subspaces])
    model = scipy.interpolate.RBFInterpolator(
        x, tangents.reshape(len(bases), -1), kernel="cubic", degree=1
    )
    U, angles, W = np.linalg.svd(
        model(wanted[np.newaxis])[0].reshape(V0.shape), full_matrices=False
    )
    V = (V0 @ W.T) * np.cos(angles) + U * np.sin(angles)
    there = bases[origin].body if body is None else body
    _check_nodes(bases[origin].body, there)
    return _unit_basis(there, V.T)


_ORTHOGONAL = 1e-3  # cosine of the largest angle between subspaces that are interpolated


def _tangent(V0: Array, V: Array) -> Array:
    """Tangent vector (n, m) at a subspace from which a geodesic leads to another; orthonormal."""
    cosines = V0.T @ V
    if np.linalg.svd(cosines, compute_uv=False)[-1] < _ORTHOGONAL:
        raise ValueError(
            "interpolated_basis: two bases are nearly orthogonal: expected bases at more parameters"
        )
    across = np.linalg.solve(cosines.T, (V - V0 @ cosines).T).T
    U, tangents, W = np.linalg.svd(across, full_matrices=False)
    return np.asarray((U * np.arctan(tangents)) @ W)


def _dimensions(body: Body) -> Array:
    """Units of increments, shape (6,): the size of the body, and 1 rad."""
    return np.repeat([body.model.size, 1.0], 3)


def _unit_basis(body: Body, vectors: Array) -> Basis:
    """Basis of dimensionless vectors (m, 6 n): their translations are displacements."""
    units = _dimensions(body) / body.model.size
    return Basis(body, vectors.reshape(len(vectors), -1, 6) * units)


def _check_nodes(one: Body, other: Body) -> None:
    instance(other, Body, "body", "a body of the scene")
    if len(one.frames) != len(other.frames):
        raise ValueError(
            f"expected bodies with as many nodes: {one.label} has {len(one.frames)}, {other.label} "
            f"has {len(other.frames)}"
        )


_NEW_SHAPE = 1e-8  # least relative norm of the part of a mode that is orthogonal to the others


def krylov(scene: Scene, inputs: Sequence[tuple[Point, npt.ArrayLike]], moments: int) -> Basis:
    """Krylov modes, which match moments of the response to nodal loads about frequency zero.

    Args:
        scene: A single body, held by clamps, without joints.
        inputs: For each load, a node of the body, and force and moment on it in its axes, (6,).
        moments: Number of modes for each load; linearly dependent ones are omitted.

    Raises:
        ValueError: No load is given, or a load is not on a node of the body or moves nothing, or
            the body has rigid-body modes.
    """
    whole(moments, "moments")
    found = LinearisedBody(scene, None)
    loads: Array = np.zeros((len(inputs), *found.free.shape))
    for number, (point, wrench) in enumerate(inputs):
        instance(point, Point, "the node of an input", "a point of a body")
        if point.body is not found.body or point.attachment is not None:
            raise ValueError(
                f"{point.label} is not a node of {found.body.label}, so no load can act there"
            )
        loads[number, found.index_of(point.node)] = vector(wrench, 6, f"the load at {point.label}")
    forces = (loads * found.weight)[:, found.free]
    if not len(forces) or not forces.any(axis=1).all():
        raise ValueError("inputs must be loads on free degrees of freedom")
    solve = found.factor().solve
    vectors: Array = np.empty((0, forces.shape[1]))
    for _ in range(moments):
        block: Array = np.empty((0, forces.shape[1]))
        for answer in solve(forces.T).T:
            new = answer / np.linalg.norm(answer)
            old = np.concatenate([vectors, block])
            for _ in range(2):
                new = new - old.T @ (old @ new)
            size = float(np.linalg.norm(new))
            if size > _NEW_SHAPE:
                block = np.concatenate([block, new[np.newaxis] / size])
        vectors, forces = np.concatenate([vectors, block]), (found.pencil.M @ block.T).T
    return Basis(found.body, found.modes_of(vectors))


_DENSE = 400  # unknowns


def craig_bampton(
    scene: Scene,
    interfaces: Sequence[Point],
    modes: int,
    *,
    at: StaticResult | None = None,
) -> Basis:
    """Craig-Bampton modes of a body that is held at its interfaces.

    The first six modes of each interface, in its own axes, are the static responses to unit
    displacements and rotations of this interface with the others fixed. The remaining modes are the
    vibration modes of lowest frequency with all interfaces fixed, normalised to unit mass. Clamped
    degrees of freedom of the scene are fixed in all of them.

    Args:
        scene: A single body, with or without clamps, without joints.
        interfaces: Nodes of the body at which joints will act; empty for a clamped body.
        modes: Number of normal modes.
        at: Equilibrium under loads about which the body is linearised; default: the initial
            configuration.

    Raises:
        ValueError: An interface is not a node of the body, or is given twice or clamped; the body
            has rigid-body modes; there are fewer modes.
    """
    return interface_modes(LinearisedBody(scene, at), interfaces, modes)


def interface_modes(found: LinearisedBody, interfaces: Sequence[Point], modes: int) -> Basis:
    """:func:`craig_bampton` for a linearised body."""
    whole(modes, "modes", 0)
    nodes = _nodes(found, interfaces)
    outside = np.zeros(found.free.shape, dtype=np.bool_)
    outside[nodes] = True
    inner = np.flatnonzero(~outside[found.free])
    number = np.cumsum(found.free).reshape(found.free.shape) - 1
    outer = number[nodes].ravel()  # in the order of the interfaces
    if modes >= len(inner):
        raise ValueError(
            f"modes must be fewer than the {len(inner)} inner unknowns of {found.body.label}, "
            f"got {modes}"
        )
    K, M = found.pencil.K.tocsc(), found.pencil.M.tocsc()
    within = K[inner][:, inner]
    solve = found.factor(inner)
    vectors = np.zeros((len(outer) + modes, len(outer) + len(inner)))
    vectors[: len(outer), outer] = np.eye(len(outer))
    if len(outer):
        vectors[: len(outer), inner] = -solve.solve(K[inner][:, outer].toarray()).T
    if modes:
        vectors[len(outer) :, inner] = _slowest(within, M[inner][:, inner], modes)
    return Basis(found.body, found.modes_of(vectors))


def _slowest(K: sp.csc_array, M: sp.csc_array, modes: int) -> Array:
    """Vibration modes of lowest frequency, (modes, f), with unit mass."""
    size = K.shape[0]
    if size > _DENSE:
        mode_vectors = scipy.sparse.linalg.eigsh(K, modes, M=M, sigma=0.0, v0=np.ones(size))[1]
    else:  # the Lanczos method may break down, or miss a multiple frequency
        some = (0, modes - 1)
        mode_vectors = scipy.linalg.eigh(K.toarray(), M.toarray(), subset_by_index=some)[1]
    return np.asarray(mode_vectors.T)


def _nodes(rest: LinearisedBody, interfaces: Sequence[Point]) -> list[int]:
    """Indices of the interfaces among the independent nodes, or ``ValueError``."""
    body, found = rest.body, list[int]()
    for point in interfaces:
        instance(point, Point, "an interface", "a point of a body")
        if point.body is not body or point.attachment is not None:
            raise ValueError(
                f"{point.label} is not a node of {body.label}, so it cannot be an interface"
            )
        index = rest.index_of(point.node)
        if index in found:
            raise ValueError(f"{point.label} is given twice as an interface")
        if not rest.free[index].all():
            raise ValueError(
                f"{point.label} has fixed degrees of freedom, so it cannot be an interface"
            )
        found.append(index)
    return found


_STEP = 1e-3  # increment of a mode in second differences, relative to the size of the body

_NEW_DERIVATIVE = 1e-6  # least relative norm of a derivative orthogonal to the other modes


def with_derivatives(scene: Scene, basis: Basis) -> Basis:
    """The basis with its static modal derivatives appended, without linearly dependent ones.

    Args:
        scene: A single clamped body along a line, that of the basis.
        basis: Modes that are zero at clamps.

    Raises:
        ValueError: The scene has other bodies or joints, or is not at rest.
    """
    instance(basis, Basis, "basis", "a Basis")
    rest, reduced = LinearisedBody(scene, None), ReducedForces(scene, basis)
    solve = rest.factor().solve
    steps = np.diag(_STEP * basis.body.model.size / np.abs(basis.modes).max(axis=(1, 2)))
    vectors = list(_orthonormal(rest.unknowns_of(basis.modes)))
    first = len(vectors)
    for i, j in combinations_with_replacement(range(len(basis)), 2):
        forces = _second_difference(reduced, steps[i], steps[j]) * rest.weight
        vector = -solve(forces[rest.free])
        old = np.array(vectors)
        size = np.linalg.norm(vector)
        for _ in range(2):
            vector = vector - old.T @ (old @ vector)
        if np.linalg.norm(vector) > _NEW_DERIVATIVE * size:
            vectors.append(vector / np.linalg.norm(vector))
    new = rest.modes_of(np.array(vectors[first:]).reshape(-1, int(rest.free.sum())))
    return Basis(basis.body, np.concatenate([basis.modes, new]))


def _orthonormal(vectors: Array) -> Array:
    return np.asarray(np.linalg.qr(vectors.T)[0].T)


def _second_difference(reduced: ReducedForces, a: Array, b: Array) -> Array:
    """Mixed second difference of all forces, (n, 6), up to a factor."""
    return (
        reduced.forces(a + b)
        - reduced.forces(a - b)
        - reduced.forces(b - a)
        + reduced.forces(-a - b)
    )

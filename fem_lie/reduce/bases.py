"""Bases of reduced-order bodies: POD, Krylov, Craig-Bampton, and modal derivatives.

Krylov shapes: how a body answers to loads at known places, slowly at first.

With ``K⁻¹f, K⁻¹MK⁻¹f, …`` as shapes the answer to a load that swings has the first terms of its
series in the square of the frequency right: as many as there are shapes for each load, and twice as
many of that of the place where the load acts.
(T.-J. Su & R. R. Craig, AIAA J. 29 (1991) 2121.)

Interface modes and normal modes with fixed interfaces.

R. R. Craig & M. C. C. Bampton, AIAA J. 6 (1968) 1313. The matrices are those of nodal increments
in local frames, so that shapes turn with the body.

Modal derivatives: what shapes draw along when they are large, such as foreshortening.

S. R. Idelsohn & A. Cardona, Comput. Methods Appl. Mech. Engrg. 49 (1985) 253, without inertia:
``K θᵢⱼ = −∂²f/∂ηᵢ∂ηⱼ``.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, instance, vector, whole
from fem_lie.bodies.body import Body, Point
from fem_lie.reduce.axes import Axes, MeanAxes, frames_of, local_motion
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest, InShapes
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.states import StateSeries
from fem_lie.scene import Scene


def pod(result: StateSeries, body: Body, modes: int, *, axes: Axes | None = None) -> Basis:
    """Shapes that are nearest to all states of a result once rigid motion is taken out of them.

    Left singular vectors of the snapshots, orthonormal with rotations times the body's size.

    Args:
        result: The states.
        body: Of which body of the scene.
        modes: How many shapes.
        axes: Which rigid motion is taken out; default: :class:`MeanAxes`.

    Raises:
        ValueError: The result has no such body, or fewer independent states than ``modes``.
    """
    whole(modes, "modes")
    frames = frames_of(result, body)
    motion = local_motion(body, frames, MeanAxes() if axes is None else axes)
    scale = np.repeat([1.0, body.size], 3)
    snapshots = (motion.increments * scale).reshape(len(frames), -1)
    _, sizes, shapes = np.linalg.svd(snapshots, full_matrices=False)
    rank = int((sizes > 1e-12 * body.size).sum())
    if modes > rank:
        raise ValueError(
            f"modes must be at most {rank}, as many independent states has {body.label} in the "
            f"result, got {modes}"
        )
    return Basis(body, shapes[:modes].reshape(modes, -1, 6) / scale)


_NEW_SHAPE = 1e-8  # the least part of a shape that is in no other one


def krylov(scene: Scene, inputs: Sequence[tuple[Point, npt.ArrayLike]], moments: int) -> Basis:
    """Shapes that match moments of the answer to loads at nodes, about frequency zero.

    Args:
        scene: One body, held by clamps, without joints.
        inputs: A node of it, and force before moment on it in its axes, (6,), for each load.
        moments: How many shapes for each load; those that bring nothing new are left out.

    Raises:
        ValueError: No load is given, or one at no node of the body, or one that moves nothing; the
            body can move rigidly.
    """
    whole(moments, "moments")
    found = BesideRest(scene, None)
    loads: Array = np.zeros((len(inputs), *found.free.shape))
    for number, (point, wrench) in enumerate(inputs):
        instance(point, Point, "an input's place", "a point of a body")
        if point.body is not found.body or point.attachment is not None:
            raise ValueError(f"{point.label} is no node of {found.body.label}: no load acts there")
        loads[number, found.place(point.node)] = vector(wrench, 6, f"the load at {point.label}")
    forces = (loads * found.weight)[:, found.free]
    if not len(forces) or not forces.any(axis=1).all():
        raise ValueError("inputs must be loads that move what is free")
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
    return Basis(found.body, found.shapes(vectors))


_DENSE = 400  # unknowns


def craig_bampton(
    scene: Scene,
    interfaces: Sequence[Point],
    modes: int,
    *,
    at: StaticResult | None = None,
) -> Basis:
    """Shapes of a body that is held at its interfaces alone.

    First come six for each interface, in its own axes: unit displacements and rotations of it with
    the others held, and no force between; then the slowest vibrations with all interfaces held,
    with unit mass. What the scene clamps is held in all of them.

    Args:
        scene: One body, with clamps if it has them, and no joints.
        interfaces: Nodes of the body that joints will hold; none for a body with clamps alone.
        modes: How many normal modes.
        at: Equilibrium under loads beside which shapes are found; default: the initial frames.

    Raises:
        ValueError: An interface is no node of the body, comes twice or is clamped; the body can
            still move rigidly; there are fewer modes.
    """
    return interface_modes(BesideRest(scene, at), interfaces, modes)


def interface_modes(found: BesideRest, interfaces: Sequence[Point], modes: int) -> Basis:
    """:func:`craig_bampton` of a body that is linearised already."""
    whole(modes, "modes", 0)
    nodes = _nodes(found, interfaces)
    outside = np.zeros(found.free.shape, dtype=np.bool_)
    outside[nodes] = True
    inner = np.flatnonzero(~outside[found.free])
    number = np.cumsum(found.free).reshape(found.free.shape) - 1
    outer = number[nodes].ravel()  # in the order of the interfaces, whatever that of the nodes
    if modes >= len(inner):
        raise ValueError(
            f"modes must be fewer than the {len(inner)} unknowns within {found.body.label}, "
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
    return Basis(found.body, found.shapes(vectors))


def _slowest(K: sp.csc_array, M: sp.csc_array, modes: int) -> Array:
    """Vibrations of the least frequencies, (modes, f), with unit mass."""
    size = K.shape[0]
    if size > _DENSE:
        shapes = scipy.sparse.linalg.eigsh(K, modes, M=M, sigma=0.0, v0=np.ones(size))[1]
    else:  # Lanczos vectors may end early, or miss one of several equal frequencies
        some = (0, modes - 1)
        shapes = scipy.linalg.eigh(K.toarray(), M.toarray(), subset_by_index=some)[1]
    return np.asarray(shapes.T)


def _nodes(rest: BesideRest, interfaces: Sequence[Point]) -> list[int]:
    """Numbers of the interfaces' nodes among those that lead, or ``ValueError``."""
    body, found = rest.body, list[int]()
    for point in interfaces:
        instance(point, Point, "an interface", "a point of a body")
        if point.body is not body or point.attachment is not None:
            raise ValueError(f"{point.label} is no node of {body.label}, and so no interface of it")
        place = rest.place(point.node)
        if place in found:
            raise ValueError(f"{point.label} is an interface twice")
        if not rest.free[place].all():
            raise ValueError(f"{point.label} is held, at least in part: it is no interface")
        found.append(place)
    return found


_STEP = 1e-3  # of the body's size: how large a shape is in second differences

_NEW_DERIVATIVE = 1e-6  # the least part of a derivative that is in no other shape


def with_derivatives(scene: Scene, basis: Basis) -> Basis:
    """The basis with its static modal derivatives behind it, those that are new alone.

    Args:
        scene: One body along a line, the basis' own, held by clamps.
        basis: Shapes that leave clamps where they are.

    Raises:
        ValueError: The scene has other bodies or joints, or is not at rest.
    """
    instance(basis, Basis, "basis", "a Basis")
    rest, reduced = BesideRest(scene, None), InShapes(scene, basis)
    solve = rest.factor().solve
    steps = np.diag(_STEP * basis.body.size / np.abs(basis.shapes).max(axis=(1, 2)))
    vectors = list(_orthonormal(rest.vectors(basis.shapes)))
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
    new = rest.shapes(np.array(vectors[first:]).reshape(-1, int(rest.free.sum())))
    return Basis(basis.body, np.concatenate([basis.shapes, new]))


def _orthonormal(vectors: Array) -> Array:
    return np.asarray(np.linalg.qr(vectors.T)[0].T)


def _second_difference(reduced: InShapes, a: Array, b: Array) -> Array:
    """Mixed second difference of all forces, (n, 6); its size does not matter."""
    return (
        reduced.forces(a + b)
        - reduced.forces(a - b)
        - reduced.forces(b - a)
        + reduced.forces(-a - b)
    )

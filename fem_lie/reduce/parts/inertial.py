"""Normal modes beside the answers to inertia of rigid motion, which make them statically complete.

Few normal modes have the motion right, and moments beside a held edge wrong: all modes are in
those. What a body does under its own weight and at slow accelerations of its frame is right with
one more shape for each, the answer to that load.
(E. L. Wilson, M.-W. Yuan & J. M. Dickens, Earthq. Eng. Struct. Dyn. 10 (1982) 813.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from fem_lie._arrays import Array
from fem_lie.bodies.body import Body, Point
from fem_lie.lie.kinds import rigid_motions
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.reduce.craig_bampton import interface_modes
from fem_lie.scene import Scene

_NEW = 1e-10  # the least square of a shape that is in no other one


def inertial_shapes(
    scene: Scene, interfaces: Sequence[Point], modes: int, *, spinning: bool = False
) -> Basis:
    """Shapes with held interfaces: answers to inertia, and the slowest vibrations.

    They are the inner shapes of a :func:`reduced_body`, whose weight and accelerations they then
    balance as all unknowns do. Shapes have unit mass and are in the order of their stiffness.

    Args:
        scene: The body alone, free to move, as :func:`craig_bampton` wants it.
        interfaces: Nodes that joints, loads and the like will take.
        modes: How many vibrations, beside six answers to accelerations of translation and rotation.
        spinning: Answers to centrifugal forces, too, six more for spins about any axes; those that
            bring nothing new are left out.

    Raises:
        ValueError: As :func:`craig_bampton` says.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> part, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = part.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=8, name="arm"))
        >>> ends = [beam.point("start"), beam.point("end")]
        >>> inner = fl.inertial_shapes(part, ends, modes=4)
        >>> len(inner), len(fl.reduced_body(part, ends, inner).stiffness)
        (10, 16)
    """
    return answers_to_inertia(BesideRest(scene, None), interfaces, modes, spinning=spinning)


def answers_to_inertia(
    rest: BesideRest, interfaces: Sequence[Point], modes: int, *, spinning: bool = False
) -> Basis:
    """:func:`inertial_shapes` of a body that is linearised already."""
    normal = interface_modes(rest, interfaces, modes).shapes[6 * len(interfaces) :]
    inside = rest.free.copy()
    inside[[rest.place(point.node) for point in interfaces]] = False
    inner = np.flatnonzero(inside[rest.free])
    K, M = rest.pencil.K.tocsc()[inner][:, inner], rest.pencil.M.tocsc()
    moved = _accelerations(rest.body, spinning)[:, rest.leads] / rest.weight
    loads = M @ moved[:, rest.free].T
    answers = rest.factor(inner).solve(loads[inner])
    X = np.hstack([answers, rest.vectors(normal)[:, inner].T])
    M = M[inner][:, inner]
    sizes = np.sqrt(np.einsum("ij,ij->j", X, M @ X))
    X = X[:, sizes > 0.0] / sizes[sizes > 0.0]
    w, V = np.linalg.eigh(X.T @ (M @ X))
    new = w > _NEW
    X = X @ (V[:, new] / np.sqrt(w[new]))
    X = X @ scipy.linalg.eigh(X.T @ (K @ X))[1]
    vectors = np.zeros((X.shape[1], rest.pencil.K.shape[0]))
    vectors[:, inner] = X.T
    return Basis(rest.body, rest.shapes(vectors))


def _accelerations(body: Body, spinning: bool) -> Array:
    """Of all nodes in their axes, (6 or 12, n, 6): rigid ones, and towards axes of spin."""
    middle = body.frames[:, 0].mean(axis=0)
    rigid = rigid_motions(body.node_kinds, body.frames, middle).transpose(2, 0, 1)
    if not spinning:
        return np.asarray(rigid)
    towards = np.zeros((6, len(body.frames), 6))
    for number, (i, j) in enumerate(zip(*np.triu_indices(3), strict=True)):
        S = np.zeros((3, 3))
        S[i, j] = S[j, i] = 1.0
        pulled = (body.frames[:, 0] - middle) @ S
        towards[number, :, :3] = np.einsum("nki,ni->nk", body.frames[:, 1:], pulled)
    return np.concatenate([rigid, towards])

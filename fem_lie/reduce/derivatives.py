"""Modal derivatives: what shapes draw along when they are large, such as foreshortening.

S. R. Idelsohn & A. Cardona, Comput. Methods Appl. Mech. Engrg. 49 (1985) 253, without inertia:
``K θᵢⱼ = −∂²f/∂ηᵢ∂ηⱼ``.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.reduce.in_shapes import InShapes
from fem_lie.scene import Scene

_STEP = 1e-3  # of the body's size: how large a shape is in second differences
_NEW = 1e-6  # the least part of a derivative that is in no other shape


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
        if np.linalg.norm(vector) > _NEW * size:
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

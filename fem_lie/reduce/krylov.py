"""Krylov shapes: how a body answers to loads at known places, slowly at first.

With ``K⁻¹f, K⁻¹MK⁻¹f, …`` as shapes the answer to a load that swings has the first terms of its
series in the square of the frequency right: as many as there are shapes for each load, and twice as
many of that of the place where the load acts.
(T.-J. Su & R. R. Craig, AIAA J. 29 (1991) 2121.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance, vector, whole
from fem_lie.bodies.body import Point
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.scene import Scene

_NEW = 1e-8  # the least part of a shape that is in no other one


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
        if point.body is not found.body or point.grip is not None:
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
            if size > _NEW:
                block = np.concatenate([block, new[np.newaxis] / size])
        vectors, forces = np.concatenate([vectors, block]), (found.pencil.M @ block.T).T
    return Basis(found.body, found.shapes(vectors))

"""Small vibrations of a body in a few shapes, beside rest or steady rotation."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from fem_lie._arrays import Array, instance, whole
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene


def reduced_frequencies(
    scene: Scene, basis: Basis, count: int, *, at: StaticResult | None = None
) -> Array:
    """The lowest angular frequencies of motions that have the shapes of a basis, (count,).

    The full equations beside the state, see :func:`~fem_lie.solve.stability.vibrations.vibrations`,
    with ``h = Φ η``: of steady rotation the stress of its equilibrium stiffens the shapes made at
    rest, and gyroscopic and centrifugal forces are those of the full mass matrix.

    Args:
        scene: One body, the basis' own.
        basis: The shapes.
        count: How many, rad per time.
        at: Equilibrium of the scene, of a steady rotation, too; default: the initial frames.

    Raises:
        ValueError: The basis is of another body, or has too few shapes; the state is no
            equilibrium.
    """
    instance(basis, Basis, "basis", "a Basis")
    whole(count, "count")
    if count > len(basis):
        raise ValueError(f"count must be at most {len(basis)}, the number of shapes, got {count}")
    found = BesideRest(scene, at)
    if found.body is not basis.body:
        raise ValueError(f"the basis is of {basis.body.label}, which is not the body of the scene")
    V = found.vectors(basis.shapes).T
    V, _ = np.linalg.qr(V)
    pencil, m = found.pencil, len(basis)
    M, K = V.T @ (pencil.M @ V), V.T @ (pencil.K @ V)
    C = np.zeros_like(M) if pencil.C is None else V.T @ (pencil.C @ V)
    A = np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]])
    B = scipy.linalg.block_diag(np.eye(m), M)
    rates = np.abs(scipy.linalg.eigvals(A, B).imag)
    return np.asarray(np.sort(rates)[::2][:count])

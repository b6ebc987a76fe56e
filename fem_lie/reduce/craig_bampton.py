"""Interface modes and normal modes with fixed interfaces.

R. R. Craig & M. C. C. Bampton, AIAA J. 6 (1968) 1313. The matrices are those of nodal increments
in local frames, so that shapes turn with the body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, instance, whole
from fem_lie.bodies.body import Point
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene

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
        if point.body is not body or point.grip is not None:
            raise ValueError(f"{point.label} is no node of {body.label}, and so no interface of it")
        place = rest.place(point.node)
        if place in found:
            raise ValueError(f"{point.label} is an interface twice")
        if not rest.free[place].all():
            raise ValueError(f"{point.label} is held, at least in part: it is no interface")
        found.append(place)
    return found

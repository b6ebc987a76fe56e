"""Bodies in few shapes for scenes in time, made from full ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.reduced.reduced_body import ReducedBody
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import BesideRest
from fem_lie.reduce.craig_bampton import interface_modes
from fem_lie.reduce.parts.inertial import answers_to_inertia
from fem_lie.reduce.parts.stretching import quadratic_strains
from fem_lie.scene import Scene

_SIX = 6  # unknowns of a node


def reduced_body(
    scene: Scene,
    interfaces: Sequence[Point],
    modes: int | Basis,
    *,
    stretching: bool = True,
    name: str = "",
) -> ReducedBody:
    """A body that moves with the frame of its first interface and deforms in few shapes.

    The shapes are interface modes of :func:`craig_bampton` and :func:`inertial_shapes`, or inner
    shapes of another basis; those of the first interface are left out, for they and the others
    together are rigid motions. The first interface is so the frame: strains and rotations within it
    are to be small. What spins fast wants ``inertial_shapes(…, spinning=True)``.

    Args:
        scene: The full body alone, free to move, without joints and loads.
        interfaces: Nodes that joints, loads and the like will take; the first is the frame.
        modes: How many vibrations with held interfaces are shapes, beside six answers to inertia;
            or other inner shapes, of which what interfaces have in them is taken out.
        stretching: Whether tension stiffens bending, and bending draws ends together; otherwise
            the stiffness is constant.
        name: Of the new body; default: that of the full one.

    Raises:
        ValueError: There is no interface, the basis is of another body, parts of the body are held,
            the body has damping, or as :func:`craig_bampton` says.

    Example:
        >>> steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
        >>> part, square = fl.Scene(), fl.Section.rectangle(0.02, 0.02, steel)
        >>> beam = part.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), square, cells=8, name="arm"))
        >>> arm = fl.reduced_body(part, [beam.point("start"), beam.point("end")], modes=6)
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> hinge = fl.Revolute(fl.ground(), arm.point("start"), axis=(0, 1, 0))
        >>> _ = scene.add(arm), scene.add(hinge)
        >>> result = fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01)
        >>> fl.expand(result, arm).position(beam.point(4)).shape
        (11, 3)
    """
    if not len(interfaces):
        raise ValueError("reduced_body: wanted an interface or more: the first is the frame")
    rest = BesideRest(scene, None)
    body = rest.body
    if not rest.free[:, :5].all():
        raise ValueError(
            f"{body.label} is held: a reduced body is free, and held by its interfaces"
        )
    if rest.pencil.C is not None:
        raise ValueError(f"{body.label} has damping, and reduced bodies have none yet")
    shapes = _shapes(rest, interfaces, modes)
    nodes = [point.node for point in interfaces]
    V, K = rest.vectors(shapes), rest.pencil.K
    stiffness = V @ (K @ V.T)
    turn = _turn(body, nodes[0])
    along = np.einsum("nij,mnhj->mnhi", turn, shapes.reshape(*shapes.shape[:2], 2, 3))
    along = along.reshape(shapes.shape)
    frame = body.frames[nodes[0]]
    density, quadratic = _density(rest, along, frame), None
    if stretching:
        quadratic = quadratic_strains(rest, frame, along, stiffness)
    points = {point.name: number for number, point in enumerate(interfaces)}
    label = name or body.name
    matrices = stiffness, density, along
    return ReducedBody(nodes, *matrices, body, points=points, quadratic=quadratic, name=label)


def _shapes(rest: BesideRest, interfaces: Sequence[Point], modes: int | Basis) -> Array:
    """Of the other interfaces, in axes of the first one, and inner ones, in nodal axes."""
    body, nodes = rest.body, [point.node for point in interfaces]
    static: Array = interface_modes(rest, interfaces, 0).shapes.reshape(len(nodes), _SIX, -1, _SIX)
    own = static[np.arange(len(nodes)), :, nodes].diagonal(axis1=1, axis2=2)
    static /= own[:, :, np.newaxis, np.newaxis].copy()
    within = modes if isinstance(modes, Basis) else answers_to_inertia(rest, interfaces, modes)
    if within.body is not body:
        raise ValueError(f"the basis is of {within.body.label}, which is not the body of the scene")
    inner = within.shapes - np.einsum("mik,iknj->mnj", within.shapes[:, nodes], static)
    outer = np.einsum("iab,ibnj->ianj", turns(_turn(body, nodes[0])[nodes[1:]]), static[1:])
    return np.concatenate([outer.reshape(-1, *inner.shape[1:]), _scaled(inner, body.size)])


def _turn(body: Body, first: int) -> Array:
    """From axes of all nodes to those of the first interface, (n, 3, 3)."""
    return np.asarray(body.frames[first, 1:] @ body.frames[:, 1:].swapaxes(1, 2))


def turns(R: Array) -> Array:
    """Rotations of both halves of twists, shape (n, 6, 6), of (n, 3, 3)."""
    found = np.zeros((len(R), _SIX, _SIX))
    found[:, :3, :3] = found[:, 3:, 3:] = R
    return found


def _scaled(shapes: Array, size: float) -> Array:
    """Three times a length, three times an angle: as unknowns of nodes are measured."""
    largest = np.abs(shapes * np.repeat([1.0, size], 3)).max(axis=(1, 2))
    unit = np.where(np.arange(len(shapes)) % _SIX < 3, 1.0, size)
    return np.asarray(shapes * (unit / largest)[:, np.newaxis, np.newaxis])


def _density(rest: BesideRest, shapes: Array, frame: Array) -> Array:
    """Matrix of ``(x, d_k, z_a d_k)``: rows of all nodes are linear in these."""
    leads, m = rest.leads, len(shapes)
    inside = lie.se3_compose(lie.se3_inverse(frame), rest.body.frames[leads])
    P = np.zeros((len(leads), 4, 4 + 3 * m))
    P[:, 0, 0] = 1.0
    P[:, :, 1:4] = inside
    own = shapes[:, leads]
    P[:, 0, 4:] = own[:, :, :3].swapaxes(0, 1).reshape(len(leads), -1)
    for k in range(3):
        turned = np.cross(own[:, :, 3:], inside[:, 1 + k])
        P[:, 1 + k, 4:] = turned.swapaxes(0, 1).reshape(len(leads), -1)
    G = rest.inertia
    size = 4 * len(leads)
    mass = sp.bsr_matrix((G.blocks, G.indices, G.indptr), shape=(size, size))
    flat = P.reshape(size, -1)
    return np.asarray(flat.T @ (mass @ flat))

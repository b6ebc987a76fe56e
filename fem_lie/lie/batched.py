"""Operations of SE(3) and SO(3) on arrays of points; conventions in :mod:`fem_lie.lie`."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import prod
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.lie.adjoints import adjoint, coadjoint_matrix
from fem_lie.lie.se3 import (
    cayley_se3,
    cayley_tangent_se3,
    compose,
    exp_se3,
    inverse,
    log_se3,
    relative,
    retract,
    tangent,
    tangent_inverse,
    tangent_inverse_transposed_derivative,
)
from fem_lie.lie.so3 import (
    cayley_so3,
    cayley_tangent_so3,
    exp_so3,
    log_so3,
    tangent_derivative_so3,
    tangent_inverse_derivative_so3,
    tangent_inverse_so3,
    tangent_so3,
)

FRAME, MATRIX, TWIST, VECTOR = (4, 3), (3, 3), (6,), (3,)

# --- frames as arrays ---------------------------------------------------------------------------


def frame(x: ArrayLike, R: ArrayLike) -> Array:
    """Frames ``(…, 4, 3)`` of positions ``x``, ``(…, 3)``, and rotations ``R``, ``(…, 3, 3)``.

    Args:
        x: Positions, shape (…, 3).
        R: Rotation matrices, shape (…, 3, 3).
    """
    x, R = _checked("x", x, VECTOR), _checked("R", R, MATRIX)
    batch = np.broadcast_shapes(x.shape[:-1], R.shape[:-2])
    H = np.empty(batch + FRAME)
    H[..., 0, :], H[..., 1:, :] = x, np.swapaxes(R, -1, -2)
    return H


def position(H: ArrayLike) -> Array:
    """Positions ``x``, shape ``(…, 3)``, of frames ``(…, 4, 3)``: a view.

    Args:
        H: Frames, shape (…, 4, 3).
    """
    return _checked("H", H, FRAME)[..., 0, :]


def rotation(H: ArrayLike) -> Array:
    """Rotation matrices ``R``, shape ``(…, 3, 3)``, of frames ``(…, 4, 3)``: a view.

    Args:
        H: Frames, shape (…, 4, 3).
    """
    return np.swapaxes(_checked("H", H, FRAME)[..., 1:, :], -1, -2)


def homogeneous(H: ArrayLike) -> Array:
    """Homogeneous matrices ``[[R, x], [0, 1]]``, shape ``(…, 4, 4)``, of frames ``(…, 4, 3)``.

    Args:
        H: Frames, shape (…, 4, 3).
    """
    H = _checked("H", H, FRAME)
    M = np.zeros((*H.shape[:-2], 4, 4))
    M[..., :3, :3], M[..., :3, 3], M[..., 3, 3] = rotation(H), position(H), 1.0
    return M


def hat(v: ArrayLike) -> Array:
    """Skew matrices ``v̂`` with ``v̂ w = v × w``, shape ``(…, 3, 3)``, of vectors ``(…, 3)``.

    Of twists ``(…, 6)``: ``[[θ̂, u], [0, 0]]``, shape ``(…, 4, 4)``.

    Args:
        v: Vectors, shape (…, 3).
    """
    v = np.asarray(v, dtype=np.float64)
    if v.shape[-1:] == TWIST:
        M = np.zeros((*v.shape[:-1], 4, 4))
        M[..., :3, :3], M[..., :3, 3] = hat(v[..., 3:]), v[..., :3]
        return M
    v = _checked("v", v, VECTOR)
    M = np.zeros(v.shape[:-1] + MATRIX)
    M[..., 2, 1], M[..., 0, 2], M[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    return M - np.swapaxes(M, -1, -2)


def vee(M: ArrayLike) -> Array:
    """Inverse of :func:`hat`; of a ``(…, 3, 3)`` block that is not skew, the skew part counts.

    Args:
        M: Matrices, shape (…, 3, 3).
    """
    M = np.asarray(M, dtype=np.float64)
    if M.shape[-2:] == (4, 4):
        return np.concatenate([M[..., :3, 3], vee(M[..., :3, :3])], axis=-1)
    M = _checked("M", M, MATRIX)
    S = 0.5 * (M - np.swapaxes(M, -1, -2))
    return np.stack([S[..., 2, 1], S[..., 0, 2], S[..., 1, 0]], axis=-1)


# --- SO(3) --------------------------------------------------------------------------------------


def so3_exp(theta: ArrayLike) -> Array:
    """Rotation matrices ``(…, 3, 3)`` of rotation vectors ``(…, 3)``.

    Args:
        theta: Rotation vectors, rad, shape (…, 3).
    """
    return np.swapaxes(_map(exp_so3, MATRIX, theta=(theta, VECTOR)), -1, -2)


def so3_log(R: ArrayLike) -> Array:
    """Rotation vectors ``(…, 3)``, ``|θ| ≤ π``, of rotation matrices ``(…, 3, 3)``.

    Args:
        R: Rotation matrices, shape (…, 3, 3).
    """
    R = np.swapaxes(_checked("R", R, MATRIX), -1, -2)
    return _map(log_so3, VECTOR, R=(R, MATRIX))


def so3_tangent(theta: ArrayLike) -> Array:
    """Tangent operators ``T(θ)``, ``(…, 3, 3)``: ``RᵀδR = (T δθ)^`` for ``R = exp θ̂``.

    Args:
        theta: Rotation vectors, rad, shape (…, 3).
    """
    return _map(tangent_so3, MATRIX, theta=(theta, VECTOR))


def so3_tangent_inverse(theta: ArrayLike) -> Array:
    """Inverse tangent operators ``T⁻¹(θ)``, shape ``(…, 3, 3)``, for ``|θ| < 2π``.

    Args:
        theta: Rotation vectors, rad, shape (…, 3).
    """
    return _map(tangent_inverse_so3, MATRIX, theta=(theta, VECTOR))


def so3_tangent_derivative(theta: ArrayLike, w: ArrayLike) -> Array:
    """Derivatives ``∂(T(θ) w)/∂θ`` at constant ``w``, shape ``(…, 3, 3)``.

    Args:
        theta: Rotation vectors, rad, shape (…, 3).
        w: Vectors, shape (…, 3).
    """
    return _map(tangent_derivative_so3, MATRIX, theta=(theta, VECTOR), w=(w, VECTOR))


def so3_tangent_inverse_derivative(theta: ArrayLike, w: ArrayLike) -> Array:
    """Derivatives ``∂(T⁻¹(θ) w)/∂θ`` at constant ``w``, shape ``(…, 3, 3)``.

    Args:
        theta: Rotation vectors, rad, shape (…, 3).
        w: Vectors, shape (…, 3).
    """
    return _map(tangent_inverse_derivative_so3, MATRIX, theta=(theta, VECTOR), w=(w, VECTOR))


def so3_cayley(psi: ArrayLike) -> Array:
    """Rotation matrices ``cay ψ``, shape ``(…, 3, 3)``; ``ψ = 2 tan(θ/2)`` along the axis.

    Args:
        psi: Cayley vectors, shape (…, 3).
    """
    return np.swapaxes(_map(cayley_so3, MATRIX, psi=(psi, VECTOR)), -1, -2)


def so3_cayley_tangent(psi: ArrayLike) -> Array:
    """Tangent operators ``C(ψ)``, ``(…, 3, 3)``: ``RᵀδR = (C δψ)^`` for ``R = cay ψ``.

    Args:
        psi: Cayley vectors, shape (…, 3).
    """
    return _map(cayley_tangent_so3, MATRIX, psi=(psi, VECTOR))


# --- SE(3) --------------------------------------------------------------------------------------


def se3_exp(d: ArrayLike) -> Array:
    """Frames ``exp(d)``, shape ``(…, 4, 3)``, of twists ``(…, 6)``.

    Args:
        d: Twists, shape (…, 6).
    """
    return _map(exp_se3, FRAME, d=(d, TWIST))


def se3_log(H: ArrayLike) -> Array:
    """Twists ``log(H)``, shape ``(…, 6)``, ``|θ| ≤ π``, of frames ``(…, 4, 3)``.

    Args:
        H: Frames, shape (…, 4, 3).
    """
    return _map(log_se3, TWIST, H=(H, FRAME))


def se3_retract(H: ArrayLike, d: ArrayLike) -> Array:
    """Frames ``H exp(d)``, shape ``(…, 4, 3)``, of frames and twists ``(…, 6)``.

    Args:
        H: Frames, shape (…, 4, 3).
        d: Twists, shape (…, 6).
    """
    return _map(retract, FRAME, H=(H, FRAME), d=(d, TWIST))


def se3_relative(A: ArrayLike, B: ArrayLike) -> Array:
    """Twists ``log(A⁻¹B)``, shape ``(…, 6)``, of frames ``(…, 4, 3)``.

    Args:
        A: Frames, shape (…, 4, 3).
        B: Frames, shape (…, 4, 3).
    """
    return _map(relative, TWIST, A=(A, FRAME), B=(B, FRAME))


def se3_compose(A: ArrayLike, B: ArrayLike) -> Array:
    """Frames ``A B``, shape ``(…, 4, 3)``: ``B``, given in ``A``, as ``A`` itself is given.

    Args:
        A: Frames, shape (…, 4, 3).
        B: Frames, shape (…, 4, 3).
    """
    return _map(compose, FRAME, A=(A, FRAME), B=(B, FRAME))


def se3_inverse(H: ArrayLike) -> Array:
    """Inverse frames ``H⁻¹``, shape ``(…, 4, 3)``.

    Args:
        H: Frames, shape (…, 4, 3).
    """
    return _map(inverse, FRAME, H=(H, FRAME))


def se3_tangent(d: ArrayLike) -> Array:
    """Tangent operators ``T₆(d)``, ``(…, 6, 6)``: ``H⁻¹δH = (T₆ δd)^`` for ``H = exp d``.

    Args:
        d: Twists, shape (…, 6).
    """
    return _map(tangent, (6, 6), d=(d, TWIST))


def se3_tangent_inverse(d: ArrayLike) -> Array:
    """Inverse tangent operators ``T₆⁻¹(d)``, shape ``(…, 6, 6)``, for ``|θ| < 2π``.

    Args:
        d: Twists, shape (…, 6).
    """
    return _map(tangent_inverse, (6, 6), d=(d, TWIST))


def se3_tangent_inverse_transposed_derivative(d: ArrayLike, f: ArrayLike) -> Array:
    """Derivatives ``G(d, f) = ∂(T₆⁻ᵀ(d) f)/∂d`` at constant ``f``, shape ``(…, 6, 6)``.

    Args:
        d: Twists, shape (…, 6).
        f: Forces, shape (…, 6).
    """
    kernel = tangent_inverse_transposed_derivative
    return _map(kernel, (6, 6), d=(d, TWIST), f=(f, TWIST))


def se3_adjoint(H: ArrayLike) -> Array:
    """Adjoint matrices ``Ad(H)``, shape ``(…, 6, 6)``, of frames ``(…, 4, 3)``, on twists.

    Args:
        H: Frames, shape (…, 4, 3).
    """
    return _map(adjoint, (6, 6), H=(H, FRAME))


def se3_ad(v: ArrayLike) -> Array:
    """Matrices ``ad(v)``, ``(…, 6, 6)``, of twists ``(…, 6)``: ``ad(v) w`` is the Lie bracket.

    Args:
        v: Twists, shape (…, 6).
    """
    v = _checked("v", v, TWIST)
    M = np.zeros(v.shape + TWIST)
    M[..., :3, :3] = M[..., 3:, 3:] = hat(v[..., 3:])
    M[..., :3, 3:] = hat(v[..., :3])
    return M


def se3_coadjoint(p: ArrayLike) -> Array:
    """Matrices ``P(p)``, ``(…, 6, 6)``, of forces or momenta: ``ad(v)ᵀ p = P(p) v``.

    Args:
        p: Forces or momenta, shape (…, 6).
    """
    return _map(coadjoint_matrix, (6, 6), p=(p, TWIST))


def se3_cayley(d: ArrayLike) -> Array:
    """Frames ``cay(d)``, shape ``(…, 4, 3)``, of twists ``(…, 6)``.

    Args:
        d: Twists, shape (…, 6).
    """
    return _map(cayley_se3, FRAME, d=(d, TWIST))


def se3_cayley_tangent(d: ArrayLike) -> Array:
    """Tangent operators ``C₆(d)``, ``(…, 6, 6)``: ``H⁻¹δH = (C₆ δd)^`` for ``H = cay d``.

    Args:
        d: Twists, shape (…, 6).
    """
    return _map(cayley_tangent_se3, (6, 6), d=(d, TWIST))


# --- batches ------------------------------------------------------------------------------------


def _map(
    kernel: Callable[..., None],
    shape: tuple[int, ...],
    **arguments: tuple[ArrayLike, tuple[int, ...]],
) -> Array:
    """Apply ``kernel`` to every point; ``arguments`` are name=(value, shape at one point)."""
    cores = [core for _, core in arguments.values()]
    arrays = [_checked(name, value, core) for name, (value, core) in arguments.items()]
    batch = np.broadcast_shapes(
        *(a.shape[: a.ndim - len(core)] for a, core in zip(arrays, cores, strict=True))
    )
    points = prod(batch)
    flat = [
        np.ascontiguousarray(np.broadcast_to(a, batch + core)).reshape((points, *core))
        for a, core in zip(arrays, cores, strict=True)
    ]
    out = np.empty((points, *shape))
    _loop(kernel, len(flat))(*flat, out)
    return out.reshape(batch + shape)


def _checked(name: str, value: ArrayLike, core: tuple[int, ...]) -> Array:
    array = np.asarray(value, dtype=np.float64)
    if array.shape[-len(core) :] != core:
        expected = ", ".join(["…", *map(str, core)])
        raise ValueError(f"{name} has shape {array.shape}, expected ({expected})")
    return array


@cache
def _loop(kernel: Callable[..., None], arity: int) -> Any:
    """Compiled loop of ``kernel`` over the first index.

    The kernel is a global name of the loop, not an argument or a closure: with those, numba's disk
    cache would not recognise the loop in the next process.
    """
    template = _each if arity == 1 else _each_pair
    namespace = {"_kernel": kernel, "__name__": __name__}
    loop = FunctionType(template.__code__, namespace, template.__name__)
    loop.__qualname__ = f"{kernel.__name__}_loop"
    return compiled(loop)


def _each(a: Array, out: Array) -> None:
    for i in range(a.shape[0]):
        _kernel(a[i], out[i])


def _each_pair(a: Array, b: Array, out: Array) -> None:
    for i in range(a.shape[0]):
        _kernel(a[i], b[i], out[i])


def _kernel(*views: Array) -> None:
    """Placeholder in :func:`_each` for the operation that :func:`_loop` inserts."""

r"""Rotations and rigid-body frames: the convention card of the project, and the operations.

**Frame.** ``H = (R, x)``: position ``x`` and rotation ``R`` of a point; ``R`` maps components
along the point's own axes (local) to components along the fixed axes (global). Stored as 12
numbers of shape ``(4, 3)``: row 0 is ``x``, rows 1-3 are the directors ``R e₁, R e₂, R e₃``, which
are the rows of ``Rᵀ``.

**Six-vectors.** Twists, velocities, increments, virtual displacements, strains ``(u, θ)``, forces
and momenta ``(n, m)``: always (translation, rotation), always in the local frame of their point.

**Increments act from the right.** ``H ← H exp(d)``, velocity ``Ḣ = H v̂`` with ``v = (Rᵀẋ, ω)``,
and the tangent operator is the right Jacobian: ``H⁻¹δH = (T₆(d) δd)^`` for ``H = exp d``, with
``T₆(−d) = Ad(exp d) T₆(d)``.

**Adjoints.** ``Ad(H) = [[R, x̂R], [0, R]]`` takes a twist out of the frame H, ``Ad⁻ᵀ(H)`` a force,
and the power ``f·v`` stays. ``ad(v) = [[ω̂, û], [0, ω̂]]``.

======================  =========================================  ===========================
symbol                  one point, compiled, in place              arrays of points
======================  =========================================  ===========================
exp d                   exp_se3                                    se3_exp
log H, \|θ\| ≤ π        log_se3                                    se3_log
H exp(d)                retract                                    se3_retract
log(A⁻¹B)               relative                                   se3_relative
A B, H⁻¹                compose, inverse                           se3_compose, se3_inverse
R ← R(3I − RᵀR)/2       reorthonormalise
T₆(d)                   tangent                                    se3_tangent
T₆(d) v, T₆ᵀ(d) f       apply_tangent[_transposed]
T₆⁻¹(±d)                tangent_inverse[_minus]                    se3_tangent_inverse
T₆⁻¹(±d) v              apply_tangent_inverse[_minus]
T₆⁻ᵀ(±d) f              apply_tangent_inverse_transposed[_minus]
∂(T₆⁻ᵀ(δ) f)/∂δ, δ=±d   tangent_inverse_transposed_derivative      as left, with ``se3_`` before
                        and …_minus
Ad(H)                   adjoint                                    se3_adjoint
Ad^{1,−1,ᵀ,−ᵀ}(H) v     apply_adjoint[_inverse][_transposed]
ad(v), ad(v)ᵀ           apply_ad, apply_ad_transposed              se3_ad
P(p): ad(v)ᵀp = P v     coadjoint_matrix                           se3_coadjoint
exp θ̂, log R            exp_so3, log_so3                           so3_exp, so3_log
T, T⁻¹                  tangent[_inverse]_so3                      so3_tangent[_inverse]
T w, Tᵀw, T⁻¹w, T⁻ᵀw    apply_tangent[_inverse][_transposed]_so3
∂(T w)/∂θ, ∂(T⁻¹w)/∂θ   tangent[_inverse]_derivative_so3           so3_tangent[_inverse]_derivative
cay ψ                   cayley_so3                                 so3_cayley
its T, T⁻¹              cayley_tangent[_inverse]_so3               so3_cayley_tangent
cay d, its T₆           cayley_se3, cayley_tangent_se3             se3_cayley, se3_cayley_tangent
======================  =========================================  ===========================

Functions of the second column are for compiled loops: the result is the last argument, may be any
view, may be an input, and nothing is allocated. Those of the third take anything that NumPy takes,
with any leading dimensions, broadcast their arguments and return new arrays; rotations are
matrices ``R``, not directors. All are accurate to round-off at every angle; ``T⁻¹`` ends at 2π.

Sources: G. S. Chirikjian, *Stochastic Models, Information Theory, and Lie Groups* 2 (2012), ch. 10;
V. Sonneville, A. Cardona & O. Brüls, *CMAME* 268 (2014) 451, doi:10.1016/j.cma.2013.10.008;
A. Müller, *Proc. R. Soc. A* 477 (2021) 20210303, doi:10.1098/rspa.2021.0303.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import prod
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fem_lie._jit import Array, compiled
from fem_lie._lie_se3 import (
    adjoint,
    apply_ad,
    apply_ad_transposed,
    apply_adjoint,
    apply_adjoint_inverse,
    apply_adjoint_inverse_transposed,
    apply_adjoint_transposed,
    apply_tangent,
    apply_tangent_inverse,
    apply_tangent_inverse_minus,
    apply_tangent_inverse_transposed,
    apply_tangent_inverse_transposed_minus,
    apply_tangent_transposed,
    cayley_se3,
    cayley_tangent_se3,
    coadjoint_matrix,
    compose,
    exp_se3,
    inverse,
    log_se3,
    relative,
    reorthonormalise,
    retract,
    tangent,
    tangent_inverse,
    tangent_inverse_minus,
    tangent_inverse_transposed_derivative,
    tangent_inverse_transposed_derivative_minus,
)
from fem_lie._lie_so3 import (
    apply_tangent_inverse_so3,
    apply_tangent_inverse_transposed_so3,
    apply_tangent_so3,
    apply_tangent_transposed_so3,
    cayley_so3,
    cayley_tangent_inverse_so3,
    cayley_tangent_so3,
    exp_so3,
    log_so3,
    tangent_derivative_so3,
    tangent_inverse_derivative_so3,
    tangent_inverse_so3,
    tangent_so3,
)

__all__ = [
    "FRAME",
    "MATRIX",
    "TWIST",
    "VECTOR",
    "Array",
    "adjoint",
    "apply_ad",
    "apply_ad_transposed",
    "apply_adjoint",
    "apply_adjoint_inverse",
    "apply_adjoint_inverse_transposed",
    "apply_adjoint_transposed",
    "apply_tangent",
    "apply_tangent_inverse",
    "apply_tangent_inverse_minus",
    "apply_tangent_inverse_so3",
    "apply_tangent_inverse_transposed",
    "apply_tangent_inverse_transposed_minus",
    "apply_tangent_inverse_transposed_so3",
    "apply_tangent_so3",
    "apply_tangent_transposed",
    "apply_tangent_transposed_so3",
    "cayley_se3",
    "cayley_so3",
    "cayley_tangent_inverse_so3",
    "cayley_tangent_se3",
    "cayley_tangent_so3",
    "coadjoint_matrix",
    "compose",
    "exp_se3",
    "exp_so3",
    "frame",
    "hat",
    "homogeneous",
    "inverse",
    "log_se3",
    "log_so3",
    "position",
    "relative",
    "reorthonormalise",
    "retract",
    "rotation",
    "se3_ad",
    "se3_adjoint",
    "se3_cayley",
    "se3_cayley_tangent",
    "se3_coadjoint",
    "se3_compose",
    "se3_exp",
    "se3_inverse",
    "se3_log",
    "se3_relative",
    "se3_retract",
    "se3_tangent",
    "se3_tangent_inverse",
    "se3_tangent_inverse_transposed_derivative",
    "so3_cayley",
    "so3_cayley_tangent",
    "so3_exp",
    "so3_log",
    "so3_tangent",
    "so3_tangent_derivative",
    "so3_tangent_inverse",
    "so3_tangent_inverse_derivative",
    "tangent",
    "tangent_derivative_so3",
    "tangent_inverse",
    "tangent_inverse_derivative_so3",
    "tangent_inverse_minus",
    "tangent_inverse_so3",
    "tangent_inverse_transposed_derivative",
    "tangent_inverse_transposed_derivative_minus",
    "tangent_so3",
    "vee",
]

FRAME, MATRIX, TWIST, VECTOR = (4, 3), (3, 3), (6,), (3,)


# --- frames as arrays ---------------------------------------------------------------------------


def frame(x: ArrayLike, R: ArrayLike) -> Array:
    """Frames ``(…, 4, 3)`` of positions ``x``, ``(…, 3)``, and rotations ``R``, ``(…, 3, 3)``."""
    x, R = _checked("x", x, VECTOR), _checked("R", R, MATRIX)
    batch = np.broadcast_shapes(x.shape[:-1], R.shape[:-2])
    H = np.empty(batch + FRAME)
    H[..., 0, :], H[..., 1:, :] = x, np.swapaxes(R, -1, -2)
    return H


def position(H: ArrayLike) -> Array:
    """Positions ``x``, shape ``(…, 3)``, of frames ``(…, 4, 3)``: a view."""
    return _checked("H", H, FRAME)[..., 0, :]


def rotation(H: ArrayLike) -> Array:
    """Rotation matrices ``R``, shape ``(…, 3, 3)``, of frames ``(…, 4, 3)``: a view."""
    return np.swapaxes(_checked("H", H, FRAME)[..., 1:, :], -1, -2)


def homogeneous(H: ArrayLike) -> Array:
    """Homogeneous matrices ``[[R, x], [0, 1]]``, shape ``(…, 4, 4)``, of frames ``(…, 4, 3)``."""
    H = _checked("H", H, FRAME)
    M = np.zeros((*H.shape[:-2], 4, 4))
    M[..., :3, :3], M[..., :3, 3], M[..., 3, 3] = rotation(H), position(H), 1.0
    return M


def hat(v: ArrayLike) -> Array:
    """``v̂`` with ``v̂ w = v × w``, shape ``(…, 3, 3)``, of vectors ``(…, 3)``.

    Of twists ``(…, 6)``: ``[[θ̂, u], [0, 0]]``, shape ``(…, 4, 4)``.
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
    """Inverse of :func:`hat`; of a ``(…, 3, 3)`` block that is not skew, the skew part counts."""
    M = np.asarray(M, dtype=np.float64)
    if M.shape[-2:] == (4, 4):
        return np.concatenate([M[..., :3, 3], vee(M[..., :3, :3])], axis=-1)
    M = _checked("M", M, MATRIX)
    S = 0.5 * (M - np.swapaxes(M, -1, -2))
    return np.stack([S[..., 2, 1], S[..., 0, 2], S[..., 1, 0]], axis=-1)


# --- SO(3) --------------------------------------------------------------------------------------


def so3_exp(theta: ArrayLike) -> Array:
    """Rotation matrices ``(…, 3, 3)`` of rotation vectors ``(…, 3)``."""
    return np.swapaxes(_map(exp_so3, MATRIX, theta=(theta, VECTOR)), -1, -2)


def so3_log(R: ArrayLike) -> Array:
    """Rotation vectors ``(…, 3)``, ``|θ| ≤ π``, of rotation matrices ``(…, 3, 3)``."""
    R = np.swapaxes(_checked("R", R, MATRIX), -1, -2)
    return _map(log_so3, VECTOR, R=(R, MATRIX))


def so3_tangent(theta: ArrayLike) -> Array:
    """``T(θ)``, shape ``(…, 3, 3)``: ``RᵀδR = (T δθ)^`` for ``R = exp θ̂``."""
    return _map(tangent_so3, MATRIX, theta=(theta, VECTOR))


def so3_tangent_inverse(theta: ArrayLike) -> Array:
    """``T⁻¹(θ)``, shape ``(…, 3, 3)``, for ``|θ| < 2π``."""
    return _map(tangent_inverse_so3, MATRIX, theta=(theta, VECTOR))


def so3_tangent_derivative(theta: ArrayLike, w: ArrayLike) -> Array:
    """``∂(T(θ) w)/∂θ``, shape ``(…, 3, 3)``."""
    return _map(tangent_derivative_so3, MATRIX, theta=(theta, VECTOR), w=(w, VECTOR))


def so3_tangent_inverse_derivative(theta: ArrayLike, w: ArrayLike) -> Array:
    """``∂(T⁻¹(θ) w)/∂θ``, shape ``(…, 3, 3)``."""
    return _map(tangent_inverse_derivative_so3, MATRIX, theta=(theta, VECTOR), w=(w, VECTOR))


def so3_cayley(psi: ArrayLike) -> Array:
    """Rotation matrices ``cay ψ``, shape ``(…, 3, 3)``; ``ψ = 2 tan(θ/2)`` along the axis."""
    return np.swapaxes(_map(cayley_so3, MATRIX, psi=(psi, VECTOR)), -1, -2)


def so3_cayley_tangent(psi: ArrayLike) -> Array:
    """``C(ψ)``, shape ``(…, 3, 3)``: ``RᵀδR = (C δψ)^`` for ``R = cay ψ``."""
    return _map(cayley_tangent_so3, MATRIX, psi=(psi, VECTOR))


# --- SE(3) --------------------------------------------------------------------------------------


def se3_exp(d: ArrayLike) -> Array:
    """Frames ``exp(d)``, shape ``(…, 4, 3)``, of twists ``(…, 6)``."""
    return _map(exp_se3, FRAME, d=(d, TWIST))


def se3_log(H: ArrayLike) -> Array:
    """Twists ``log(H)``, shape ``(…, 6)``, ``|θ| ≤ π``, of frames ``(…, 4, 3)``."""
    return _map(log_se3, TWIST, H=(H, FRAME))


def se3_retract(H: ArrayLike, d: ArrayLike) -> Array:
    """Frames ``H exp(d)``, shape ``(…, 4, 3)``, of frames and twists ``(…, 6)``."""
    return _map(retract, FRAME, H=(H, FRAME), d=(d, TWIST))


def se3_relative(A: ArrayLike, B: ArrayLike) -> Array:
    """Twists ``log(A⁻¹B)``, shape ``(…, 6)``, of frames ``(…, 4, 3)``."""
    return _map(relative, TWIST, A=(A, FRAME), B=(B, FRAME))


def se3_compose(A: ArrayLike, B: ArrayLike) -> Array:
    """Frames ``A B``, shape ``(…, 4, 3)``: ``B``, given in ``A``, as ``A`` itself is given."""
    return _map(compose, FRAME, A=(A, FRAME), B=(B, FRAME))


def se3_inverse(H: ArrayLike) -> Array:
    """Frames ``H⁻¹``, shape ``(…, 4, 3)``."""
    return _map(inverse, FRAME, H=(H, FRAME))


def se3_tangent(d: ArrayLike) -> Array:
    """``T₆(d)``, shape ``(…, 6, 6)``: ``H⁻¹δH = (T₆ δd)^`` for ``H = exp d``."""
    return _map(tangent, (6, 6), d=(d, TWIST))


def se3_tangent_inverse(d: ArrayLike) -> Array:
    """``T₆⁻¹(d)``, shape ``(…, 6, 6)``, for ``|θ| < 2π``."""
    return _map(tangent_inverse, (6, 6), d=(d, TWIST))


def se3_tangent_inverse_transposed_derivative(d: ArrayLike, f: ArrayLike) -> Array:
    """``G(d, f) = ∂(T₆⁻ᵀ(d) f)/∂d``, shape ``(…, 6, 6)``, of twists and forces ``(…, 6)``."""
    kernel = tangent_inverse_transposed_derivative
    return _map(kernel, (6, 6), d=(d, TWIST), f=(f, TWIST))


def se3_adjoint(H: ArrayLike) -> Array:
    """``Ad(H)``, shape ``(…, 6, 6)``, of frames ``(…, 4, 3)``."""
    return _map(adjoint, (6, 6), H=(H, FRAME))


def se3_ad(v: ArrayLike) -> Array:
    """``ad(v)``, shape ``(…, 6, 6)``, of twists ``(…, 6)``: ``ad(v) w`` is the Lie bracket."""
    v = _checked("v", v, TWIST)
    M = np.zeros(v.shape + TWIST)
    M[..., :3, :3] = M[..., 3:, 3:] = hat(v[..., 3:])
    M[..., :3, 3:] = hat(v[..., :3])
    return M


def se3_coadjoint(p: ArrayLike) -> Array:
    """``P(p)``, shape ``(…, 6, 6)``, of forces or momenta ``(…, 6)``: ``ad(v)ᵀ p = P(p) v``."""
    return _map(coadjoint_matrix, (6, 6), p=(p, TWIST))


def se3_cayley(d: ArrayLike) -> Array:
    """Frames ``cay(d)``, shape ``(…, 4, 3)``, of twists ``(…, 6)``."""
    return _map(cayley_se3, FRAME, d=(d, TWIST))


def se3_cayley_tangent(d: ArrayLike) -> Array:
    """``C₆(d)``, shape ``(…, 6, 6)``: ``H⁻¹δH = (C₆ δd)^`` for ``H = cay d``."""
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
        wanted = ", ".join(["…", *map(str, core)])
        raise ValueError(f"{name} has shape {array.shape}, wanted ({wanted})")
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
    """Stands in :func:`_each` for the operation that :func:`_loop` puts there."""

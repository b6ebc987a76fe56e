"""Adjoint operators of SE(3): change of frame of twists and forces at one point; compiled.

As in :mod:`fem_lie.lie.se3`, results are written in place, without allocation.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.lie.tuples import (
    cross,
    load,
    load_frame,
    minus,
    plus,
    rotate,
    rotate_back,
    shifted_hat,
    store,
    store_codual,
    store_dual,
)


@inlined
def adjoint(H: Array, out: Array) -> None:
    """Adjoint matrix ``Ad(H) = [[R, x̂R], [0, R]]`` of a frame, on twists.

    Args:
        H: Frame, shape (4, 3).
        out: The result, shape (6, 6), written in place.
    """
    x, d1, d2, d3 = load_frame(H)
    m1, m2, m3 = cross(x, d1), cross(x, d2), cross(x, d3)
    R = (d1[0], d2[0], d3[0], d1[1], d2[1], d3[1], d1[2], d2[2], d3[2])
    xR = (m1[0], m2[0], m3[0], m1[1], m2[1], m3[1], m1[2], m2[2], m3[2])
    store_dual(out, R, xR)


@inlined
def apply_adjoint(H: Array, v: Array, out: Array) -> None:
    """Twist ``Ad(H) v``: from components in the frame H to those in its reference frame.

    Args:
        H: Frame, shape (4, 3).
        v: Twist, shape (6,).
        out: The result, shape (6,), written in place.
    """
    x, d1, d2, d3 = load_frame(H)
    ω = rotate(d1, d2, d3, load(v, 3))
    store(out, 0, plus(rotate(d1, d2, d3, load(v, 0)), cross(x, ω)))
    store(out, 3, ω)


@inlined
def apply_adjoint_inverse(H: Array, v: Array, out: Array) -> None:
    """Twist ``Ad(H)⁻¹ v``: from components in the reference frame of H to those in H.

    Args:
        H: Frame, shape (4, 3).
        v: Twist, shape (6,).
        out: The result, shape (6,), written in place.
    """
    x, d1, d2, d3 = load_frame(H)
    u, ω = load(v, 0), load(v, 3)
    store(out, 0, rotate_back(d1, d2, d3, minus(u, cross(x, ω))))
    store(out, 3, rotate_back(d1, d2, d3, ω))


@inlined
def apply_adjoint_transposed(H: Array, f: Array, out: Array) -> None:
    """Force and moment ``Ad(H)ᵀ f``: from the reference frame of H to H.

    Args:
        H: Frame, shape (4, 3).
        f: Force and moment, shape (6,).
        out: The result, shape (6,), written in place.
    """
    x, d1, d2, d3 = load_frame(H)
    n, m = load(f, 0), load(f, 3)
    store(out, 0, rotate_back(d1, d2, d3, n))
    store(out, 3, rotate_back(d1, d2, d3, minus(m, cross(x, n))))


@inlined
def apply_adjoint_inverse_transposed(H: Array, f: Array, out: Array) -> None:
    """Force and moment ``Ad(H)⁻ᵀ f``: from the frame H to its reference frame.

    Args:
        H: Frame, shape (4, 3).
        f: Force and moment, shape (6,).
        out: The result, shape (6,), written in place.
    """
    x, d1, d2, d3 = load_frame(H)
    n = rotate(d1, d2, d3, load(f, 0))
    store(out, 3, plus(rotate(d1, d2, d3, load(f, 3)), cross(x, n)))
    store(out, 0, n)


@inlined
def apply_ad(v: Array, w: Array, out: Array) -> None:
    """Lie bracket ``ad(v) w`` of two twists.

    Args:
        v: Twist, shape (6,).
        w: Twist, shape (6,).
        out: The result, shape (6,), written in place.
    """
    ω, q = load(v, 3), load(w, 3)
    translation = plus(cross(ω, load(w, 0)), cross(load(v, 0), q))
    store(out, 3, cross(ω, q))
    store(out, 0, translation)


@inlined
def apply_ad_transposed(v: Array, p: Array, out: Array) -> None:
    """Product ``ad(v)ᵀ p`` of a twist with a force or momentum.

    Args:
        v: Twist, shape (6,).
        p: Force or momentum (n, m), shape (6,).
        out: The result, shape (6,), written in place.
    """
    u, ω, n, m = load(v, 0), load(v, 3), load(p, 0), load(p, 3)
    store(out, 0, cross(n, ω))
    store(out, 3, plus(cross(n, u), cross(m, ω)))


@inlined
def coadjoint_matrix(p: Array, out: Array) -> None:
    """Matrix ``P(p) = [[0, n̂], [n̂, m̂]]`` of ``p = (n, m)``: ``ad(v)ᵀ p = P(p) v``.

    Args:
        p: Force or momentum (n, m), shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    n, m = shifted_hat(0.0, load(p, 0)), shifted_hat(0.0, load(p, 3))
    store_codual(out, n, m)

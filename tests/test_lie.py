"""Laws of SO(3) and SE(3), and comparison with 50-digit arithmetic from the definitions."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba.core.runtime import _nrt_python, rtsys

import fem_lie as fl
from fem_lie import lie
from fem_lie.lie import series

PI = np.pi
SMALL = [0.0, 1e-12, 1e-8, 1e-4, 0.7, 0.71, 1.0]  # the series change length at θ² = ½
TO_PI = [*SMALL, 3.0, PI - 1e-6, PI]
ALL = [*TO_PI, 3.15, 4.0, 6.0, 2 * PI, 20.0]

# Results are of order 1 and the longest chains have some 20 roundings of 1.1e-16.
ROUNDING = 4e-15

law = settings(deadline=None, max_examples=150, derandomize=True)


def unit(seed: int) -> np.ndarray:
    a = np.random.default_rng(seed).normal(size=3)
    return a / np.linalg.norm(a)


@st.composite
def twists(draw, angles=TO_PI):
    """Twists of these angles or any up to π, |u| ≤ 2, along general and coordinate axes."""
    angle = draw(st.sampled_from(angles) | st.floats(0.0, PI))
    seed = draw(st.integers(0, 2**16))
    axis = np.eye(3)[seed % 3] if seed % 4 == 0 else unit(seed)
    return np.concatenate([draw(st.floats(-2.0, 2.0)) * unit(seed + 1), angle * axis])


def twist(angle: float, seed: int = 3) -> np.ndarray:
    return np.concatenate([unit(seed + 1), angle * unit(seed)])


frames = twists().map(lie.se3_exp)


def close(a, b, tolerance=ROUNDING):
    np.testing.assert_allclose(a, b, rtol=0.0, atol=tolerance)


# --- 50 digits ----------------------------------------------------------------------------------

mp.mp.dps = 50


def mp_hat(d):
    u, t = d[:3], d[3:]
    return mp.matrix(
        [[0, -t[2], t[1], u[0]], [t[2], 0, -t[0], u[1]], [-t[1], t[0], 0, u[2]], [0, 0, 0, 0]]
    )


def mp_series(A, first):
    """``Σ Aᵏ / (k + first)!``: exp for 0, and the right Jacobian of exp for 1 and A = −ad."""
    total = term = mp.eye(A.rows) / mp.factorial(first)
    for k in range(1, 160):
        term = term * A / (k + first)
        total += term
        if mp.mnorm(term, 1) < mp.mpf(10) ** -55:
            return total
    raise AssertionError("series has not converged")


def mp_exp(d):
    return mp_series(mp_hat(d), 0)


def mp_tangent(d):
    A = mp.zeros(6, 6)
    for block, part in (((0, 0), d[3:]), ((3, 3), d[3:]), ((0, 3), d[:3])):
        h = mp_hat([0, 0, 0, *part])
        for i in range(3):
            for j in range(3):
                A[block[0] + i, block[1] + j] = -h[i, j]
    return mp_series(A, 1)


def mp_columns(function, d):
    """Central differences of a vector function, exact to some 30 digits."""
    h, columns = mp.mpf(10) ** -18, []
    for i in range(len(d)):
        e = [h if j == i else mp.mpf(0) for j in range(len(d))]
        upper, lower = (function([x + s * y for x, y in zip(d, e, strict=True)]) for s in (1, -1))
        columns.append([(a - b) / (2 * h) for a, b in zip(upper, lower, strict=True)])
    return np.array(columns, dtype=float).T


def exact(d):
    return [mp.mpf(float(x)) for x in d]


def as_float(M):
    return np.array(M.tolist(), dtype=float)


@pytest.mark.parametrize("angle", ALL)
def test_exp_is_the_matrix_exponential(angle):
    d = twist(angle)
    close(lie.homogeneous(lie.se3_exp(d)), as_float(mp_exp(exact(d))))
    close(lie.so3_exp(d[3:]), as_float(mp_exp(exact(d)))[:3, :3])


@pytest.mark.parametrize("angle", ALL)
def test_tangent_is_the_right_jacobian(angle):
    d = twist(angle)
    H_inverse = mp_exp(exact(d)) ** -1

    def local_change(delta):
        M = H_inverse * mp_exp(delta)
        return [M[0, 3], M[1, 3], M[2, 3], M[2, 1], M[0, 2], M[1, 0]]

    close(lie.se3_tangent(d), mp_columns(local_change, exact(d)))
    close(lie.se3_tangent(d), as_float(mp_tangent(exact(d))))
    close(lie.so3_tangent(d[3:]), as_float(mp_tangent(exact(d)))[3:, 3:])


@pytest.mark.parametrize("angle", [*TO_PI, 4.0, 5.5, 7.0])
def test_tangent_inverse(angle):
    d = twist(angle)
    wanted = as_float(mp_tangent(exact(d)) ** -1)
    size = np.abs(wanted).max()  # grows towards the pole at 2π
    close(lie.se3_tangent_inverse(d), wanted, ROUNDING * size)
    close(lie.so3_tangent_inverse(d[3:]), wanted[3:, 3:], ROUNDING * size)


@pytest.mark.parametrize("angle", [*TO_PI, 4.0])
def test_derivative_of_the_transposed_tangent_inverse(angle):
    d, f = twist(angle), np.array([0.3, -0.5, 0.7, 0.2, 0.9, -0.4])

    def force(delta):
        return list((mp_tangent(delta).T ** -1) * mp.matrix(exact(f)))

    wanted = mp_columns(force, exact(d))
    close(lie.se3_tangent_inverse_transposed_derivative(d, f), wanted)
    out = np.empty((6, 6))
    lie.tangent_inverse_transposed_derivative_minus(-d, f, out)
    close(out, wanted)


@pytest.mark.parametrize("angle", [*TO_PI, 4.0])
def test_derivatives_of_rotation_tangents(angle):
    theta, w = twist(angle)[3:], np.array([0.3, -0.5, 0.7])

    def direct(t):
        return list(mp_tangent([0, 0, 0, *t])[3:, 3:] * mp.matrix(exact(w)))

    def inverse(t):
        return list((mp_tangent([0, 0, 0, *t])[3:, 3:] ** -1) * mp.matrix(exact(w)))

    close(lie.so3_tangent_derivative(theta, w), mp_columns(direct, exact(theta)))
    close(lie.so3_tangent_inverse_derivative(theta, w), mp_columns(inverse, exact(theta)))


@fl.extend.compiled
def _coefficients(x):
    return series.stumpff(x)[2:], series.inverse_series(x)


@pytest.mark.parametrize("angle", [*TO_PI, 3.15, 5.0])
def test_coefficients_keep_their_relative_accuracy(angle):
    """At small angles e″ and the like are hidden in matrices by powers of θ."""

    def c(k, x):
        return mp.fsum((-x) ** i / mp.factorial(2 * i + k) for i in range(60))

    def e(x):
        return (c(3, x) / 2 - c(4, x)) / c(2, x)

    x = angle**2
    stumpff, inverse = _coefficients(x)
    wanted = [float(c(k, mp.mpf(x))) for k in range(2, 8)]
    np.testing.assert_allclose(stumpff, wanted, rtol=1e-15)
    taylor = mp.taylor(e, mp.mpf(x), 2)
    np.testing.assert_allclose(
        inverse, [float(taylor[0]), float(taylor[1]), 2 * float(taylor[2])], rtol=1e-14
    )


# --- exp and log --------------------------------------------------------------------------------


@law
@given(twists())
def test_log_inverts_exp(d):
    theta = np.linalg.norm(d[3:])
    back = lie.se3_log(lie.se3_exp(d))
    if theta > PI - 1e-9 and back[3:] @ d[3:] < 0:  # either axis is right
        close(lie.se3_exp(back), lie.se3_exp(d))
        close(back[3:], -d[3:])
    else:
        close(back, d)
        assert np.linalg.norm(back[3:] - d[3:]) <= ROUNDING * theta


@law
@given(frames)
def test_exp_inverts_log(H):
    d = lie.se3_log(H)
    assert np.linalg.norm(d[3:]) <= PI * (1 + 1e-15)
    close(lie.se3_exp(d), H)


@pytest.mark.parametrize("axis", [*np.eye(3), -np.eye(3)[1], unit(1), unit(2), unit(9)])
def test_log_of_exact_half_turn(axis):
    theta = lie.so3_log(2 * np.outer(axis, axis) - np.eye(3))
    close(np.linalg.norm(theta), PI)
    close(abs(theta @ axis), PI)


def test_log_beyond_half_a_turn_is_the_shorter_way():
    close(lie.so3_log(lie.so3_exp([0.0, 4.0, 0.0])), [0.0, 4.0 - 2 * PI, 0.0])


# --- group --------------------------------------------------------------------------------------


@law
@given(frames, frames, frames)
def test_group_laws(A, B, C):
    compose = lie.se3_compose
    identity = lie.frame(np.zeros(3), np.eye(3))
    close(compose(compose(A, B), C), compose(A, compose(B, C)), 2 * ROUNDING)
    close(compose(A, lie.se3_inverse(A)), identity)
    close(compose(lie.se3_inverse(A), A), identity)
    close(lie.homogeneous(compose(A, B)), lie.homogeneous(A) @ lie.homogeneous(B))


@law
@given(frames, twists())
def test_retract_and_relative(A, d):
    B = lie.se3_retract(A, d)
    close(B, lie.se3_compose(A, lie.se3_exp(d)))
    relative = lie.se3_relative(A, B)
    close(lie.se3_retract(A, relative), B, 2 * ROUNDING)
    if np.linalg.norm(d[3:]) < PI - 1e-9:
        close(relative, d, 2 * ROUNDING)


@law
@given(frames, frames, twists())
def test_adjoint(A, B, v):
    Ad = lie.se3_adjoint(A)
    M = lie.homogeneous(A)
    close(lie.hat(Ad @ v), M @ lie.hat(v) @ np.linalg.inv(M), 4 * ROUNDING)
    close(lie.se3_adjoint(lie.se3_compose(A, B)), Ad @ lie.se3_adjoint(B), 2 * ROUNDING)
    for name, expected in {
        "apply_adjoint": Ad @ v,
        "apply_adjoint_inverse": np.linalg.inv(Ad) @ v,
        "apply_adjoint_transposed": Ad.T @ v,
        "apply_adjoint_inverse_transposed": np.linalg.inv(Ad).T @ v,
    }.items():
        out = v.copy()
        getattr(lie, name)(A, out, out)
        close(out, expected, 10 * ROUNDING)  # of size |x| |v| ≤ 8


@law
@given(twists(), twists(), twists())
def test_bracket_and_coadjoint(v, w, p):
    ad = lie.se3_ad(v)
    commutator = lie.hat(v) @ lie.hat(w) - lie.hat(w) @ lie.hat(v)
    close(lie.hat(ad @ w), commutator, 10 * ROUNDING)
    close(ad.T @ p, lie.se3_coadjoint(p) @ v, 10 * ROUNDING)
    out, out_transposed = np.empty(6), np.empty(6)
    lie.apply_ad(v, w, out)
    lie.apply_ad_transposed(v, p, out_transposed)
    close(out, ad @ w, 10 * ROUNDING)
    close(out_transposed, ad.T @ p, 10 * ROUNDING)


# --- tangent operator ---------------------------------------------------------------------------


@law
@given(twists([*ALL]), twists())
def test_tangent_family(d, v):
    T, T_minus = lie.se3_tangent(d), lie.se3_tangent(-d)
    Ad = lie.se3_adjoint(lie.se3_exp(d))
    close(T_minus, Ad @ T, 4 * ROUNDING)
    close(T[3:, 3:] @ d[3:], d[3:], ROUNDING * 20)  # |θ| ≤ 20
    for name, matrix in {"": T, "_transposed": T.T}.items():
        out = v.copy()
        getattr(lie, "apply_tangent" + name)(d, out, out)
        close(out, matrix @ v, 8 * ROUNDING)


@law
@given(twists(), twists())
def test_tangent_inverse_family(d, v):
    inverse, minus = lie.se3_tangent_inverse(d), lie.se3_tangent_inverse(-d)
    close(inverse @ lie.se3_tangent(d), np.eye(6), 2 * ROUNDING)
    close(lie.se3_tangent_inverse(d), minus @ lie.se3_adjoint(lie.se3_exp(d)), 4 * ROUNDING)
    for name, matrix in {
        "": inverse,
        "_transposed": inverse.T,
        "_minus": minus,
        "_transposed_minus": minus.T,
    }.items():
        out = v.copy()
        getattr(lie, "apply_tangent_inverse" + name)(d, out, out)
        close(out, matrix @ v, 8 * ROUNDING)
    out = np.empty((6, 6))
    lie.tangent_inverse_minus(d, out)
    close(out, minus)


@law
@given(twists(), twists())
def test_rotation_tangents(d, v):
    theta, w = d[3:], v[3:]
    T, inverse = lie.so3_tangent(theta), lie.so3_tangent_inverse(theta)
    for name, matrix in {
        "apply_tangent_so3": T,
        "apply_tangent_transposed_so3": T.T,
        "apply_tangent_inverse_so3": inverse,
        "apply_tangent_inverse_transposed_so3": inverse.T,
    }.items():
        out = w.copy()
        getattr(lie, name)(theta, out, out)
        close(out, matrix @ w, 4 * ROUNDING)


# --- Cayley -------------------------------------------------------------------------------------


@law
@given(twists(), st.floats(0.01, 3.0))
def test_cayley(d, size):
    psi = size * d[3:]
    length = np.linalg.norm(psi)
    R = lie.so3_cayley(psi)
    angle = 2 * np.arctan(length / 2)
    close(R, lie.so3_exp(psi * (angle / length if length else 1.0)))
    # averaged directors: the work identity of energy-momentum schemes rests on it
    close(R - np.eye(3), 0.5 * (R + np.eye(3)) @ lie.hat(psi), ROUNDING * (1 + length))
    inverse = np.empty((3, 3))
    lie.cayley_tangent_inverse_so3(psi, inverse)
    close(lie.so3_cayley_tangent(psi) @ inverse, np.eye(3), ROUNDING * (1 + length**2))


@pytest.mark.parametrize("length", [0.0, 1e-8, 1e-4, 1.0, 30.0])
def test_cayley_tangent_is_the_right_jacobian(length):
    psi = length * unit(4)

    def cayley(p):
        h = mp_hat([0, 0, 0, *p])[:3, :3]
        return (mp.eye(3) + h / 2) * ((mp.eye(3) - h / 2) ** -1)

    R = cayley(exact(psi))

    def local_change(p):
        M = R.T * cayley(p)
        return [M[2, 1], M[0, 2], M[1, 0]]

    close(lie.so3_cayley(psi), as_float(cayley(exact(psi))))
    close(lie.so3_cayley_tangent(psi), mp_columns(local_change, exact(psi)))


@pytest.mark.parametrize("angle", [0.0, 1e-8, 1e-4, 1.0, 30.0])
def test_cayley_of_se3(angle):
    """``(I − ½X)⁻¹(I + ½X)``, its right Jacobian, and the group of rotations in it."""
    d = twist(angle)

    def cayley(p):
        X = mp_hat(p)
        return (mp.eye(4) - X / 2) ** -1 * (mp.eye(4) + X / 2)

    inverse = cayley(exact(d)) ** -1

    def local_change(p):
        M = inverse * cayley(p)
        return [M[0, 3], M[1, 3], M[2, 3], M[2, 1], M[0, 2], M[1, 0]]

    close(lie.homogeneous(lie.se3_cayley(d)), as_float(cayley(exact(d))))
    close(lie.se3_cayley_tangent(d), mp_columns(local_change, exact(d)))
    close(lie.rotation(lie.se3_cayley(d)), lie.so3_cayley(d[3:]))


# --- compiled loops -----------------------------------------------------------------------------


@fl.extend.compiled
def _march(H, d, steps, clean):
    for _ in range(steps):
        lie.retract(H, d, H)
        if clean:
            lie.reorthonormalise(H)


def test_million_products_stay_on_the_group():
    d = np.array([1e-3, 2e-3, 0.0, 0.11, -0.23, 0.31])
    errors = {}
    for clean in (True, False):
        H = lie.se3_exp(d)
        _march(H, d, 10**6, clean)
        errors[clean] = np.abs(H[1:] @ H[1:].T - np.eye(3)).max()
    assert errors[True] <= 1e-15
    assert errors[False] > 1e-13  # or the test would show nothing


def test_reorthonormalise_squares_the_error():
    H = lie.se3_exp(twist(1.0))
    wanted = H.copy()
    H[1:] += 1e-5 * np.random.default_rng(0).normal(size=(3, 3))
    lie.reorthonormalise(H)
    assert np.abs(H[1:] @ H[1:].T - np.eye(3)).max() < 1e-9
    close(H, wanted, 1e-4)


@fl.extend.compiled
def _everything(H, d, v, M, out, frame_out):
    lie.retract(H, d, frame_out)
    lie.relative(H, frame_out, out)
    lie.compose(H, H, frame_out)
    lie.inverse(frame_out, frame_out)
    lie.reorthonormalise(frame_out)
    lie.apply_tangent(d, v, out)
    lie.apply_tangent_inverse_transposed_minus(d, out, out)
    lie.apply_adjoint_inverse(H, out, out)
    lie.apply_ad(d, v, out)
    lie.tangent(d, M)
    lie.tangent_inverse(d, M)
    lie.tangent_inverse_transposed_derivative(d, v, M)
    lie.adjoint(H, M)
    lie.coadjoint_matrix(v, M)
    lie.cayley_so3(out[3:], M[:3, :3])
    lie.tangent_derivative_so3(out[3:], v[:3], M[3:, 3:])


@fl.extend.compiled
def _allocating(H, d, v, M, out, frame_out):
    out[:] = v + d


def test_nothing_is_allocated():
    arguments = (lie.se3_exp(twist(1.0)), twist(0.3), twist(0.2), np.empty((6, 6)), np.empty(6))
    frame_out = np.empty((4, 3))
    counts = []
    for function in (_everything, _allocating):
        function(*arguments, frame_out)
        _nrt_python.memsys_enable_stats()
        try:
            before = rtsys.get_allocation_stats().alloc
            function(*arguments, frame_out)
            counts.append(rtsys.get_allocation_stats().alloc - before)
        finally:
            _nrt_python.memsys_disable_stats()
    # NumPy arrays that enter from Python cost one small record each, the same for both
    assert counts[1] == counts[0] + 1


def test_results_go_to_any_view():
    d, H = twist(2.0), lie.se3_exp(twist(1.0))
    big = np.full((12, 12), np.nan)
    lie.tangent(d, big[::2, 1::2])
    close(big[::2, 1::2], lie.se3_tangent(d))
    assert np.isnan(big).sum() == 144 - 36
    column = np.full((6, 4), np.nan)
    lie.apply_tangent(d, d, column[:, 2])
    close(column[:, 2], lie.se3_tangent(d) @ d)
    lie.retract(H.T.copy().T, d, big[:4, :3])
    close(big[:4, :3], lie.se3_retract(H, d))
    lie.retract(H, d, H)
    close(big[:4, :3], H)


# --- arrays of points ---------------------------------------------------------------------------


def test_batches_equal_single_points():
    rng = np.random.default_rng(5)
    d, v = rng.normal(size=(2, 3, 6)), rng.normal(size=(3, 6))
    H = lie.se3_exp(d)
    assert H.shape == (2, 3, 4, 3)
    for i, j in np.ndindex(2, 3):
        close(H[i, j], lie.se3_exp(d[i, j]))
        close(lie.se3_retract(H, v)[i, j], lie.se3_retract(H[i, j], v[j]))
        G = lie.se3_tangent_inverse_transposed_derivative(d, v)
        close(G[i, j], lie.se3_tangent_inverse_transposed_derivative(d[i, j], v[j]))
        close(lie.so3_log(lie.rotation(H))[i, j], d[i, j, 3:])


def test_any_batch_shape():
    assert lie.se3_exp(np.zeros((0, 6))).shape == (0, 4, 3)
    assert lie.se3_relative(np.zeros((5, 1, 4, 3)), np.zeros((2, 4, 3))).shape == (5, 2, 6)
    assert lie.so3_tangent([0, 0, 1]).shape == (3, 3)


def test_frames_as_arrays():
    x, R = np.array([1.0, 2.0, 3.0]), lie.so3_exp([0.1, 0.2, 0.3])
    H = lie.frame(x, R)
    close(lie.position(H), x, 0.0)
    close(lie.rotation(H), R, 0.0)
    close(H[1], R[:, 0], 0.0)
    assert lie.frame(np.zeros((7, 3)), R).shape == (7, 4, 3)
    v = np.arange(1.0, 7.0)
    close(lie.hat(v[:3]) @ v[3:], np.cross(v[:3], v[3:]), 0.0)
    close(lie.vee(lie.hat(v)), v, 0.0)
    close(lie.vee(lie.hat(v[:3])), v[:3], 0.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: lie.se3_exp(np.zeros((2, 5))), r"d has shape \(2, 5\), expected \(…, 6\)"),
        (lambda: lie.so3_exp(0.0), r"theta has shape \(\), expected \(…, 3\)"),
        (lambda: lie.frame(np.zeros(3), np.zeros(3)), r"R has shape \(3,\), expected \(…, 3, 3\)"),
        (lambda: lie.hat(np.zeros(4)), r"v has shape \(4,\), expected \(…, 3\)"),
        (lambda: lie.se3_compose(np.zeros((2, 4, 3)), np.zeros((3, 4, 3))), "broadcast"),
    ],
)
def test_wrong_shapes(call, message):
    with pytest.raises(ValueError, match=message):
        call()

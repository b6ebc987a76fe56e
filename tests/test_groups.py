"""Moving nodes on SE(3) and R³×SO(3), by exponential and Cayley map, for one node at a time."""

import numpy as np
import pytest

from fem_lie import lie
from fem_lie.extend import node_types as nodes

H = lie.se3_exp([0.3, -2.0, 1.1, 0.4, 1.2, -0.9])
D = np.array([0.5, -0.2, 0.3, 0.6, -0.7, 0.4])
KINDS = range(4)


def moved(kind: int, d: np.ndarray) -> np.ndarray:
    out = np.empty((1, 4, 3))
    nodes.move_all(np.array([kind]), H[np.newaxis], d[np.newaxis], out)
    return out[0]


@pytest.mark.parametrize("kind", KINDS)
def test_moves(kind):
    """Against the maps of the groups; translations are global on R³×SO(3)."""
    increment = lie.se3_cayley(D) if kind & 2 else lie.se3_exp(D)
    expected = lie.se3_compose(H, increment)
    if kind & 1:
        expected[0] = H[0] + D[:3]
    np.testing.assert_allclose(moved(kind, D), expected, atol=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_tangent_takes_corrections_to_twists(kind):
    """By central differences; corrections are along the axes of the moved frame."""
    H1, epsilon = moved(kind, D), 1e-5
    T, numeric = np.empty((6, 6)), np.empty((6, 6))
    nodes.tangent(kind, D, T)
    for j, x in enumerate(epsilon * np.eye(6)):
        if kind & 1:
            x[:3] = lie.rotation(H1) @ x[:3]
        change = lie.se3_relative(H1, moved(kind, D + x)) - lie.se3_relative(H1, moved(kind, D - x))
        numeric[:, j] = change / (2 * epsilon)
    np.testing.assert_allclose(T, numeric, atol=1e-9)
    x, out = np.arange(6.0), np.empty((1, 6))
    nodes.twists(np.array([kind]), D[np.newaxis], x[np.newaxis], out)
    np.testing.assert_allclose(out[0], T @ x, atol=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_velocities_and_accelerations_of_the_group(kind):
    """(ẋ, ω) and (ẍ, ω̇) of a motion with given twist and rate, by differences; and back."""
    twist, rate, t = np.array([0.3, 1, -2, 0.5, 0.7, -1]), np.array([1.0, 2, 0, -3, 1, 2]), 1e-4
    v, vdot = np.empty((1, 6)), np.empty((1, 6))
    one = np.array([kind])
    nodes.all_from_local(one, H[np.newaxis], twist[np.newaxis], rate[np.newaxis], v, vdot)
    if kind & 1:
        x = [lie.se3_retract(H, twist * s + 0.5 * rate * s**2)[0] for s in (-t, 0.0, t)]
        np.testing.assert_allclose(v[0, :3], (x[2] - x[0]) / (2 * t), atol=1e-6)
        np.testing.assert_allclose(vdot[0, :3], (x[2] - 2 * x[1] + x[0]) / t**2, atol=1e-6)
    else:
        np.testing.assert_array_equal(v[0], twist)
    np.testing.assert_array_equal((v[0, 3:], vdot[0, 3:]), (twist[3:], rate[3:]))
    back = np.empty((2, 6))
    nodes.to_local(kind, H, v[0], vdot[0], back[0], back[1])
    np.testing.assert_allclose(back, (twist, rate), atol=1e-14)

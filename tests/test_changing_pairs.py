"""Terms whose pairs of nodes change, without anything else knowing of it.

Soft balls repel each other where they overlap: the pairs change in the middle of a run. They are
added to a scene as loads are, by their contributions.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

import fem_lie as fl
from tests.assembled import Assembled

STIFFNESS, RADIUS = 50.0, 0.5


class Overlaps(fl.extend.Term):
    """Energy ``½ k (2 r − |x_i − x_j|)²`` of each pair of nodes that overlaps."""

    label = "soft balls"

    def __init__(self, nodes: np.ndarray) -> None:
        self._of = np.array([(i, j) for i in nodes for j in nodes if i < j], dtype=np.int64)
        self._now = self._of[:0]

    def find(self, H: np.ndarray) -> None:
        """The pairs that overlap at frames ``H``."""
        gaps = np.linalg.norm(np.diff(H[self._of, 0], axis=1)[:, 0], axis=1) - 2 * RADIUS
        found = self._of[gaps < 0.0]
        if not np.array_equal(found, self._now):
            self._now, self.version = found, self.version + 1

    @property
    def pairs(self) -> fl.extend.Pairs:
        both = self._now[:, [0, 0, 1, 1]], self._now[:, [0, 1, 0, 1]]
        return both[0].ravel(), both[1].ravel()

    def _directions(self, H: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        apart = H[self._now[:, 1], 0] - H[self._now[:, 0], 0]
        distance = np.linalg.norm(apart, axis=1)
        return apart / distance[:, np.newaxis], distance

    def energy(self, H: np.ndarray) -> float:
        self.find(H)
        return 0.5 * STIFFNESS * float(((2 * RADIUS - self._directions(H)[1]) ** 2).sum())

    def add_forces(self, H: np.ndarray, out: np.ndarray, kept: np.ndarray | None = None) -> None:
        self.find(H)
        n, distance = self._directions(H)
        push = STIFFNESS * (2 * RADIUS - distance)[:, np.newaxis] * n
        for side, sign in ((0, 1.0), (1, -1.0)):
            nodes = self._now[:, side]
            np.add.at(out[:, :3], nodes, sign * np.einsum("pij,pj->pi", H[nodes, 1:], push))

    def tangent(self, H: np.ndarray, kept: np.ndarray) -> np.ndarray:
        n, distance = self._directions(H)
        over = (2 * RADIUS - distance) / distance
        nn = np.einsum("pi,pj->pij", n, n)
        k = STIFFNESS * (nn - over[:, np.newaxis, np.newaxis] * (np.eye(3) - nn))
        push = STIFFNESS * (2 * RADIUS - distance)[:, np.newaxis] * n
        blocks = np.zeros((len(n), 2, 2, 6, 6))
        for a, sign in ((0, 1.0), (1, -1.0)):
            R = H[self._now[:, a], 1:]
            for b, other in ((0, 1.0), (1, -1.0)):
                Q = H[self._now[:, b], 1:]
                blocks[:, a, b, :3, :3] = sign * other * R @ k @ Q.transpose(0, 2, 1)
            # components turn with the node: δ(Rᵀ f) = (Rᵀ f) × η
            f = sign * np.einsum("pij,pj->pi", R, push)
            blocks[:, a, a, :3, 3:] += np.cross(f[:, np.newaxis], np.eye(3)).transpose(0, 2, 1)
        return blocks.reshape(-1, 6, 6)


@dataclass(frozen=True, eq=False)
class SoftBalls(fl.extend.Load):
    """All bodies repel each other."""

    carrier = fl.extend.Carrier("balls", tuple, "bodies")
    balls: tuple[fl.extend.Body, ...]
    history: Callable[[float], float] | None = None

    @property
    def body(self) -> fl.extend.Body:
        return self.balls[0]

    def check(self) -> None:
        """Nothing can be wrong."""

    def contribute(self, to: fl.extend.Sum) -> None:
        to.add_term(Overlaps(np.array([to.nodes(ball)[0] for ball in self.balls])))


def ball(position, velocity=(0.0, 0.0, 0.0)) -> fl.RigidBody:
    body = fl.RigidBody(1.0, 0.1 * np.eye(3), position)
    body.velocities[:, :3] = velocity
    return body


def billiard() -> tuple[fl.Scene, list[fl.RigidBody]]:
    """One ball runs into two that lie at an angle."""
    balls = [
        ball((0, 0, 0), (1.0, 0, 0)),
        ball((1.5, 0.3, 0.1)),
        ball((1.7, -0.9, 0)),
    ]
    scene = fl.Scene()
    for each in balls:
        scene.add(each)
    scene.add(SoftBalls(tuple(balls)))
    return scene, balls


def test_the_matrix_has_the_pairs_of_the_present_state():
    """Of two states with other pairs, there and back; against differences of the residual."""
    scene, _ = billiard()
    system = Assembled(scene, dynamics=True)
    n, rng = system.count, np.random.default_rng(2)
    first = system.equations.matrix.version
    for positions in ([[0, 0, 0], [0.8, 0.1, 0], [3, 0, 0]], [[0, 0, 0], [3, 0, 0], [0.7, 0.2, 0]]):
        H = system.start.copy()
        H[:n, 0] = positions
        H = system.moved(H, 0.01 * rng.normal(size=(n, 6)))
        A, h = system.matrix(H), rng.normal(size=(n, 6))
        ahead, behind = (system.residual(system.moved(H, sign * 1e-6 * h)) for sign in (1, -1))
        expected = (ahead - behind) / 2e-6
        np.testing.assert_allclose(A @ h.ravel(), expected, atol=1e-7 * np.abs(expected).max())
    assert system.equations.matrix.version == first + 2
    # two of the three balls touch
    assert np.count_nonzero(np.abs(A.reshape(n, 6, n, 6)).max(axis=(1, 3))) == 4


@pytest.mark.parametrize(
    "step", [2e-3, fl.schemes.AdaptiveStep(1e-5)], ids=["constant", "adaptive"]
)
def test_balls_bounce_off_and_conserve(step):
    """Momenta to round-off of the iteration, energy to the scheme's order, while pairs change."""
    scene, balls = billiard()
    counted = []

    class Watched(Overlaps):
        def find(self, H):
            super().find(H)
            counted.append(len(self._now))

    def contribute(self, to):
        to.add_term(Watched(np.array([to.nodes(each)[0] for each in self.balls])))

    kind = type("Watched", (SoftBalls,), {"contribute": contribute})
    scene.loads[:] = [kind(tuple(balls))]
    scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-8)
    result = scheme.run(scene, duration=4.0, step=step, progress=False)
    assert {0, 1} <= set(counted)
    momentum = result.momentum
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=1e-8)
    energy = result.kinetic + result.elastic
    assert result.elastic.max() > 0.1 * energy[0]
    np.testing.assert_allclose(energy[-1], energy[0], rtol=2e-3)
    x = np.array([result.position(each.point("centre"))[-1] for each in balls])
    assert np.linalg.norm(x[0] - x[1]) > 2 * RADIUS


def test_conserving_schemes_say_that_they_have_no_such_forces():
    scene, _ = billiard()
    with pytest.raises(ValueError, match="not support soft balls"):
        fl.EnergyMomentum().run(scene, duration=0.1, step=1e-2)

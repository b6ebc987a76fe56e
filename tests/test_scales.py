"""Scales of constraints, and effects of their scaled multipliers."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.parts import Vectors

TOUCHED = [{0, 1}, {0, 1}, {0, 1}, {1}, {0, 2}, {0, 2}]
"""Nodes of a vector of three constraints, of one that stands alone, and of a vector of two."""
JOINED = np.array([False, True, True, False, False, True])
VECTORS = [slice(0, 3), slice(3, 4), slice(4, 6)]


class Constraints:
    """Constraints of three nodes, with a prescribed diagonal of the matrix."""

    def __init__(self, diagonal: np.ndarray | None = None) -> None:
        rng = np.random.default_rng(3)
        self.incidences, self.vectors = Incidences.of(TOUCHED, 3), Vectors(JOINED)
        self.rows = rng.normal(size=(len(self.incidences.nodes), 6))
        self.diagonal = rng.uniform(1.0, 3.0, (3, 6)) if diagonal is None else diagonal
        self.units = np.ones((3, 6))

    def dense(self) -> np.ndarray:
        """``B diag(S)⁻¹ Bᵀ``."""
        B = np.zeros((len(JOINED), 3, 6))
        B[self.incidences.rows, self.incidences.nodes] = self.rows
        return np.einsum("ank,nk,bnk->ab", B, 1.0 / self.diagonal, B)

    def scales(self) -> tuple[np.ndarray, np.ndarray]:
        """Scales, and ``spread`` within vectors as a square matrix."""
        spread = np.empty(self.vectors.others.shape)
        given = self.rows, self.diagonal, self.units
        scale = self.vectors.scales(self.incidences, *given, spread)
        square = np.zeros((len(JOINED), len(JOINED)))
        c, j = np.nonzero(self.vectors.there)
        square[c, self.vectors.others[c, j]] = spread[c, j]
        assert (spread[~self.vectors.there] == 0.0).all()
        return scale, square


def test_spread_is_what_scaled_multipliers_move():
    given = Constraints()
    scale, spread = given.scales()
    moved = given.dense() * scale
    for part in VECTORS:
        np.testing.assert_allclose(spread[part, part], moved[part, part], rtol=1e-13)
        assert spread[part].any(axis=0).sum() == part.stop - part.start
    assert spread[3, 3] == pytest.approx(1.0, rel=1e-15)


def test_what_a_force_moves_does_not_depend_on_axes_of_its_vector():
    """Neither does the scale, if components differ little."""
    given, force = Constraints(), np.array([2.0, -1.0, 0.5])
    scale, spread = given.scales()
    turn = Rotation.from_rotvec([0.4, -1.1, 0.3]).as_matrix()
    turned = Constraints()
    blocks = given.rows[:6].reshape(3, 2, 6)
    turned.rows[:6] = np.einsum("ab,bnk->ank", turn, blocks).reshape(6, 6)
    other, found = turned.scales()
    np.testing.assert_allclose(other, scale, rtol=1e-13)
    moved, again = spread[:3, :3] @ force, found[:3, :3] @ (turn @ force)
    assert np.linalg.norm(again) == pytest.approx(np.linalg.norm(moved), rel=1e-13)
    # components alone would not tell
    alone = np.linalg.norm(np.diag(spread[:3, :3]) * force)
    assert abs(np.linalg.norm(np.diag(found[:3, :3]) * (turn @ force)) / alone - 1.0) > 1e-3


def test_components_that_differ_much_have_scales_of_their_own():
    given = Constraints()
    given.rows[:2] *= 100.0
    scale, _ = given.scales()
    np.testing.assert_allclose(scale[:3], 1.0 / np.diag(given.dense())[:3], rtol=1e-13)
    assert scale[4] == scale[5]


def test_constraints_that_move_nothing_count_as_they_are():
    given = Constraints()
    given.rows[6] = 0.0
    scale, spread = given.scales()
    assert scale[3] == spread[3, 3] == 1.0


@pytest.mark.parametrize("length", [1e-6, 1e3])
def test_nodes_without_stiffness_count_alike_in_all_units(length):
    """Rigid bodies in statics have no stiffness but round-off."""
    energy, plain, other = 1e-12, Constraints(), Constraints()
    plain.diagonal[1], plain.diagonal[2, 3:] = 0.0, 1e-30
    units = np.tile(np.repeat([length, 1.0], 3), (3, 1))
    other.rows, other.units = plain.rows / units[other.incidences.nodes], units
    other.diagonal = energy * plain.diagonal / units**2
    expected, found = plain.scales()[0], other.scales()[0]
    np.testing.assert_allclose(found / energy, expected, rtol=1e-12)
    assert expected.min() > 1e-3

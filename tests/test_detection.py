"""Who is near whom: the same pairs in any order, and nothing left out that meets."""

import numpy as np
import pytest

from fem_lie.contact.sides.curves import Opposite, Strands, at, set_curves, set_overlaps
from fem_lie.contact.sides.curves import nearest as nearest_of
from fem_lie.contact.sides.detection import near, near_between
from fem_lie.contact.sides.gauss_points import STEPS, intervals
from fem_lie.contact.sides.passage import are_apart
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, UNUSED

RADIUS = 0.1


def test_pairs_are_the_same_in_any_order_and_as_all_against_all():
    rng = np.random.default_rng(0)
    positions, reach = rng.uniform(0, 4, size=(400, 3)), rng.uniform(0.05, 0.3, size=400)
    gaps = np.linalg.norm(positions[:, np.newaxis] - positions, axis=2)
    wanted = np.argwhere(np.triu(gaps < reach[:, np.newaxis] + reach, 1))
    np.testing.assert_array_equal(near(positions, reach), wanted)
    order = rng.permutation(400)
    again = np.sort(order[near(positions[order], reach[order])], axis=1)
    np.testing.assert_array_equal(again[np.lexsort(again.T[::-1])], wanted)


@pytest.mark.parametrize("first", [3, 200])
def test_pairs_between_two_sides_are_those_of_all(first):
    """A few points among many, which may be large, and equal numbers on both sides."""
    rng = np.random.default_rng(1)
    positions, reach = rng.uniform(0, 4, size=(400, 3)), rng.uniform(0.05, 0.3, size=400)
    reach[:first] *= 4.0 if first == 3 else 1.0
    pairs = near(positions, reach)
    wanted = pairs[(pairs[:, 0] < first) & (pairs[:, 1] >= first)]
    assert len(wanted) > 5
    np.testing.assert_array_equal(near_between(positions, reach, first), wanted)


def curved(count: int, bend: float, seed: int) -> Strands:
    """Pieces fixed to ground, about one long, in a cube of a side of two."""
    rng = np.random.default_rng(seed)
    start = rng.uniform(0, 2, size=(count, 3))
    along = rng.normal(size=(count, 3))
    along /= np.linalg.norm(along, axis=1)[:, np.newaxis]
    nodes = np.full((count, MOST_NODES), UNUSED)
    nodes[:, 0] = GROUND
    ends, tangents = np.stack([start, start + along], axis=1), bend * rng.normal(size=(count, 2, 3))
    arms = np.zeros((count, MOST_NODES, 4, 3))
    arms[:, 0] = np.concatenate([ends, along[:, np.newaxis] + tangents], axis=1)
    strands = Strands(
        nodes=nodes,
        weights=np.zeros((count, MOST_NODES, 4)),
        arms=arms,
        lengths=np.ones(count),
        chords=np.ones(count),
        stretches=np.ones(count),
        radii=np.full(count, RADIUS),
        before=np.full(count, -1),
        after=np.full(count, -1),
        curves=np.zeros((count, 4, 3)),
        bulges=np.zeros(count),
    )
    set_curves(np.zeros((1, 4, 3)), strands, False)
    return strands


@pytest.mark.parametrize(("bend", "part"), [(0.0, 1.0), (1e-3, 0.99), (0.3, 0.6), (1.5, 0.1)])
def test_what_overlaps_is_not_apart(bend, part):
    """And of what does not the more is seen to be, the straighter lines are."""
    a, b = curved(60, bend, 1), curved(60, bend, 2)
    nowhere, found, seen = (0.0, 0.0, 0.0), 0, 0
    for i in range(60):
        for j in range(60):
            other = Opposite(j, j, nowhere, nowhere, 2 * RADIUS)
            meets = set_overlaps(a.curves[i], b, other, STEPS, intervals()) > 0
            apart = are_apart(a, i, b, other)
            assert not (meets and apart)
            found, seen = found + meets, seen + apart
    assert found > 100
    assert seen >= part * (3600 - found)


def test_all_that_overlaps_is_found_on_bent_segments():
    """Where the gap has several extrema within a tenth of a segment, too."""
    a, b, parts, reach = curved(100, 0.7, 4), curved(100, 0.7, 5), intervals(), 0.03
    stations, nowhere, overlaps = np.linspace(0.0, 1.0, 301), (0.0, 0.0, 0.0), 0
    for i in range(100):
        points = [at(a.curves[i], s) for s in stations]
        for j in range(100):
            other = Opposite(j, j, nowhere, nowhere, reach)
            if are_apart(a, i, b, other):
                continue
            found = parts[: set_overlaps(a.curves[i], b, other, STEPS, parts)]
            squares = np.array([nearest_of(b, other, P)[0] for P in points])
            within = ((found[:, :1] <= stations) & (stations <= found[:, 1:])).any(axis=0)
            np.testing.assert_array_equal(within, squares < reach**2)
            overlaps += len(found)
    assert overlaps > 30


def test_curves_are_within_their_bulges():
    strands = curved(50, 0.7, 3)
    for C, bulge in zip(strands.curves, strands.bulges, strict=True):
        off = [np.array(at(C, s)) - (1 - s) * C[0] - s * C[1] for s in np.linspace(0, 1, 21)]
        assert np.linalg.norm(off, axis=1).max() <= bulge * (1 + 1e-12)


def test_parallel_chords_that_touch_are_not_apart():
    """Along a line, beside each other and of no length."""
    strands = curved(3, 0.0, 4)
    for shift in ((0.0, 0.2, 0.0), (1.2, 0.0, 0.0), (0.5, 0.2 / np.sqrt(2), 0.2 / np.sqrt(2))):
        strands.curves[:] = 0.0
        strands.curves[0, 1:, 0] = 1.0
        strands.curves[1] = strands.curves[0]
        strands.curves[1, :2] += shift
        strands.curves[2, :2] = shift
        for j in (1, 2):
            for part, wanted in ((1.0 - 1e-9, True), (1.0 + 1e-9, False)):
                other = Opposite(j, j, shift, shift, part * 0.2)
                assert are_apart(strands, 0, strands, other) == wanted


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("shape", [(1, 1, 1), (100, 1, 0), (0, 0, 0), (1e9, 1, 1)])
def test_pairs_are_those_of_all_pairs(seed, shape):
    """Whatever the cells, in increasing order, and in any order of the positions."""
    rng = np.random.default_rng(seed)
    X = rng.uniform(size=(300, 3)) * shape + [5.0, -3.0, 0.0]
    reach = rng.uniform(0.02, 0.06, size=300)
    i, j = np.triu_indices(300, 1)
    distance = np.linalg.norm(X[i] - X[j], axis=1)
    close = distance < reach[i] + reach[j]
    expected = np.transpose([i[close], j[close]])
    np.testing.assert_array_equal(near(X, reach), expected)
    order = rng.permutation(300)
    found = np.sort(order[near(X[order], reach[order])], axis=1)
    np.testing.assert_array_equal(found[np.lexsort((found[:, 1], found[:, 0]))], expected)

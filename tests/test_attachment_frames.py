"""Laws of attachments: frames with a Jacobian, whatever they hold on to."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fem_lie import lie
from fem_lie.attachments.at_nodes import along_tangent, at_node, on_section
from fem_lie.attachments.attachment import bend, changes, cores, locate, spread
from fem_lie.attachments.between_frames import interpolated, on_geodesic
from fem_lie.attachments.patch import averaging_attachment
from fem_lie.attachments.surface import on_surface
from fem_lie.extend import node_types
from fem_lie.system.nodes.numbering import MasterMap

seeds = st.integers(0, 2**32 - 1)


def moved_frames(X, h):
    return lie.se3_retract(X, h)


def moved_slopes(X, h):
    """Nodes of position and slope moved in their own axes, which are carried with the tangent."""
    axes = X[:, 1:].copy()
    axes[:, 0] /= np.linalg.norm(axes[:, 0], axis=1, keepdims=True)
    moved = X.copy()
    moved[:, 0] += np.einsum("nij,ni->nj", axes, h[:, :3])
    moved[:, 1] += np.einsum("nij,ni->nj", axes, h[:, 3:])
    for row, old in zip(moved, axes, strict=True):
        t = row[1] / np.linalg.norm(row[1])
        a = np.cross(old[0], t)
        turn = np.eye(3) + lie.hat(a) + lie.hat(a) @ lie.hat(a) / (1.0 + old[0] @ t)
        row[2:] = old[1:] @ turn.T
    return moved


def moved_places(X, h):
    """Nodes that are positions, along axes that stay."""
    moved = X.copy()
    moved[:, 0] += np.einsum("nij,ni->nj", X[:, 1:], h[:, :3])
    return moved


PLACES = np.array(
    [[1.0, 0.2, 0], [-0.9, 0.1, 0.3], [0.1, 1.1, -0.2], [0.3, -0.8, 0.5], [0, 0, 1.2]]
)
PATCHES = {"patch": PLACES, "flat patch": PLACES[:4] * [1, 1, 0]}


def patch(positions):
    axes = lie.se3_exp(np.array([0, 0, 0, 0.3, -0.5, 0.2]))[1:]
    return averaging_attachment(
        range(len(positions)), positions, np.arange(1.0, 1.0 + len(positions)), axes
    )


def near_patch(positions, rng):
    """Rows of nodes about a patch that is deformed and moved, with any axes."""
    X = lie.se3_exp(rng.normal(size=(len(positions), 6)))
    X[:, 0] = positions + 0.1 * rng.normal(size=positions.shape)
    return lie.se3_compose(lie.se3_exp(rng.normal(size=6)), X)


ON_SURFACES = {"surface", "cross-section"}
SURFACES = np.repeat([node_types.SURFACE_GRADIENT, node_types.MIXED_DERIVATIVE], 2)


def moved_surface(X, h):
    """Two nodes of a point of a surface; their axes stay."""
    moved = np.empty_like(X)
    node_types.retract_all(SURFACES, X, h, moved)
    return moved


def turned_with(motion, X, name):
    """All nodes moved rigidly, axes that are no rows, too."""
    moved = lie.se3_compose(motion, X)
    if name in ON_SURFACES:
        axes = node_types.all_axes(SURFACES, X) @ motion[1:]
        node_types.set_all_axes(SURFACES, moved, axes)
    return moved


OF_PLACES = [[0.6, -1.0, 0.1], [0.4, 1.0, -0.1], [0.0, 0.1, 0.2], [0.1, -0.1, 0.1]]
OF_SLOPES = [[0.1, 0.6, 0.1], [-0.1, 0.4, 0.1], [0.1, 0.2, 0.6], [-0.1, 0.1, 0.5]]
SHARES = np.stack([OF_PLACES, OF_SLOPES], axis=1)
OFFSET = lie.se3_exp(np.array([0.3, -0.2, 0.5, 0.4, 0.1, -0.3]))
ATTACHMENTS = {
    "geodesic": (on_geodesic(0, 1, 0.3), moved_frames),
    "two directors": (interpolated((0, 1), (0.7, 0.3)), moved_frames),
    "three directors": (interpolated((0, 1, 2), (0.28, -0.12, 0.84)), moved_frames),
    "node": (at_node(0, OFFSET), moved_frames),
    "tangent": (along_tangent(0), moved_slopes),
    **{name: (patch(positions), moved_places) for name, positions in PATCHES.items()},
    "surface": (on_surface(range(4), SHARES), moved_surface),
    "cross-section": (on_section(range(4), SHARES), moved_surface),
}
"""Each with how its nodes move: adding one here tests it."""


def state(name: str, seed: int):
    """An attachment, rows of its nodes within half a right angle of each other, and a generator."""
    rng = np.random.default_rng(seed)
    attachment, move = ATTACHMENTS[name]
    near = rng.normal(size=(len(attachment.nodes), 6)) * [0.5, 0.5, 0.5, 0.25, 0.25, 0.25]
    if name in ON_SURFACES:
        near *= 0.1  # differences of positions are slopes, which must not be along each other
    X = lie.se3_compose(lie.se3_exp(rng.normal(size=6)), lie.se3_exp(near))
    if name == "tangent":
        X[:, 1] *= 0.5 + rng.random()
    if name in PATCHES:
        X = near_patch(PATCHES[name], rng)
    return attachment, np.array(attachment.data), X, move, rng


def one(attachment, data, X):
    H, J = locate(attachment.kind, X[np.newaxis], data[np.newaxis])
    return H[0], J[0]


def pulled(attachment, data, X, f):
    return np.einsum("kij,i->kj", one(attachment, data, X)[1], f)


@pytest.mark.parametrize("name", ATTACHMENTS)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_the_jacobian_is_the_derivative_of_the_frame(name, seed):
    attachment, data, X, move, rng = state(name, seed)
    _, J = one(attachment, data, X)
    h = rng.normal(size=(len(X), 6))
    ahead, behind = (one(attachment, data, move(X, s * h))[0] for s in (1e-5, -1e-5))
    twist = lie.se3_relative(behind, ahead) / 2e-5
    # differences: 1e-10 times third derivatives, and round-off over the step
    np.testing.assert_allclose(np.einsum("kij,kj->i", J, h), twist, atol=2e-8)


@pytest.mark.parametrize("name", PATCHES)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_mean_coordinates_move_the_frame_and_couple_all_nodes(name, seed):
    attachment, data, X, _, rng = state(name, seed)
    f, h, means = rng.normal(size=6), rng.normal(size=(len(X), 6)), attachment.kind.means
    given = X[np.newaxis], data[np.newaxis]
    (S,) = spread(means, *given)
    (L,), (C,) = cores(means, *given, f[np.newaxis])
    _, J = one(attachment, data, X)
    rates = np.einsum("krj,kj->r", S, h)
    np.testing.assert_allclose(L @ rates, np.einsum("kij,kj->i", J, h), atol=1e-12)
    (K,) = bend(attachment.kind, *given, f[np.newaxis])
    coupled = np.einsum("krj,rs,s->kj", S, C, rates)
    np.testing.assert_allclose(coupled, np.einsum("kiaj,aj->ki", K, h), atol=1e-11)


@pytest.mark.parametrize("name", ATTACHMENTS)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_geometric_stiffness_is_the_derivative_of_the_nodal_forces(name, seed):
    attachment, data, X, move, rng = state(name, seed)
    f, h = rng.normal(size=6), rng.normal(size=(len(X), 6))
    K = bend(attachment.kind, X[np.newaxis], data[np.newaxis], f[np.newaxis])[0]
    ahead, behind = (pulled(attachment, data, move(X, s * h), f) for s in (1e-5, -1e-5))
    numeric = (ahead - behind) / 2e-5
    np.testing.assert_allclose(np.einsum("aibj,bj->ai", K, h), numeric, atol=2e-8)


@pytest.mark.parametrize("name", ATTACHMENTS)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_changes_are_second_rates_of_the_frame(name, seed):
    attachment, data, X, move, rng = state(name, seed)
    h = rng.normal(size=(len(X), 6))
    rate = changes(attachment.kind, X[np.newaxis], data[np.newaxis], h[np.newaxis])[0]
    # nodes that move along exp(t h) have constant twists
    ahead, behind = (one(attachment, data, move(X, s * h))[1] for s in (1e-5, -1e-5))
    numeric = np.einsum("kij,kj->i", ahead - behind, h) / 2e-5
    np.testing.assert_allclose(rate, numeric, atol=1e-7)


@pytest.mark.parametrize("name", ATTACHMENTS)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_frames_are_frames_and_rotate_with_the_body(name, seed):
    attachment, data, X, _, rng = state(name, seed)
    H, J = one(attachment, data, X)
    np.testing.assert_allclose(H[1:] @ H[1:].T, np.eye(3), atol=1e-14)
    motion = lie.se3_exp(rng.normal(size=6))
    moved, same = one(attachment, data, turned_with(motion, X, name))
    np.testing.assert_allclose(moved, lie.se3_compose(motion, H), atol=1e-13)
    np.testing.assert_allclose(same, J, atol=1e-13)
    if name == "tangent":
        np.testing.assert_allclose(H[1], X[0, 1] / np.linalg.norm(X[0, 1]), atol=1e-14)
        return  # it has no spin about that
    if name in PATCHES:
        twist = rng.normal(size=6)
        about = np.cross(twist[3:], X[:, 0]) + twist[:3]
        own = np.zeros((len(X), 6))
        own[:, :3] = np.einsum("nij,nj->ni", X[:, 1:], about)
        wanted = lie.se3_adjoint(lie.se3_inverse(H)) @ twist
        np.testing.assert_allclose(np.einsum("kij,kj->i", J, own), wanted, atol=1e-12)
        return
    # of a rigid motion the attachment has the same as all nodes
    twist = rng.normal(size=6)
    if name in ON_SURFACES:
        rigid = node_types.rigid_motions(SURFACES, X, np.zeros(3))
        shown = np.concatenate([H[1:] @ (twist[:3] + np.cross(twist[3:], H[0])), H[1:] @ twist[3:]])
        np.testing.assert_allclose(np.einsum("kij,kjl,l->i", J, rigid, twist), shown, atol=1e-13)
        return
    own = np.array([lie.se3_adjoint(lie.se3_inverse(row)) @ twist for row in X])
    wanted = lie.se3_adjoint(lie.se3_inverse(H)) @ twist
    np.testing.assert_allclose(np.einsum("kij,kj->i", J, own), wanted, atol=1e-13)


def test_many_states_at_once():
    attachment, _, X, _, _ = state("geodesic", 1)
    many = np.stack([X, lie.se3_retract(X, np.full((2, 6), 0.1)), X])
    found = attachment.frame(many)
    assert found.shape == (3, 4, 3)
    np.testing.assert_array_equal(found[1], attachment.frame(many[1]))


def test_an_unloaded_patch_is_where_it_was_with_its_axes():
    positions = PATCHES["flat patch"]
    X = np.tile(lie.frame(np.zeros(3), np.eye(3)), (4, 1, 1))
    X[:, 0] = positions
    found = patch(positions).frame(X)
    np.testing.assert_allclose(found[0], np.array([1, 2, 3, 4]) @ positions / 10, atol=1e-15)
    axes = lie.se3_exp(np.array([0, 0, 0, 0.3, -0.5, 0.2]))[1:]
    np.testing.assert_allclose(found[1:], axes, atol=1e-15)


def test_a_patch_on_a_line_is_refused():
    positions = np.outer([0.0, 1.0, 2.5], [1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="not collinear"):
        averaging_attachment(range(3), positions, np.ones(3), np.eye(3))


# --- rigid attachments ---


def test_forces_on_rigid_attachments_are_the_transposed_of_their_twists():
    """Power is the same on all nodes and on the master nodes; ``q = W q_master``."""
    rng = np.random.default_rng(1)
    H = lie.se3_exp(rng.normal(size=(6, 6)))
    master_map = MasterMap(H, [(4, 1), (5, 4), (3, 0)])
    assert master_map.masters.tolist() == [2, 3, 5]
    assert master_map.master.tolist() == [1, 2, 0, 1, 2, 2]
    moved = lie.se3_retract(H[master_map.masters], rng.normal(size=(3, 6)))
    frames, v, f = master_map.frames(moved), rng.normal(size=(3, 6)), rng.normal(size=(6, 6))
    W = master_map.linear()
    np.testing.assert_allclose(
        np.einsum("nab,nbj->naj", W, moved[master_map.master]), frames, atol=1e-14
    )
    collected = np.zeros((3, 6))
    master_map.collect(f, collected)
    assert np.sum(f * master_map.twists(v)) == pytest.approx(np.sum(collected * v), rel=1e-13)
    step = 1e-6
    ahead, behind = (master_map.frames(lie.se3_retract(moved, s * v)) for s in (step, -step))
    numeric = lie.se3_relative(behind, ahead) / (2 * step)
    np.testing.assert_allclose(master_map.twists(v), numeric, atol=1e-8)

"""Laws that hold for every kind of node, whatever its rows and unknowns mean."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types
from fem_lie.lie.node_types import (
    MODAL,
    POSITION,
    POSITION_GRADIENT,
    SURFACE_GRADIENT,
    TRAITS,
    inertia,
)
from fem_lie.system import System
from fem_lie.system.nodes import numbering

KINDS = {
    f"{group.name}, {parametrisation.name}": group + 2 * parametrisation
    for group in fl.lie.Group
    for parametrisation in fl.lie.Parametrisation
} | {kind.name: int(kind) for kind in fl.extend.NodeType if kind >= POSITION_GRADIENT}
STEP = 1e-5
WEIGHTS = {-2: -1 / 12, -1: 4 / 3, 0: -5 / 2, 1: 4 / 3, 2: -1 / 12}

every_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS.keys())


class Node:
    """A node anywhere, moving anyhow."""

    def __init__(self, kind: int, seed: int = 3) -> None:
        rng = np.random.default_rng(seed)
        self.kind, self.kinds = kind, np.array([kind])
        self.H = lie.se3_exp(rng.normal(size=(1, 6)))
        rows = TRAITS[
            fl.extend.NodeType.FRAME if kind < POSITION_GRADIENT else fl.extend.NodeType(kind)
        ].rows
        self.rows, self.placed = slice(rows.start, rows.stop), rows.start == 0
        if kind in (POSITION_GRADIENT, SURFACE_GRADIENT):
            self.H[:, 1] *= 1.3
        self.v, self.a, self.h = rng.normal(size=(3, 1, 6))
        self.f = np.zeros((1, 4, 3))
        self.f[:, self.rows] = rng.normal(size=(1, 4, 3))[:, self.rows]

    def follow(self, h):
        out = np.empty_like(self.H)
        node_types.retract_all(self.kinds, self.H, h, out)
        return out

    def push(self, H, v):
        out = np.empty((1, 4, 3))
        node_types.push_all_forward(self.kinds, H, v, out)
        return out

    def pull(self, H, f):
        out = np.zeros(6)
        node_types.pull_all_back(self.kinds, H, f, 1.0, out)
        return out

    def group(self, H, twist, rate):
        """Velocity and acceleration of the group."""
        v, vdot = np.empty((2, 1, 6))
        node_types.all_from_local(self.kinds, H, twist, rate, v, vdot)
        return v, vdot

    def at(self, t):
        """Moved at constant acceleration of the group, and its velocity in its axes."""
        v, vdot = self.group(self.H, self.v, self.a)
        H = np.empty_like(self.H)
        d, rate = v * t + 0.5 * vdot * t**2, v + vdot * t
        node_types.move_all(self.kinds, self.H, d, H)
        x, twist = rate.copy(), np.empty_like(rate)
        node_types.all_from_group(self.kinds, H, x)
        node_types.twists(self.kinds, d, x, twist)
        return H, twist


@every_kind
def test_push_is_how_the_rows_move(kind):
    node = Node(kind)
    ahead, behind = node.follow(STEP * node.v), node.follow(-STEP * node.v)
    numeric = (ahead - behind)[:, node.rows] / (2 * STEP)
    np.testing.assert_allclose(node.push(node.H, node.v)[:, node.rows], numeric, atol=1e-8)


@every_kind
def test_increments_move_as_velocities_do(kind):
    """``T(d)`` takes corrections of increments, in the node's axes, to its velocity."""
    node = Node(kind)
    numeric = (node.at(0.3 + STEP)[0] - node.at(0.3 - STEP)[0]) / (2 * STEP)
    pushed = node.push(*node.at(0.3))
    np.testing.assert_allclose(pushed[:, node.rows], numeric[:, node.rows], atol=1e-7)


@every_kind
def test_corrections_of_increments_from_twists(kind):
    """``T⁻¹(d)`` after ``T(d)``."""
    node = Node(kind)
    twist = np.empty_like(node.h)
    node_types.twists(node.kinds, node.a, node.h, twist)
    inverse = np.empty((6, 6))
    node_types.tangent_inverse(kind, node.a[0], inverse)
    np.testing.assert_allclose(twist @ inverse.T, node.h, atol=1e-14)


@every_kind
def test_pull_is_the_transpose_of_push(kind):
    node = Node(kind)
    work = np.vdot(node.f, node.push(node.H, node.v))
    assert node.pull(node.H, node.f) @ node.v[0] == pytest.approx(work, rel=1e-13)


@every_kind
def test_derivative_of_pull(kind):
    node, block, numeric = Node(kind), np.zeros((6, 6)), np.empty((6, 6))
    node_types.pull_back_derivative(kind, node.H[0], node.f[0], 1.0, block)
    for k, h in enumerate(STEP * np.eye(6)[:, np.newaxis]):
        ahead, behind = (node.pull(node.follow(s * h), node.f) for s in (1, -1))
        numeric[:, k] = (ahead - behind) / (2 * STEP)
    np.testing.assert_allclose(block, numeric, atol=1e-8)


@every_kind
def test_acceleration_is_the_second_derivative_of_the_rows(kind):
    node, t, found = Node(kind), 1e-3, np.empty((1, 4, 3))
    inertia.accelerations(node.kinds, node.H, node.v, node.a, found)
    numeric = sum(w * node.at(k * t)[0] for k, w in WEIGHTS.items()) / t**2
    numeric, found = numeric[:, node.rows], found[:, node.rows]
    np.testing.assert_allclose(found, numeric, atol=1e-7 * np.abs(numeric).max())


@every_kind
def test_power_of_inertia_is_the_rate_of_kinetic_energy(kind):
    """``v · Lᵀ G (L a + L̇ v) = d/dt ½ q̇ · G q̇`` with any constant matrix."""
    node, t = Node(kind), 1e-3
    root = np.random.default_rng(5).normal(size=(4, 4))
    root[[row for row in range(4) if row not in range(4)[node.rows]]] = 0.0
    G = root @ root.T

    def energy(time):
        rates = node.push(*node.at(time))[0]
        return 0.5 * np.vdot(rates, G @ rates)

    q = np.empty((1, 4, 3))
    inertia.accelerations(node.kinds, node.H, node.v, node.a, q)
    power = node.pull(node.H, G @ q) @ node.v[0]
    rate = (8 * (energy(t) - energy(-t)) - energy(2 * t) + energy(-2 * t)) / (12 * t)
    assert power == pytest.approx(rate, rel=1e-8)


@every_kind
def test_velocities_and_accelerations_of_the_group_and_back(kind):
    node, back = Node(kind), np.empty((2, 6))
    v, vdot = node.group(node.H, node.v, node.a)
    node_types.to_local(kind, node.H[0], v[0], vdot[0], back[0], back[1])
    np.testing.assert_allclose(back, (node.v[0], node.a[0]), atol=1e-14)
    x = node.h.copy()
    node_types.all_to_group(node.kinds, node.H, x)
    node_types.all_from_group(node.kinds, node.H, x)
    np.testing.assert_allclose(x, node.h, atol=1e-14)


@every_kind
def test_what_increments_lack_of_the_series_of_velocities(kind):
    """``h v + ½h² v̇ + h³ (v̈/6 + bend/12)`` is the increment of a motion, to fourth order."""
    node = Node(kind)
    v, vdot = node.group(node.H, node.v, node.a)
    bend = np.empty_like(v)
    node_types.all_cubic_terms(node.kinds, v, vdot, bend)

    def gap(h):
        """A motion with velocity v + v̇ t, in small steps, against the increment."""
        H, parts = node.H, 400
        for k in range(parts):
            d = h / parts * (v + vdot * (k + 0.5) * h / parts)
            node_types.move_all(node.kinds, H, d, out := np.empty_like(H))
            H = out
        whole = np.empty_like(H)
        d = h * v + 0.5 * h**2 * vdot + h**3 / 12 * bend
        node_types.move_all(node.kinds, node.H, d, whole)
        return np.abs(H - whole)[:, node.rows].max()

    assert gap(0.02) < 1e-13 or gap(0.04) / gap(0.02) > 12


@every_kind
def test_rigid_motions(kind):
    """Turning everything about a position moves all rows as their velocities say."""
    node, about = Node(kind), np.array([0.3, -2.0, 1.0])
    motions = node_types.rigid_motions(node.kinds, node.H, about)[0]
    ξ = np.array([0.4, 1.0, -0.3, 0.7, -0.2, 0.5])
    expected = np.cross(ξ[3:], node.H[0]) if kind != MODAL else np.zeros((4, 3))
    if node.placed:
        expected[0] = ξ[:3] + np.cross(ξ[3:], node.H[0, 0] - about)
    found = node.push(node.H, (motions @ ξ)[np.newaxis])[0]
    np.testing.assert_allclose(found[node.rows], expected[node.rows], atol=1e-14)


@every_kind
def test_forces_are_seen_as_resultants(kind):
    """Power of a force in rigid motion is that of its force and moment about the node."""
    node = Node(kind)
    r = node.pull(node.H, node.f)
    force, moment = node_types.wrench(kind, node.H[0], r)
    if kind == MODAL:
        np.testing.assert_array_equal((force, moment), 0.0)
        return
    np.testing.assert_allclose(force, node.f[0, 0], atol=1e-14)
    np.testing.assert_allclose(
        moment, np.cross(node.H[0, 1:], node.f[0, 1:]).sum(axis=0), atol=1e-13
    )


@every_kind
def test_shown_velocities_are_of_the_rows(kind):
    """The position moves by ``Σ uₖ rowₖ``, and where only rotation counts the rows turn by θ."""
    node, shown = Node(kind), np.empty((1, 6))
    node_types.all_result_twists(node.kinds, node.H, node.v, shown)
    if kind == MODAL:
        np.testing.assert_array_equal(shown, node.v)
        return
    if not node.placed:
        np.testing.assert_array_equal(shown, 0.0)
        return
    rates = node.push(node.H, node.v)[0]
    np.testing.assert_allclose(shown[0, :3] @ node.H[0, 1:], rates[0], atol=1e-13)
    spin, first = shown[0, 3:] @ node.H[0, 1:], node.H[0, 1]
    across = rates[1] - first * (first @ rates[1]) / (first @ first)
    np.testing.assert_allclose(np.cross(spin, first), across, atol=1e-13)


@pytest.mark.parametrize("kind", [kind for kind in fl.extend.NodeType if POSITION <= kind < MODAL])
def test_axes_are_what_they_were_set_to(kind):
    """Straight rows stay, and so do the axes in any motion."""
    node, R = Node(kind), lie.se3_exp(np.random.default_rng(8).normal(size=(1, 6)))[:, 1:]
    H = node.H.copy()
    node_types.set_all_axes(node.kinds, H, R)
    np.testing.assert_array_equal(H[:, node.rows], node.H[:, node.rows])
    moved = np.empty_like(H)
    node_types.move_all(node.kinds, H, node.h, moved)
    for rows in (H, moved):
        np.testing.assert_allclose(node_types.all_axes(node.kinds, rows), R, atol=1e-14)


def test_carried_axes_stay_unit_vectors_without_twist():
    """A slope goes round a closed path on the sphere: what is left is the solid angle."""
    H = np.array([[[0.0, 0, 0], [2.0, 0, 0], [0, 1, 0], [0, 0, 1]]])
    corners, kind = 2.0 * np.eye(3), np.array([POSITION_GRADIENT])
    for to in (corners[1], corners[2], corners[0]):
        start = H[0, 1].copy()
        for angle in np.linspace(0.0, np.pi / 2, 6)[1:]:
            d = np.zeros((1, 6))
            d[0, 3:] = np.cos(angle) * start + np.sin(angle) * to - H[0, 1]
            node_types.move_all(kind, H, d, out := np.empty_like(H))
            H = out
    np.testing.assert_allclose(H[0, 1:] @ H[0, 1:].T, np.diag([4.0, 1, 1]), atol=1e-14)
    # the octant has the solid angle π/2
    np.testing.assert_allclose(H[0, 1:], [[2, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-14)


def test_clamps_hold_position_and_direction():
    """A clamped slope may still be stretched."""
    node = Node(POSITION_GRADIENT)
    h = np.where(TRAITS[fl.extend.NodeType.POSITION_GRADIENT].clamp_holds, 0.0, node.h)
    moved = node.follow(h)
    np.testing.assert_array_equal(moved[0, 0], node.H[0, 0])
    assert np.abs(np.cross(moved[0, 1], node.H[0, 1])).max() < 1e-15
    assert np.abs(moved[0, 1] - node.H[0, 1]).max() > 0.1


def test_unknowns_that_a_kind_does_not_have_are_none_of_the_matrix(monkeypatch):
    """Fewer of them are unit rows and couple with nothing; equations are those of the others."""
    section = fl.Section.from_stiffness([1e3, 1, 1, 1, 1, 1], mass=1.0)
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), section, cells=2)
    scene = fl.Scene()
    scene.add(cable)
    three = TRAITS[fl.extend.NodeType.POSITION_GRADIENT]._replace(unknowns=3)
    monkeypatch.setattr(
        numbering, "TRAITS", {**TRAITS, fl.extend.NodeType.POSITION_GRADIENT: three}
    )
    system = System(scene, dynamics=True)
    assert system.held[:, 3:].all() and not system.held[:, :3].any()
    _, columns, pointers = system.kkt.csr
    sizes = np.diff(pointers).reshape(-1, 6)
    assert (sizes[:, 3:] == 1).all()
    assert set(columns % 6) == set(range(6)) and (columns[columns % 6 >= 3]).size == 3 * 3

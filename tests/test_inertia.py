"""Inertia in redundant coordinates against mechanics written otherwise; rates of directors."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st
from mass_matrix import mass_matrix_6x6
from models import few

import fem_lie as fl
from fem_lie import lie
from fem_lie.forms import frames
from fem_lie.lie.node_types import inertia
from fem_lie.lie.node_types.inertia import (
    Inertia,
    director_inertia,
    local_twists,
    turning_of,
)
from fem_lie.system import System

seeds = st.integers(0, 2**32 - 1)


class Body:
    """Three nodes: a chain coupled by consistent blocks, each a random distribution of mass."""

    indptr = np.array([0, 2, 5, 7], dtype=np.int32)
    indices = np.array([0, 1, 0, 1, 2, 1, 2], dtype=np.int32)

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        n = 3
        self.H = lie.se3_exp(rng.normal(size=(n, 6)) * [2, 2, 2, 1.5, 1.5, 1.5])
        self.v, self.a = rng.normal(size=(2, n, 6))
        self.rng = rng
        self.dense = np.zeros((n, 4, n, 4))
        for i in range(n - 1):
            mass_matrix = random_mass_matrix(rng)
            for a in (i, i + 1):
                for b in (i, i + 1):
                    self.dense[a, :, b] += mass_matrix * (2.0 if a == b else 1.0) / 6
        rows = np.repeat(np.arange(n), np.diff(self.indptr))
        self.blocks = np.array(
            [self.dense[i, :, j] for i, j in zip(rows, self.indices, strict=True)]
        )
        self.pattern = (self.indptr, self.indices, self.blocks)

    def times(self, q: np.ndarray) -> np.ndarray:
        return np.einsum("iajb,jbk->iak", self.dense, q)

    def force(self, H=None, v=None, a=None) -> np.ndarray:
        """``Lᵀ G q̈`` by the compiled functions, shape (n, 6)."""
        H, v, a = (getattr(self, k) if x is None else x for k, x in (("H", H), ("v", v), ("a", a)))
        acceleration, load, r = np.empty_like(H), np.empty_like(H), np.zeros_like(v)
        inertia.accelerations(on_se3(H), H, v, a, acceleration)
        inertia.multiply(*self.pattern, acceleration, load)
        frames.pull_back(H, load, 1.0, r)
        return r


def on_se3(H: np.ndarray) -> np.ndarray:
    """Kinds of so many frames."""
    return np.zeros(len(H), dtype=np.int64)


def random_mass_matrix(rng: np.random.Generator) -> np.ndarray:
    """Mass matrix of ten random masses: any body, its centre of mass off the origin."""
    points = np.column_stack([np.ones(10), rng.normal(size=(10, 3)) + rng.normal(size=3)])
    return np.einsum("p,pa,pb->ab", rng.uniform(0.1, 1.0, 10), points, points)


def motion(H: np.ndarray, v: np.ndarray, a: np.ndarray, t: float) -> np.ndarray:
    """Frames that move with local velocity v and acceleration a at t = 0."""
    return lie.se3_retract(H, v * t + 0.5 * a * t**2)


@given(seed=seeds)
@few
def test_push_is_the_derivative_of_the_frames(seed):
    body, step = Body(seed), 1e-5
    pushed = np.empty_like(body.H)
    frames.push_forward(body.H, body.v, pushed)
    zero = np.zeros_like(body.v)
    ahead, back = (motion(body.H, body.v, zero, t) for t in (step, -step))
    # step² of third derivatives
    np.testing.assert_allclose(pushed, (ahead - back) / (2 * step), atol=1e-8)


@given(seed=seeds)
@few
def test_pull_is_the_transpose_of_push(seed):
    body = Body(seed)
    f, pushed, r = body.rng.normal(size=(3, 4, 3)), np.empty((3, 4, 3)), np.ones((3, 6))
    frames.push_forward(body.H, body.v, pushed)
    frames.pull_back(body.H, f, -2.0, r)  # adds, with a factor
    assert np.vdot(r - 1, body.v) == pytest.approx(-2.0 * np.vdot(f, pushed), rel=1e-12, abs=1e-12)


@given(seed=seeds)
@few
def test_pull_derivative(seed):
    body, step = Body(seed), 1e-5
    f, block = body.rng.normal(size=(1, 4, 3)), np.ones((6, 6))
    frames.pull_back_derivative(body.H[0], f[0], -2.0, block)
    for j, h in enumerate(step * np.eye(6)):
        pulled = np.zeros((2, 1, 6))
        for k, sign in enumerate((1, -1)):
            frames.pull_back(lie.se3_retract(body.H[:1], sign * h), f, 1.0, pulled[k])
        column = (pulled[0, 0] - pulled[1, 0]) / (2 * step)
        np.testing.assert_allclose(block[:, j] - 1, -2.0 * column, atol=1e-8)


@given(seed=seeds)
@few
def test_accelerations_are_second_derivatives(seed):
    body, t = Body(seed), 1e-3
    out = np.empty_like(body.H)
    inertia.accelerations(on_se3(body.H), body.H, body.v, body.a, out)
    # five points: t⁴ of sixth derivatives, and 1e-15 / t²
    weights = {-2: -1 / 12, -1: 4 / 3, 0: -5 / 2, 1: 4 / 3, 2: -1 / 12}
    numeric = sum(w * motion(body.H, body.v, body.a, k * t) for k, w in weights.items()) / t**2
    np.testing.assert_allclose(out, numeric, atol=1e-7 * max(1.0, np.abs(numeric).max()))


@given(seed=seeds)
@few
def test_force_is_dalemberts(seed):
    """Virtual work of the inertia force: ``Σ G q̈ · δq``, all of it by differences of frames."""
    body, t = Body(seed), 1e-3
    weights = {-2: -1 / 12, -1: 4 / 3, 0: -5 / 2, 1: 4 / 3, 2: -1 / 12}
    acceleration = sum(w * motion(body.H, body.v, body.a, k * t) for k, w in weights.items()) / t**2
    load = body.times(acceleration)
    h = body.rng.normal(size=(3, 6))
    ahead, back = (lie.se3_retract(body.H, s * h) for s in (1e-5, -1e-5))
    work = np.vdot(load, ahead - back) / 2e-5
    scale = np.abs(load).max() * np.abs(h).max()
    assert np.vdot(body.force(), h) == pytest.approx(work, abs=1e-7 * scale)


@given(seed=seeds)
@few
def test_one_block_is_a_rigid_body(seed):
    """``M v̇ − ad(v)ᵀ M v`` with the 6×6 mass matrix, the centre of mass anywhere."""
    rng = np.random.default_rng(seed)
    G = random_mass_matrix(rng)
    H = lie.se3_exp(rng.normal(size=(1, 6)))
    v, a = rng.normal(size=(2, 1, 6))
    out, load, r = np.empty_like(H), np.empty_like(H), np.zeros((1, 6))
    inertia.accelerations(on_se3(H), H, v, a, out)
    first = np.zeros(1, dtype=np.int32)
    inertia.multiply(np.array([0, 1], dtype=np.int32), first, G[np.newaxis], out, load)
    frames.pull_back(H, load, 1.0, r)
    M = mass_matrix_6x6(G)
    expected = M @ a[0] - lie.se3_ad(v[0]).T @ M @ v[0]
    # sums of a few terms of this size
    np.testing.assert_allclose(r[0], expected, atol=1e-13 * np.abs(M).max() * 10)


@given(seed=seeds)
@few
def test_mass_matrix_gives_the_kinetic_energy_of_points(seed):
    rng = np.random.default_rng(seed)
    points, masses, v = rng.normal(size=(10, 3)) + 1, rng.uniform(0.1, 1, 10), rng.normal(size=6)
    mass_matrix = np.einsum("p,pa,pb->ab", masses, *[np.column_stack([np.ones(10), points])] * 2)
    energy = 0.5 * (masses * ((v[:3] + np.cross(v[3:], points)) ** 2).sum(axis=1)).sum()
    assert 0.5 * v @ mass_matrix_6x6(mass_matrix) @ v == pytest.approx(energy, rel=1e-13)


@given(seed=seeds)
@few
def test_director_mass_matrix_is_that_of_points(seed):
    """Mass, centre and inertia tensor say the same as the points that they come from."""
    rng = np.random.default_rng(seed)
    points, masses = rng.normal(size=(10, 3)) + 1, rng.uniform(0.1, 1, 10)
    mass_matrix = np.einsum("p,pa,pb->ab", masses, *[np.column_stack([np.ones(10), points])] * 2)
    centre = masses @ points / masses.sum()
    arms = points - centre
    inner = (arms**2).sum(axis=1)[:, np.newaxis, np.newaxis] * np.eye(3)
    J = np.einsum("p,pij->ij", masses, inner - np.einsum("pi,pj->pij", arms, arms))
    np.testing.assert_allclose(
        fl.sections.director_mass_matrix(masses.sum(), J, centre), mass_matrix, rtol=1e-12
    )


@given(seed=seeds)
@few
def test_tangents(seed):
    """Derivatives of the force in a, v and h; that of ``Lᵀ`` comes from pull_derivative."""
    body = Body(seed)
    mass, damping, step = 0.7, -1.3, 1e-5
    # blocks in a pattern with other blocks between and in another order
    position = np.array([9, 1, 4, 0, 8, 2, 6])
    A, K = np.ones((11, 6, 6)), np.ones((11, 6, 6))
    H, v, a = body.H, body.v, body.a
    kinds = np.zeros(3, dtype=np.int64)
    inertia.tangents((H, v, a), kinds, body.pattern, (position, position), (mass, damping), (A, K))
    untouched = np.setdiff1d(np.arange(11), position)
    assert (A[untouched] == 1).all() and (K[untouched] == 1).all()

    acceleration, load = np.empty_like(H), np.empty_like(H)
    inertia.accelerations(on_se3(H), H, v, a, acceleration)
    inertia.multiply(*body.pattern, acceleration, load)
    dense = np.zeros((2, 18, 18))
    rows = np.repeat(np.arange(3), np.diff(body.indptr))
    for i, j, p in zip(rows, body.indices, position, strict=True):
        for target, blocks in zip(dense, (A, K), strict=True):
            target[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] = blocks[p] - 1
    for i in range(3):
        frames.pull_back_derivative(
            H[i], load[i], 1.0, dense[1, 6 * i : 6 * i + 6, 6 * i : 6 * i + 6]
        )

    numeric = np.zeros((2, 18, 18))
    for j in range(18):
        e = step * np.eye(1, 18, j).reshape(3, 6)
        by_a = body.force(a=a + e) - body.force(a=a - e)
        by_v = body.force(v=v + e) - body.force(v=v - e)
        by_h = body.force(H=lie.se3_retract(H, e)) - body.force(H=lie.se3_retract(H, -e))
        numeric[0, :, j] = (mass * by_a + damping * by_v).ravel() / (2 * step)
        numeric[1, :, j] = by_h.ravel() / (2 * step)
    np.testing.assert_allclose(dense, numeric, atol=1e-8 * np.abs(numeric).max())


@given(seed=seeds)
@few
def test_invariants_are_direct_sums(seed):
    """Energy, momentum, angular momentum of the coordinates as vectors with masses G."""
    body, step = Body(seed), 1e-5
    zero = np.zeros_like(body.v)
    ahead, back = (motion(body.H, body.v, zero, t) for t in (step, -step))
    q, rate = body.H, (ahead - back) / (2 * step)
    p = body.times(rate)
    expected = [0.5 * np.vdot(rate, p), *p[:, 0].sum(axis=0), *np.cross(q, p).sum(axis=(0, 1))]
    got = inertia.invariants(
        on_se3(body.H), body.H, body.v, *body.pattern, np.empty_like(q), np.empty_like(q)
    )
    # step² of third derivatives
    np.testing.assert_allclose(got, expected, atol=1e-8 * np.abs(expected).max())


@given(seed=seeds)
@few
def test_momenta_of_a_rigid_body(seed):
    """``invariants`` against m ẋ_c and x_c × m ẋ_c + R J ω of a body off its node."""
    rng = np.random.default_rng(seed)
    mass, centre = 2.0, rng.normal(size=3)
    J = np.diag([1.0, 1.2, 1.5])
    H, v = lie.se3_exp(rng.normal(size=(1, 6))), rng.normal(size=(1, 6))
    R, x = lie.rotation(H[0]), H[0, 0]
    velocity = R @ (v[0, :3] + np.cross(v[0, 3:], centre))
    spin = R @ J @ v[0, 3:]
    momentum = mass * velocity
    energy = 0.5 * mass * velocity @ velocity + 0.5 * v[0, 3:] @ J @ v[0, 3:]
    pattern = np.array([0, 1], dtype=np.int32), np.zeros(1, dtype=np.int32)
    G = fl.sections.director_mass_matrix(mass, J, centre)[np.newaxis]
    got = inertia.invariants(on_se3(H), H, v, *pattern, G, np.empty_like(H), np.empty_like(H))
    expected = [energy, *momentum, *(np.cross(x + R @ centre, momentum) + spin)]
    np.testing.assert_allclose(got, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("seed", [1, 2])
def test_momenta_balance_the_force(seed):
    """Rate of momentum = resultant of the force; rate of energy = its power."""
    body, t = Body(seed), 1e-4

    def invariants(time):
        H = motion(body.H, body.v, body.a, time)
        d = body.v * time + 0.5 * body.a * time**2
        v = np.einsum("nij,nj->ni", lie.se3_tangent(d), body.v + body.a * time)
        return np.array(
            inertia.invariants(on_se3(H), H, v, *body.pattern, np.empty_like(H), np.empty_like(H))
        )

    rate = (invariants(t) - invariants(-t)) / (2 * t)
    force = body.force()
    R = lie.rotation(body.H)
    resultant = np.einsum("nij,nj->i", R, force[:, :3])
    moment = np.einsum("nij,nj->i", R, force[:, 3:]) + np.cross(
        body.H[:, 0], np.einsum("nij,nj->ni", R, force[:, :3])
    ).sum(axis=0)
    expected = [np.vdot(force, body.v), *resultant, *moment]
    # t² of third derivatives
    np.testing.assert_allclose(rate, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, (1, 1, 1)), "mass must be a positive finite number, got 0.0"),
        ((np.nan, (1, 1, 1)), "mass must be"),
        ((1.0, (1, 1, 1), (0, np.inf, 0)), "centre must be 3 finite numbers"),
        ((1.0, (1, 1, 1), (0, 0)), "centre must be 3 finite numbers"),
        ((1.0, [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]), "symmetric 3×3"),
        ((1.0, (1, 1)), "symmetric 3×3"),
        ((1.0, (1, 1, -0.1)), "positive principal values"),
        ((1.0, (1, 1, 2.1)), "none greater than the sum of the others"),
        ((1.0, (0, 0, 0)), r"RigidBody.ball\(mass, radius\) has some"),
    ],
)
def test_bodies_that_cannot_be(arguments, message):
    with pytest.raises(ValueError, match=message):
        fl.sections.director_mass_matrix(*arguments)


BEAMS = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director 1": fl.elements.DirectorBeam(1),
    "director 2": fl.elements.DirectorBeam(2),
    "Kirchhoff": fl.elements.KirchhoffRod(),
}


@pytest.mark.parametrize("name", BEAMS)
@given(seed=seeds)
@few
def test_kinetic_energy_is_positive_for_any_rates_of_the_directors(name, seed):
    """Not only for those of frames that turn: sections of all shapes, turned, off their centre."""
    rng = np.random.default_rng(seed)
    width, height = 0.1 * 10 ** rng.uniform(-1.5, 0, 2)
    section = fl.Section.rectangle(width, height, fl.Material(2e11, 0.3, 7800.0))
    section = section.rotated(rng.uniform(0, np.pi)).offset(*(0.1 * rng.normal(size=2)))
    scene, angle = fl.Scene(), rng.uniform(0.01, 2.0)
    cells = max(4, int(np.ceil(angle / 0.3)))
    arc = lambda s: (np.sin(angle * s), 1 - np.cos(angle * s), 0.1 * s)  # noqa: E731
    scene.add(fl.Beam.curve(arc, section, cells=cells, formulation=BEAMS[name]))
    system = System(scene, dynamics=True)
    indptr, indices, blocks = system.inertia
    size = 4 * (len(indptr) - 1)
    found = sp.bsr_matrix((blocks, indices, indptr), shape=(size, size)).toarray()
    values = np.linalg.eigvalsh(found)
    assert values[0] > -1e-13 * values[-1]


# --- angular velocities of nodes whose directors have no inertia, in conserving schemes ---


STEP = 2e-3
SCHEMES = {"energy-momentum": fl.EnergyMomentum(), "energy-decaying": fl.EnergyDecaying(radius=0.8)}


def plate() -> tuple[fl.Scene, fl.Shell]:
    """One that bends while it tumbles; only its third director has inertia."""
    section = fl.ShellSection.layer(0.02, fl.Material(1e6, 0.3, 1000.0))
    shell = fl.Shell(fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.0), (4, 2)), section)
    shell.add_velocity(omega=(1.0, 2.0, 0.5), about=(0, 0, 0))
    scene = fl.Scene()
    scene.add(shell)
    return scene, shell


@pytest.mark.parametrize("name", SCHEMES)
def test_reported_velocities_are_those_of_the_frames(name):
    """Not what directors without inertia remember, which changes sign in every step."""
    scene, _ = plate()
    result = SCHEMES[name].run(scene, duration=0.4, step=STEP)
    moved = lie.se3_relative(result.frames[:-2], result.frames[2:])[:, :, 3:] / (2 * STEP)
    reported = result.velocities[1:-1, :, 3:]
    assert np.abs(moved[..., :2]).max() > 1.0
    np.testing.assert_allclose(reported, moved, atol=0.02 * np.abs(moved).max())


def test_rates_of_a_turning_frame_give_its_velocity():
    """Whatever the inertia, in part or none."""
    rng = np.random.default_rng(1)
    matrices = np.zeros((5, 4, 4))
    matrices[:, 0, 0] = 1.0
    matrices[1, 3, 3] = 1e-6
    matrices[2, 1:, 1:] = np.diag([0.0, 2.0, 1e-3])
    for k in (3, 4):
        points = rng.normal(size=(6, 3))
        matrices[k, 1:, 1:] = points.T @ points
    mass = Inertia(np.arange(6), np.arange(5), matrices)
    H, v = lie.se3_exp(rng.normal(size=(5, 6))), rng.normal(size=(5, 6))
    rates = np.empty((5, 4, 3))
    rates[:, 0] = np.einsum("nk,nkj->nj", v[:, :3], H[:, 1:])
    turned = np.einsum("nij->nji", lie.hat(v[:, 3:]))
    rates[:, 1:] = np.einsum("nki,nij->nkj", turned, H[:, 1:])
    held, found = np.zeros((5, 6), dtype=bool), np.empty((5, 6))
    directors = director_inertia(mass, 5)
    local_twists(H, rates, turning_of(directors, held), found)
    np.testing.assert_allclose(found, v, rtol=1e-12, atol=1e-12)
    # what has no inertia may do as it likes: the first two directors of the second node
    rates[1, 1:3] = rng.normal(size=(2, 3))
    held[1, 5] = True
    local_twists(H, rates, turning_of(directors, held), found)
    np.testing.assert_allclose(found[1], v[1] * [1, 1, 1, 1, 1, 0], rtol=1e-12, atol=1e-12)


def moments(points: np.ndarray, mass: float) -> np.ndarray:
    """Inertia tensor about the origin of equal masses at points, shape (3, 3)."""
    squares = np.einsum("ni,nj->ij", points, points) / len(points)
    return mass * (np.trace(squares) * np.eye(3) - squares)


def grid(n: int) -> np.ndarray:
    """Middles of the n³ cells of the cube from -1 to 1."""
    line = (2.0 * np.arange(n) + 1.0) / n - 1.0
    return np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)


def tensor(body: fl.RigidBody) -> np.ndarray:
    """Inertia tensor about the centre of mass, global axes."""
    squares = body.model.mass_matrix[1:, 1:]
    R = body.frames[0, 1:].T
    return R @ (np.trace(squares) * np.eye(3) - squares) @ R.T


def test_box_ball_and_cylinder_have_the_inertia_of_their_points():
    cube, mass = grid(60), 3.0
    edges, turn = np.array([0.3, 0.5, 0.9]), lie.so3_exp(np.array([0.3, -0.5, 0.2]))
    box = fl.RigidBody.box(mass, edges, (1, 2, 3), turn)
    np.testing.assert_allclose(tensor(box), moments(0.5 * edges * cube @ turn.T, mass), rtol=1e-3)
    ball = fl.RigidBody.ball(mass, 0.7, (1, 2, 3))
    inside = cube[np.linalg.norm(cube, axis=1) < 1.0]
    np.testing.assert_allclose(tensor(ball), moments(0.7 * inside, mass), rtol=2e-3, atol=1e-12)
    start, end = np.array([1.0, 0.0, 0.0]), np.array([1.0, 2.0, 1.0])
    rod = fl.RigidBody.cylinder(mass, 0.4, start, end)
    round_ = cube[np.linalg.norm(cube[:, 1:], axis=1) < 1.0]
    half = 0.5 * np.linalg.norm(end - start)
    placed = round_ * (half, 0.4, 0.4) @ rod.frames[0, 1:]
    np.testing.assert_allclose(tensor(rod), moments(placed, mass), rtol=3e-3, atol=3e-3)
    np.testing.assert_allclose(rod.frames[0, 0], 0.5 * (start + end))
    np.testing.assert_allclose(rod.frames[0, 1], (end - start) / (2.0 * half))
    assert np.linalg.det(rod.frames[0, 1:]) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fl.RigidBody.box(1.0, (1, 0, 1)), "an edge"),
        (lambda: fl.RigidBody.ball(1.0, -0.1), "radius"),
        (lambda: fl.RigidBody.ball(0.0, 0.1), "mass"),
        (lambda: fl.RigidBody.cylinder(1.0, 0.1, (1, 2, 3), (1, 2, 3)), "from start to end"),
    ],
)
def test_bodies_that_cannot_be_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()

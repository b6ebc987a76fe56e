"""Sliding along flexible beams, and velocity constraints: derivatives, invariants, closed forms."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_lie as fl
from fem_lie import lie
from fem_lie.system import System
from fem_lie.system.constraints import Connections
from fem_lie.system.nodes.numbering import Numbering

SECTION = fl.Section.circle(0.01, fl.Material(2e9, 0.3, 1000.0))
KINDS = [fl.joints.Sliding, fl.joints.Collar, fl.joints.Sleeve]
seeds = st.integers(0, 2**32 - 1)


def rail(cells: int = 4, **options) -> fl.Beam:
    return fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=cells, name="rail", **options)


@cache
def system_of(kind: type[fl.joints.Sliding]) -> System:
    """A body that is driven along a rail."""
    scene = fl.Scene()
    beam = scene.add(rail())
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1), (0.4, 0.3, 0)))
    scene.add(kind(beam, body.point("centre"), at=(0.35, 0, 0), travel=lambda t: 0.35))
    return System(scene, dynamics=True)


class Case:
    """A body on a rail in a random configuration near a point of the second of four elements."""

    def __init__(self, kind: type[fl.joints.Sliding], seed: int) -> None:
        rng = np.random.default_rng(seed)
        system = system_of(kind)
        self.connections: Connections = system.connections
        (self.set,) = self.connections.sets[1:]
        self.n, self.m = system.count, system.m
        bend = rng.normal(size=(self.n, 6)) * [0.02, 0.02, 0.02, 0.15, 0.15, 0.15]
        turned = lie.se3_compose(lie.se3_exp(rng.normal(size=6)), system.frames[: self.n])
        self.H = np.concatenate([lie.se3_retract(turned, bend), system.frames[self.n :]])
        self.weights, self.v = rng.normal(size=self.m), rng.normal(size=(self.n, 6))

    def evaluate(self, H: np.ndarray) -> np.ndarray:
        r = np.zeros(6 * self.n + self.m)
        self.set.evaluate(H, self.v, self.weights, np.ones(self.m), self.n, r)
        return r

    def jacobian(self) -> np.ndarray:
        incidences, rows = self.connections.incidences, np.zeros((self.m, self.n, 6))
        blocks = np.zeros((len(incidences.nodes), 6))
        self.set.jacobian(self.H, blocks)
        rows[incidences.rows, incidences.nodes] = blocks
        return rows.reshape(self.m, -1)

    def differences(self, function) -> np.ndarray:
        columns = []
        for j in range(6 * self.n):
            h = np.zeros((len(self.H), 6))
            h[j // 6, j % 6] = 1e-6
            ahead, behind = (function(lie.se3_retract(self.H, s * h)) for s in (1, -1))
            columns.append((ahead - behind) / 2e-6)
        return np.array(columns).T


@pytest.mark.parametrize("kind", KINDS)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_derivatives(kind, seed):
    case = Case(kind, seed)
    n, B = case.n, case.jacobian()
    numeric = case.differences(lambda H: case.evaluate(H)[6 * n :])
    # differences of quantities of order 10 with a step of 1e-6
    assert np.abs(B - numeric).max() < 1e-7 * (1 + np.abs(B).max())
    force = case.evaluate(case.H)[: 6 * n]
    np.testing.assert_allclose(force, B.T @ case.weights, atol=1e-12 * (1 + np.abs(B).max()))
    blocks = np.zeros((n * n, 6, 6))
    rows, columns = case.set.pairs
    position = np.where((rows < n) & (columns < n), rows * n + columns, -1)
    case.set.geometric(case.H, case.weights, position, blocks)
    K = blocks.reshape(n, n, 6, 6).transpose(0, 2, 1, 3).reshape(6 * n, 6 * n)
    numeric = case.differences(lambda H: case.evaluate(H)[: 6 * n])
    assert np.abs(K - numeric).max() < 1e-6 * (1 + np.abs(K).max())


@pytest.mark.parametrize("kind", KINDS)
@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_rates_balance_and_invariance(kind, seed):
    case = Case(kind, seed)
    n, B = case.n, case.jacobian()
    first, second = case.connections.rates(case.H, case.v)
    np.testing.assert_allclose(first, B @ case.v.ravel(), atol=1e-11 * (1 + np.abs(B).max()))
    twists = np.concatenate([case.v, np.zeros((len(case.H) - n, 6))])

    def values(t: float) -> np.ndarray:
        return case.evaluate(lie.se3_retract(case.H, t * twists))[6 * n :]

    h = 1e-4
    numeric = (values(h) - 2 * values(0) + values(-h)) / h**2
    scale = 1 + np.abs(case.v).max() ** 4 * np.abs(B).max() ** 2
    assert np.abs(second - numeric).max() < 1e-4 * scale
    f = case.evaluate(case.H)[: 6 * n].reshape(n, 6)
    total = sum(np.linalg.inv(lie.se3_adjoint(F)).T @ g for F, g in zip(case.H[:n], f, strict=True))
    bound = 1e-12 * (1 + np.abs(B).max())
    assert np.abs(total).max() < 10 * bound
    moved = lie.se3_compose(lie.se3_exp(np.arange(6) / 3.0), case.H)
    np.testing.assert_allclose(case.evaluate(moved)[: 6 * n].reshape(n, 6), f, atol=10 * bound)


def bead(
    kind: type[fl.joints.Sliding], step: float, cells: int = 5
) -> tuple[fl.Result, fl.joints.Sliding]:
    """A free flexible rail rotates, and a body slides along it over several elements."""
    scene = fl.Scene()
    beam = scene.add(rail(cells))
    ball = scene.add(fl.RigidBody(0.2, (2e-4,) * 3, (0.2, 0, 0), name="ball"))
    for body in (beam, ball):
        body.add_velocity(omega=(0, 0, 1.0), about=(0.5, 0, 0))
    ball.add_velocity((0.5, 0, 0))
    joint = scene.add(kind(beam, ball.point("centre"), name="ring"))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9)
    return scheme.run(scene, duration=1.0, step=step), joint


@pytest.mark.parametrize("kind", KINDS)
def test_momenta_and_energy_over_the_elements(kind):
    """Second-order errors; the bead crosses two boundaries of elements of length 0.2."""
    coarse, fine = bead(kind, 4e-3), bead(kind, 2e-3)
    position = fine[0].coordinate(fine[1])
    assert position[0] == pytest.approx(0.2) and 0.58 < position[-1] < 0.61
    assert fine[0].joint_violation("ring").max() < 1e-9
    for name, bound in (("momentum", 5e-6), ("angular_momentum", 1e-5), ("energy", 1e-5)):
        errors = [getattr(run[0], f"{name}_error") for run in (coarse, fine)]
        assert errors[1] < bound, (name, errors)
        assert errors[0] / errors[1] > 2.5, (name, errors)
    # without friction there is no force along the axis, but for what bending turns it by
    force = np.abs(fine[0].joint_force("ring")[:, :3])
    assert force[:, 0].max() < 1e-4 * force[:, 1].max()


def test_path_on_the_rail_converges_with_the_elements():
    positions = [
        bead(fl.joints.Sliding, 2e-3, cells)[0].position("ball.centre")[-1] for cells in (5, 10, 20)
    ]
    gaps = [np.linalg.norm(positions[k] - positions[2]) for k in (0, 1)]
    assert gaps[0] < 1e-5 and gaps[0] / gaps[1] > 3.0


def test_bead_on_a_driven_rod():
    """A stiff rod rotates with constant speed: the bead moves outward as cosh ωt."""
    speed = 2.0
    scene = fl.Scene()
    stiff = fl.Section.circle(0.02, fl.Material(2e11, 0.3, 8000.0))
    rod = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), stiff, cells=6))
    ball = scene.add(fl.RigidBody(1e-3, (1e-7,) * 3, (0.2, 0, 0)))
    for body in (rod, ball):
        body.add_velocity(omega=(0, 0, speed), about=(0, 0, 0))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), rod.point("start"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: speed * t))
    joint = scene.add(fl.joints.Sliding(rod, ball.point("centre")))
    errors = []
    for step in (4e-3, 2e-3):
        scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9)
        result = scheme.run(scene, duration=1.0, step=step)
        exact = 0.2 * np.cosh(speed * result.times)
        errors.append(np.abs(result.coordinate(joint) - exact).max())
    # the rod stretches by 1e-6 of its length
    assert errors[1] < 1e-5 and 3.5 < errors[0] / errors[1] < 4.5
    force = result.joint_force(joint)[:, 1]
    coriolis = -1e-3 * 2 * speed * 0.2 * speed * np.sinh(speed * result.times)
    np.testing.assert_allclose(force[1:-1], coriolis[1:-1], atol=2e-3 * np.abs(coriolis).max())


@pytest.mark.parametrize(
    ("kind", "free"), [(fl.joints.Sliding, 3), (fl.joints.Collar, 1), (fl.joints.Sleeve, 0)]
)
def test_moments_turn_what_the_joint_leaves_free(kind, free):
    """On a stiff rail: rotation about all axes, about that of the rail, none."""
    scene = fl.Scene()
    stiff = fl.Section.circle(0.05, fl.Material(2e11, 0.3, 8000.0))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), stiff, cells=2))
    scene.add(fl.Clamp(beam.point("start")))
    ball = scene.add(fl.RigidBody(1.0, (0.01,) * 3, (0.6, 0, 0)))
    scene.add(kind(beam, ball.point("centre")))
    moment = np.array([0.02, 0.03, -0.01])
    scene.add(fl.PointLoad(ball.point("centre"), moment=moment))
    result = fl.GeneralisedAlpha(tolerance=1e-9).run(scene, duration=1.0, step=1e-2)
    # constant moments about fixed axes turn a ball by M t²/2J
    turned = lie.so3_log(result.rotation(ball.point("centre"))[-1])
    np.testing.assert_allclose(turned, np.where(np.arange(3) < free, 50 * moment, 0), atol=1e-5)


def test_travel_is_driven_and_the_end_is_an_error():
    scene = fl.Scene()
    beam = scene.add(rail())
    scene.add(fl.Clamp(beam.point("start")))
    ball = scene.add(fl.RigidBody(0.05, (1e-5,) * 3, (0.3, 0, 0)))
    joint = scene.add(
        fl.joints.Sleeve(beam, ball.point("centre"), travel=lambda t: 0.3 + 0.5 * t**3)
    )
    result = fl.GeneralisedAlpha().run(scene, duration=1.0, step=5e-3)
    np.testing.assert_allclose(
        result.coordinate(joint), 0.3 + 0.5 * result.times**3, rtol=0, atol=1e-9
    )
    with pytest.raises(fl.ConvergenceError, match="slid off its beam") as caught:
        fl.GeneralisedAlpha().run(scene, duration=1.5, step=5e-3)
    kept = caught.value.result
    length = beam.model.lengths.sum()
    assert kept.coordinate(joint)[-1] == pytest.approx(length, rel=0.02)
    assert kept.coordinate(joint)[-1] <= length


@settings(max_examples=60, deadline=None)
@given(along=st.floats(0.0, 1.0), seed=st.integers(0, 10))
def test_every_position_on_a_beam_is_found(along, seed):
    """Near a node as well, where the nearest sample point is on its other side."""
    beam, rng = rail(), np.random.default_rng(seed)
    k = rng.integers(len(beam.model.lengths))
    a, b = beam.model.elements[k, :2]
    twist = lie.se3_relative(beam.frames[a], beam.frames[b])
    position = lie.se3_retract(beam.frames[a], along * twist)[0]
    bead = fl.RigidBody(1.0, (1.0, 1.0, 1.0), position)
    definition = fl.joints.Sliding(beam, bead.point("centre")).sliding_definition()
    assert definition.arclength == pytest.approx(
        beam.model.lengths[:k].sum() + along * beam.model.lengths[k]
    )


def test_bad_positions_and_beams_are_refused():
    scene = fl.Scene()
    beam = scene.add(rail())
    ends = (0, 1, 0), (1, 1, 0)
    other = scene.add(
        fl.Beam.straight(*ends, SECTION, cells=2, formulation=fl.elements.DirectorBeam(1))
    )
    ball = scene.add(fl.RigidBody(1.0, (1, 1, 1), (0.5, 0.2, 0)))
    with pytest.raises(ValueError, match=r"0\.2 off the beam's axis.*at=\("):
        scene.add(fl.joints.Sliding(beam, ball.point("centre")))
    with pytest.raises(ValueError, match="geodesic"):
        scene.add(fl.joints.Sliding(other, ball.point("centre"), at=(0.5, 1, 0)))
    with pytest.raises(ValueError, match=r"start at arclength 0\.5, got 0\.1"):
        scene.add(
            fl.joints.Sliding(beam, ball.point("centre"), at=(0.5, 0, 0), travel=lambda t: 0.1)
        )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("driven", [False, True])
def test_a_position_just_off_the_axis_pulls_at_nothing(kind, driven):
    """The slider starts on the axis: the first step would close a gap, by any force."""

    def forces(off: float) -> np.ndarray:
        scene = fl.Scene(gravity=(0, 0, -9.81))
        beam, bead = scene.add(rail()), scene.add(fl.RigidBody(0.1, [1e-4] * 3, (0.4, 0, 0.05)))
        scene.add(fl.Clamp(beam.point("start")))
        travel = (lambda t: 0.4 + off) if driven else None
        joint = scene.add(kind(beam, bead.point("centre"), at=(0.4, 0.3 * off, off), travel=travel))
        run = fl.GeneralisedAlpha().run(scene, duration=1e-2, step=1e-3, progress=False)
        return run.joint_force(joint)

    exact = forces(0.0)
    assert np.abs(forces(9e-7) - exact).max() < 1e-4 * np.abs(exact).max()


# --- velocity constraints: properties, and a sledge with a known closed-form motion ---


JOINTS = {
    "edge": lambda a, b: fl.joints.KnifeEdge(a, b, at=(0.2, 0.1, 0), axis=(0, 1, 1)),
    "disc": lambda a, b: fl.joints.RollingDisc(a, b, axis=(0.2, 1, 0.3), radius=0.4),
}


@cache
def connections_of(name: str) -> Connections:
    """Connections between two free bodies."""
    scene = fl.Scene()
    a = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    b = scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(0.3, 0.5, 0.8)))
    scene.add(JOINTS[name](a.point("centre"), b.point("centre")))
    numbering = Numbering(scene.bodies)
    frames = np.concatenate([numbering.frames, [lie.frame(np.zeros(3), np.eye(3))]])
    return Connections(scene, numbering, frames, np.zeros((2, 6), dtype=bool))


def state(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random frames and twists of two nodes."""
    rng = np.random.default_rng(seed)
    return lie.se3_exp(rng.normal(size=(2, 6)) * [1, 1, 1, 0.5, 0.5, 0.5]), rng.normal(size=(2, 6))


def bound(connections: Connections, H: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The constrained velocities."""
    first = np.zeros(connections.m)
    connections.sets[1].values(H, v, first)
    return first[len(connections.table.targets) :]


def dense(connections: Connections, H: np.ndarray) -> np.ndarray:
    """Rows of the velocity constraints."""
    incidences = connections.incidences
    blocks, rows = np.zeros((len(incidences.nodes), 6)), np.zeros((connections.m, 2, 6))
    connections.sets[1].jacobian(H, blocks)
    rows[incidences.rows, incidences.nodes] = blocks
    return rows.reshape(-1, 12)[len(connections.table.targets) :]


@pytest.mark.parametrize("name", JOINTS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_rows_forces_and_rates(name, seed):
    connections = connections_of(name)
    H, v = state(seed)
    W, m = dense(connections, H), connections.m
    # identities of sums of a dozen numbers of order 1
    np.testing.assert_allclose(bound(connections, H, v), W @ v.ravel(), atol=1e-13)
    weights = np.random.default_rng(seed).normal(size=m)
    r = np.zeros(12 + m)
    connections.sets[1].evaluate(H, v, weights, np.ones(m), 2, r)
    k = len(connections.table.targets)
    np.testing.assert_allclose(r[:12], W.T @ weights[k:], atol=1e-13)
    np.testing.assert_allclose(r[12 + k :], W @ v.ravel(), atol=1e-13)
    total = sum(
        np.linalg.inv(lie.se3_adjoint(F)).T @ f
        for F, f in zip(H, r[:12].reshape(2, 6), strict=True)
    )
    assert np.abs(total).max() < 1e-12
    second = np.zeros(m)
    connections.sets[1].rates(H, v, np.zeros(m), second)
    h = 1e-6
    ahead, behind = (bound(connections, lie.se3_retract(H, s * v), v) for s in (h, -h))
    # central differences: h² · 10³ and 1e-16/h
    np.testing.assert_allclose(second[k:], (ahead - behind) / (2 * h), atol=1e-6)


def test_rows_of_an_edge_are_constant_in_its_frame():
    connections = connections_of("edge")
    rows = [dense(connections, state(seed)[0])[:, 6:] for seed in range(3)]
    np.testing.assert_allclose(rows[1:], [rows[0]] * 2, atol=1e-15)


def sledge(step: float) -> tuple[float, fl.Result, fl.joints.KnifeEdge]:
    """Chaplygin's sledge: largest error of the velocities in 2 s."""
    ahead, inertia, mass, v0, w0 = 0.3, 0.05, 1.5, -0.5, 2.0
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(mass, (inertia,) * 3, name="sledge"))
    scene.add(fl.joints.Planar(fl.ground(), body.point("centre")))
    blade = scene.add(
        fl.joints.KnifeEdge(fl.ground(), body.point("centre"), at=(-ahead, 0, 0), axis=(0, 1, 0))
    )
    body.add_velocity(omega=(0, 0, w0), about=(-ahead, 0, 0))
    body.add_velocity((v0, 0, 0))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    result = scheme.run(scene, duration=2.0, step=step)
    # dv/dt = a ω², v² + b² ω² = E²
    b = np.sqrt(inertia / mass + ahead**2)
    E = np.hypot(v0, b * w0)
    phase = ahead * E / b**2 * result.times + np.arctanh(v0 / E)
    velocity = result.velocity(body.point("centre"))
    errors = velocity[:, 0] - E * np.tanh(phase), velocity[:, 5] - E / b / np.cosh(phase)
    return float(np.abs(errors).max()), result, blade


def test_sledge_is_of_second_order_and_keeps_its_energy():
    coarse, fine = sledge(1e-2), sledge(5e-3)
    assert fine[0] < 2e-5
    assert 3.9 < coarse[0] / fine[0] < 4.1
    assert fine[1].energy_error < 3e-6
    assert 3.9 < coarse[1].energy_error / fine[1].energy_error < 4.1
    # a velocity over the tolerance of 1e-10 of a step's motion
    assert fine[1].joint_violation(fine[2]).max() < 1e-8


def test_blade_pushes_the_ground_as_the_sledge_is_pushed():
    """The reported force acts on the ground, in its axes and about the point there."""
    _, result, blade = sledge(5e-3)
    R, axes = result.rotation("sledge.centre"), blade.frame()[1:]
    velocity = np.einsum("tij,tj->ti", R, result.velocity("sledge.centre")[:, :3])
    force, moment = (result.joint_force(blade)[:, k : k + 3] @ axes for k in (0, 3))
    inner = slice(2, -2)
    push = -1.5 * np.gradient(velocity, result.times, axis=0)
    # differences over two steps: 3e-4 of 3 N
    np.testing.assert_allclose(force[inner], push[inner], atol=2e-3)
    assert np.abs(np.diff(R[:, 0, 0])).max() > 0.01
    position = result.position("sledge.centre") + R @ (-0.3, 0, 0) - (-0.3, 0, 0)
    np.testing.assert_allclose(moment, np.cross(position, force), atol=1e-9)


def test_velocities_that_slip_are_refused():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    scene.add(fl.joints.KnifeEdge(fl.ground(), body.point("centre"), axis=(0, 1, 0), name="blade"))
    body.add_velocity((0, 1, 0))
    with pytest.raises(ValueError, match="velocities break blade"):
        fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.1)
    with pytest.raises(ValueError, match="constrain velocities: use dynamics"):
        fl.statics(scene)

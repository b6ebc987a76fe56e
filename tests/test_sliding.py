"""Joints that slide along flexible beams: derivatives, invariants, a bead on a rotating rod."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_lie as fl
from fem_lie import lie
from fem_lie.system import System
from fem_lie.system.constraints import Connections

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
    place = np.where((rows < n) & (columns < n), rows * n + columns, -1)
    case.set.geometric(case.H, case.weights, place, blocks)
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
    place = fine[0].coordinate(fine[1])
    assert place[0] == pytest.approx(0.2) and 0.58 < place[-1] < 0.61
    assert fine[0].joint_violation("ring").max() < 1e-9
    for name, bound in (("momentum", 5e-6), ("angular_momentum", 1e-5), ("energy", 1e-5)):
        errors = [getattr(run[0], f"{name}_error") for run in (coarse, fine)]
        assert errors[1] < bound, (name, errors)
        assert errors[0] / errors[1] > 2.5, (name, errors)
    # without friction there is no force along the axis, but for what bending turns it by
    force = np.abs(fine[0].joint_force("ring")[:, :3])
    assert force[:, 0].max() < 1e-4 * force[:, 1].max()


def test_path_on_the_rail_converges_with_the_elements():
    places = [
        bead(fl.joints.Sliding, 2e-3, cells)[0].position("ball.centre")[-1] for cells in (5, 10, 20)
    ]
    gaps = [np.linalg.norm(places[k] - places[2]) for k in (0, 1)]
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
    with pytest.raises(ValueError, match="slid off its beam"):
        fl.GeneralisedAlpha().run(scene, duration=1.5, step=5e-3)


@settings(max_examples=60, deadline=None)
@given(along=st.floats(0.0, 1.0), seed=st.integers(0, 10))
def test_every_place_on_a_beam_is_found(along, seed):
    """Near a node as well, where the nearest sample point is on its other side."""
    beam, rng = rail(), np.random.default_rng(seed)
    k = rng.integers(len(beam.lengths))
    a, b = beam.elements[k, :2]
    twist = lie.se3_relative(beam.frames[a], beam.frames[b])
    place = lie.se3_retract(beam.frames[a], along * twist)[0]
    bead = fl.RigidBody(1.0, (1.0, 1.0, 1.0), place)
    definition = fl.joints.Sliding(beam, bead.point("centre")).sliding_definition()
    assert definition.arclength == pytest.approx(beam.lengths[:k].sum() + along * beam.lengths[k])


def test_bad_places_and_beams_are_refused():
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
def test_a_place_just_off_the_axis_pulls_at_nothing(kind, driven):
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

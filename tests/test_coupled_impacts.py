"""Impacts and friction of bodies in joints and of flexible ones, against closed forms."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fem_lie as fl

GRAVITY = 9.81


DAMPED = fl.GeneralisedAlpha(radius=0.8)
SCHEMES = {"generalised alpha": DAMPED, "variational": fl.schemes.Variational()}
each_scheme = pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)


def run(scene, duration, step, scheme=DAMPED, **options) -> fl.Result:
    return scheme.run(scene, duration=duration, step=step, progress=False, **options)


def cuboid(mass: float, edges) -> np.ndarray:
    squares = np.asarray(edges, dtype=float) ** 2
    return mass / 12 * (squares.sum() - squares)


def hung_up(scene: fl.Scene) -> fl.Scene:
    """With a pendulum far away, for whose sake contacts go through one matrix of all bodies."""
    bob = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (50.0, 0, 0)))
    scene.add(fl.joints.Spherical(fl.ground(), bob.point((50.0, 0, 1.0))))
    return scene


def floored(
    body: fl.RigidBody, surface: fl.contact.ContactSurface, law: fl.contact.Impact, angle=0.0
) -> fl.Scene:
    scene = fl.Scene(gravity=(GRAVITY * np.sin(angle), 0, -GRAVITY * np.cos(angle)))
    scene.add(body)
    scene.add(fl.contact.Contact(surface, fl.contact.Plane(fl.ground(), (0, 0, 1)), law))
    return hung_up(scene)


# --- what a joint elsewhere must not change ---


@each_scheme
@pytest.mark.parametrize("restitution", [1.0, 0.8])
def test_a_ball_bounces_as_without_joints(restitution, scheme):
    ball = fl.RigidBody(1.0, 4e-3 * np.ones(3), (0, 0, 1.1))
    law = fl.contact.Impact(restitution=restitution)
    result = run(
        floored(ball, fl.contact.Sphere(ball.point("centre"), 0.1), law), 1.0, 1e-2, scheme
    )
    fall = np.sqrt(2 / GRAVITY)
    after = np.maximum(0.0, result.times - fall)
    expected = np.where(
        result.times < fall,
        1 - 0.5 * GRAVITY * result.times**2,
        restitution * np.sqrt(2 * GRAVITY) * after - 0.5 * GRAVITY * after**2,
    )
    height = result.position(ball.point("centre"))[:, 2] - 0.1
    np.testing.assert_allclose(height, expected, rtol=0, atol=1e-13)
    assert result.contacts.penetration.max() < 1e-13
    assert result.contacts.impact_loss.sum() == pytest.approx(
        GRAVITY * (1 - restitution**2), abs=1e-12
    )


@each_scheme
@pytest.mark.parametrize("angle", [20.0, 26.56, 26.57, 40.0])
def test_a_block_sticks_or_slides_on_a_slope(angle, scheme):
    edges, down = (0.2, 0.2, 0.1), np.radians(angle)
    block = fl.RigidBody(1.0, cuboid(1.0, edges), (0, 0, 0.05))
    scene = floored(
        block, fl.contact.Box(block.point("centre"), edges), fl.contact.Impact(friction=0.5), down
    )
    result = run(scene, 0.5, 1e-2, scheme)
    pull = GRAVITY * (np.sin(down) - 0.5 * np.cos(down))
    assert result.position(block.point("centre"))[-1, 0] == pytest.approx(
        max(0.0, pull) / 8, abs=1e-9
    )
    assert result.contacts.cone_residual.max() < 1e-6


@each_scheme
def test_a_ladder_slides_with_second_order(scheme):
    errors = []
    fall = solve_ivp(
        lambda t, y: [y[1], 1.5 * GRAVITY * np.sin(y[0])],
        (0, 0.4),
        [0.3, 0.0],
        rtol=1e-12,
        atol=1e-13,
    ).y[0, -1]
    c, s = np.cos(0.3), np.sin(0.3)
    for step in (2e-2, 1e-2):
        axes = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
        rod = fl.RigidBody(1.0, (1 / 12, 1 / 12, 1e-3), (s / 2, 0, c / 2), axes)
        top, foot = rod.point((0, 0, c)), rod.point((s, 0, 0))
        law = fl.contact.Impact()
        scene = floored(rod, fl.contact.Vertices([foot]), law)
        wall = fl.contact.Plane(fl.ground(), (1, 0, 0))
        scene.add(fl.contact.Contact(fl.contact.Vertices([top]), wall, law))
        result = run(scene, 0.4, step, scheme)
        up = result.position(top)[-1] - result.position(foot)[-1]
        errors.append(np.arctan2(abs(up[0]), up[2]) - fall)
    assert abs(errors[1]) < 1.3e-4
    assert 3.6 < errors[0] / errors[1] < 4.6


def with_beam(scene: fl.Scene) -> fl.Scene:
    """With a clamped beam far away, for whose sake positions follow from the iteration matrix."""
    section = fl.Section.circle(0.02, fl.Material(1e8, 0.3, 1000.0))
    beam = scene.add(fl.Beam.straight((50.0, 0, 0), (51.0, 0, 0), section, cells=4))
    scene.add(fl.Clamp(beam.point("start")))
    return scene


BALL = 0.05


def in_box(count: tuple[int, int, int], speed=0.0, restitution=0.0) -> fl.Scene:
    """Balls that fall from a lattice into a box, with friction, rotation and rebound."""
    rng, law, radius = np.random.default_rng(1), fl.contact.Impact(0.3, restitution), BALL
    scene, balls = fl.Scene(gravity=(0, 0, -GRAVITY)), []
    for at in np.ndindex(count):
        position = 2.1 * radius * (np.array(at) + 0.5) + 0.02 * radius * rng.standard_normal(3)
        ball = scene.add(fl.RigidBody(1.0, np.full(3, 0.4 * radius**2), position))
        ball.add_velocity(speed * rng.normal(size=3))
        ball.add_velocity(omega=speed / radius * rng.normal(size=3), about=ball.point("centre"))
        balls.append(ball.point("centre"))
    heap, ends = fl.contact.Vertices(balls, radius), 2.1 * radius * np.array(count)
    scene.add(fl.contact.Contact(heap, heap, law))
    scene.add(fl.contact.Contact(heap, fl.contact.Plane(fl.ground(), (0, 0, 1)), law))
    for normal in np.eye(3)[:2]:
        for sign, at in ((1, np.zeros(3)), (-1, normal * ends)):
            scene.add(
                fl.contact.Contact(heap, fl.contact.Plane(fl.ground(), sign * normal, at), law)
            )
    return scene


def test_balls_with_friction_bounce_the_same_whatever_else_is_in_the_scene():
    """A joint and a beam elsewhere make no difference; free bodies alone have a step of their own.

    Of that the end differs by errors of a step, what impacts and friction take with it.
    """
    scenes = (add(in_box((2, 2, 2), 0.2, 0.3)) for add in (hung_up, with_beam, lambda scene: scene))
    jointed, flexible, free = (run(scene, 0.2, 2e-3) for scene in scenes)
    for other, near, part in ((flexible, 1e-9, 1e-9), (free, 0.03, 5e-3)):
        apart = np.linalg.norm(other.frames[:, :8, 0] - jointed.frames[:, :8, 0], axis=2)
        assert apart.max() < near * BALL
        for name in ("friction_loss", "impact_loss"):
            lost, expected = (getattr(each.contacts, name).sum() for each in (other, jointed))
            assert lost > 0.4 * free.kinetic[0]
            assert lost == pytest.approx(expected, rel=part)


def test_a_pile_comes_to_rest_next_to_a_joint():
    """More contacts than Newton's method takes, most of them among balls that nothing couples."""
    result = run(hung_up(in_box((4, 4, 4))), 0.12, 2e-3)
    reported, most = result.contacts, result.total_energy[0]
    assert (reported.impact_loss + reported.friction_loss).min() > -1e-8 * most
    assert reported.contacts.max() > 60
    assert reported.cone_residual.max() <= 1e-6
    assert reported.penetration.max() < 1e-11


def test_a_chain_of_boxes_falls_flat_and_stays():
    """Velocities that violate joints would have energy that impacts set free, and never rest."""
    scene, length, links = fl.Scene(gravity=(0, 0, -GRAVITY)), 0.1, []
    for i in range(6):
        position = ((i + 0.5) * length, 0, 0.1 + 0.03 * i)
        links.append(scene.add(fl.RigidBody(0.1, cuboid(0.1, (0.09, 0.04, 0.03)), position)))
    for a, b in pairwise(links):
        ends = a.point("centre"), b.point("centre")
        at = 0.5 * (ends[0].position + ends[1].position)
        scene.add(fl.joints.Revolute(*ends, at=at, axis=(0, 1, 0)))
    floor, law = fl.contact.Plane(fl.ground(), (0, 0, 1)), fl.contact.Impact(friction=0.4)
    for link in links:
        box = fl.contact.Box(link.point("centre"), (0.09, 0.04, 0.03))
        scene.add(fl.contact.Contact(box, floor, law))
    result = run(scene, 1.0, 2e-3)
    assert np.diff(result.total_energy).max() < 1e-12 * result.total_energy[0]
    assert np.abs(result.velocities[-1]).max() < 1e-10


def test_an_impact_spreads_over_a_whole_row_in_one_step():
    """Each ball that is pushed meets the next one, which did not take part before."""
    scene, radius, count = fl.Scene(), 0.1, 24
    positions = (2 * radius + 1e-4) * np.arange(count)
    balls = [scene.add(fl.RigidBody(1.0, 4e-3 * np.ones(3), (x, 0, 0))) for x in positions]
    balls[0].add_velocity((5.0, 0, 0))
    for a, b in pairwise(balls):
        spheres = (fl.contact.Sphere(ball.point("centre"), radius) for ball in (a, b))
        scene.add(fl.contact.Contact(*spheres, fl.contact.Impact(restitution=0.0)))
    result = run(hung_up(scene), 0.05, 1e-2)
    x = np.array([result.position(ball.point("centre"))[:, 0] for ball in balls])
    assert np.diff(x, axis=0).min() > 2 * radius - 1e-9
    np.testing.assert_allclose(result.momentum[:, 0], 5.0, rtol=1e-12)


@pytest.mark.parametrize(
    ("joint", "what"),
    [
        (lambda ball: fl.joints.Fixed(fl.ground(), ball), "violate joints by"),
        (
            lambda ball: fl.joints.Prismatic(fl.ground(), ball, axis=(1, 0, 0)),
            "still overlap by 8e-05",
        ),
    ],
    ids=["fixed", "slides across"],
)
def test_a_body_that_cannot_give_way_to_a_driven_one_is_refused(joint, what):
    """Neither the contact nor a joint gives way in silence."""
    scene = fl.Scene()
    ball, plate = (fl.RigidBody(1.0, 4e-3 * np.ones(3), (0, 0, z)) for z in (0.105, 0.0))
    scene.add(ball)
    scene.add(plate)
    scene.add(joint(ball.point("centre")))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), plate.point("centre"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(rail.displacement, lambda t: 20 * t * t))
    surfaces = (
        fl.contact.Sphere(ball.point("centre"), 0.1),
        fl.contact.Plane(plate.point("centre"), (0, 0, 1)),
    )
    scene.add(fl.contact.Contact(*surfaces, fl.contact.Impact()))
    with pytest.raises(fl.ConvergenceError, match=rf"1 contacts {what}.*are bodies wedged\?"):
        run(hung_up(scene), 0.05, 1e-2)


# --- joints ---


def pendulum(angles, rates, law: fl.contact.Impact, gap: float):
    """Two rods of 1 kg and 1 m hang on each other in x-z; the lower end is before a wall."""
    scene, before, rods = fl.Scene(gravity=(0, 0, -GRAVITY)), fl.ground(), []
    top, speed = np.zeros((2, 3))
    for angle, rate in zip(angles, rates, strict=True):
        c, s = np.cos(angle), np.sin(angle)
        down = np.array([s, 0, -c])
        axes = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
        rod = scene.add(fl.RigidBody(1.0, (1 / 12, 1 / 12, 1e-3), top + 0.5 * down, axes))
        rod.add_velocity(speed)
        rod.add_velocity(omega=(0, -rate, 0), about=top)
        scene.add(fl.joints.Revolute(before, rod.point(top), axis=(0, 1, 0)))
        speed = speed + rate * np.array([c, 0, s])
        top = top + down
        before = rod.point(top)
        rods.append(rod)
    away = np.sign(gap)
    wall = fl.contact.Plane(fl.ground(), (-away, 0, 0), at=(top[0] + gap, 0, 0))
    scene.add(fl.contact.Contact(fl.contact.Vertices([before]), wall, law))
    return scene, rods, before


def thrown(M, n, t, rates, friction: float, restitution: float) -> np.ndarray:
    """Rates after an impact along ``n`` with friction along ``t``: it slides on, sticks or back."""
    G = np.stack([n, t])
    own, wanted = G @ np.linalg.solve(M, G.T), np.array([-(1 + restitution), -1.0]) * (G @ rates)
    p = np.linalg.solve(own, wanted)
    if abs(p[1]) > friction * p[0]:
        for sign in (1.0, -1.0):
            way = np.array([1.0, -sign * friction])
            p = way * wanted[0] / (own[0] @ way)
            if sign * (t @ rates + own[1] @ p) > 0.0:
                break
    return rates + np.linalg.solve(M, G.T @ p)


@each_scheme
@pytest.mark.parametrize("friction", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_impact_of_a_double_pendulum_is_that_of_impulses(friction, restitution, scheme):
    """``M (ω⁺ − ω⁻) = Jᵀ p`` with the normal velocity reversed, in the first step.

    With much friction Newton's restitution of 1 gives four times the energy there was (Kane &
    Levinson, Dynamics (1985) 348): it is reduced to what gives none.
    """
    angles, rates, step = np.array([0.3, 0.7]), np.array([1.0, 2.0]), 1e-6
    law = fl.contact.Impact(friction, restitution)
    scene, rods, _ = pendulum(angles, rates, law, 0.5 * step * (rates @ np.cos(angles)))
    result = run(scene, step, step, scheme)
    turned = [
        -(result.rotation(rod.point("centre"))[-1] @ result.velocity(rod.point("centre"))[-1, 3:])[
            1
        ]
        for rod in rods
    ]
    coupling = 0.5 * np.cos(angles[0] - angles[1])
    M = np.array([[4 / 3, coupling], [coupling, 1 / 3]])

    def after(e: float) -> np.ndarray:
        return thrown(M, -np.cos(angles), np.sin(angles), rates, friction, e)

    def loss(e: float) -> float:
        return 0.5 * rates @ M @ rates - 0.5 * after(e) @ M @ after(e)

    gains = loss(restitution) < -1e-3
    assert gains == (restitution == 1.0 and friction == 2.0)
    if gains:
        restitution = brentq(loss, 0.0, restitution)
    expected, lost = after(restitution), loss(restitution)
    near = 2e-3 if gains else 5e-5
    np.testing.assert_allclose(turned, expected, rtol=near, atol=2e-5)
    reported = result.contacts
    assert reported.impact_loss[0] + reported.friction_loss[0] == pytest.approx(
        lost, rel=1e-4, abs=2 * near
    )
    n, t = -np.cos(angles), np.sin(angles)
    _, along = np.linalg.solve(np.stack([n, t]).T, M @ (expected - rates))
    friction_work = -along * 0.5 * t @ (rates + expected)
    assert reported.friction_loss[0] == pytest.approx(friction_work, rel=2 * near, abs=2 * near)
    assert result.joint_violations.max() < 1e-12


@each_scheme
def test_a_pendulum_that_bounces_keeps_its_joints_and_gains_nothing(scheme):
    scene, _, _ = pendulum((1.2, 1.0), (0, 0), fl.contact.Impact(0.2, 0.5), -1.6)
    result = run(scene, 2.0, 1e-3, scheme)
    reported = result.contacts
    assert (reported.contacts > 0).sum() >= 2
    assert reported.penetration.max() < 1e-12
    assert result.joint_violations.max() < 1e-9
    # what steps of 1e-3 s make of the swing after the impact
    assert np.diff(result.total_energy).max() < 4e-5
    assert result.energy_error < 1e-4


def colliding() -> fl.Scene:
    """A ball hits a heavier one aslant, both spin; the normal turns within the step."""
    scene, balls, radius = fl.Scene(), [], 0.1
    for mass, at in ((1.0, (0, 0, 0)), (2.0, (0.5, 0.05, 0.02))):
        turning = 0.4 * mass * radius**2 * np.ones(3)
        balls.append(scene.add(fl.RigidBody(mass, turning, at)))
    balls[0].add_velocity((3, 0, 0))
    balls[0].add_velocity(omega=(5, -8, 11), about=balls[0].point("centre"))
    balls[1].add_velocity(omega=(0, 7, 3), about=balls[1].point("centre"))
    spheres = (fl.contact.Sphere(ball.point("centre"), radius) for ball in balls)
    scene.add(fl.contact.Contact(*spheres, fl.contact.Impact(restitution=1.0)))
    return hung_up(scene)


def on_a_spring() -> fl.Scene:
    """A ball on a rail and a spring bounces; positions are corrected against the spring."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    ball = scene.add(fl.RigidBody(1.0, 4e-3 * np.ones(3), (0, 0, 0.5)))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), ball.point("centre"), axis=(0, 0, 1)))
    scene.add(fl.joints.Spring(rail.displacement, stiffness=20.0))
    ball.add_velocity((0, 0, -3))
    surfaces = (
        fl.contact.Sphere(ball.point("centre"), 0.1),
        fl.contact.Plane(fl.ground(), (0, 0, 1)),
    )
    scene.add(fl.contact.Contact(*surfaces, fl.contact.Impact(restitution=1.0)))
    return scene


@pytest.mark.parametrize("scheme", [fl.GeneralisedAlpha(radius=1.0), fl.schemes.Variational()])
@pytest.mark.parametrize("make", [colliding, on_a_spring])
def test_restitution_adds_no_energy(make, scheme):
    """It gave two per cent to the balls, and 2e-4 to the one on a spring."""
    result = run(make(), 1.0, 1e-2 if make is colliding else 4e-3, scheme)
    energy = result.total_energy
    assert result.contacts.contacts.any()
    assert np.diff(energy).max() < 1e-9 * energy[0]
    assert energy[-1] > 0.999 * energy[0]
    if make is colliding:
        assert np.abs(result.momentum - result.momentum[0]).max() < 1e-14


@each_scheme
@pytest.mark.parametrize("pull", [3.0, 7.0])
def test_a_block_on_a_driven_platform_is_taken_along_by_friction(pull, scheme):
    """μ g = 4.905 m/s²: with less it sticks, with more it slides at that acceleration."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    platform = scene.add(fl.RigidBody(5.0, np.ones(3), (0, 0, -0.1)))
    block = scene.add(fl.RigidBody(1.0, cuboid(1.0, (0.2, 0.2, 0.1)), (0, 0, 0.05)))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), platform.point("centre"), axis=(1, 0, 0)))
    scene.add(fl.joints.Drive(rail.displacement, lambda t: 0.5 * pull * t * t))
    top = fl.contact.Plane(platform.point((0, 0, 0)), (0, 0, 1))
    box = fl.contact.Box(block.point("centre"), (0.2, 0.2, 0.1))
    scene.add(fl.contact.Contact(box, top, fl.contact.Impact(friction=0.5)))
    result = run(scene, 0.5, 5e-3, scheme)
    expected = 0.5 * min(pull, 0.5 * GRAVITY) * 0.25
    assert result.position(platform.point("centre"))[-1, 0] == pytest.approx(0.125 * pull, abs=1e-9)
    assert result.position(block.point("centre"))[-1, 0] == pytest.approx(expected, abs=1e-8)
    assert np.abs(result.position(block.point("centre"))[:, 2] - 0.05).max() < 1e-11


def test_a_platform_that_a_joint_holds_is_ground():
    """A block rocks on either in the same way."""
    half, tall, paths = 0.05, 0.25, []
    corner = np.arctan(half / tall)
    c, s = np.cos(0.5 * corner), np.sin(0.5 * corner)
    axes = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    edges = (2 * half, 0.2, 2 * tall)
    for held in (True, False):
        scene = fl.Scene(gravity=(0, 0, -GRAVITY))
        block = scene.add(fl.RigidBody(1.0, cuboid(1.0, edges), -axes @ (half, 0, -tall), axes))
        under = fl.ground()
        if held:
            platform = scene.add(fl.RigidBody(3.0, np.ones(3), (0.2, 0.1, -1.0)))
            scene.add(fl.joints.Fixed(fl.ground(), platform.point("centre")))
            under = platform.point((0, 0, 0))
        floor = fl.contact.Plane(under, (0, 0, 1))
        scene.add(
            fl.contact.Contact(
                fl.contact.Box(block.point("centre"), edges), floor, fl.contact.Impact(1.0)
            )
        )
        result = run(scene, 0.6, 1e-3)
        paths.append(result.rotation(block.point("centre"))[:, 0, 2])
    np.testing.assert_allclose(paths[0][::50], paths[1][::50], rtol=0, atol=2e-3)


# --- what is reported of each contact ---


@pytest.mark.parametrize("jointed", [False, True])
def test_forces_of_impacts_are_reported_for_each_contact_point(jointed, tmp_path):
    """A block slides, and is held by friction: weight and friction, on its four lower corners."""
    edges, scene = (0.2, 0.2, 0.1), fl.Scene(gravity=(0, 0, -GRAVITY))
    block = scene.add(fl.RigidBody(2.0, cuboid(2.0, edges), (0, 0, 0.05)))
    block.add_velocity((1.0, 0, 0))
    box, floor = (
        fl.contact.Box(block.point("centre"), edges),
        fl.contact.Plane(fl.ground(), (0, 0, 1)),
    )
    touch = scene.add(fl.contact.Contact(box, floor, fl.contact.Impact(friction=0.5)))
    if jointed:
        hung_up(scene)
    result = run(scene, 0.3, 1e-2)
    result.save(tmp_path / "block.h5")
    for each in (result, fl.Result.load(tmp_path / "block.h5")):
        found = fl.post.contact_forces(each, touch)
        assert found.touching[0] == 0
        weight, friction = 2 * GRAVITY, np.where(result.times < 1.0 / (0.5 * GRAVITY), GRAVITY, 0.0)
        np.testing.assert_allclose(found.total[1:, 2], weight, rtol=1e-9)
        np.testing.assert_allclose(found.total[1:20, 0], -friction[1:20], rtol=1e-8)
        np.testing.assert_allclose(found.total[22:], [[0, 0, weight]] * 9, atol=1e-8)
        assert not found.sticks[found.states == 10].any()
        assert found.sticks[found.states == 30].all()
        # of its own velocity, against which friction acts
        speed = result.velocity(block.point("centre"))[10, 0]
        np.testing.assert_allclose(found.slips[found.states == 10, 0], speed, rtol=1e-8)
        assert found.penetration.max() < 1e-12
        arrows = found.arrows(10)
        assert arrows.along.shape == (found.touching[10], 3)
        np.testing.assert_allclose(found.positions[found.states == 10, 2], 0.0, atol=1e-12)
        np.testing.assert_allclose(found.impulses, 1e-2 * found.forces)


def test_joint_forces_include_contact_forces():
    """A platform of 3 kg on a joint, with a block of 1 kg on it; a beam at rest on a floor."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    platform = scene.add(fl.RigidBody(3.0, np.ones(3), (0, 0, -0.1)))
    joint = scene.add(fl.joints.Fixed(fl.ground(), platform.point("centre")))
    block = scene.add(fl.RigidBody(1.0, cuboid(1.0, (0.2, 0.2, 0.1)), (0, 0, 0.05)))
    top = fl.contact.Plane(platform.point((0, 0, 0)), (0, 0, 1))
    box = fl.contact.Box(block.point("centre"), (0.2, 0.2, 0.1))
    scene.add(fl.contact.Contact(box, top, fl.contact.Impact(friction=0.5)))
    result = run(scene, 0.1, 1e-2)
    np.testing.assert_allclose(result.joint_force(joint)[1:, 2], -4.0 * GRAVITY, rtol=1e-8)


@each_scheme
def test_what_a_drive_does_through_friction_is_its_work(scheme):
    """On a platform that is shaken a block slides to and fro: friction alone takes energy."""
    result = run(stick_and_slip(), 0.3, 2.5e-3, scheme)
    reported = result.contacts
    work, lost = result.balance[-1, 0], reported.friction_loss.sum()
    assert lost > 0.05
    assert reported.friction_loss.min() > -1e-9
    assert np.abs(reported.impact_loss).sum() < 0.02 * lost
    assert work == pytest.approx(lost + result.total_energy[-1] - result.total_energy[0], rel=2e-2)
    assert result.energy_error < 5e-3


# --- flexible bodies ---

STEEL = fl.Material(2e9, 0.0, 1000.0)
WAVE = np.sqrt(2e9 / 1000.0)


@each_scheme
@pytest.mark.parametrize("courant", [0.5, 1.0, 2.0])
def test_an_elastic_bar_hits_a_wall_with_the_force_of_its_wave(courant, scheme):
    """ρ c v A while the wave goes and comes back; the energy never grows."""
    cells, gap, area = 50, 1e-3, np.pi * 0.02**2
    beam = fl.Beam.straight((0, 0, 0), (-1, 0, 0), fl.Section.circle(0.02, STEEL), cells=cells)
    beam.add_velocity((1, 0, 0))
    scene = fl.Scene()
    scene.add(beam)
    wall = fl.contact.Plane(fl.ground(), (-1, 0, 0), at=(gap, 0, 0))
    scene.add(
        fl.contact.Contact(fl.contact.Vertices([beam.point("start")]), wall, fl.contact.Impact())
    )
    step, back = courant / cells / WAVE, 2 / WAVE
    result = run(scene, np.ceil((gap + 1.3 * back) / step) * step, step, scheme)
    force = -np.diff(result.impulses[:, 1, 0]) / step / (1000.0 * WAVE * area)
    since = (result.times[1:] - 0.5 * step - gap) / back
    inside = force[(since > 0.1) & (since < 0.9)]
    assert inside.mean() == pytest.approx(1.0, abs=2e-3)
    assert inside.std() < 5e-3
    assert result.total_energy.max() <= (1 + 1e-12) * result.total_energy[0]
    assert -result.momentum[-1, 0] / result.momentum[0, 0] > 0.95
    assert result.contacts.penetration.max() < 1e-13


def bouncing_beam(friction=0.2):
    """It falls askew on the floor, and slides."""
    section = fl.Section.circle(0.02, fl.Material(1e8, 0.3, 1000.0))
    beam = fl.Beam.straight((0, 0, 0.05), (1, 0, 0.15), section, cells=8)
    beam.add_velocity((0.5, 0, 0))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(beam)
    nodes = fl.contact.Vertices([fl.extend.Point(beam, k) for k in range(9)], 0.02)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(fl.contact.Contact(nodes, floor, fl.contact.Impact(friction=friction)))
    return scene


def test_a_step_with_impacts_that_has_no_solution_says_that_parts_have_none():
    scheme, scene = fl.GeneralisedAlpha(max_iterations=1), bouncing_beam()
    scene.bodies[0].add_velocity(omega=(0, 30, 50), about=(0.5, 0, 0.1))
    with pytest.raises(fl.ConvergenceError, match="did not converge in 1 iterations") as info:
        scheme.run(scene, duration=0.01, step=0.01, progress=False)
    assert "Nor did it in 64 sub-steps" in str(info.value)


def test_a_beam_that_bounces_never_gains_energy():
    result = run(bouncing_beam(), 0.4, 1e-3)
    reported = result.contacts
    assert reported.contacts.max() >= 4
    assert reported.penetration.max() < 1e-11
    assert reported.cone_residual.max() < 1e-6
    # contacts that close soon after they opened: the error of steps of generalised-α
    assert np.diff(result.total_energy).max() < 1e-5 * result.total_energy[0]
    assert result.total_energy[-1] < 0.8 * result.total_energy[0]


# --- directions without inertia ---


def bouncing_plate(drilling, friction: float, joint=None) -> fl.Scene:
    """Its nodes fall on the floor one after the other; a corner may carry a body by a joint."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.6 * b, 0.02 + 0.1 * a + 0.05 * b), (3, 2))
    section = fl.ShellSection.layer(0.02, fl.Material(1e8, 0.3, 1000.0))
    plate = fl.Shell(mesh, section, drilling=drilling)
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(plate)
    balls = fl.contact.Vertices([fl.extend.Point(plate, k) for k in range(len(plate.frames))], 0.01)
    scene.add(
        fl.contact.Contact(
            balls, fl.contact.Plane(fl.ground(), (0, 0, 1)), fl.contact.Impact(friction=friction)
        )
    )
    if joint is not None:
        arm = scene.add(fl.RigidBody(0.5, 5e-3 * np.ones(3), (-0.1, 0, 0.1)))
        scene.add(joint(arm.point("centre"), plate.point("00"), at=plate.point("00").position))
    for body in scene.bodies:
        body.add_velocity((0.5, 0.3, 0))
    return scene


def check_plate(result: fl.Result) -> None:
    assert result.contacts.contacts.max() >= 4
    assert result.contacts.penetration.max() < 1e-13
    assert np.diff(result.total_energy).max() < 1e-3 * result.total_energy[0]
    # frames rotate about their directors as the plate does, and not by round-off over no inertia
    assert np.abs(result.velocities[:, :12, 5]).max() < 5.0


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_plate_whose_drilling_has_no_inertia_bounces_as_one_of_five_parameters(friction):
    positions = []
    for drilling in (False, True):
        result = run(bouncing_plate(drilling, friction), 0.12, 1e-3)
        check_plate(result)
        positions.append(result.frames[:, :12, 0])
    assert np.linalg.norm(positions[1] - positions[0], axis=2).max() < 2e-3


@pytest.mark.parametrize("joint", [fl.joints.Revolute, fl.joints.Fixed])
def test_a_plate_bounces_with_a_body_on_a_joint_that_holds_its_drilling(joint):
    result = run(bouncing_plate(None, 0.3, joint), 0.12, 1e-3)
    check_plate(result)


@pytest.mark.parametrize(("scheme", "left"), [(DAMPED, 2e-4), (fl.schemes.Variational(), 5e-4)])
@pytest.mark.parametrize(("stiffness", "cells"), [(1e6, 2), (1e6, 8)])
def test_a_beam_struck_with_friction_keeps_its_momentum(scheme, left, stiffness, cells):
    """The mass of a bent beam, and of one that contacts turn, is not that of a straight one."""
    material = fl.Material(E=stiffness, nu=0.3, density=1000.0)
    section = fl.Section.circle(0.03, material)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells)
    ball = fl.RigidBody.ball(1.0, radius=0.05, position=(0.5, 0.02, 0.15))
    ball.add_velocity((0.5, 0, -3))
    surfaces = (
        fl.contact.Sphere(ball.point("centre"), radius=0.05),
        fl.contact.Sphere(beam.point((0.5, 0, 0)), radius=0.03),
    )
    scene = fl.Scene()
    for item in beam, ball:
        scene.add(item)
    scene.add(fl.contact.Contact(*surfaces, fl.contact.Impact(restitution=0.5, friction=0.3)))
    momentum = run(scene, 0.1, 1e-3, scheme).momentum
    assert np.abs(momentum - (0.5, 0, -3)).max() < left * 3.0


def test_a_beam_without_rotary_inertia_hits_the_floor():
    """As with that of its section, which is 1e-4 of its mass times its length squared."""
    full = fl.Section.circle(0.02, fl.Material(1e8, 0.3, 1000.0))
    light = fl.Section.from_stiffness(full.stiffness, mass=1000 * np.pi * 0.02**2)
    ends = []
    for section in (full, light):
        beam = fl.Beam.straight((0, 0, 0.1), (1, 0, 0.1), section, cells=6)
        scene = fl.Scene(gravity=(0, 0, -10 * GRAVITY))
        scene.add(beam)
        scene.add(fl.Clamp(beam.point("start")))
        tip = fl.contact.Sphere(beam.point("end"), 0.02)
        floor = fl.contact.Plane(fl.ground(), (0, 0.1, 1))
        scene.add(fl.contact.Contact(tip, floor, fl.contact.Impact()))
        result = run(scene, 0.2, 1e-3)
        assert result.contacts.contacts.any()
        assert np.diff(result.total_energy).max() < 1e-3 * result.total_energy[0]
        ends.append(result.position(beam.point("end")))
    assert np.abs(ends[1] - ends[0]).max() < 0.02


def test_velocities_by_momenta_need_inertia():
    full = fl.Section.circle(0.02, fl.Material(1e8, 0.3, 1000.0))
    light = fl.Section.from_stiffness(full.stiffness, mass=1.0)
    beam = fl.Beam.straight((0, 0, 0.1), (1, 0, 0.1), light, cells=2)
    scene = fl.Scene()
    scene.add(beam)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(
        fl.contact.Contact(fl.contact.Sphere(beam.point("end"), 0.02), floor, fl.contact.Impact())
    )
    with pytest.raises(ValueError, match="expected rotary inertia at all nodes"):
        run(scene, 0.1, 1e-2, fl.schemes.Variational())


# --- runs that go on ---


def stick_and_slip() -> fl.Scene:
    """A block on a platform that is driven to and fro: it sticks and slides in turns."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    platform = scene.add(fl.RigidBody(5.0, np.ones(3), (0, 0, -0.1)))
    block = scene.add(fl.RigidBody(1.0, cuboid(1.0, (0.2, 0.2, 0.1)), (0, 0, 0.05)))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), platform.point("centre"), axis=(1, 0, 0)))
    scene.add(fl.joints.Drive(rail.displacement, lambda t: 0.02 * (1 - np.cos(20 * t))))
    top = fl.contact.Plane(platform.point((0, 0, 0)), (0, 0, 1))
    box = fl.contact.Box(block.point("centre"), (0.2, 0.2, 0.1))
    scene.add(fl.contact.Contact(box, top, fl.contact.Impact(friction=0.5)))
    return scene


@each_scheme
@pytest.mark.parametrize("make", [stick_and_slip, bouncing_beam])
@pytest.mark.parametrize("every", [37, 80])
def test_a_restart_agrees_to_the_last_bit(tmp_path, make, every, scheme):
    options, file = {"duration": 0.3, "step": 2.5e-3, "progress": False}, tmp_path / "run.h5"
    whole = scheme.run(make(), **options)
    scheme.run(make(), **options, file=file, checkpoint_every=every)
    resumed = scheme.resume(make(), file, progress=False)
    loaded = fl.Result.load(file)
    assert whole.contacts.contacts[every:].max() > 0
    for name in ("frames", "velocities", "balance", "impulses", "iterations"):
        for other in (resumed, loaded):
            np.testing.assert_array_equal(getattr(other, name), getattr(whole, name))
    for name, values in vars(whole.contacts).items():
        np.testing.assert_array_equal(getattr(resumed.contacts, name), values)
        np.testing.assert_array_equal(getattr(loaded.contacts, name), values)


# --- bad input ---


def with_guide() -> fl.Scene:
    ball = fl.RigidBody(1.0, 4e-3 * np.ones(3), (0, 0, 1.1))
    scene = floored(ball, fl.contact.Sphere(ball.point("centre"), 0.1), fl.contact.Impact())
    mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 2.0]), (2, 2))
    sheet = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.05, STEEL)))
    sheet.roller("a=0", (1, 0, 0))
    return scene


def with_a_reduced_body() -> fl.Scene:
    full = fl.Scene()
    beam = full.add(fl.Beam.straight((0, 0, 1), (1, 0, 1), fl.Section.circle(0.02, STEEL), cells=4))
    rod = fl.reduction.reduced_order_body(full, [beam.point("start"), beam.point("end")], 2)
    return floored(rod, fl.contact.Sphere(rod.point("end"), 0.1), fl.contact.Impact())


def with_disc() -> fl.Scene:
    disc = fl.RigidBody(1.0, (0.1, 0.1, 0.2), (0, 0, 0.3))
    scene = fl.Scene()
    scene.add(disc)
    scene.add(fl.joints.RollingDisc(fl.ground(), disc.point("centre"), axis=(0, 1, 0), radius=0.3))
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(disc.point("centre"), 0.05), floor, fl.contact.Impact()
        )
    )
    return scene


REFUSED = {
    "guide": (with_guide, "without supports along fixed axes"),
    "reduced-order body": (with_a_reduced_body, "without reduced-order bodies"),
    "rolls": (with_disc, "without joints that roll"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        run(make(), 0.1, 0.01)

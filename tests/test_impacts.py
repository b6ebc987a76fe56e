"""Impacts and friction of rigid bodies: closed forms at steps of a hundredth of a second."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import fem_lie as fl
from fem_lie.contact.cones import solver
from fem_lie.contact.cones.factors import (
    add_block,
    empty_factors,
    factorise,
    pattern_of,
    set_identity,
    solve_nodes,
)
from fem_lie.contact.cones.jacobian import empty_rows
from fem_lie.contact.cones.sweeps import Cones, cones_of
from fem_lie.contact.impact.touching import Touching
from fem_lie.contact.impact.velocities import largest_speed, time_of

GRAVITY, RADIUS = 9.81, 0.1
FLOOR = fl.contact.Plane(fl.ground(), (0, 0, 1))


def run(scene, duration, step, radius=0.8, **options) -> fl.Result:
    scheme = fl.GeneralisedAlpha(radius=radius)
    return scheme.run(scene, duration=duration, step=step, progress=False, **options)


def on_slope(
    angle: float, body: fl.RigidBody, surface: fl.contact.ContactSurface, law, size=1.0
) -> fl.Scene:
    """A body on a plane across Z, with gravity as on an incline down X."""
    pull = GRAVITY * size
    scene = fl.Scene(gravity=(pull * np.sin(angle), 0, -pull * np.cos(angle)))
    scene.add(body)
    scene.add(fl.contact.Contact(surface, FLOOR, law))
    return scene


def cuboid(mass: float, edges) -> np.ndarray:
    squares = np.asarray(edges, dtype=float) ** 2
    return mass / 12 * (squares.sum() - squares)


# --- restitution ---


def falls(restitution: float, times: np.ndarray) -> np.ndarray:
    """Height of a ball that falls one metre, bounce after bounce."""
    out = np.empty_like(times)
    for k, time in enumerate(times):
        t, speed, length = time, 0.0, np.sqrt(2 / GRAVITY)
        height = 1.0
        after = restitution * np.sqrt(2 * GRAVITY)
        while t >= length and after > 1e-12:
            t, height, speed = t - length, 0.0, after
            length, after = 2 * speed / GRAVITY, restitution * speed
        rests = t >= length
        out[k] = 0.0 if rests else height + speed * t - 0.5 * GRAVITY * t**2
    return out


@pytest.mark.parametrize(
    ("restitution", "step", "error"),
    [
        (1.0, 1e-2, 1e-14),
        (1.0, 1e-3, 1e-13),
        (0.8, 1e-2, 1e-14),
        (0.8, 1e-3, 1e-13),
        (0.5, 1e-2, 2e-4),  # infinitely many impacts before it rests
        (0.5, 1e-3, 5e-7),
        (0.0, 1e-2, 1e-14),
    ],
)
def test_a_ball_bounces_as_the_closed_form(restitution, step, error):
    ball = fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), (0, 0, 1 + RADIUS))
    law = fl.contact.Impact(restitution=restitution)
    result = run(
        on_slope(0.0, ball, fl.contact.Sphere(ball.point("centre"), RADIUS), law), 2.0, step
    )
    height = result.position(ball.point("centre"))[:, 2] - RADIUS
    np.testing.assert_allclose(height, falls(restitution, result.times), rtol=0, atol=error)
    # the balance includes losses of impacts and the impulse of the ground
    assert result.energy_error < 1e-13
    assert result.momentum_error < 1e-13
    assert result.contacts.impact_loss.min() > -1e-13
    assert result.contacts.penetration.max() < 1e-13


@pytest.mark.parametrize("curvature", [0.0, 1e-18, 1e-15, 1e-12, 1e-8, 1e-4, 0.3, 2.0, 40.0])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_gap_is_zero_at_the_time_of_its_impact_and_open_before(curvature, sign):
    """Steadily, accelerated, slowed down, and thrown up first; times are right to round-off."""
    rng = np.random.default_rng(0)
    bend = sign * curvature
    for g0 in rng.uniform(0.01, 1.0, 50):
        moved = -(g0 + bend) - rng.uniform(0.0, 1.0)
        g1 = g0 + moved + bend
        assert g1 <= 0.0
        τ = time_of(g0, moved, g1)
        assert 0.0 < τ <= 1.0
        # what round-off of the three numbers is, and with it of the curvature
        size = g0 + abs(moved) + curvature
        assert abs(g0 + τ * (moved + τ * bend)) < 1e-15 * 8 * size
        before = np.linspace(0.0, τ, 100, endpoint=False)
        assert (g0 + before * (moved + before * bend) > -1e-15 * size).all()


def test_a_gap_that_only_just_closes_does_so_at_the_end_of_the_step():
    assert time_of(1.0, -2.0, 0.0) == pytest.approx(1.0, abs=1e-7)
    assert time_of(1.0, 0.0, 0.0) == 1.0


def test_balls_that_meet_change_velocities():
    """Along a line, one by one; and obliquely, without friction along the line of centres alone."""
    scene, balls = fl.Scene(), []
    for x, speed in ((0.0, 1.0), (0.5, 0.0), (1.0, 0.0)):
        balls.append(scene.add(fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), (x, 0, 0))))
        balls[-1].add_velocity((speed, 0, 0))
    surface = fl.contact.Vertices([ball.point("centre") for ball in balls], RADIUS)
    scene.add(fl.contact.Contact(surface, surface, fl.contact.Impact(restitution=1.0)))
    result = run(scene, 1.0, 1e-2)
    velocities = [result.velocity(ball.point("centre"))[-1, 0] for ball in balls]
    np.testing.assert_allclose(velocities, [0.0, 0.0, 1.0], atol=1e-13)
    # the last one is as far as if it had been one ball, less two diameters
    assert result.position(balls[2].point("centre"))[-1, 0] == pytest.approx(
        1.0 + 4 * RADIUS, abs=1e-13
    )


# --- friction ---


def slid(angle: float, size: float = 1.0, step: float = 1e-2, **options):
    edges = size * np.array([0.2, 0.2, 0.1])
    block = fl.RigidBody(1.0, cuboid(1.0, edges), (0, 0, edges[2] / 2))
    block.add_velocity((options.get("speed", 0.0) * size, 0, 0))
    law = fl.contact.Impact(friction=options.get("friction", 0.5))
    scene = on_slope(
        np.radians(angle), block, fl.contact.Box(block.point("centre"), edges), law, size
    )
    result = run(scene, 1.0, step)
    return result.position(block.point("centre")) / size, result


@pytest.mark.parametrize("angle", [20.0, 26.5, 26.56, 26.57, 30.0, 40.0])
def test_a_block_sticks_or_slides_on_a_slope(angle):
    """The tangent of 26.565° is the friction."""
    path, result = slid(angle)
    down, across = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    expected = max(0.0, 0.5 * GRAVITY * (down - 0.5 * across))
    assert path[-1, 0] == pytest.approx(expected, abs=1e-9)
    np.testing.assert_allclose(path[:, 2], 0.05, rtol=0, atol=1e-11)
    assert result.contacts.friction_loss.min() > -1e-9
    assert result.contacts.cone_residual.max() < 1e-6


def test_a_slope_has_no_size():
    paths = [slid(30.0, size)[0][-1, 0] for size in (1.0, 0.1, 1e-3)]
    np.testing.assert_allclose(paths, paths[0], rtol=1e-10)


@pytest.mark.parametrize(("step", "error"), [(1e-2, 1e-5), (1e-3, 1e-6)])
def test_a_block_slides_to_rest(step, error):
    path, result = slid(0.0, step=step, speed=2.0, friction=0.4)
    assert path[-1, 0] == pytest.approx(4.0 / (0.8 * GRAVITY), abs=error)
    assert result.contacts.friction_loss.sum() == pytest.approx(2.0, rel=1e-9)
    assert result.energy_error < 1e-13


@pytest.mark.parametrize("friction", [0.3, 0.1], ids=["rolls", "slides"])
def test_a_sphere_on_a_slope(friction):
    """It rolls if the friction is more than two sevenths of the tangent."""
    angle, r = np.radians(30.0), RADIUS
    sphere = fl.RigidBody(1.0, 0.4 * r * r * np.ones(3), (0, 0, r))
    law = fl.contact.Impact(friction)
    result = run(
        on_slope(angle, sphere, fl.contact.Sphere(sphere.point("centre"), r), law), 1.0, 1e-2
    )
    down, across = GRAVITY * np.sin(angle), GRAVITY * np.cos(angle)
    rolls = friction > 2 / 7 * np.tan(angle)
    acceleration = 5 / 7 * down if rolls else down - friction * across
    spin = 5 / 7 * down / r if rolls else 2.5 * friction * across / r
    assert result.position(sphere.point("centre"))[-1, 0] == pytest.approx(
        0.5 * acceleration, abs=1e-12
    )
    turned = (
        result.rotation(sphere.point("centre"))[-1]
        @ result.velocity(sphere.point("centre"))[-1, 3:]
    )
    assert turned[1] == pytest.approx(spin, abs=1e-11)
    assert result.energy_error < 1e-12


# --- constraints that come and go ---


def ladder(step: float, duration: float) -> tuple[fl.Result, np.ndarray, np.ndarray]:
    """A rod between a smooth wall and a smooth floor: its angle, and how far its top is off."""
    lean = 0.3
    c, s = np.cos(lean), np.sin(lean)
    axes = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    rod = fl.RigidBody(1.0, (1 / 12, 1 / 12, 1e-3), (s / 2, 0, c / 2), axes)
    along = rod.frames[0, 3] / 2
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(rod)
    top, foot = rod.point(rod.frames[0, 0] + along), rod.point(rod.frames[0, 0] - along)
    wall, floor = (fl.contact.Plane(fl.ground(), normal) for normal in ((1, 0, 0), (0, 0, 1)))
    scene.add(fl.contact.Contact(fl.contact.Vertices([top]), wall, fl.contact.Impact()))
    scene.add(fl.contact.Contact(fl.contact.Vertices([foot]), floor, fl.contact.Impact()))
    result = run(scene, duration, step)
    up = result.position(top) - result.position(foot)
    return result, np.arctan2(np.abs(up[:, 0]), up[:, 2]), result.position(top)[:, 0]


def test_a_ladder_slides_with_second_order_and_leaves_the_wall():
    """Its top leaves the wall at two thirds of its height."""
    fall = solve_ivp(
        lambda t, y: [y[1], 1.5 * GRAVITY * np.sin(y[0])],
        (0, 0.4),
        [0.3, 0.0],
        rtol=1e-12,
        atol=1e-13,
    )
    errors = [ladder(h, 0.4)[1][-1] - fall.y[0, -1] for h in (1e-2, 5e-3, 2.5e-3)]
    assert abs(errors[0]) < 1.2e-4
    assert 3.9 < errors[0] / errors[1] < 4.3
    assert 3.9 < errors[1] / errors[2] < 4.1
    result, _, top = ladder(2.5e-3, 0.6)
    left = result.times[np.flatnonzero(np.abs(top - top[0]) > 1e-7)[0]]
    assert left == pytest.approx(0.46001, abs=5e-3)
    assert np.diff(result.total_energy).max() < 1e-6


def test_a_rocking_block_loses_what_housner_says():
    """Of its rate in the impact on the other edge; what steps miss of the free motion is h."""
    half, tall = 0.05, 0.25
    corner = np.arctan(half / tall)
    lean, p2 = 0.5 * corner, 0.75 * GRAVITY / np.hypot(half, tall)
    gained = 2 * p2 * (np.cos(corner - lean) - np.cos(corner))
    time = quad(
        lambda q: 2 * q / np.sqrt(2 * p2 * (np.cos(corner - lean) - np.cos(corner - lean + q * q))),
        1e-12,
        np.sqrt(lean),
    )[0]
    c, s = np.cos(lean), np.sin(lean)
    axes = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    errors = []
    for step in (2e-3, 1e-3):
        edges = (2 * half, 0.2, 2 * tall)
        block = fl.RigidBody(1.0, cuboid(1.0, edges), -axes @ (half, 0, -tall), axes)
        scene = on_slope(
            0.0, block, fl.contact.Box(block.point("centre"), edges), fl.contact.Impact(1.0)
        )
        steps = int(np.ceil((time + 1.2 * step) / step))
        result = run(scene, steps * step, step)
        rate = abs(result.velocity(block.point("centre"))[-1, 4]) / np.sqrt(gained)
        errors.append(1 - 1.5 * np.sin(corner) ** 2 - rate)
    assert 0.0 < errors[1] < 0.016
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.3)


def test_restitution_adds_no_energy_in_a_box():
    """Sixteen balls with friction and rebound; momentum of free bodies is conserved."""
    rng = np.random.default_rng(1)
    scene = fl.Scene()
    balls = []
    for position in 0.25 * np.array(list(np.ndindex(4, 2, 2))):
        balls.append(scene.add(fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), position)))
        balls[-1].add_velocity(rng.normal(size=3))
    shell = scene.add(fl.RigidBody(30.0, 3.0 * np.ones(3), (0.375, 0.125, 0.125)))
    surface = fl.contact.Vertices([ball.point("centre") for ball in balls], RADIUS)
    law = fl.contact.Impact(friction=0.3, restitution=0.7)
    scene.add(fl.contact.Contact(surface, surface, law))
    scene.add(
        fl.contact.Contact(
            surface, fl.contact.Box(shell.point("centre"), (1.4, 1.4, 1.4), inside=True), law
        )
    )
    result = run(scene, 1.0, 1e-3)
    assert (result.contacts.contacts > 0).sum() > 10
    assert np.diff(result.kinetic).max() < 1e-4 * result.kinetic[0]
    assert result.kinetic[-1] < 0.8 * result.kinetic[0]
    assert result.momentum_error < 1e-13
    assert result.contacts.penetration.max() < 1e-9
    assert result.energy_error < 1e-9


# --- the law itself ---


def problem_of(W: np.ndarray, q: np.ndarray, friction: np.ndarray) -> Cones:
    """Contacts of one body with ground whose products are nearly those of ``W``."""
    k = len(friction)
    rows = empty_rows(k, 1, 3)
    rows.first[:], rows.values[:] = np.arange(k + 1), W.reshape(k, 3, 6)
    problem = cones_of(rows, rows, 1)
    problem.q[:], problem.friction[:] = q, friction
    return problem


@pytest.mark.parametrize("seed", range(8))
def test_solutions_satisfy_coulombs_law(seed):
    """Velocities and impulses of a body on several contacts, each by itself."""
    rng = np.random.default_rng(seed)
    k = 1 + seed % 5
    friction = rng.uniform(0.0, 1.2, size=k)
    rows = rng.normal(size=(3 * k, 6))
    # a motion that opens all contacts exists
    rows[::3, 2] = 3.0 + np.abs(rows[::3, 2])
    problem = problem_of(rows, rng.normal(size=(k, 3)) - [1.0, 0, 0], friction)
    _, _, left = solver.solve(problem, k, 1e-12)
    assert left < 1e-10
    r, u = problem.r, problem.q + (rows @ problem.W[0]).reshape(k, 3)
    size, fast = np.abs(r).max(), np.abs(problem.q).max()
    slide, push = np.linalg.norm(u[:, 1:], axis=1), np.linalg.norm(r[:, 1:], axis=1)
    assert r[:, 0].min() >= 0.0
    assert u[:, 0].min() > -1e-9 * fast
    np.testing.assert_allclose(r[:, 0] * u[:, 0], 0.0, atol=1e-9 * size * fast)
    assert (push <= friction * r[:, 0] + 1e-9 * size).all()
    # what slides is held back with all there is, against its way
    np.testing.assert_allclose(
        (r[:, 1:] * u[:, 1:]).sum(axis=1), -friction * r[:, 0] * slide, atol=1e-8 * size * fast
    )


def test_many_contacts_without_friction_are_solved_as_exactly_as_few():
    """A tower of 80 balls on the ground: each contact carries what is above it."""
    k, weight = 80, GRAVITY
    rows = empty_rows(k, 2, 3)
    rows.first[:] = 2 * np.arange(k + 1) - (np.arange(k + 1) > 0)
    axes = np.hstack([np.eye(3)[[2, 0, 1]], np.zeros((3, 3))])
    for c in range(k):
        block = rows.first[c]
        rows.nodes[block], rows.values[block] = c, axes
        if c > 0:
            rows.nodes[block + 1], rows.values[block + 1] = c - 1, -axes
    problem = cones_of(rows, rows, k)
    problem.q[0, 0] = -weight  # the others fall together
    _, _, left = solver.solve(problem, k, 1e-9)
    assert left <= 1e-9
    np.testing.assert_allclose(problem.r[:, 0], weight * np.arange(k, 0, -1), rtol=1e-4)


def test_many_contacts_come_to_rest():
    """A heap of 100 balls in a box, from its lattice on: cones to 1e-6 in every step."""
    rng, radius, law = np.random.default_rng(1), 0.05, fl.contact.Impact(0.3)
    scene, balls = fl.Scene(gravity=(0, 0, -GRAVITY)), []
    for at in np.ndindex(5, 5, 4):
        position = 2.1 * radius * (np.array(at) + 0.5) + 0.02 * radius * rng.standard_normal(3)
        balls.append(
            scene.add(fl.RigidBody(1.0, np.full(3, 0.4 * radius**2), position)).point("centre")
        )
    heap = fl.contact.Vertices(balls, radius)
    scene.add(fl.contact.Contact(heap, heap, law))
    scene.add(fl.contact.Contact(heap, FLOOR, law))
    side = 10.5 * radius
    for at, normal in ((0, (1, 0, 0)), (side, (-1, 0, 0)), (0, (0, 1, 0)), (side, (0, -1, 0))):
        wall = fl.contact.Plane(fl.ground(), normal, (at, at, 0))
        scene.add(fl.contact.Contact(heap, wall, law))
    reported = run(scene, 0.12, 2e-3).contacts
    assert reported.contacts.max() > 100
    assert reported.cone_residual.max() <= 1e-6
    assert reported.penetration.max() < 1e-12
    assert reported.friction_loss.min() > -1e-9


def in_a_groove(degrees: float) -> tuple[fl.Scene, fl.extend.Point, float]:
    """A ball that falls into a groove of so small an angle, and the height at which it fits."""
    angle, scene = np.radians(degrees), fl.Scene(gravity=(0, 0, -GRAVITY))
    height = RADIUS / np.sin(angle)
    position = (0, 0, height + 0.1 * RADIUS)
    ball = scene.add(fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), position, name="ball"))
    ball.add_velocity((3.0 * RADIUS, 0, -20.0 * RADIUS))
    for side in (1, -1):
        normal = (side * np.cos(angle), 0, np.sin(angle))
        wall = fl.contact.Plane(fl.ground(), normal, (0, 0, 0))
        scene.add(
            fl.contact.Contact(
                fl.contact.Sphere(ball.point("centre"), RADIUS), wall, fl.contact.Impact()
            )
        )
    return scene, ball.point("centre"), height


@pytest.mark.parametrize(("degrees", "overlap"), [(1.0, 1e-12), (0.3, 1e-12), (3e-3, 1e-11)])
def test_walls_that_almost_face_each_other_part_a_ball(degrees, overlap):
    """Gauss-Seidel sweeps part it by less than the angle squared each; it was left in the walls."""
    scene, ball, height = in_a_groove(degrees)
    result = run(scene, 0.3, 1e-2)
    assert result.divided == 0
    assert result.contacts.penetration.max() < overlap * RADIUS
    assert result.position(ball)[-1, 2] == pytest.approx(height, rel=1e-10)


def test_steps_in_which_bodies_cannot_be_parted_are_divided():
    scene, ball, height = in_a_groove(3e-4)
    result = run(scene, 0.3, 1e-2)
    assert result.divided > 0
    assert result.contacts.penetration.max() < 1e-9 * RADIUS
    assert result.position(ball)[-1, 2] == pytest.approx(height, rel=1e-6)


def test_bodies_that_cannot_be_parted_are_an_error():
    scene, _, _ = in_a_groove(1e-5)
    with pytest.raises(fl.ConvergenceError, match=r"ball and ground still overlap by .* wedged\?"):
        run(scene, 0.3, 1e-2)


# --- bad input ---


def impacted(law=None, **options) -> fl.Scene:
    ball = fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), (0, 0, 1))
    law = fl.contact.Impact() if law is None else law
    return on_slope(0.0, ball, fl.contact.Sphere(ball.point("centre"), RADIUS), law)


REFUSED = {
    "friction": (lambda: fl.contact.Impact(friction=-0.1), "friction must not be negative"),
    "restitution": (lambda: fl.contact.Impact(restitution=1.1), r"restitution must be in \[0, 1\]"),
    "not finite": (
        lambda: fl.contact.Impact(friction=float("inf")),
        "friction must be a finite number",
    ),
    "conserving": (
        lambda: fl.EnergyMomentum().run(impacted(), duration=1.0, step=0.1),
        "Impact is for GeneralisedAlpha, Variational and Explicit with constant steps",
    ),
    "statics": (lambda: fl.statics(impacted()), "Impact is for GeneralisedAlpha"),
    "adaptive": (
        lambda: run(impacted(), 1.0, fl.schemes.AdaptiveStep(1e-4)),
        "Impact is for GeneralisedAlpha with constant steps",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        make()


def test_results_come_back_from_a_file(tmp_path):
    result = run(impacted(), 0.5, 1e-2)
    result.save(tmp_path / "impacts.h5")
    loaded = fl.Result.load(tmp_path / "impacts.h5")
    for name, values in vars(result.contacts).items():
        np.testing.assert_array_equal(getattr(loaded.contacts, name), values)


def rolling_pile(friction: float = 0.4) -> fl.Scene:
    """Balls that fall on each other in a box, with rotation, friction and rebound."""
    rng = np.random.default_rng(3)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    positions = 0.22 * np.stack(np.meshgrid(*3 * [np.arange(2)], indexing="ij"), -1).reshape(-1, 3)
    positions -= (0.11, 0.11, 0.2)
    law = fl.contact.Impact(friction, 0.3)
    balls = [
        fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), tuple(position)) for position in positions
    ]
    for each in balls:
        each.add_velocity(rng.normal(size=3))
        each.add_velocity(omega=rng.normal(size=3), about=each.point("centre"))
        scene.add(each)
    surface = fl.contact.Vertices([each.point("centre") for each in balls], RADIUS)
    scene.add(fl.contact.Contact(surface, surface, law))
    walls = fl.contact.Box(fl.ground(), (0.8, 0.8, 0.8), inside=True)
    scene.add(fl.contact.Contact(surface, walls, law))
    return scene


@pytest.mark.parametrize("every", [40, 110, 160])
def test_a_restart_agrees_to_the_last_bit(tmp_path, every):
    """From among impacts, in the middle of sliding, and where most sticks or rolls."""
    options, file = {"duration": 0.6, "step": 2e-3, "progress": False}, tmp_path / "run.h5"
    scheme = fl.GeneralisedAlpha(radius=0.8)
    whole = scheme.run(rolling_pile(), **options)
    scheme.run(rolling_pile(), **options, file=file, checkpoint_every=every)
    resumed = scheme.resume(rolling_pile(), file, progress=False)
    loaded = fl.Result.load(file)
    assert whole.contacts.friction_loss[every * (300 // every) - 1 :].max() > 0.0
    for name in ("frames", "velocities", "balance", "impulses", "iterations"):
        for other in (resumed, loaded):
            np.testing.assert_array_equal(getattr(other, name), getattr(whole, name))
    for name, values in vars(whole.contacts).items():
        np.testing.assert_array_equal(getattr(resumed.contacts, name), values)
        np.testing.assert_array_equal(getattr(loaded.contacts, name), values)
    with pytest.raises(ValueError, match="belongs to another scene"):
        scheme.resume(rolling_pile(0.5), file, progress=False)


def test_spinning_balls_near_a_large_body_do_not_lengthen_the_list_of_neighbours():
    """A point moves with the spin of its own body; a drum's radius is none of the balls'."""
    scene, law = fl.Scene(), fl.contact.Impact(0.3)
    bar = scene.add(fl.RigidBody.box(1.0, (20.0, 0.1, 0.1), (0, 5, 0)))
    balls = [scene.add(fl.RigidBody.ball(1.0, RADIUS, (float(x), 0, 0))) for x in range(30)]
    row = fl.contact.Vertices([ball.point("centre") for ball in balls], RADIUS)
    tip = fl.contact.Vertices([bar.point((10.0, 5.0, 0.0))], RADIUS)
    scene.add(fl.contact.Contact(row, row, law))
    scene.add(fl.contact.Contact(row, tip, law))
    bodies = [bar, *balls]
    H = np.concatenate([body.frames for body in bodies])
    numbers = {body: np.array([k]) for k, body in enumerate(bodies)}
    touching = Touching(scene.contacts, numbers.__getitem__, np.ones(len(bodies)), H)
    np.testing.assert_allclose(touching.arms, [10.0] + 30 * [0.0], atol=1e-14)
    v = np.zeros((len(bodies), 6))
    v[1:, 3] = 100.0
    assert largest_speed(v, touching.arms) == 0.0
    touching.update(H, 1e-2 * largest_speed(v, touching.arms))
    assert len(touching.touch.pairs) == 0
    v[0, 3:] = 0.0, 3.0, 4.0
    assert largest_speed(v, touching.arms) == pytest.approx(50.0)


def test_impulses_stay_with_their_pairs_when_the_list_changes():
    """The workspace has room for later lists, in which pairs have other places."""
    scene = fl.Scene()
    balls = [scene.add(fl.RigidBody.ball(1.0, RADIUS, (0.2 * x, 0, 0))) for x in range(4)]
    row = fl.contact.Vertices([ball.point("centre") for ball in balls], RADIUS)
    scene.add(fl.contact.Contact(row, row, fl.contact.Impact()))
    H = np.concatenate([body.frames for body in balls])
    numbers = {body: np.array([k]) for k, body in enumerate(balls)}
    touching = Touching(scene.contacts, numbers.__getitem__, np.ones(4), H)
    work, whole = touching.work, [[0, 1], [1, 2], [2, 3]]
    np.testing.assert_array_equal(touching.touch.pairs, whole)
    work.impulses[:3] = np.arange(1.0, 10.0).reshape(3, 3)
    H[0, 0, 2] = 5.0
    touching.update(H)
    np.testing.assert_array_equal(touching.touch.pairs, whole[1:])
    np.testing.assert_array_equal(touching.work.impulses[:2], [[4, 5, 6], [7, 8, 9]])
    assert touching.work is work
    H[0, 0, 2] = 0.0
    touching.update(H)
    np.testing.assert_array_equal(touching.touch.pairs, whole)
    np.testing.assert_array_equal(touching.work.impulses[:3], [[0, 0, 0], [4, 5, 6], [7, 8, 9]])


def test_a_surface_of_many_points_is_named_once_when_it_is_checked():
    """The name lists all points, so that a name for each would take the square of their number."""

    class Named(fl.contact.Vertices):
        names = 0

        @property
        def label(self) -> str:
            Named.names += 1
            return super().label

    balls = [fl.RigidBody.ball(1.0, RADIUS, (float(x), 0, 0)) for x in range(20)]
    surface = Named([ball.point("centre") for ball in balls], RADIUS)
    Named.names = 0
    surface.check()
    assert Named.names <= 1


@pytest.mark.parametrize("n", [1, 7, 40])
def test_sparse_factors_solve_what_dense_ones_do(n):
    """Of a matrix of blocks of nodes in a random graph, with one node coupled to all others."""
    random = np.random.default_rng(n)
    pairs = [(i, j) for i in range(n) for j in range(n) if j == 0 or random.random() < 0.1]
    pairs += [(j, i) for i, j in pairs]
    nodes = [[j for k, j in pairs if k == i] for i in range(n)]
    first = np.cumsum([0, *(len(each) for each in nodes)])
    pattern = pattern_of(first, np.concatenate(nodes).astype(np.int64))
    factors, dense = empty_factors(n, len(pattern.later)), np.eye(6 * n)
    set_identity(factors)
    for i, j in pairs:
        left, right = 0.3 * random.standard_normal((2, 3, 6))
        add_block(pattern, factors, pattern.position[i], pattern.position[j], left, right)
        dense[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] += left.T @ right
    dense += 50 * np.eye(6 * n)
    factors.diagonal[:] += 50 * np.eye(6)
    factorise(pattern, factors, np.zeros(n, dtype=np.int64), np.zeros((6, 12)))
    x = random.standard_normal((n, 6))
    expected = np.linalg.solve(dense, x.ravel())
    solve_nodes(pattern, factors, x, np.zeros((n, 6)), np.zeros((6, 12)))
    np.testing.assert_allclose(x.ravel(), expected, rtol=1e-11, atol=1e-13)

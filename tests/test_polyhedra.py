"""Convex polyhedra that touch each other and balls: closed forms and linear programs."""

from itertools import pairwise, product

import numpy as np
import pytest
from scipy.optimize import linprog, minimize
from scipy.spatial import ConvexHull

import fem_lie as fl
from fem_lie import lie

GRAVITY, EDGE = 9.81, 0.2
CUBE = (EDGE, EDGE, EDGE)


def run(scene, duration, step, **options) -> fl.Result:
    return fl.GeneralisedAlpha().run(scene, duration=duration, step=step, progress=False, **options)


def cuboid(mass: float, edges) -> np.ndarray:
    squares = np.asarray(edges, dtype=float) ** 2
    return mass / 12 * (squares.sum() - squares)


def box_at(scene, position, edges=CUBE, rotation=None, mass=1.0):
    rotation = np.eye(3) if rotation is None else rotation
    body = fl.RigidBody(mass, cuboid(mass, edges), position=position, rotation=rotation)
    return scene.add(body), fl.contact.Box(body.point("centre"), edges)


def stack(
    count: int, law: fl.contact.Impact, offset: float = 0.0
) -> tuple[fl.Scene, list[fl.RigidBody]]:
    """Cubes on a cube that is fixed to ground, each so far along X from the one below it."""
    scene, bodies = fl.Scene(gravity=(0, 0, -GRAVITY)), []
    below = fl.contact.Box(fl.ground(), CUBE)
    for k in range(count):
        body, box = box_at(scene, (offset * (k + 1), 0, EDGE * (k + 1)))
        scene.add(fl.contact.Contact(below, box, law))
        bodies.append(body)
        below = box
    return scene, bodies


def moved(result, body) -> np.ndarray:
    positions = result.position(body.point("centre"))
    return positions[-1] - positions[0]


def energy(result) -> np.ndarray:
    return np.asarray(result.kinetic + result.potential)


# --- at rest ---


def test_ten_cubes_stay_where_they_are():
    """For ten seconds, to round-off: each step solves Coulomb's law to the last digits."""
    scene, bodies = stack(10, fl.contact.Impact(friction=0.5))
    result = run(scene, 10.0, 1e-2, save_every=1000)
    assert max(np.abs(moved(result, body)).max() for body in bodies) < 1e-12
    assert result.contacts.penetration.max() < 1e-12


def overhang(count: int, part: float) -> tuple[fl.Scene, fl.RigidBody]:
    """Blocks that reach over the edge of a table by a part of ``½ Σ 1/k`` of their length."""
    scene, law = fl.Scene(gravity=(0, 0, -GRAVITY)), fl.contact.Impact(friction=0.8)
    length, height = 1.0, 0.1
    table = fl.contact.Box(fl.ground(), (4.0, 1.0, height))
    surfaces, point_at = [], 2.0 - 0.5 * length
    shifts = [0.5 * part * length / (count - k) for k in range(count)]
    for k, shift in enumerate(shifts):
        point_at += shift
        body, box = box_at(scene, (point_at, 0, height * (k + 1)), (length, 0.5, height))
        surfaces.append(box)
    for below, above in pairwise([table, *surfaces]):
        scene.add(fl.contact.Contact(below, above, law))
    return scene, body


@pytest.mark.parametrize(("part", "stands"), [(0.99, True), (1.01, False)])
def test_blocks_hang_over_by_the_harmonic_series(part, stands):
    scene, top = overhang(5, part)
    result = run(scene, 1.0, 5e-3)
    fallen = moved(result, top)
    if stands:
        assert np.abs(fallen).max() < 1e-12
    else:
        assert fallen[2] < -0.02


@pytest.mark.parametrize("degrees", [20.0, 30.0])
def test_a_cube_on_a_wedge_sticks_or_slides(degrees):
    """Down by ``½ g (sin α − μ cos α) t²``, and not at all where that is negative."""
    angle, friction, time = np.radians(degrees), 0.45, 0.5
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    slope = np.array([np.cos(angle), 0, -np.sin(angle)])
    normal = np.array([np.sin(angle), 0, np.cos(angle)])
    corners = [
        s * slope + y * np.array([0, 1, 0]) - z * normal
        for s, y, z in product((-2, 2), (-1, 1), (0, 1))
    ]
    wedge = fl.contact.ConvexPolyhedron(fl.ground(), corners)
    axes = np.column_stack([slope, (0, 1, 0), normal])
    body, box = box_at(scene, 0.5 * EDGE * normal, rotation=axes)
    scene.add(fl.contact.Contact(box, wedge, fl.contact.Impact(friction=friction)))
    result = run(scene, time, 1e-2)
    pull = max(0.0, GRAVITY * (np.sin(angle) - friction * np.cos(angle)))
    np.testing.assert_allclose(moved(result, body), 0.5 * pull * time**2 * slope, atol=1e-12)


def test_crossed_bars_touch_with_their_edges():
    """One falls on the other, edge on edge, and bounces back to where it was."""
    edges, fall = (1.0, 0.2, 0.2), 0.05
    askew = lie.so3_exp(np.array([np.pi / 4, 0, 0]))
    across = lie.so3_exp(np.array([0, 0, np.pi / 2])) @ askew
    corners = [across @ (0.5 * np.array(edges) * s) for s in product((-1, 1), repeat=3)]
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    height = 2 * 0.1 * np.sqrt(2) + fall
    body, box = box_at(scene, (0, 0, height), edges, askew)
    bar = fl.contact.ConvexPolyhedron(fl.ground(), corners)
    scene.add(fl.contact.Contact(bar, box, fl.contact.Impact(restitution=1.0)))
    bounces = 2 * np.sqrt(2 * fall / GRAVITY)
    result = run(scene, 3 * bounces, bounces / 40)
    assert np.abs(moved(result, body)).max() < 1e-12
    assert result.position(body.point("centre"))[:, 2].min() < height - 0.99 * fall
    np.testing.assert_allclose(energy(result), energy(result)[0], rtol=1e-12)


# --- when they meet ---


def random_polyhedron(rng, count: int = 10) -> np.ndarray:
    """Corners of one about the origin."""
    points = rng.normal(size=(count, 3))
    points *= 0.5 / np.linalg.norm(points, axis=1)[:, np.newaxis]
    return points - points[ConvexHull(points).vertices].mean(axis=0)


def way_to_meet(first: np.ndarray, second: np.ndarray, direction: np.ndarray) -> float:
    """How far the first goes until it touches the second: a linear program.

    ``λᵀ first + t d = μᵀ second`` with weights ``λ`` and ``μ`` of the corners, ``t`` the least.
    """
    n, m = len(first), len(second)
    equal = np.zeros((5, n + m + 1))
    equal[:3, :n], equal[:3, n : n + m], equal[:3, -1] = first.T, -second.T, direction
    equal[3, :n], equal[4, n : n + m] = 1.0, 1.0
    cost = np.zeros(n + m + 1)
    cost[-1] = 1.0
    found = linprog(cost, A_eq=equal, b_eq=[0, 0, 0, 1, 1], bounds=(0, None))
    assert found.success
    return float(found.fun)


def first_step(result) -> int:
    return int(np.flatnonzero(result.contacts.contacts)[0]) + 1


@pytest.mark.parametrize("seed", range(24))
def test_polyhedra_meet_when_a_linear_program_says(seed):
    """Thrown at each other, corner on face, edge on edge and face on corner; what is thrown stays.

    Impacts are elastic and smooth: momentum stays, and no energy is gained.
    """
    rng = np.random.default_rng(seed)
    speed, step = 1.0, 1e-3
    corners = random_polyhedron(rng), random_polyhedron(rng)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    start = -1.3 * direction
    scene = fl.Scene()
    positions = start, np.zeros(3)
    bodies = [
        scene.add(fl.RigidBody(mass, (0.1 * mass,) * 3, position=point_at))
        for mass, point_at in zip((1.0, 2.0), positions, strict=True)
    ]
    bodies[0].add_velocity(speed * direction)
    surfaces = [
        fl.contact.ConvexPolyhedron(body.point("centre"), of)
        for body, of in zip(bodies, corners, strict=True)
    ]
    scene.add(fl.contact.Contact(*surfaces, fl.contact.Impact(restitution=1.0)))
    way = way_to_meet(corners[0] + start, corners[1], direction)
    result = run(scene, 1.0, step)
    assert first_step(result) == int(np.ceil(way / speed / step))
    assert np.abs(result.momentum - result.momentum[0]).max() < 1e-13
    # impulses act where bodies are at the end of the step of the impact
    assert np.abs(result.angular_momentum - result.angular_momentum[0]).max() < speed * step
    np.testing.assert_allclose(energy(result), energy(result)[0], rtol=4 * speed * step)
    assert (energy(result) <= energy(result)[0] * (1 + 1e-12)).all()
    assert result.contacts.penetration.max() < 1e-12


def distance_to(corners: np.ndarray, point_at: np.ndarray) -> float:
    """Of a position from a polyhedron, by its weights of the corners."""
    n = len(corners)
    found = minimize(
        lambda w: ((w @ corners - point_at) ** 2).sum(),
        np.full(n, 1 / n),
        jac=lambda w: 2 * corners @ (w @ corners - point_at),
        bounds=n * [(0, 1)],
        constraints={"type": "eq", "fun": lambda w: w.sum() - 1, "jac": lambda w: np.ones(n)},
        method="SLSQP",
        options={"ftol": 1e-16, "maxiter": 500},
    )
    return float(np.sqrt(found.fun))


@pytest.mark.parametrize(
    ("aside", "away"),
    [
        ((0.0, 0.0), None),
        ((0.53, 0.1), None),
        ((0.53, 0.53), None),
        ((0.58, -0.55), None),
        ((0.2, 0.61), 0.61),
    ],
    ids=["face", "edge", "corner", "another corner", "none"],
)
def test_a_ball_meets_faces_edges_and_corners(aside, away):
    """It falls past a box that is fixed, and touches it where it is nearest."""
    radius, half, step = 0.1, 0.5, 1e-3
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    point_at = np.array([*aside, 0.8])
    ball = scene.add(fl.RigidBody(1.0, (0.004,) * 3, position=point_at))
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), radius),
            fl.contact.Box(fl.ground(), (1, 1, 1)),
            fl.contact.Impact(restitution=1),
        )
    )
    result = run(scene, 0.3, step)
    corners = half * np.array(list(product((-1, 1), repeat=3)))
    positions = result.position(ball.point("centre"))
    if away is not None:
        assert not result.contacts.contacts.any()
        return
    apart = np.maximum(np.abs(point_at[:2]) - half, 0.0)
    rise = np.sqrt(radius**2 - apart @ apart)
    assert first_step(result) == int(np.ceil(np.sqrt(2 * (0.3 - rise) / GRAVITY) / step))
    gaps = [distance_to(corners, x) - radius for x in positions[::10]]
    assert min(gaps) > -1e-6
    # the normal of an edge or corner turns while the ball goes on in the step of the impact
    assert (energy(result) <= energy(result)[0] * (1 + 1e-12)).all()
    np.testing.assert_allclose(energy(result), energy(result)[0], rtol=1e-4)


# --- with joints, and over steps ---


def test_a_cube_in_a_joint_presses_on_a_stack():
    scene, bodies = stack(2, fl.contact.Impact(friction=0.5))
    top, box = box_at(scene, (0, 0, 3.2 * EDGE))
    scene.add(fl.joints.Prismatic(fl.ground(), top.point("centre"), axis=(0, 0, 1)))
    scene.add(
        fl.contact.Contact(
            fl.contact.Box(bodies[-1].point("centre"), CUBE), box, fl.contact.Impact(friction=0.5)
        )
    )
    result = run(scene, 0.5, 2e-3)
    np.testing.assert_allclose(moved(result, top), (0, 0, -0.2 * EDGE), atol=1e-9)
    for body in bodies:
        assert np.abs(moved(result, body)).max() < 1e-9


def tumbling() -> fl.Scene:
    scene, law = (
        fl.Scene(gravity=(0, 0, -GRAVITY)),
        fl.contact.Impact(friction=0.3, restitution=0.2),
    )
    rng, surfaces = np.random.default_rng(5), []
    for k in range(3):
        body, box = box_at(
            scene, (0.02 * k, 0, 0.3 + 0.4 * k), rotation=lie.so3_exp(rng.normal(size=3))
        )
        surfaces.append(box)
        body.add_velocity(omega=rng.normal(size=3), about=body.point("centre"))
    floor = fl.contact.Box(fl.ground(), (2, 2, 0.2))
    for k, box in enumerate(surfaces):
        for other in [floor, *surfaces[:k]]:
            scene.add(fl.contact.Contact(box, other, law))
    return scene


@pytest.mark.parametrize("every", [40, 110])
def test_a_restart_agrees_to_the_last_bit(tmp_path, every):
    options, file = {"duration": 0.6, "step": 2e-3, "progress": False}, tmp_path / "run.h5"
    scheme = fl.GeneralisedAlpha()
    whole = scheme.run(tumbling(), **options)
    scheme.run(tumbling(), **options, file=file, checkpoint_every=every)
    resumed = scheme.resume(tumbling(), file, progress=False)
    assert whole.contacts.penetration.max() < 1e-9
    for name in ("frames", "velocities", "balance", "impulses", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))
    for name, values in vars(whole.contacts).items():
        np.testing.assert_array_equal(getattr(resumed.contacts, name), values)


@pytest.mark.parametrize("ball", [True, False])
def test_what_goes_through_is_an_error(ball):
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (0.01,) * 3, position=(0, 0, 1)))
    body.add_velocity((0, 0, -200))
    surface = (
        fl.contact.Sphere(body.point("centre"), 0.1)
        if ball
        else fl.contact.Box(body.point("centre"), CUBE)
    )
    plate = fl.contact.Box(fl.ground(), (1, 1, 0.1))
    scene.add(fl.contact.Contact(surface, plate, fl.contact.Impact()))
    with pytest.raises(fl.ConvergenceError, match="one side passed through the other"):
        run(scene, 0.2, 1e-2)


# --- bad input ---


def two(first, second, law=None, apart=1.0):
    scene = fl.Scene()
    bodies = [scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(x, 0, 0))) for x in (0.0, apart)]
    return scene.add(
        fl.contact.Contact(first(bodies[0]), second(bodies[1]), law or fl.contact.Impact())
    )


def cube(body):
    return fl.contact.Box(body.point("centre"), CUBE)


REFUSED = {
    "penalty": (
        lambda: two(cube, cube, fl.contact.Penalty(1e5)),
        "polyhedra touch each other by Impact",
    ),
    "overlap": (lambda: two(cube, cube, apart=0.15), "overlap by 0.05; start with a gap"),
    "flat": (
        lambda: fl.contact.ConvexPolyhedron(
            fl.ground(), [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        ),
        "must not lie in a plane",
    ),
    "three corners": (
        lambda: fl.contact.ConvexPolyhedron(fl.ground(), np.eye(3)),
        r"at least four finite points, shape \(n, 3\), got shape \(3, 3\)",
    ),
    "itself": (
        lambda: two(cube, lambda body: fl.contact.Box(body.point("centre"), CUBE)).check()
        or fl.Scene().add(
            fl.contact.Contact(*2 * [fl.contact.Box(fl.ground(), CUBE)], fl.contact.Impact())
        ),
        "expected surfaces on different frames",
    ),
    "points": (
        lambda: two(cube, lambda body: fl.contact.Vertices([body.point("centre")])),
        "points and hollow spheres do not touch polyhedra",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        make()

"""Line contact of cables and nets: a line that touches itself, closed lines, threads that cross."""

import numpy as np
import pytest

import fem_lie as fl
from tests.test_contact_pairs import Knob

RADIUS = 0.01
SOFT = fl.Material(1e8, 0.3, 1000.0)
SECTION = fl.Section.circle(RADIUS, SOFT)
LAW = fl.contact.Penalty(1e6)
DEPTH = 1e-3


def forces(contact: fl.contact.Contact, *bodies: fl.extend.Body) -> np.ndarray:
    """Forces on the nodes at the start, global components, shape (n, 3)."""
    first = np.cumsum([0, *(len(body.frames) for body in bodies)])
    numbers = {b: np.arange(len(b.frames)) + k for b, k in zip(bodies, first, strict=False)}
    H, out = np.concatenate([body.frames for body in bodies]), np.zeros((first[-1], 6))
    contact.term(numbers.__getitem__).add_forces(H, out)
    # unit slopes at the start, so that these are the axes of all nodes
    return np.einsum("nk,nkj->nj", out[:, :3], H[:, 1:])


def loop(t: float) -> np.ndarray:
    """A line that crosses over itself at right angles at the origin."""
    x, y = np.sin(t), np.sin(t) * np.cos(t)
    z = (RADIUS - 0.5 * DEPTH) * np.cos(t)
    return np.array([x, np.sqrt(2.0) * y, z])


def crossing(start: float, end: float, cells: int) -> fl.Cable:
    """Part of the line."""
    axis = fl.mesh.curve(lambda s: loop(np.pi * (start + s * (end - start))), cells)
    return fl.Cable(axis, SECTION)


def test_a_line_pushes_itself_apart_where_it_crosses_itself():
    """As two lines with the same axes do, and without a resultant."""
    whole = crossing(-0.4, 1.4, 90)
    line = fl.contact.Line(whole, RADIUS)
    found = forces(fl.contact.Contact(line, line, LAW), whole)
    parts = crossing(-0.4, 0.4, 40), crossing(0.6, 1.4, 40)
    lines = [fl.contact.Line(part, RADIUS) for part in parts]
    two = forces(fl.contact.Contact(*lines, LAW), *parts)[:41].sum(axis=0)
    push = np.linalg.norm(two)
    assert push > 0.0
    np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-12 * push)
    np.testing.assert_allclose(found[:46].sum(axis=0), two, atol=1e-2 * push)


@pytest.mark.parametrize("make", ["cable", "net", "beam"])
def test_neighbours_along_a_line_do_not_touch(make):
    """Segments may be shorter than their radius."""
    axis = fl.mesh.curve(lambda s: np.array([s, 0.02 * s * s, 0.0]), 200)
    body = {
        "cable": lambda: fl.Cable(axis, SECTION),
        "net": lambda: fl.Net(axis.points, [range(201)], SECTION),
        "beam": lambda: fl.Beam(axis, SECTION),
    }[make]()
    line = fl.contact.Line(body, RADIUS)
    contact = fl.contact.Contact(line, line, LAW)
    contact.check()
    assert not forces(contact, body).any()


@pytest.mark.parametrize("make", ["spline", "net"])
def test_a_closed_line_has_no_seam(make):
    """A ball touches a ring with the same force wherever it is, at the first node, too."""
    cells, ring = 24, 0.2
    angles = np.linspace(0.0, 2.0 * np.pi, cells + 1)
    around = ring * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    body = {
        "spline": lambda: fl.SplineCable.circle((0, 0, 0), ring, (0, 0, 1), SECTION, cells=cells),
        "net": lambda: fl.Net(around[:-1], [[*range(cells), 0]], SECTION),
    }[make]()
    found = []
    for part in np.linspace(0.0, 1.0, 9):
        angle = 2.0 * np.pi * (part - 0.5) / cells
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        point = fl.RigidBody(1.0, np.eye(3), (ring + 2.0 * RADIUS - 4.0 * DEPTH) * out)
        ball = fl.contact.Sphere(point.point("centre"), RADIUS)
        contact = fl.contact.Contact(ball, fl.contact.Line(body, RADIUS), LAW)
        found.append(np.linalg.norm(forces(contact, point, body)[0]))
    assert min(found) > 0.0
    assert np.ptp(found) < 0.02 * max(found)


def wave(s: float) -> np.ndarray:
    """A cubic that falls, rises and falls again: its lowest point is at neither end."""
    u, slope = s - 0.5, 0.3
    lowest = -2.0 / 3.0 * slope * np.sqrt(slope / 3.0)
    return np.array([s, 0.2 * (slope * u - u**3 - lowest) + 2.0 * RADIUS - DEPTH, 0.0])


@pytest.mark.parametrize("first", [0, 1])
def test_a_bent_element_touches_where_its_gap_has_several_extrema(first):
    """The gap falls at both ends of the element, and is least in between."""
    straight = fl.Cable.straight((0, 0, 0), (1, 0, 0), SECTION, cells=1)
    found = []
    for cells in (1, 16):
        bent = fl.Cable(fl.mesh.curve(wave, cells), SECTION)
        pair = [straight, bent] if first == 0 else [bent, straight]
        lines = [fl.contact.Line(body, RADIUS) for body in pair]
        on = forces(fl.contact.Contact(*lines, LAW), *pair)
        np.testing.assert_allclose(on.sum(axis=0), 0.0, atol=1e-12 * np.abs(on).max())
        found.append(on[:2].sum(axis=0) if first == 0 else on[-2:].sum(axis=0))
    assert abs(found[1][1]) > 10.0
    np.testing.assert_allclose(found[0], found[1], rtol=0.06, atol=1e-3 * abs(found[1][1]))


GRAVITY, FRICTION = 9.81, 0.5


def thread(make: str, path, cells: int, section: fl.Section) -> fl.extend.Body:
    """A cable, spline cable or net along a path of a parameter from 0 to 1."""
    if make == "cable":
        return fl.Cable(fl.mesh.curve(path, cells), section)
    s = np.linspace(0.0, 1.0, cells + 1)
    points = np.array([path(t) for t in s])
    if make == "net":
        return fl.Net(points, [range(cells + 1)], section)
    rates = [(path(t + 1e-6) - path(t - 1e-6)) / 2e-6 for t in s]
    return fl.SplineCable(s, points, rates, section)


ALPHA, EXPLICIT = fl.GeneralisedAlpha(radius=0.8), fl.Explicit()


@pytest.mark.parametrize(
    ("make", "scheme"),
    [("cable", ALPHA), ("spline", ALPHA), ("net", ALPHA), ("cable", EXPLICIT), ("net", EXPLICIT)],
)
def test_a_thread_sticks_or_slides_on_an_incline(make, scheme):
    """By Coulomb's law, along its axis and across it, as one without rotations does not roll."""
    k, weight = 1e5, GRAVITY * 1000.0 * np.pi * RADIUS**2
    for degrees, sticks in ((20.0, True), (30.0, False)):
        angle = np.radians(degrees)
        height = RADIUS - weight * np.cos(angle) / k
        body = thread(make, lambda s, z=height: np.array([0.8 * s, 0.6 * s, z]), 6, SECTION)
        scene = fl.Scene(gravity=(GRAVITY * np.sin(angle), 0, -GRAVITY * np.cos(angle)))
        scene.add(body)
        floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
        law = fl.contact.Penalty(k, friction=FRICTION)
        scene.add(fl.contact.Contact(fl.contact.Line(body, RADIUS), floor, law))
        step = 1e-3
        if scheme is EXPLICIT:
            step = 0.1 / np.ceil(0.1 / (0.5 * scheme.stable_step(scene)))
        result = scheme.run(scene, duration=0.1, step=step, progress=False)
        moved = (result.frames[:, :, 0, 0] - result.frames[0, :, 0, 0]).mean(axis=1)
        assert result.energy_error < 3e-3
        if sticks:
            # it vibrates on its springs
            assert moved.max() < 4.0 * weight * np.sin(angle) / k
            continue
        late = result.times > 0.04
        square, _, _ = np.polyfit(result.times[late], moved[late], 2)
        wanted = GRAVITY * (np.sin(angle) - FRICTION * np.cos(angle))
        assert 2.0 * square == pytest.approx(wanted, rel=1e-2)
        lost = FRICTION * weight * np.cos(angle) * moved[-1]
        assert result.balance[-1, 1] == pytest.approx(lost, rel=1e-2)


@pytest.mark.parametrize(
    ("make", "law"),
    [
        ("cable", fl.contact.Penalty(1e6, friction=0.3)),
        ("spline", fl.contact.Penalty(1e6, friction=0.3)),
        ("cable", fl.contact.MortarPenalty(1e6, friction=0.3)),
    ],
)
def test_a_cable_around_half_of_a_drum_has_the_tensions_of_a_capstan(make, law):
    """Pulled at one end and held at the other: exp(μφ), without its bending stiffness."""
    drum, thick, n = 0.1, 5e-3, 46
    radius = drum + thick - 6e-6
    tail = 3 * np.pi * radius / (n - 6)

    def path(s: float) -> np.ndarray:
        along = s * (np.pi * radius + 2.0 * tail) - tail
        angle = min(max(along / radius, 0.0), np.pi)
        beyond, c, s = along - angle * radius, np.cos(angle), np.sin(angle)
        return np.array([radius * c - beyond * s, radius * s + beyond * c, 0.0])

    section = fl.Section.from_stiffness([100.0, 30.0, 30.0, 1e-7, 1e-7, 1e-7])
    body = thread(make, path, n, section)
    scene = fl.Scene()
    scene.add(body)
    end = body.point("end")
    scene.add(fl.joints.Spherical(fl.ground(end.position), end, name="held"))
    scene.add(fl.PointLoad(body.point("start"), force=(0, -1.0, 0)))
    bar = fl.contact.Cylinder(fl.ground(), (0, 0, 0.4), drum)
    scene.add(fl.contact.Contact(fl.contact.Line(body, thick), bar, law))
    rest = fl.statics(scene, load_steps=10)
    held = np.linalg.norm(rest.joint_force("held")[-1, :3])
    assert 1.0 / held == pytest.approx(np.exp(law.friction * np.pi), rel=2e-3)


LAID = fl.elements.DiscreteCable(natural=True)


def test_two_threads_collide_and_keep_energy_and_momenta():
    """Free discrete cables that cross, at 1e-12; the upper one does not pass through."""
    ends = np.array([[-0.5, 0.02, 0.0], [0.5, -0.02, 0.0]])
    paths = [ends[0] + np.linspace(0, 1, 9)[:, None] * (ends[1] - ends[0])]
    paths.append(paths[0][:, [1, 0, 2]] + [0.03, 0.0, 2.0 * RADIUS + 1e-4])
    threads = [fl.Net(path, [range(9)], SECTION) for path in paths]
    threads[1].add_velocity((0.0, 0.0, -2.0))
    scene = fl.Scene()
    for thread in threads:
        scene.add(thread)
    lines = [fl.contact.Line(thread, RADIUS) for thread in threads]
    contact = scene.add(fl.contact.Contact(*lines, fl.contact.Penalty(1e6)))
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=2.5e-4, progress=False)
    assert fl.post.contact_forces(result, contact).touching.max() > 0
    assert result.balance_error < 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-12
    heights = [result.frames[:, result.info.body(t.label).nodes, 0, 2] for t in threads]
    middles = [each[:, 4] for each in heights]
    assert (middles[1] - middles[0]).min() > RADIUS


def test_a_cable_touches_itself_and_keeps_energy_and_momenta():
    """Both sides of a hairpin clap together."""
    s = np.linspace(-1.0, 1.0, 41)
    bend = 0.06
    turn = np.clip(s / 0.3, -1.0, 1.0) * 0.5 * np.pi
    x = np.where(np.abs(s) < 0.3, bend * np.cos(turn), -(np.abs(s) - 0.3) * 0.5)
    y = np.where(np.abs(s) < 0.3, bend * np.sin(turn), bend * np.sign(s))
    path = np.column_stack([x, y, 0.002 * s])
    cable = fl.Net(path, [range(41)], SECTION, formulation=LAID, name="hairpin")
    scene = fl.Scene()
    scene.add(cable)
    for k, way in ((0, 1.0), (40, -1.0)):
        scene.add(fl.PointLoad(cable.point(k), force=(0, way, 0)))
    line = fl.contact.Line(cable, RADIUS)
    contact = scene.add(fl.contact.Contact(line, line, fl.contact.Penalty(1e6)))
    result = fl.EnergyMomentum().run(scene, duration=0.3, step=1e-3, progress=False)
    assert fl.post.contact_forces(result, contact).touching.max() > 0
    assert result.balance_error < 1e-10
    gap = result.frames[:, [0, 40], 0]
    assert np.linalg.norm(gap[:, 0] - gap[:, 1], axis=1).min() > RADIUS


def test_a_net_wraps_a_free_ball_along_its_threads():
    """Forces are integrated along the threads, between their nodes, too."""
    along, size = np.linspace(-0.5, 0.5, 9), 0.2
    x, y = np.meshgrid(along, along, indexing="ij")
    positions = np.stack([x, y, 0.0 * x + size + 0.011], axis=-1).reshape(-1, 3)
    numbers = np.arange(81).reshape(9, 9)
    net = fl.Net(positions, [*numbers, *numbers.T], fl.Section.circle(1e-3, SOFT))
    net.add_velocity((0.1, 0.0, -10.0))
    ball = fl.RigidBody(0.5, 8e-3 * np.eye(3), (0.03, 0.02, 0.0))
    scene = fl.Scene()
    for body in (net, ball):
        scene.add(body)
    line = fl.contact.Line(net, RADIUS)
    catch = fl.contact.Contact(Knob(ball.point("centre"), size), line, fl.contact.Penalty(2e4))
    scene.add(catch)
    scene.add(fl.contact.Contact(line, line, fl.contact.Penalty(1e5)))
    result = fl.EnergyMomentum().run(scene, duration=0.02, step=2e-4, progress=False)
    found = fl.post.contact_forces(result, catch)
    # at several points at once, and not deeper than the threads are thick
    assert found.touching.max() > 9
    assert found.penetration.max() < RADIUS
    assert result.balance_error < 1e-12
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-13

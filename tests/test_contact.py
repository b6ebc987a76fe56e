"""Contact by penalty: closed forms, invariants, who is near whom, and what is refused."""

import numpy as np
import pytest
from PIL import Image

import fem_lie as fl
from benchmarks import pressed_cap, pressed_cylinder
from fem_lie import extend
from tests.own_surface import Quartic

GRAVITY, RADIUS = 9.81, 0.1
SECTION = fl.Section.circle(0.02, fl.Material(2e9, 0.3, 1000.0))
FLOOR = fl.contact.Plane(fl.ground(), (0, 0, 2))


def ball(position, velocity=(0.0, 0.0, 0.0), mass=1.0) -> fl.RigidBody:
    body = fl.RigidBody(mass, 0.4 * mass * RADIUS**2 * np.eye(3), position)
    body.add_velocity(velocity)
    return body


def scene_with(*items, gravity=(0, 0, -GRAVITY)) -> fl.Scene:
    scene = fl.Scene(gravity=gravity)
    for item in items:
        scene.add(item)
    return scene


def run(scene, duration, step, radius=1.0, **options) -> fl.Result:
    scheme = fl.GeneralisedAlpha(radius=radius, tolerance=1e-9)
    return scheme.run(scene, duration=duration, step=step, progress=False, **options)


def dropped(law: fl.contact.Penalty) -> tuple[fl.Scene, fl.RigidBody, fl.contact.Contact]:
    """A ball, one metre above the floor."""
    body = ball((0, 0, 1 + RADIUS))
    contact = fl.contact.Contact(fl.contact.Sphere(body.point("centre"), RADIUS), FLOOR, law)
    return scene_with(body, contact), body, contact


def flight(times: np.ndarray, stiffness: float) -> np.ndarray:
    """Height of the ball over the floor: parabolas, and half a swing on the spring between."""
    fall, speed = np.sqrt(2 / GRAVITY), np.sqrt(2 * GRAVITY)
    rate = np.sqrt(stiffness)
    rest = GRAVITY / stiffness
    swing = (2 * np.pi - 2 * np.arctan2(speed / rate, rest)) / rate
    t = np.mod(times, 2 * fall + swing)
    s = np.clip(t - fall, 0.0, swing)
    pressed = -rest + rest * np.cos(rate * s) - speed / rate * np.sin(rate * s)
    after = t - fall - swing
    up = speed * after - 0.5 * GRAVITY * after**2
    return np.where(t < fall, 1 - 0.5 * GRAVITY * t**2, np.where(after < 0.0, pressed, up))


def test_a_ball_bounces_as_the_closed_form():
    stiffness = 1e3
    scene, body, contact = dropped(fl.contact.Penalty(stiffness))
    result = run(scene, 2.0, 5e-4)
    height = result.position(body.point("centre"))[:, 2] - RADIUS
    np.testing.assert_allclose(height, flight(result.times, stiffness), rtol=0, atol=2e-4)
    found = fl.post.contact_forces(result, contact)
    # ½ k δ² = m g (1 + δ)
    deepest = (GRAVITY + np.sqrt(GRAVITY**2 + 2 * stiffness * GRAVITY)) / stiffness
    assert found.penetration.max() == pytest.approx(deepest, rel=1e-4)
    np.testing.assert_allclose(found.total[:, 2], stiffness * found.penetration, rtol=1e-13)
    assert result.energy_error < 1e-4
    # the balance includes the work of the ground
    assert result.momentum_error < 1e-6


def test_damping_dissipates_energy_and_is_never_tensile():
    """A critically damped ball comes to rest under its weight; the balance includes the losses."""
    stiffness = 1e3
    scene, body, contact = dropped(fl.contact.Penalty(stiffness, damping=2 * np.sqrt(stiffness)))
    result = run(scene, 3.0, 5e-4, radius=0.8)
    assert result.position(body.point("centre"))[-1, 2] - RADIUS == pytest.approx(
        -GRAVITY / stiffness, rel=1e-6
    )
    forces = fl.post.contact_forces(result, contact).forces
    assert forces[:, 2].min() >= 0.0
    assert np.diff(result.balance[:, 1]).min() >= 0.0
    assert result.balance[-1, 1] == pytest.approx(GRAVITY * 1.0, rel=2e-2)
    assert result.energy_error < 1e-3


@pytest.mark.parametrize("hollow", [False, True], ids=["outside", "inside"])
def test_momenta_of_free_balls_stay(hollow):
    """Oblique impacts of bodies on each other, and of one in another."""
    if hollow:
        two = ball((0.1, 0, 0), mass=3.0)
        one = ball((0.3, 0.1, 0), (1.0, 0.3, -0.2))
        surface = fl.contact.Sphere(two.point((0.15, 0, 0)), 0.5, hollow=True)
    else:
        two = ball((0.5, 0.05, 0.02), mass=3.0)
        one = ball((0, 0, 0), (1.0, 0, 0))
        surface = fl.contact.Sphere(two.point((0.5, 0.1, 0.0)), 2 * RADIUS)
    touch = fl.contact.Contact(
        surface, fl.contact.Sphere(one.point("centre"), RADIUS), fl.contact.Penalty(200.0)
    )
    result = run(scene_with(one, two, touch, gravity=(0, 0, 0)), 2.0, 2e-3)
    found = fl.post.contact_forces(result, touch)
    assert found.touching.max() == 1
    assert found.penetration.max() > 0.01
    # the scheme keeps the momentum, and the angular momentum to its order
    for momentum, allowed in ((result.momentum, 1e-9), (result.angular_momentum, 1e-5)):
        np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=allowed)
    assert result.energy_error < 2e-3


def test_a_round_end_of_a_beam_lies_on_a_plane():
    """In statics: a cantilever whose tip is pressed on a floor, by two contact springs."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=8)
    bending = SECTION.stiffness[4, 4]
    gap, stiffness, force = 0.001, 300.0, 2.0
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -0.02 - gap))
    touch = fl.contact.Contact(
        fl.contact.Sphere(beam.point("end"), 0.02), floor, fl.contact.Penalty(stiffness)
    )
    scene = scene_with(
        beam,
        fl.Clamp(beam.point("start")),
        fl.PointLoad(beam.point("end"), (0, 0, -force)),
        touch,
        gravity=(0, 0, 0),
    )
    state = fl.statics(scene)
    down = -state.position(beam.point("end"))[-1, 2]
    own = 3 * bending
    assert down == pytest.approx((force + stiffness * gap) / (own + stiffness), rel=2e-3)
    found = fl.post.contact_forces(state, touch)
    assert found.total[-1, 2] == pytest.approx(stiffness * (down - gap), rel=1e-9)


def test_a_cylinder_of_shell_between_planes_is_an_elastica(monkeypatch):
    """Also where it lies flat on them."""
    monkeypatch.setattr(pressed_cylinder, "PRESSED", np.array([0.2, 0.4]))
    result, forces, deep = pressed_cylinder.press(12, load_steps=8)
    at = [int(np.argmin(np.abs(result.factors - pressed))) for pressed in (0.2, 0.4)]
    wanted = [pressed_cylinder.elastica(pressed) for pressed in (0.2, 0.4)]
    np.testing.assert_allclose(forces[at], wanted, rtol=0.02)
    assert deep < 0.01 * pressed_cylinder.THICKNESS


def test_a_ball_presses_a_cap_of_shell_until_it_has_snapped():
    """Its force grows, falls and grows again."""
    depths, forces, deep, _ = pressed_cap.press(5, load_steps=20)
    rise, fall, beyond = (float(np.interp(at, depths, forces)) for at in (0.18, 0.27, 0.3))
    assert fall < 0.5 * rise < beyond
    assert deep < 0.01 * pressed_cap.THICKNESS


# --- who is near whom ---


def pile() -> tuple[fl.Scene, list[fl.RigidBody]]:
    """Balls that fly through each other in a box without gravity."""
    rng = np.random.default_rng(5)
    positions = 0.21 * np.stack(np.meshgrid(*3 * [np.arange(3)], indexing="ij"), -1).reshape(-1, 3)
    balls = [
        ball(position, velocity)
        for position, velocity in zip(positions, rng.normal(size=(27, 3)), strict=True)
    ]
    surface = fl.contact.Vertices([each.point("centre") for each in balls], RADIUS)
    law = fl.contact.Penalty(2e3)
    scene = scene_with(*balls, fl.contact.Contact(surface, surface, law), gravity=(0, 0, 0))
    box = fl.contact.Box(fl.ground(), (1.3, 1.3, 1.3), inside=True)
    scene.add(fl.contact.Contact(surface, box, law))
    return scene, balls


def test_a_list_with_a_margin_has_all_contacts():
    """Forces during a run are those of a list that is recomputed."""
    scene, _ = pile()
    nodes = fl.extend.Equations(scene, dynamics=True).unknowns.bodies
    result = run(scene, 0.2, 2e-3)
    term = scene.contacts[0].term(nodes.__getitem__)
    versions, touched = set(), 0
    for frames in result.frames:
        out, fresh = np.zeros((2, len(frames), 6))
        term.add_forces(frames, out)
        versions.add(term.version)
        scene.contacts[0].term(nodes.__getitem__).add_forces(frames, fresh)
        np.testing.assert_array_equal(out, fresh)
        touched += bool(out.any())
    assert len(versions) > 3
    assert touched > 20


def test_balls_in_a_box_keep_their_energy():
    scene, _ = pile()
    result = run(scene, 0.4, 1e-3)
    assert result.elastic.max() > 0.02 * result.kinetic[0]
    assert result.energy_error < 5e-3
    assert result.momentum_error < 1e-5


def test_a_restart_agrees_to_the_last_bit(tmp_path):
    """From a checkpoint at which other balls were near each other than in the beginning."""
    scene, _ = pile()
    options = {"duration": 0.2, "step": 2e-3, "progress": False}
    scheme, file = fl.GeneralisedAlpha(radius=1.0), tmp_path / "run.h5"
    whole = scheme.run(scene, **options, file=tmp_path / "whole.h5", checkpoint_every=60)
    scheme.run(scene, **options, file=file, checkpoint_every=60)
    resumed = scheme.resume(pile()[0], file, progress=False)
    for name in ("frames", "velocities", "elastic"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


# --- bad input ---


def one_body(item):
    body = ball((0, 0, 1))
    return scene_with(body, item(body))


def two_bodies(item):
    one, two = ball((0, 0, 1)), ball((0, 0, 2))
    return scene_with(one, two, item(one, two))


LAW = fl.contact.Penalty(1e3)
REFUSED = {
    "no stiffness": (lambda: fl.contact.Penalty(0.0), "stiffness must be a positive"),
    "stiffness that is none": (
        lambda: fl.contact.Penalty(float("nan")),
        "stiffness must be a finite",
    ),
    "negative damping": (
        lambda: fl.contact.Penalty(1.0, damping=-1.0),
        "damping must not be negative",
    ),
    "flat ball": (lambda: fl.contact.Sphere(fl.ground(), 0.0), "radius must be a positive"),
    "inside out": (lambda: fl.contact.Vertices([fl.ground()], -1.0), "radius must not be negative"),
    "no points": (lambda: fl.contact.Vertices([]), "expected at least one point"),
    "flat box": (lambda: fl.contact.Box(fl.ground(), (1, 0, 1)), "3 positive finite lengths"),
    "no normal": (lambda: fl.contact.Plane(fl.ground(), (0, 0, 0)), "must not be zero"),
    "overlap": (
        lambda: one_body(
            lambda body: fl.contact.Contact(
                fl.contact.Sphere(body.point("centre"), 0.2),
                fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, 0.9)),
                LAW,
            )
        ),
        r"overlap by 0\.1 at \(0, 0, 0\.8\); start with a gap",
    ),
    "overlap of balls": (
        lambda: two_bodies(
            lambda one, two: fl.contact.Contact(
                fl.contact.Sphere(one.point("centre"), 0.6),
                fl.contact.Sphere(two.point("centre"), 0.5),
                LAW,
            )
        ),
        r"overlap by 0\.1 at",
    ),
    "same body": (
        lambda: one_body(
            lambda body: fl.contact.Contact(
                fl.contact.Sphere(body.point((0, 0, 3)), 0.1),
                fl.contact.Plane(body.point("centre"), (0, 0, 1)),
                LAW,
            )
        ),
        "expected surfaces on different frames",
    ),
    "two planes": (
        lambda: one_body(
            lambda body: fl.contact.Contact(
                fl.contact.Plane(body.point("centre"), (0, 0, -1)), FLOOR, LAW
            )
        ),
        "planes touch points",
    ),
    "two points": (
        lambda: two_bodies(
            lambda one, two: fl.contact.Contact(
                fl.contact.Vertices([one.point("centre")]),
                fl.contact.Vertices([two.point("centre")]),
                LAW,
            )
        ),
        "points never touch points",
    ),
    "corners on a box": (
        lambda: two_bodies(
            lambda one, two: fl.contact.Contact(
                fl.contact.Box(one.point("centre"), (1, 1, 1)),
                fl.contact.Vertices([two.point("centre")]),
                LAW,
            )
        ),
        "points do not touch polyhedra; give balls",
    ),
    "hollows": (
        lambda: two_bodies(
            lambda one, two: fl.contact.Contact(
                fl.contact.Sphere(one.point("centre"), 3.0),
                fl.contact.Sphere(two.point("centre"), 2.0, hollow=True),
                LAW,
            )
        ),
        "must be smaller",
    ),
    "body that is not there": (
        lambda: scene_with(
            fl.contact.Contact(fl.contact.Sphere(ball((0, 0, 1)).point("centre"), 0.1), FLOOR, LAW)
        ),
        "is not in the scene",
    ),
    "conserving": (
        lambda: fl.EnergyMomentum().run(
            dropped(fl.contact.Penalty(1e3, damping=1.0))[0], duration=0.1, step=1e-2
        ),
        "support contacts by penalty with damping: use GeneralisedAlpha",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        make()


WRONG = {
    "law": (lambda: fl.contact.Contact(FLOOR, FLOOR, 1e3), "Contact: law must be a law"),
    "surface": (
        lambda: fl.contact.Contact(FLOOR, fl.ground(), LAW),
        "Contact: b must be a surface",
    ),
    "point": (lambda: fl.contact.Sphere((0, 0, 0), 1.0), "Sphere: point must be a point"),
    "points": (lambda: fl.contact.Vertices(fl.ground()), "Vertices: of must be points"),
    "number": (lambda: fl.contact.Penalty("1e3"), "stiffness must be a number"),
}


@pytest.mark.parametrize("name", WRONG)
def test_is_no_such_thing(name):
    make, message = WRONG[name]
    with pytest.raises(TypeError, match=message):
        make()


def test_pictures_show_forces_as_arrows(tmp_path):
    """Orange arrows at the contact points of a state; without contact there are none."""
    scene, body, contact = dropped(fl.contact.Penalty(1e3))
    scheme = fl.GeneralisedAlpha(radius=1.0)
    result = scheme.run(scene, duration=0.5, step=1e-2, progress=False)
    found = fl.post.contact_forces(result, contact)
    last = int(found.states[-1])
    arrows = found.arrows(last)
    np.testing.assert_array_equal(arrows.at, found.positions[found.states == last])
    np.testing.assert_array_equal(arrows.along.sum(axis=0), found.total[last])
    assert not len(found.arrows(0).at)
    with pytest.raises(ValueError, match="got state 99"):
        found.arrows(99)

    def orange(name: str, forces) -> int:
        file = tmp_path / name
        result.picture(file, [result.times[last]], trace=[body.point("centre")], arrows=forces)
        red, _, blue = np.moveaxis(np.array(Image.open(file).convert("RGB"), dtype=int), -1, 0)
        return int((red - blue > 60).sum())

    nothing = orange("none.png", found.arrows(0))
    assert orange("arrows.png", arrows) > nothing + 200


# --- a stiffness that is chosen ---


def test_a_stiffness_is_chosen_by_what_is_behind(caplog):
    """A fifth of EA/ℓ, or E ℓ of a shell, per length and area where forces are."""
    E, r, t, cells = 1e9, 0.01, 0.02, 4
    steel, floor = fl.Material(E, 0.0, 1e3), fl.contact.Plane(fl.ground(), (0, 0, 1))
    beam = fl.Beam.straight((0, 0, 1), (2, 0, 1), fl.Section.circle(r, steel), cells=cells)
    mesh = fl.mesh.parametric_surface(lambda a, b: np.array([2 * a, 2 * b, 1]), (cells, cells))
    sheet = fl.Shell(mesh, fl.ShellSection.layer(t, steel))
    patch = fl.mesh.smooth_patch(lambda a, b: (2 * a, 2 * b, 1), (cells, cells))
    thin = fl.ThinShell(patch, fl.ShellSection.layer(t, steel))
    ball = fl.RigidBody(1.0, np.eye(3), (0, 0, 3))
    EA, length = E * np.pi * r**2, 2 / cells
    for surface, other, wanted in (
        (fl.contact.Vertices([beam.point("start")], r), floor, 0.2 * EA / length),
        (fl.contact.Line(beam, r), floor, 0.2 * EA / length**2),
        (fl.contact.ShellSurface(sheet), floor, E / length),
        (fl.contact.Facets(thin), floor, E / length),
        (fl.contact.Sphere(ball.point("centre"), 0.1), fl.contact.ShellSurface(sheet), E * length),
    ):
        with caplog.at_level("INFO"):
            law = fl.contact.Contact(surface, other, fl.contact.Penalty(friction=0.1)).law
        assert law.stiffness == pytest.approx(wanted, rel=1e-6)
        assert law.coulomb.holding == law.stiffness
        assert f"stiffness {law.stiffness:g} was chosen" in caplog.messages[-1]
    with pytest.raises(ValueError, match="Penalty needs a stiffness, for neither surface belongs"):
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.1), floor, fl.contact.Penalty()
        )


@pytest.mark.parametrize("cells", [4, 8])
def test_a_chosen_stiffness_keeps_the_overlap_small_where_a_shell_is_soft(cells):
    """A ball presses a clamped plate of rubber until that is strained by some per cent."""
    E, t, radius = 1e6, 0.02, 0.1
    mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a - 0.5, b - 0.5, 0]), (cells, cells))
    sheet = fl.Shell(mesh, fl.ShellSection.layer(t, fl.Material(E, 0.3, 1e3)), drilling=False)
    for edge in ("a=0", "a=1", "b=0", "b=1"):
        sheet.clamp(edge)
    body = fl.RigidBody(1.0, np.eye(3), (0.01, 0.02, radius + t / 2))
    scene = scene_with(sheet, body, gravity=(0, 0, 0))
    surface = fl.contact.ShellSurface(sheet, smooth=False)
    sphere = fl.contact.Sphere(body.point("centre"), radius)
    touch = scene.add(fl.contact.Contact(surface, sphere, fl.contact.Penalty()))
    force = 0.4 * 0.05 * E * t**2
    scene.add(fl.PointLoad(body.point("centre"), (0, 0, -force)))
    result = fl.EnergyMomentum().run(scene, duration=0.4, step=2e-3, progress=False)
    found = fl.post.contact_forces(result, touch)
    assert np.abs(found.total[:, 2]).max() > force
    assert found.penetration.max() < 0.1 * (t / 2)


def test_a_free_surface_with_a_gap_function_conserves_all():
    """A ball in a hollow of no symmetry, both free: momenta of both bodies, energy."""
    scene = fl.Scene()
    hollow = scene.add(fl.RigidBody(2.0, np.diag([0.3, 0.2, 0.4]), (0.1, 0.2, 0.3)))
    ball = scene.add(fl.RigidBody(0.5, np.diag([0.01, 0.02, 0.015]), (0.2, 0.25, 0.3)))
    hollow.add_velocity(omega=(0.5, -0.3, 0.8), about=hollow.point("centre"))
    ball.add_velocity((1.0, -2.0, 0.7))
    law = fl.contact.Penalty(2e3)
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.05), Quartic(hollow.point("centre")), law
        )
    )
    result = fl.EnergyMomentum().run(scene, duration=1.0, step=2e-3, progress=False)
    assert fl.post.contact_forces(result, scene.contacts[0]).touching.sum() > 10
    assert result.balance_error < 1e-12
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-13


def test_pairs_that_are_not_known_are_refused():
    class Own(fl.contact.ContactSurface):
        points = ()

        def __init__(self, point):
            self.points = (point,)

    body = fl.RigidBody(1.0, np.eye(3), (0, 0, 1))
    contact = fl.contact.Contact(
        Own(body.point("centre")), fl.contact.Sphere(fl.ground(), 0.1), fl.contact.Penalty(1e3)
    )
    with pytest.raises(ValueError, match="no contact pair of Own and Sphere; register_contact"):
        contact.check()
    with pytest.raises(ValueError, match="PlaneSurface and PointSurface is registered already"):
        extend.register_contact_pair(extend.PlaneSurface, extend.PointSurface, "why not")
    extend.register_contact_pair(Own, extend.PointSurface, "own surfaces never touch points")
    with pytest.raises(ValueError, match="own surfaces never touch points"):
        fl.contact.Contact(
            fl.contact.Sphere(fl.ground(), 0.1), Own(body.point("centre")), fl.contact.Penalty(1e3)
        ).check()

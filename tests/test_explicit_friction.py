"""Friction in explicit steps: by penalty, and by impulses in Coulomb's cones; closed forms."""

import numpy as np
import pytest

import fem_lie as fl
from tests.test_friction import GRAVITY, SIZE, ball, block, on_slope

EXPLICIT = fl.Explicit()
STIFF, FRICTION = 1e5, 0.5
PENALTY, CONES = fl.contact.Penalty(STIFF, friction=FRICTION), fl.contact.Impact(friction=FRICTION)
LAWS = {"penalty": (PENALTY, 2e-4, 3e-3, 1e-6), "cones": (CONES, 2e-3, 1e-6, 1e-12)}
laws = pytest.mark.parametrize(("law", "step", "near", "balance"), LAWS.values(), ids=LAWS)


def run(scene, duration, step, **options):
    return EXPLICIT.run(scene, duration=duration, step=step, progress=False, **options)


@laws
def test_a_block_slides_to_rest_on_a_slope_and_sticks(law, step, near, balance):
    """After ``v²/2a`` with ``a = g (μ cos α − sin α)``; friction dissipates ``μ N`` times that."""
    degrees, angle = 20.0, np.radians(20.0)
    overlap = GRAVITY * np.cos(angle) / (4 * STIFF) if law is PENALTY else 0.0
    scene, centre = on_slope(degrees, block, law, overlap)
    scene.bodies[0].add_velocity((1.0, 0.0, 0.0))
    result = run(scene, 1.0, step)
    along = result.position(centre)[:, 0]
    way = 0.5 / (GRAVITY * (FRICTION * np.cos(angle) - np.sin(angle)))
    assert along[-1] == pytest.approx(way, rel=near)
    late = result.times > 0.9
    # springs without damping keep what they have stored
    assert np.ptp(along[late]) < (1e-2 if law is PENALTY else 1e-14)
    assert result.energy_error < balance
    assert result.momentum_error < 1e-11
    lost = FRICTION * GRAVITY * np.cos(angle) * way
    assert result.balance[-1, 1] == pytest.approx(lost, rel=max(near, 1e-5))


@laws
def test_a_ball_slips_until_it_rolls(law, step, near, balance):
    """With 5/7 of its speed; a seventh of ``m v²`` is lost."""
    overlap = GRAVITY / STIFF if law is PENALTY else 0.0
    scene, centre = on_slope(0.0, ball, law, overlap)
    scene.bodies[0].add_velocity((1.0, 0.0, 0.0))
    result = run(scene, 0.4, step)
    # springs without damping go on to vibrate
    rolls = result.times >= 0.2
    (along,) = np.polyfit(result.times[rolls], result.position(centre)[rolls, 0], 1)[:1]
    # and of a rolling step the chord is seen
    assert along == pytest.approx(5.0 / 7.0, rel=max(near, 2e-5))
    assert result.balance[-1, 1] == pytest.approx(1.0 / 7.0, rel=near)
    assert result.energy_error < balance


def test_a_restart_agrees_to_the_last_bit(tmp_path):
    """Of springs of friction that are stretched, and of contacts that are closed."""
    options = {"duration": 0.05, "step": 5e-5, "progress": False, "checkpoint_every": 317}
    for name, law in (("penalty", PENALTY), ("cones", CONES)):

        def made(law=law):
            scene, _ = on_slope(20.0, ball, law, 1e-6)
            scene.bodies[0].add_velocity((1.0, 0.2, 0.0))
            return scene

        whole = EXPLICIT.run(made(), **options, file=tmp_path / f"{name}-whole.h5")
        EXPLICIT.run(made(), **options, file=tmp_path / f"{name}.h5")
        resumed = EXPLICIT.resume(made(), tmp_path / f"{name}.h5", progress=False)
        for what in ("frames", "velocities", "balance"):
            np.testing.assert_array_equal(getattr(resumed, what), getattr(whole, what))
        if law is CONES:
            np.testing.assert_array_equal(resumed.contacts.contacts, whole.contacts.contacts)
            assert whole.contacts.contacts.sum() > 500


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_two_balls_collide_in_flight(restitution):
    """Newton's law along the normal, Coulomb's across it, and momenta to round-off."""
    law = fl.contact.Impact(restitution=restitution, friction=0.2)
    inertia = 0.4 * SIZE**2 * np.eye(3)
    scene = fl.Scene()
    one, other = (
        scene.add(fl.RigidBody(m, m * inertia, position))
        for m, position in ((1.0, (0, 0, 0)), (2.0, (0.5, 0.05, 0)))
    )
    one.add_velocity((3.0, 0.0, 0.0))
    other.add_velocity((0.0, 0.0, 1.0))
    points = one.point("centre"), other.point("centre")
    scene.add(fl.contact.Contact(*(fl.contact.Sphere(p, SIZE) for p in points), law))
    result = run(scene, 0.2, 1e-4)
    assert result.momentum_error < 1e-13
    assert result.angular_momentum_error < 1e-13
    assert result.energy_error < 1e-13
    (hit,) = np.flatnonzero(result.contacts.contacts)
    before, after = result.frames[hit, :, 0], result.velocities
    normal = before[1] - before[0]
    normal /= np.linalg.norm(normal)

    def closing(k):
        R = result.frames[k, :, 1:]
        v = np.einsum("nij,ni->nj", R, after[k, :, :3])
        return (v[0] - v[1]) @ normal

    assert closing(-1) == pytest.approx(-restitution * closing(0), abs=4e-3)
    lost = result.kinetic[0] - result.kinetic[-1]
    assert lost == pytest.approx(result.balance[-1, 1], rel=1e-12)
    assert lost > 0.0


def test_a_swinging_rod_hits_a_wall():
    """With a hinge that stays closed: the ball at its end stops there without restitution."""
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    rod = scene.add(fl.RigidBody(1.0, np.eye(3) / 12, (0.5, 0, 0)))
    scene.add(fl.joints.Revolute(fl.ground(), rod.point((0, 0, 0)), axis=(0, 1, 0), name="hinge"))
    tip = rod.point((1.0, 0, 0))
    wall = fl.contact.Plane(fl.ground((0.0, 0, 0)), (1, 0, 0))
    law = fl.contact.Impact(friction=0.3)
    scene.add(fl.contact.Contact(fl.contact.Sphere(tip, 0.05), wall, law))
    result = run(scene, 0.6, 1e-3)
    assert result.joint_violation("hinge").max() < 1e-12
    assert result.energy_error < 1e-5
    assert result.kinetic[-1] < 1e-12
    assert result.position(tip)[-1, 0] == pytest.approx(0.05, abs=1e-6)


def test_a_beam_falls_on_the_floor():
    """Its elements vibrate; what it has lost is in the balance."""
    rubber = fl.Material(1e7, 0.3, 1000.0)
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    section = fl.Section.rectangle(0.05, 0.05, rubber)
    beam = scene.add(fl.Beam.straight((0, 0, 0.12), (1, 0, 0.16), section, cells=6, name="beam"))
    beam.add_velocity((1.0, 0.0, 0.0))
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    law = fl.contact.Impact(friction=0.3)
    for node in range(7):
        contact = fl.contact.Sphere(beam.point(node), 0.025)
        scene.add(fl.contact.Contact(contact, floor, law))
    step = 0.1 * EXPLICIT.stable_step(scene)
    count = int(np.ceil(0.4 / step))
    result = run(scene, 0.4, 0.4 / count)
    assert result.energy_error < 1e-3
    assert result.frames[:, :, 0, 2].min() > 0.025 - 1e-8
    again = fl.GeneralisedAlpha().run(scene, duration=0.4, step=5e-4, progress=False)
    assert result.balance[-1, 1] == pytest.approx(again.balance[-1, 1], rel=3e-3)
    assert (np.diff(result.balance[:, 1]) > -1e-5 * result.balance[-1, 1]).all()


def test_a_shell_falls_on_the_floor():
    """Its forces are not in the compiled sum; it slides to rest."""
    rubber = fl.Material(1e6, 0.3, 1000.0)
    mesh = fl.mesh.parametric_surface(lambda a, b: (0.4 * a, 0.4 * b, 0.025), (2, 2))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    plate = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.05, rubber), name="plate"))
    plate.add_velocity((0.3, 0.0, 0.0))
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    for node in range(9):
        ball = fl.contact.Sphere(plate.point(node), 0.025)
        scene.add(fl.contact.Contact(ball, floor, fl.contact.Impact(friction=FRICTION)))
    count = int(np.ceil(0.1 / (0.5 * EXPLICIT.stable_step(scene))))
    result = run(scene, 0.1, 0.1 / count)
    moved = result.frames[-1, :, 0] - result.frames[0, :, 0]
    way = 0.3**2 / (2 * FRICTION * GRAVITY)
    np.testing.assert_allclose(moved[:, 0].mean(), way, rtol=2e-2)
    assert np.abs(moved[:, 2]).max() < 1e-8
    assert result.energy_error < 1e-2
    assert result.balance[-1, 1] == pytest.approx(result.kinetic[0], rel=2e-2)


@pytest.mark.parametrize("make", ["beam", "cable"])
def test_a_rope_slides_over_a_drum(make):
    """Along the drum ``T - ρv² + ρaR/μ`` grows by ``exp(μφ)``, in the tails ``T`` by ``ρa``."""
    friction, weak, strong, cells, tails, density = 0.3, 1.0, 2.8, 20, 3, 1.0
    radius = 0.1 + 0.97 * 2e-4
    tail = tails * np.pi * radius / cells

    def position(s):
        along = s * (np.pi * radius + 2.0 * tail) - tail
        angle = min(max(along / radius, 0.0), np.pi)
        beyond, c, n = along - angle * radius, np.cos(angle), np.sin(angle)
        return radius * c - beyond * n, radius * n + beyond * c, 0.0

    stiffness = [1e4, 1e4 / 3, 1e4 / 3, 1e-5, 1e-5, 1e-5]
    section = fl.Section.from_stiffness(stiffness, mass=density, rotary=(1e-4, 1e-4))
    mesh, scene = fl.mesh.curve(position, cells + 2 * tails), fl.Scene()
    if make == "cable":
        rope = fl.Cable(mesh, section)
    else:
        rope = fl.Beam(
            mesh, section, formulation=fl.elements.GeodesicBeam(bending_flexibility=False)
        )
    scene.add(rope)
    directions = rope.frames[[0, -1], 1]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for name, force in (("start", -weak * directions[0]), ("end", strong * directions[1])):
        load = fl.PointLoad(rope.point(name), force=force, history=lambda t: min(t / 0.05, 1.0))
        scene.add(load)
    drum = fl.contact.Cylinder(fl.ground(), (0, 0, 0.4), 0.1)
    law = fl.contact.Penalty(1e6, friction=friction)
    scene.add(fl.contact.Contact(fl.contact.Line(rope, 2e-4), drum, law))
    count = int(np.ceil(0.15 / (0.9 * EXPLICIT.stable_step(scene))))
    result = run(scene, 0.15, 0.15 / count)
    # waves of the first pull have passed
    slides = result.times > 0.09
    way = result.position(rope.point("end")) @ directions[1]
    square, slope, _ = np.polyfit(result.times[slides] - 0.12, way[slides], 2)
    a, v = 2.0 * square, slope
    assert v > 0.02
    along = density * (a * radius / friction - v**2)
    ratio = (strong - density * tail * a + along) / (weak + density * tail * a + along)
    assert ratio == pytest.approx(np.exp(friction * np.pi), rel=5e-3)
    assert result.energy_error < 5e-4

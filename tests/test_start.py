"""Motions and statics that start from a result of statics."""

import numpy as np
import pytest

import fem_lie as fl
from tests.interruption import interrupted

STEEL = fl.Material(E=2.1e8, nu=0.3, density=7800.0)
SECTION = fl.Section.circle(0.02, STEEL)
FILM = fl.ShellSection.layer(0.01, STEEL)
SURFACE = fl.mesh.parametric_surface(lambda a, b: np.array([a, 0.3 * b, 0.0]), (3, 2))
DOWN = (0.0, 0.0, -3.0)


def scene_of(*items):
    scene = fl.Scene(gravity=DOWN)
    for item in items:
        scene.add(item)
    return scene


def beam(section=SECTION, cells=5):
    body = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells, name="beam")
    return scene_of(body, fl.Clamp(body.point("start")))


def shell(formulation=None):
    body = fl.Shell(SURFACE, FILM, formulation=formulation)
    body.clamp("a=0")
    return scene_of(body)


def mixed():
    return shell(fl.elements.HuWashizu())


def rubber():
    law = fl.sections.NeoHooke(E=1e6, nu=0.49, density=1e3)
    body = fl.Solid.brick((1, 0.2, 0.2), law, cells=(3, 1, 1))
    body.clamp("a=0")
    return scene_of(body)


def cable():
    body = fl.Cable.straight((0, 0, 0), (1, 0, 0.2), SECTION, cells=5)
    body.pin(body.point("start"), body.point("end"))
    return scene_of(body)


def ancf():
    body = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=4)
    body.clamp(body.point("start"))
    return scene_of(body)


def film():
    body = fl.Membrane(SURFACE, FILM, prestress=(1e4, 1e4, 0.0))
    for edge in "a=0", "a=1", "b=0", "b=1":
        body.clamp(edge)
    return scene_of(body)


def reduced():
    part = fl.Scene()
    whole = part.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=8))
    ends = [whole.point("start"), whole.point("end")]
    body = fl.reduction.reduced_order_body(part, ends, 3)
    return scene_of(body, fl.Clamp(body.point("start")))


def tree():
    """Two rigid bodies on hinges with springs."""
    bodies = [fl.RigidBody(1.0, (0.1, 0.1, 0.1), (x, 0, 0), name=f"body {x}") for x in (1, 2)]
    scene, before = scene_of(*bodies), fl.ground()
    for x, body in enumerate(bodies):
        here = body.point("centre")
        hinge = fl.joints.Revolute(before, here, at=(x, 0, 0), axis=(0, 1, 0), name=f"hinge {x}")
        scene.add(hinge)
        scene.add(fl.joints.Spring(hinge.angle, 20.0))
        before = here
    return scene


def run(scheme, scene, start, step=1e-3, steps=10, **plan):
    return scheme.run(scene, duration=steps * step, step=step, start=start, **plan)


def away(found, expected):
    """Largest difference, relative to the largest value."""
    size = np.abs(expected).max(initial=0.0)
    return np.abs(found - expected).max(initial=0.0) / (size or 1.0)


BODIES = [beam, shell, mixed, rubber, cable, ancf, film, reduced, tree]
SCHEMES = {
    "alpha": lambda scene: fl.GeneralisedAlpha(),
    "conserving": lambda scene: fl.EnergyMomentum(),
    "decaying": lambda scene: fl.EnergyDecaying(),
    "variational": lambda scene: fl.schemes.Variational(),
    "composed": lambda scene: fl.schemes.Composed(),
    "multirate": lambda scene: fl.schemes.MultiRate({scene.bodies[0]: 2}),
    "explicit": lambda scene: fl.Explicit(),
    "munthe-kaas": lambda scene: fl.schemes.MuntheKaas(),
}
RUNS = [(body, name) for body in BODIES for name in ("alpha", "conserving")]
RUNS += [(beam, name) for name in SCHEMES if name not in ("alpha", "conserving", "munthe-kaas")]
RUNS += [(tree, name) for name in SCHEMES if name not in ("alpha", "conserving", "multirate")]
RUNS += [(rubber, "explicit"), (mixed, "explicit"), (mixed, "variational")]


@pytest.mark.parametrize(("build", "name"), RUNS)
def test_motion_from_an_equilibrium_stays_there(build, name):
    still, scene = fl.statics(build()), build()
    moved = np.abs(still.frames[-1] - still.info.undeformed).max()
    result = run(SCHEMES[name](scene), scene, still, 1e-5 if name == "explicit" else 1e-3)
    assert np.abs(result.frames - still.frames[-1]).max() < 1e-9 < moved
    assert away(result.joint_forces[0], still.joint_forces[-1]) < 1e-9
    assert away(result.reactions[0], still.reactions[-1]) < 1e-9


def pulled(*loads, **options):
    """Cantilever without gravity, whose end a force bends."""
    scene = beam(**options)
    scene.gravity = (0, 0, 0)
    for force in loads:
        scene.add(fl.PointLoad(scene.bodies[0].point("end"), force=(0, 0, force)))
    return scene


def test_released_load_swings_as_the_modes_of_a_cantilever():
    """Deflection F L^3/(E I) sum 4/lambda^4 cos(omega t), the sum 1/3 at the start."""
    force, radius = 1e-5, 5e-3
    EI, mass = STEEL.E * np.pi * radius**4 / 4, STEEL.density * np.pi * radius**2
    roots = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349])
    slender = {"section": fl.Section.circle(radius, STEEL), "cells": 10}
    still = fl.statics(pulled(force, **slender))
    result = run(fl.EnergyMomentum(), pulled(**slender), still, 0.01, 440)
    omega = roots**2 * np.sqrt(EI / mass)
    exact = force / EI * np.cos(np.outer(result.times, omega)) @ (4 / roots**4)
    tip = result.displacement("beam.end")[:, 2]
    assert np.abs(tip - exact).max() < 5e-3 * force / (3 * EI)
    # all energy is the work of the force that bent it
    energy = result.kinetic + result.elastic
    np.testing.assert_allclose(energy, force * tip[0] / 2, rtol=1e-6)


def test_it_is_the_run_of_bodies_placed_by_hand():
    still, placed = fl.statics(beam()), pulled()
    placed.bodies[0].model.start_frames = still.frames[-1].copy()
    by_hand = fl.GeneralisedAlpha().run(placed, duration=0.1, step=1e-2)
    result = run(fl.GeneralisedAlpha(), pulled(), still, 1e-2)
    assert (result.frames == by_hand.frames).all()
    assert np.abs(result.velocities[-1]).max() > 0.1
    assert (beam().bodies[0].frames == placed.bodies[0].frames).all()


@pytest.mark.parametrize("name", ["alpha", "conserving", "variational"])
def test_resumed_run_from_an_equilibrium_is_the_same_to_the_last_bit(name, tmp_path):
    still, file, scheme = fl.statics(beam()), tmp_path / "motion.h5", SCHEMES[name](None)
    plan = {"file": file, "checkpoint_every": 3}
    whole = run(scheme, pulled(), still, 1e-2, **plan)
    with interrupted():
        run(scheme, pulled(), still, 1e-2, **plan)
    result = scheme.resume(pulled(), file)
    for what in "frames", "velocities", "joint_forces", "reactions", "elastic":
        assert (getattr(result, what) == getattr(whole, what)).all(), what
    with pytest.raises(ValueError, match=r"it belongs to another scene.* stiffness"):
        scheme.resume(pulled(section=fl.Section.circle(0.03, STEEL)), file)
    with pytest.raises(ValueError, match="expected a start of 9 nodes, got one of 6"):
        scheme.resume(pulled(cells=8), file)


def turned(function=None):
    """Rigid bodies on driven hinges."""
    scene = tree()
    scene.connections.clear()
    for hinge in scene.joints:
        scene.add(fl.joints.Drive(hinge.angle, function))
    return scene


def test_joints_keep_their_turns_and_drives_hold_their_coordinates(tmp_path):
    still = fl.statics(turned(lambda t: 9.0 * np.pi * t))
    file, scheme = tmp_path / "motion.h5", fl.GeneralisedAlpha()
    with interrupted():
        run(scheme, turned(), still, 1e-2, file=file, checkpoint_every=3)
    result = scheme.resume(turned(), file)
    for hinge in "hinge 0", "hinge 1":
        np.testing.assert_allclose(result.coordinate(hinge), 9.0 * np.pi, rtol=1e-9)
    wrong = "start: expected a state that satisfies all joints, but .* is violated by .* rad"
    with pytest.raises(ValueError, match=wrong):
        run(scheme, turned(lambda t: t**2), still)


def test_joints_act_where_points_are_in_the_state_in_which_their_nodes_are_linked():
    """A joint on a node linked to a bent beam was sought where the unbent beam had it."""

    def scene(*items):
        found = beam()
        post = fl.Beam.straight((1, 0, -0.5), (1, 0.5, -0.5), SECTION, cells=2, name="post")
        tip, foot = found.bodies[0].point("end"), found.add(post).point("start")
        for item in items:
            found.add(item(tip, foot))
        return found

    pulled = scene(
        lambda tip, foot: fl.PointLoad(tip, force=(0, 0, -0.3)),
        lambda tip, foot: fl.Clamp(foot),
    )
    bent = fl.statics(pulled)
    assert np.abs(bent.position(pulled.bodies[0].point("end"))[-1, 2]) > 0.1
    linked = scene(
        lambda tip, foot: fl.joints.RigidLink(tip, foot),
        lambda tip, foot: fl.joints.Spherical(fl.ground(), foot),
    )
    result = run(fl.GeneralisedAlpha(), linked, bent)
    foot = result.info.body("post").nodes[0]
    np.testing.assert_allclose(result.frames[:, foot, 0], [(1, 0, -0.5)] * 11, atol=1e-12)


def test_steadily_rotating_beam_is_at_rest_in_the_rotating_frame():
    spin = np.array([0.0, 0.0, 4.0])
    still, scene = fl.statics(beam(), spin=spin), beam()
    root = scene.bodies[0].point("start")
    scene.clamps.clear()

    def hub(time):
        return fl.lie.frame(np.zeros(3), fl.lie.so3_exp(time * spin))

    scene.add(fl.PrescribedMotion(root, hub))
    result = run(fl.GeneralisedAlpha(), scene, still, 1e-2, 20)
    seen = np.einsum(
        "tji,tnj->tni", fl.lie.so3_exp(np.outer(result.times, spin)), result.frames[:, :, 0]
    )
    assert np.abs(seen - still.frames[-1, :, 0]).max() < 1e-5
    assert np.abs(seen[0, -1] - (1, 0, 0)).max() > 0.05


def named(name):
    scene = beam()
    scene.bodies[0].name = name
    return scene


def other_element():
    body = fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), SECTION, cells=5, name="beam", formulation=fl.elements.DirectorBeam()
    )
    return scene_of(body)


def with_friction():
    scene = beam()
    ball = fl.contact.Sphere(scene.bodies[0].point("end"), 0.01)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -2.0))
    scene.add(fl.contact.Contact(ball, floor, fl.contact.Penalty(1e4, friction=0.3)))
    return scene


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: named("arm"), r"result of the bodies \['arm'\], got one of \['beam'\]"),
        (lambda: beam(cells=8), "its mesh of 9 nodes, got 6 nodes"),
        (other_element, "with DirectorBeam, got GeodesicBeam"),
        (lambda: scene_of(fl.Rod.straight((0, 0, 0), (1, 0, 0), SECTION, cells=5, name="beam")),
         "a result of a Rod, got one of a Beam"),
        (lambda: scene_of(fl.Beam.straight((0, 0, 0), (1.1, 0, 0), SECTION, cells=5, name="beam")),
         "got another one: node 5 was at"),
        (with_friction, "contacts without friction"),
    ],
)  # fmt: skip
def test_other_scenes_are_refused(build, message):
    still = fl.statics(beam())
    with pytest.raises(ValueError, match=f"start.*{message}"):
        run(fl.GeneralisedAlpha(), build(), still)


def test_only_results_of_statics_are_taken():
    motion = fl.GeneralisedAlpha().run(beam(), duration=1e-3, step=1e-3)
    with pytest.raises(TypeError, match="start must be a result of statics or of a path, got"):
        run(fl.GeneralisedAlpha(), beam(), motion)


def snapping(drive):
    """Mass on a vertical guide between two oblique springs, which also rest turned upside down."""
    body = fl.RigidBody(1.0, (0.1, 0.1, 0.1), (0, 0, 0.3), name="mass")
    scene, at = fl.Scene(), body.point("centre")
    scene.add(body)
    guide = scene.add(fl.joints.Prismatic(fl.ground(), at, axis=(0, 0, 1)))
    for x in -1.0, 1.0:
        ends = fl.ground((x, 0, 0)), at
        scene.add(fl.loads.ForceLaw(ends, lambda t, q, rate: 100.0 * (q - 1.09**0.5)))
    if drive:
        scene.add(fl.joints.Drive(guide.displacement, lambda t: -0.5 * t))
    return scene


def test_statics_finds_the_equilibrium_at_its_start():
    pushed = fl.statics(snapping(True))
    heights = [
        fl.statics(snapping(False), start=start).position("mass.centre")[-1, 2]
        for start in (None, pushed)
    ]
    np.testing.assert_allclose(heights, [0.3, -0.3], rtol=1e-9)


def test_statics_from_a_motion():
    """A pendulum that nothing but gravity holds, from a state on its way down."""

    def pendulum():
        body = fl.RigidBody(1.0, (0.1, 0.1, 0.1), (1, 0, 0), name="mass")
        hinge = fl.joints.Revolute(fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 1, 0))
        return scene_of(body, hinge)

    falling = fl.GeneralisedAlpha().run(pendulum(), duration=0.9, step=1e-2)
    assert 0.1 < falling.position("mass.centre")[-1, 0]
    hangs = fl.statics(pendulum(), start=falling)
    np.testing.assert_allclose(hangs.position("mass.centre")[-1], (0, 0, -1), atol=1e-9)


def bent(moment):
    scene = beam(cells=8)
    scene.gravity = (0, 0, 0)
    circle = 2.0 * np.pi * SECTION.stiffness[4, 4]
    scene.add(fl.PointLoad(scene.bodies[0].point("end"), moment=(0, moment * circle, 0)))
    return scene


def test_statics_removes_what_is_out_of_balance_in_parts():
    """From a circle to the circle on the other side, which one step does not reach."""
    circle = fl.statics(bent(1.0), load_steps=6)
    found = fl.statics(bent(-1.0), start=circle)
    expected = fl.statics(bent(-1.0), load_steps=6).frames[-1]
    np.testing.assert_allclose(found.frames[-1], expected, atol=1e-9)
    assert found.failed_steps > 0 and len(found.factors) == 1
    # the same loads are in balance at once, and load steps follow
    more = fl.statics(bent(0.5), levels=(2.0, 2.2), start=circle, load_steps=11)
    assert more.iterations[0] <= 2 and more.factors.tolist() == [2.0, 2.2]
    np.testing.assert_allclose(more.frames[0], circle.frames[-1], atol=1e-9)

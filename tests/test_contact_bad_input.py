"""What contacts refuse, each with its message: surfaces, laws, schemes, and steps that fail."""

import numpy as np
import pytest

import fem_lie as fl

RADIUS = 0.1
FLOOR = fl.contact.Plane(fl.ground(), (0, 0, 1))
MATERIAL = fl.Material(1e9, 0.3, 1000.0)


def ball(position, name: str = "", speed: float = 0.0) -> fl.RigidBody:
    body = fl.RigidBody(1.0, 0.4 * RADIUS**2 * np.ones(3), position, name=name)
    body.add_velocity((speed, 0, 0))
    return body


def sphere(body: fl.RigidBody) -> fl.contact.Sphere:
    return fl.contact.Sphere(body.point("centre"), RADIUS)


def falling(law, bodies: list[fl.RigidBody], *others) -> fl.Scene:
    """Balls on a floor, or against each other, and what else is in the scene."""
    scene = fl.Scene()
    for each in (*bodies, *others):
        scene.add(each)
    surfaces = fl.contact.Vertices([body.point("centre") for body in bodies], RADIUS)
    scene.add(fl.contact.Contact(surfaces, surfaces if len(bodies) > 1 else FLOOR, law))
    return scene


def run(scene: fl.Scene, scheme=None, step=1e-2) -> None:
    scheme = fl.GeneralisedAlpha(radius=0.8) if scheme is None else scheme
    scheme.run(scene, duration=0.5, step=step, progress=False)


def checked(a: fl.contact.ContactSurface, b: fl.contact.ContactSurface, law=None) -> None:
    fl.contact.Contact(a, b, fl.contact.Penalty(1e3) if law is None else law, name="two").check()


def beam_line(radius: float, bent: float = 0.0) -> fl.contact.Line:
    section = fl.Section.circle(RADIUS, MATERIAL)
    beam = fl.Beam.straight((-1, 0, 0), (1, 0, 0), section, cells=4)
    c, s = np.cos(bent), np.sin(bent)
    beam.frames[0, 1:] = [[c, s, 0], [-s, c, 0], [0, 0, 1]]
    return fl.contact.Line(beam, radius)


ONE = [ball((0, 0, 1))]
VALUES = {
    "negative friction": (
        lambda: fl.contact.Impact(-0.1),
        r"friction must not be negative, got -0\.1",
    ),
    "friction of a penalty": (
        lambda: fl.contact.Penalty(1e3, friction=-1.0),
        "friction must not be negative, got -1",
    ),
    "too much restitution": (
        lambda: fl.contact.Impact(restitution=1.5),
        r"restitution must be in \[0, 1\], got 1\.5",
    ),
    "negative restitution": (
        lambda: fl.contact.Impact(restitution=-0.5),
        r"must be in \[0, 1\], got -0",
    ),
    "restitution of a penalty": (
        lambda: fl.contact.Penalty(1e3, restitution=0.5),
        "a penalty has damping, not restitution",
    ),
    "no stiffness": (lambda: fl.contact.Penalty(0.0), "Penalty: stiffness must be a positive"),
    "infinite stiffness": (lambda: fl.contact.Penalty(np.inf), "stiffness must be a finite"),
    "no radius": (
        lambda: fl.contact.Sphere(fl.ground(), -0.1),
        "Sphere: radius must be a positive",
    ),
    "radius that is none": (
        lambda: fl.contact.Sphere(fl.ground(), np.nan),
        "Sphere: radius must be a fin",
    ),
    "bar without radius": (
        lambda: fl.contact.Cylinder(fl.ground(), (0, 0, 1), 0.0),
        "Cylinder: radius must be a positive",
    ),
}
SURFACES = {
    "overlap": (
        lambda: checked(sphere(ball((0, 0, 0.05))), FLOOR),
        r"two: they overlap by 0\.05 at \(0, 0, -0\.05\); start with a gap, or give",
    ),
    "the same body": (
        lambda: checked(
            fl.contact.Sphere(ONE[0].point((0, 0, 2)), 0.1),
            fl.contact.Plane(ONE[0].point("centre"), (0, 0, 1)),
        ),
        "two: expected surfaces on different frames",
    ),
    "kinks": (lambda: checked(beam_line(0.1, 0.3), FLOOR), "of node 0 is more than 10° off"),
    "impacts of lines": (
        lambda: checked(beam_line(0.1), FLOOR, fl.contact.Impact()),
        "two: Line and Plane touch by Penalty, not by Impact",
    ),
}
SCHEMES = {
    "conserving": (
        lambda: run(falling(fl.contact.Impact(), ONE), fl.EnergyMomentum()),
        "Impact is for GeneralisedAlpha.* give Penalty elsewhere",
    ),
    "decaying": (
        lambda: run(falling(fl.contact.Impact(), ONE), fl.EnergyDecaying()),
        "Impact is for GeneralisedAlpha.* give Penalty elsewhere",
    ),
    "statics": (lambda: fl.statics(falling(fl.contact.Impact(), ONE)), "give Penalty elsewhere"),
    "steps that change": (
        lambda: run(falling(fl.contact.Impact(), ONE), step=fl.schemes.AdaptiveStep(1e-4)),
        "GeneralisedAlpha with constant steps",
    ),
    "damping in conserving steps": (
        lambda: run(falling(fl.contact.Penalty(1e3, damping=1.0), ONE), fl.EnergyMomentum()),
        "support contacts by penalty with damping: use GeneralisedAlpha",
    ),
}
REFUSED = VALUES | SURFACES | SCHEMES


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(("speed", "through"), [(100.0, True), (15.0, False)])
def test_a_body_that_passes_through_another_is_named(speed, through):
    """Ten radii in a step; with less than that the impact is seen, wherever steps begin."""
    bodies = [ball((0, 0, 0), "ball", speed), ball((1.53, 0, 0), "other")]
    scene = falling(fl.contact.Impact(restitution=1.0), bodies)
    if through:
        with pytest.raises(
            fl.ConvergenceError,
            match=r"step 2 .*: ball and other: one side passed through the other .* times smaller",
        ):
            run(scene)
        return
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.5, step=1e-2, progress=False)
    assert result.velocity(bodies[1].point("centre"))[-1, 0] == pytest.approx(speed, rel=1e-12)


def test_nothing_is_said_of_what_flies_past():
    bodies = [ball((0, 0, 0), "ball", 100.0), ball((1.53, 0.25, 0), "other")]
    result = fl.GeneralisedAlpha(radius=0.8).run(
        falling(fl.contact.Impact(), bodies), duration=0.1, step=1e-2, progress=False
    )
    assert result.velocity(bodies[0].point("centre"))[-1, 0] == 100.0

"""Initial velocities that joints, drives and prescribed motions allow."""

import numpy as np
import pytest

import fem_lie as fl
from demos.slider_crank import CRANK_END, PIVOT, SLIDER, SPEED, flexible, mechanism
from tests.combinations import BODIES, JOINTS, joined
from tests.scene_builder import build

STEP = 1e-3
ON_BEAMS = ("Sliding", "Collar", "Sleeve")
ON_RIGID = [
    each for each in JOINTS if each not in (*ON_BEAMS, "RigidLink", "KnifeEdge", "RollingDisc")
]
UNBALANCED = "net"
"""Its straight cables were bent to its shape."""
JOINED = [
    *(("rigid body", joint) for joint in ON_RIGID),
    *(("beam, geodesic", joint) for joint in ON_BEAMS),
    *((body, "Spherical") for body in BODIES if body not in ("discrete cable", UNBALANCED)),
    ("discrete cable", "Distance, drive"),
]


def momenta(scene):
    """Momentum and angular momentum at the start."""
    result = fl.GeneralisedAlpha().run(scene, duration=STEP, step=STEP)
    return np.append(result.momentum[0], result.angular_momentum[0])


@pytest.mark.parametrize(("body", "joint"), JOINED)
def test_joints_keep_momenta_of_bodies_thrown_at_random(body, joint):
    scene = build(joined(body, joint)).scene
    before = 0.0
    random = np.random.default_rng(3)
    for part in scene.bodies:
        velocity, omega = random.normal(size=(2, 3))
        part.add_velocity(velocity, omega=omega, about=(0.1, 0.2, 0.3))
        alone = fl.Scene()
        alone.add(part)
        before = before + momenta(alone)
    fl.schemes.set_initial_velocities(scene, STEP)
    after = momenta(scene)
    np.testing.assert_allclose(after, before, atol=1e-11 * np.abs(before).max())
    found = [part.velocities for part in scene.bodies]
    fl.schemes.set_initial_velocities(scene, STEP)
    for part, velocities in zip(scene.bodies, found, strict=True):
        np.testing.assert_allclose(
            part.velocities, velocities, atol=1e-9 * np.abs(velocities).max()
        )


@pytest.mark.parametrize("modulus", [None, 2e8, 2e11])
def test_bodies_of_a_mechanism_move_without_deforming(modulus):
    """The slider of a slider-crank has the velocity of the rod along it, and beams are not bent."""
    rod = None if modulus is None else flexible(8, modulus)
    scene, _, _ = mechanism(rod)
    end = np.cross((SPEED, 0, 0), CRANK_END - PIVOT)
    along = (SLIDER - CRANK_END) / 0.3
    slide = end @ along / along[0]
    omega = np.cross(along, (slide, 0, 0) - end) / 0.3
    expected = flexible(8, 1.0)
    expected.add_velocity(end, omega=omega, about=CRANK_END)
    crank, slider, rod = scene.bodies
    np.testing.assert_allclose(slider.velocities[0, 0], slide, rtol=1e-11)
    np.testing.assert_allclose(crank.velocities[0, 3:], (SPEED, 0, 0), rtol=1e-12, atol=1e-12)
    if modulus is not None:
        np.testing.assert_allclose(rod.velocities, expected.velocities, atol=1e-10 * SPEED)


def cart() -> tuple[fl.Scene, fl.joints.Prismatic, fl.RigidBody]:
    """A cart on a rail, with a second one behind it."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    first = scene.add(fl.RigidBody(1.0, (1, 1, 1), name="first"))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), first.point("centre"), axis=(1, 0, 0)))
    second = scene.add(fl.RigidBody(0.5, (0.01, 0.01, 0.01), (0, 0, -0.5), name="second"))
    return scene, rail, second


def test_what_is_free_moves_as_after_an_impulse():
    """A pendulum of mass m below the driven cart: (J + m l²) ω = m l v."""
    scene, rail, pendulum = cart()
    pin = pendulum.point("centre"), rail.b
    scene.add(fl.joints.Revolute(*pin, at=(0, 0, 0), axis=(0, 1, 0)))
    scene.add(fl.joints.Drive(rail.displacement, lambda t: 2.0 * t + t**2))
    fl.schemes.set_initial_velocities(scene, STEP)
    omega = 0.5 * 0.5 * 2.0 / (0.01 + 0.5 * 0.25)
    expected = (2.0 - 0.5 * omega, 0, 0, 0, omega, 0)
    np.testing.assert_allclose(pendulum.velocities[0], expected, atol=1e-10)
    fl.GeneralisedAlpha().run(scene, duration=0.1, step=STEP)


def test_springs_keep_their_length():
    scene, rail, second = cart()
    slide = fl.joints.Prismatic(rail.b, second.point("centre"), at=(0, 0, 0), axis=(1, 0, 0))
    scene.add(slide)
    scene.add(fl.joints.Spring(slide.displacement, 100.0))
    fl.schemes.set_initial_velocities(scene, STEP, rates=[(rail.displacement, 3.0)])
    np.testing.assert_allclose(second.velocities[0], (3.0, 0, 0, 0, 0, 0), atol=1e-8)


def test_prescribed_motions_and_equilibria_in_rotation():
    """A beam on a hub that turns starts from its equilibrium in rotation: nothing to change."""
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(1e9, 0.3, 1000.0))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0.1, 0, 0), (1.1, 0, 0), section, cells=4))
    held = fl.Scene()
    held.add(beam)
    held.add(fl.Clamp(beam.point("start")))
    steady = fl.statics(held, spin=(0, 0, 5.0))
    first = beam.frames[0]

    def turned(t: float) -> np.ndarray:
        c, s = np.cos(5.0 * t), np.sin(5.0 * t)
        return first @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])

    scene.add(fl.PrescribedMotion(beam.point("start"), turned))
    fl.schemes.set_initial_velocities(scene, STEP, start=steady)
    np.testing.assert_allclose(beam.velocities, 0.0, atol=1e-7)
    fl.GeneralisedAlpha().run(scene, duration=0.01, step=STEP, start=steady)


WRONG = {
    "rate": (lambda rail: [(rail.displacement, np.nan)], ValueError, "rate of the displacement"),
    "joint": (lambda rail: [(rail, 1.0)], TypeError, "Prismatic has: displacement"),
    "pairs": (lambda rail: [rail.displacement], TypeError, "pairs of a coordinate and its rate"),
    "list": (lambda rail: rail.displacement.joint, TypeError, "list of pairs"),
    "twice": (lambda rail: 2 * [(rail.displacement, 1.0)], ValueError, "redundant"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_rates(name):
    rates, error, message = WRONG[name]
    scene, rail, _ = cart()
    with pytest.raises(error, match=message):
        fl.schemes.set_initial_velocities(scene, STEP, rates=rates(rail))


def test_contradictory_rates_change_nothing():
    scene, rail, _ = cart()
    scene.redundant = fl.joints.RedundantConstraints.MINIMUM_NORM
    rates = [(rail.displacement, 1.0), (rail.displacement, 2.0)]
    with pytest.raises(ValueError, match="constraints that some velocities satisfy"):
        fl.schemes.set_initial_velocities(scene, STEP, rates=rates)
    assert not any(body.velocities.any() for body in scene.bodies)

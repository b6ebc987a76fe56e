"""Sliding and rolling joints in conserving schemes: energy, momenta, order, other schemes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.test_composed import resumed_as_whole

TIME = 0.2
SCHEMES = {
    "energy-momentum": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(radius=0.8),
    "composed": fl.schemes.Composed(),
}
each = pytest.mark.parametrize("name", SCHEMES)
SECTION = fl.Section.rectangle(0.05, 0.04, fl.Material(4e6, 0.3, 1000.0))


def line() -> fl.Beam:
    """A bowed beam of six elements, of length one."""
    curve = fl.mesh.curve(lambda s: (s, 0.05 * np.sin(np.pi * s), 0.0), 6)
    return fl.Beam(curve, SECTION, up=(0, 0, 1), name="beam")


def sliding(joint: str, *, free: bool = True, spin: float = 9.0) -> fl.Scene:
    """A body slides along a beam that flies and turns, or hangs on a ball joint, over elements."""
    scene = fl.Scene(gravity=(0, 0, 0 if free else -9.81))
    beam = scene.add(line())
    at = middle_of(beam)
    bead = scene.add(fl.RigidBody(0.5, (0.002, 0.003, 0.004), tuple(at)))
    scene.add(getattr(fl.joints, joint)(beam, bead.point("centre")))
    if free:
        for body in (beam, bead):
            body.add_velocity(omega=(0.5, 1.0, spin), about=(0, 0, 0))
    else:
        scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    return scene


def middle_of(beam: fl.Beam) -> np.ndarray:
    """A point on the axis within the third element."""
    ahead = lie.se3_relative(beam.frames[2], beam.frames[3])
    return np.asarray(lie.se3_retract(beam.frames[2], 0.3 * ahead))[0]


def rolling(joint: str) -> fl.Scene:
    """An edge, or a disc, on the ground, that carries a beam on a hinge."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    wheel = scene.add(fl.RigidBody(2.0, (0.02, 0.02, 0.03), (0, 0, 0.3)))
    if joint == "KnifeEdge":
        scene.add(fl.joints.KnifeEdge(fl.ground(), wheel.point("centre"), axis=(0, 1, 0)))
        scene.add(
            fl.joints.Planar(fl.ground(), wheel.point("centre"), axis=(0, 0, 1), second=(1, 0, 0))
        )
        wheel.add_velocity(omega=(0, 0, 4.0), about=wheel.point("centre"))
        wheel.add_velocity((1.0, 0, 0))
    else:
        rim = {"axis": (0, 1, 0), "radius": 0.3, "normal": (0, 0, 1)}
        scene.add(fl.joints.RollingDisc(fl.ground(), wheel.point("centre"), **rim))
        wheel.add_velocity(omega=(0.3, 4.0, 0.8), about=(0, 0, 0))
    return scene


SCENES = {
    "Sliding": lambda: sliding("Sliding"),
    "Collar": lambda: sliding("Collar"),
    "Sleeve": lambda: sliding("Sleeve", free=False),
    "KnifeEdge": lambda: rolling("KnifeEdge"),
    "RollingDisc": lambda: rolling("RollingDisc"),
}


def centre_of(scheme, scene: fl.Scene, step: float) -> tuple[np.ndarray, fl.Result]:
    """Where the body is at the end."""
    (body,) = (body for body in scene.bodies if isinstance(body, fl.RigidBody))
    result = scheme.run(scene, duration=TIME, step=step)
    return result.position(body.point("centre"))[-1], result


@each
def test_a_bead_on_a_beam_gets_no_moment(name):
    """A sliding joint at its centre acts on its position only, however small its inertia."""
    scene = fl.Scene()
    beam = scene.add(line())
    bead = scene.add(fl.RigidBody(0.01, (1e-9, 1e-9, 1e-9), tuple(middle_of(beam))))
    scene.add(fl.joints.Sliding(beam, bead.point("centre")))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    scene.add(fl.PointLoad(bead.point("centre"), force=(0.5, 0, -0.5)))
    result = SCHEMES[name].run(scene, duration=0.05, step=5e-3)
    rotation = result.rotation(bead.point("centre"))
    assert abs(result.displacement(bead.point("centre"))[-1, [0, 2]]).min() > 1e-4
    np.testing.assert_allclose(rotation, np.broadcast_to(np.eye(3), rotation.shape), atol=1e-6)


@each
@pytest.mark.parametrize("joint", SCENES)
def test_energy_momenta_and_joints_are_exact(name, joint):
    _, result = centre_of(SCHEMES[name], SCENES[joint](), 2e-3)
    assert result.balance_error < (1e-10 if name == "decaying" else 1e-11)
    assert result.joint_violations.max() < 1e-11
    if joint in ("Sliding", "Collar"):
        assert result.momentum_error < 1e-11
        assert result.angular_momentum_error < 1e-11
        crossed = result.joint_coordinates[:, 0]
        assert crossed.max() - crossed.min() > 0.2  # of elements of a sixth


SMOOTH = SCENES | {
    "Sliding": lambda: sliding("Sliding", spin=2.0),
    "Collar": lambda: sliding("Collar", spin=2.0),
}
"""Within one element, from which beams go on to the next with another curvature."""


@each
@pytest.mark.parametrize("joint", SMOOTH)
def test_second_order_and_the_motion_of_generalised_alpha(name, joint):
    exact, _ = centre_of(fl.GeneralisedAlpha(), SMOOTH[joint](), 1e-4)
    steps = (4e-3, 2e-3, 1e-3) if name == "composed" else (1e-3, 5e-4, 2.5e-4)
    ends = [centre_of(SCHEMES[name], SMOOTH[joint](), step)[0] for step in steps]
    assert np.linalg.norm(ends[-1] - exact) < 2e-5
    far, near = (np.linalg.norm(a - b) for a, b in pairwise(ends))
    assert near < 1e-9 or np.log2(far / near) > 1.6, (far, near)


def test_travel_that_is_driven_does_work():
    """A motor moves a body out along a beam that turns: its work is all the energy that comes."""
    scene = fl.Scene()
    beam = scene.add(line())
    bead = scene.add(fl.RigidBody(0.5, (0.002, 0.003, 0.004), tuple(beam.frames[2, 0])))
    reached = float(beam.model.lengths[:2].sum())
    scene.add(
        fl.joints.Collar(
            beam, bead.point("centre"), travel=lambda t: reached + 0.3 * np.sin(8 * t) ** 2
        )
    )
    for body in (beam, bead):
        body.add_velocity(omega=(0, 0, 5.0), about=(0.5, 0, 0))
    result = fl.EnergyMomentum().run(scene, duration=TIME, step=1e-3)
    gained = result.total_energy[-1] - result.total_energy[0]
    assert abs(gained) > 1e-3 * result.total_energy[0]
    assert result.balance_error < 1e-11
    assert result.angular_momentum_error < 1e-11
    assert result.joint_violations.max() < 1e-12


@pytest.mark.parametrize("joint", ["Collar", "RollingDisc"])
def test_steps_that_are_chosen(joint):
    result = fl.EnergyMomentum().run(
        SCENES[joint](), duration=TIME, step=fl.schemes.AdaptiveStep(1e-4)
    )
    assert result.balance_error < 1e-10
    assert result.joint_violations.max() < 1e-10


@pytest.mark.parametrize("joint", ["Collar", "KnifeEdge"])
@pytest.mark.parametrize("name", ["energy-momentum", "decaying"])
def test_resumed_to_the_last_bit(tmp_path, name, joint):
    plan = {"duration": 0.06, "step": 2e-3, "save_every": 3}
    resumed_as_whole(SCHEMES[name], SCENES[joint], plan, tmp_path / "run.h5")


def hinged(*, sprung: bool = False) -> fl.Scene:
    """A body on a hinge between two nodes of a beam that flies."""
    scene = fl.Scene()
    beam = scene.add(line())
    position = beam.point((0.4, 0.05 * np.sin(0.4 * np.pi), 0.0), tolerance=0.01)
    body = scene.add(fl.RigidBody(0.5, (0.002, 0.003, 0.004), tuple(position.position + 0.1)))
    hinge = scene.add(
        fl.joints.Revolute(position, body.point(tuple(position.position)), axis=(0, 0, 1))
    )
    if sprung:
        scene.add(fl.joints.Spring(hinge.angle, 1.0))
    beam.add_velocity(omega=(0.5, 1.0, 4.0), about=(0, 0, 0))
    body.add_velocity(omega=(0.5, 1.0, 4.0), about=(0, 0, 0))
    return scene


@each
def test_a_hinge_between_two_nodes(name):
    end, result = centre_of(SCHEMES[name], hinged(), 1e-3)
    exact, _ = centre_of(fl.GeneralisedAlpha(), hinged(), 1e-4)
    assert np.linalg.norm(end - exact) < 1e-5
    assert result.balance_error < 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-11
    assert result.joint_violations.max() < 1e-12


def test_a_spring_between_two_nodes_is_refused():
    with pytest.raises(ValueError, match="springs of joints on points that are not nodes"):
        fl.EnergyMomentum().run(hinged(sprung=True), duration=1e-3, step=1e-3)

"""Ropes through rings: workless, with momenta, against closed forms, with friction."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import fem_lie as fl
from benchmarks.rings import CABLE, capstan, free, position, rope

OPTIONS = {"duration": 0.02, "step": 5e-4, "progress": False}


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(
    ("kind", "ring"), [("net", "body"), ("net", "place"), ("cable", "body"), ("cable", "place")]
)
def test_conserving_steps_keep_energy_and_momenta(kind, ring, friction):
    result = fl.EnergyMomentum().run(free(kind, ring, friction), **OPTIONS)
    assert result.balance_error < 2e-11
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-13
    lost = result.balance[:, 1]
    assert np.diff(lost).min() >= 0.0
    assert (lost[-1] > 1e-2 * result.kinetic[0]) == (friction > 0.0)


def test_rings_on_beams_among_frames_alone():
    result = fl.EnergyMomentum().run(free("beam", "body"), **{**OPTIONS, "duration": 0.005})
    assert result.balance_error < 2e-11
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-13


@pytest.mark.parametrize("kind", ["net", "cable", "beam"])
def test_schemes_agree_on_all_kinds_of_nodes(kind):
    """A rope of nodes with positions, position gradients or frames."""
    found = []
    for scheme in (fl.EnergyMomentum(), fl.GeneralisedAlpha(radius=1.0)):
        scene = free(kind, "place")
        result = scheme.run(scene, duration=0.01, step=2.5e-4, progress=False)
        first = len(scene.bodies[0].frames)
        found.append(result.frames[-1, first, 0])
    moved = np.linalg.norm([2.0, 0, -1.0]) * 0.01
    assert np.abs(found[0] - found[1]).max() < 2e-3 * moved


KNOTS = np.array([0.0, 0.2, 0.5, 0.6, 1.0])


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("kind", ["net", "cable"])
def test_curves_of_ropes_are_exact_between_uneven_nodes(kind, backwards):
    """A parabola along the rope with positions, a cubic with position gradients."""
    if kind == "net":
        body = fl.Net([(s, 0, 0) for s in KNOTS], [range(len(KNOTS))], CABLE)
        p = np.polynomial.Polynomial([0.3, -1.0, 2.0])
    else:
        body = fl.Cable.curve(lambda s: (s + 0.3 * s * s, 0, 0), CABLE, cells=4)
        p = np.polynomial.Polynomial([0.3, -1.0, 2.0, -0.7])
    nodes = list(range(len(body.frames)))[:: -1 if backwards else 1]
    rope = fl.contact.Rope(body, nodes)
    ends = np.cumsum([0.0, *rope.lengths])
    positions = body.frames[nodes, 0, 0]
    np.testing.assert_allclose(ends, np.abs(positions - positions[0]), rtol=1e-12)
    # slopes of the body are along its own nodes, not along those of a rope that runs backwards
    slopes = (-1.0 if backwards else 1.0) * p.deriv()(ends)
    rows, (slots, controls) = np.stack([p(ends), slopes]), rope.controls()
    for k, length in enumerate(rope.lengths):
        found = np.einsum("akq,ka->q", controls[k], rows[:, slots[k]])  # of no node: zero
        curve = CubicHermiteSpline([0.0, 1.0], found[:2], found[2:])
        s = np.linspace(0.0, 1.0, 7)
        wanted = p(ends[k] + s * length)
        np.testing.assert_allclose(curve(s), wanted, atol=1e-13)


def test_rings_are_on_the_part_of_a_rope_that_is_nearest():
    """A rope that goes and comes back beside itself: not where one gets to from its start."""
    there = [(0.1 * k, 0.0, 0.0) for k in range(11)]
    net = fl.Net([*there, *((x, 0.1, 0.0) for x, _, _ in reversed(there))], [range(22)], CABLE)
    positions = [(0.43, 0.1, 0), (0.43, 0, 0), (0.87, 0.1, 0)]
    touch = fl.contact.Contact(
        fl.contact.Rope(net),
        fl.contact.Rings([fl.ground()] * 3, at=positions),
        fl.contact.Penalty(1e4),
    )
    touch.check()
    feet = touch.term(lambda body: np.arange(len(body.frames))).feet
    np.testing.assert_allclose(feet, [1.1 + 0.57, 0.43, 1.1 + 0.13], atol=1e-12)


def taut(friction: float, weight: float = 1.0) -> tuple[fl.Scene, fl.RigidBody]:
    """A bead on a straight rope under tension, between pins."""
    scene = fl.Scene(gravity=(0, 0, -9.81 * weight))
    cable = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), CABLE, cells=20, length=0.9))
    cable.pin(cable.point("start"), cable.point("end"))
    bead = scene.add(fl.RigidBody(0.02, 1e-6 * np.eye(3), (0.31, 0, 0)))
    bead.add_velocity((1.0, 0, 0))
    rings = fl.contact.Rings([bead.point("centre")])
    scene.add(
        fl.contact.Contact(
            fl.contact.Rope(cable), rings, fl.contact.Penalty(1e5, friction=friction)
        )
    )
    return scene, bead


def test_a_bead_glides_along_a_straight_rope_over_its_elements():
    scene, _ = taut(0.0, weight=0.0)
    result = fl.EnergyMomentum().run(scene, duration=0.4, step=2e-3, progress=False)
    x = result.frames[:, 21, 0]
    np.testing.assert_allclose(x[:, 0], 0.31 + result.times, atol=1e-10)
    np.testing.assert_allclose(x[:, 1:], 0.0, atol=1e-12)


def test_friction_is_that_of_coulomb():
    """On a rope that is nearly straight a bead is slowed down by μ g, and rests in the end."""
    friction, time = 0.2, 0.3
    scene, _ = taut(friction)
    scheme = fl.GeneralisedAlpha(radius=0.5)
    result = scheme.run(scene, duration=time, step=1e-3, progress=False)
    x = result.frames[:, 21, 0, 0]
    speed = (x[-1] - x[-41]) / (result.times[-1] - result.times[-41])
    middle = 0.5 * (result.times[-1] + result.times[-41])
    assert 1.0 - speed == pytest.approx(friction * 9.81 * middle, rel=0.05)
    lost = 0.5 * 0.02 * (1.0 - speed**2)
    assert result.balance[-40:, 1].mean() == pytest.approx(lost, rel=0.05)
    along = fl.post.contact_forces(result, scene.contacts[0]).total[20:, 0]
    # the bead drags the rope along
    assert along.mean() == pytest.approx(friction * 9.81 * 0.02, rel=0.1)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_tension_grows_from_ring_to_ring_as_on_a_capstan(friction):
    """Rings that bend a rope by 11° each."""
    found = capstan(180, 16, 4, friction)
    assert abs(found["error"]) < 0.01
    assert abs(found["angle"] - 180) < 1
    assert (found["ratio"] > 2.0) == (friction > 0.0)


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.GeneralisedAlpha(radius=0.8)])
def test_a_restart_agrees_to_the_last_bit(tmp_path, scheme):
    options = {**OPTIONS, "checkpoint_every": 25}
    whole = scheme.run(free("net", "body", 0.3), **options, file=tmp_path / "whole.h5")
    scheme.run(free("net", "body", 0.3), **options, file=tmp_path / "run.h5")
    resumed = scheme.resume(free("net", "body", 0.3), tmp_path / "run.h5", progress=False)
    for name in ("frames", "elastic", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


def refused(rope: object, rings: object, law: object = fl.contact.Penalty(1e4)) -> None:
    scene = fl.Scene()
    for point in rings.points:
        if point.body is not None:
            scene.add(point.body)
    if rope.body not in scene.bodies:
        scene.add(rope.body)
    scene.add(fl.contact.Contact(rope, rings, law))
    fl.GeneralisedAlpha().run(scene, duration=1e-3, step=1e-3, progress=False)


def test_bad_input():
    cable, at = rope("net"), position(0.5)
    ground = fl.contact.Rings([fl.ground()], at=[at])
    with pytest.raises(ValueError, match=r"ring 0 is 0\..* off the rope"):
        refused(fl.contact.Rope(rope("net")), fl.contact.Rings([fl.ground()], at=[(0.5, 0.5, 0)]))
    with pytest.raises(ValueError, match="fixed to a node of its rope"):
        refused(fl.contact.Rope(cable), fl.contact.Rings([cable.point(10)]))
    with pytest.raises(ValueError, match="by Penalty without damping"):
        refused(fl.contact.Rope(rope("net")), ground, fl.contact.Penalty(1e4, damping=1.0))
    with pytest.raises(ValueError, match="nodes 2 and 5 follow each other"):
        refused(fl.contact.Rope(rope("net"), [0, 1, 2, 5]), ground)
    for few in ([0, 1], [0, 1, 0]):
        with pytest.raises(ValueError, match="three nodes or more"):
            refused(fl.contact.Rope(rope("net"), few), ground)
    with pytest.raises(ValueError, match="ropes touch rings only"):
        ball = fl.contact.Sphere(fl.RigidBody(1.0, np.eye(3), (0, 0, 1)).point("centre"), 0.1)
        fl.contact.Contact(fl.contact.Rope(cable), ball, fl.contact.Penalty(1e4)).check()
    with pytest.raises(ValueError, match="ignore_initial is for"):
        fl.contact.Contact(
            fl.contact.Rope(cable), ground, fl.contact.Penalty(1e4), ignore_initial=True
        ).check()
    with pytest.raises(ValueError, match="by Penalty without damping"):
        refused(fl.contact.Rope(rope("net")), ground, fl.contact.Impact())
    with pytest.raises(ValueError, match="expected at least one point"):
        fl.contact.Rings([])
    with pytest.raises(ValueError, match="a ring with an offset from its node needs"):
        other = fl.Net([at, (0.5, 0, 1)], [[0, 1]], CABLE)
        refused(fl.contact.Rope(rope("net")), fl.contact.Rings([other.point(1)], at=[at]))
    with pytest.raises(ValueError, match="at must be 1 positions"):
        fl.contact.Rings([fl.ground()], at=[(0, 0, 0), (1, 0, 0)])

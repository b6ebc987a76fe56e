"""Discrete rods in all schemes: laws of mechanics, order, and each scheme against the others."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.test_composed import resumed_as_whole

TIME = 0.1
CONSERVING = {
    "energy-momentum": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(radius=0.8),
    "composed": fl.schemes.Composed(),
    "explicit": fl.Explicit(),
}
conserving = pytest.mark.parametrize("name", CONSERVING)


def rod(*, flat: bool = False) -> fl.Rod:
    """Naturally bent, of four edges; ``flat``: in a plane."""
    section = fl.Section.rectangle(0.05, 0.04, fl.Material(4e6, 0.3, 1000.0))
    rise, up = (0.0, (0, 0, 1)) if flat else (0.3, (0, 0.3, 1))
    line = fl.mesh.curve(lambda s: (s, 0.1 * np.sin(3 * s), rise * s * s), 4)
    return fl.Rod(line, section, up=up, formulation=fl.elements.DiscreteRod(), name="rod")


def flying(*, flat: bool = False) -> fl.Scene:
    """Free, and turning."""
    scene = fl.Scene()
    spin = (0, 0, 6.0) if flat else (0.5, 2.0, 6.0)
    scene.add(rod(flat=flat)).add_velocity(omega=spin, about=(0.5, 0, 0))
    return scene


def swinging() -> fl.Scene:
    """A pendulum on a ball joint, that carries a body on a hinge and is drawn by a moment."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    own = scene.add(rod())
    end = own.frames[own.point("end").node, 0]
    bob = scene.add(fl.RigidBody(0.5, (0.002, 0.003, 0.004), tuple(end + np.array([0.1, 0.05, 0]))))
    scene.add(fl.joints.Spherical(fl.ground(), own.point("start")))
    scene.add(fl.joints.Revolute(own.point("end"), bob.point(tuple(end)), axis=(0, 1, 0)))
    scene.add(fl.PointLoad(own.point("end"), moment=(0.3, 0.2, -0.1)))
    return scene


def end_of(scheme, scene: fl.Scene, step: float) -> tuple[np.ndarray, fl.Result]:
    """Where the end is after a time."""
    steps = round(TIME / step)
    result = scheme.run(scene, duration=TIME, step=step, save_every=steps)
    (own,) = (body for body in scene.bodies if isinstance(body, fl.Rod))
    return result.position(own.point("end"))[-1], result


@conserving
@pytest.mark.parametrize("scene", [flying, swinging])
def test_energy_is_accounted_for(name, scene):
    step = 5e-5 if name == "explicit" else 1e-3
    _, result = end_of(CONSERVING[name], scene(), step)
    assert result.balance_error < (1e-6 if name == "explicit" else 1e-11)
    assert result.joint_violations.max(initial=0.0) < 1e-12


@conserving
def test_momenta_are_exact(name):
    """Angular momentum in a plane, where no edge spins about a tangent that turns."""
    _, result = end_of(CONSERVING[name], flying(flat=True), 5e-4)
    assert result.momentum_error < 1e-11
    assert result.angular_momentum_error < 1e-11


def test_moment_of_momentum_of_spins_is_that_of_generalised_alpha():
    """What turning tangents change of it is left out of the inertia of edges."""
    lost = []
    for scheme in (fl.GeneralisedAlpha(), *CONSERVING.values()):
        _, result = end_of(scheme, flying(), 1e-4)
        lost.append(result.angular_momentum[-1] - result.angular_momentum[0])
    scale = np.linalg.norm(lost[0])
    assert scale > 0
    for other in lost[1:]:
        assert np.linalg.norm(other - lost[0]) < 1e-2 * scale


@conserving
@pytest.mark.parametrize("scene", [flying, swinging])
def test_second_order_and_the_motion_of_generalised_alpha(name, scene):
    exact, _ = end_of(fl.GeneralisedAlpha(), scene(), 2.5e-5)
    steps = np.array([4e-4, 2e-4, 1e-4, 5e-5]) * (5 if name == "composed" else 1)
    ends = [end_of(CONSERVING[name], scene(), step)[0] for step in steps]
    assert np.linalg.norm(ends[-1] - exact) < 1e-5
    errors = [np.linalg.norm(a - b) for a, b in pairwise(ends)]
    least = 1.7 if name != "composed" else 3.0
    assert np.log2(errors[1] / errors[2]) > least


@pytest.mark.parametrize("name", [*CONSERVING, "generalised-α"])
def test_a_linked_end_moves_as_a_fixed_one(name):
    """The edge beside it goes to the end, and not to the node that leads it."""

    def carried(*, linked: bool) -> fl.Scene:
        scene = flying()
        (own,) = scene.bodies
        end = own.frames[own.point("end").node, 0]
        bob = scene.add(
            fl.RigidBody(0.5, (0.002, 0.003, 0.004), tuple(end + np.array([0.3, 0.2, 0.1])))
        )
        bob.add_velocity(omega=(0.5, 2.0, 6.0), about=(0.5, 0, 0))
        if linked:
            scene.add(fl.joints.RigidLink(bob.point("centre"), own.point("end")))
        else:
            scene.add(fl.joints.Fixed(bob.point(tuple(end)), own.point("end")))
        return scene

    scheme = CONSERVING.get(name, fl.GeneralisedAlpha())
    step = 1e-4 if name == "explicit" else 1e-3
    ends = [end_of(scheme, carried(linked=linked), step)[0] for linked in (True, False)]
    np.testing.assert_allclose(*ends, rtol=0, atol=1e-6)


def test_steps_that_are_chosen_conserve_too():
    scene = flying()
    result = fl.EnergyMomentum().run(scene, duration=TIME, step=fl.schemes.AdaptiveStep(1e-4))
    assert result.balance_error < 1e-11


def test_steps_of_its_own():
    scene = swinging()
    body = next(iter(scene.bodies))
    result = fl.schemes.MultiRate({body: 3}).run(scene, duration=TIME, step=2e-3)
    assert result.balance_error < 1e-9


@pytest.mark.parametrize("name", ["energy-momentum", "explicit"])
def test_resumed_to_the_last_bit(tmp_path, name):
    step = 5e-5 if name == "explicit" else 1e-3
    plan = {"duration": 30 * step, "step": step, "save_every": 3}
    resumed_as_whole(CONSERVING[name], swinging, plan, tmp_path / "run.h5")


def test_explicit_steps_up_to_the_largest_stable_one():
    scene = flying()
    step = fl.Explicit().stable_step(scene)
    result = fl.Explicit().run(flying(), duration=400 * 0.95 * step, step=0.95 * step)
    assert result.balance_error < 0.1
    with pytest.raises(ValueError, match="stable step"):
        fl.Explicit().run(flying(), duration=4 * step, step=2 * step)

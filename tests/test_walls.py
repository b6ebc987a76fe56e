"""Redundant contacts: walls at rest and struck by a ball, piles."""

import numpy as np

import fem_lie as fl
from benchmarks.piles import at_rest, scene_of
from benchmarks.walls import BRICK, brick, wall


def test_a_wall_stands_still():
    """Sweeps alone left contacts at velocities of 1e-5, and overlaps that failed steps."""
    result = fl.GeneralisedAlpha(radius=0.8).run(
        wall(4), duration=0.5, step=5e-3, save_every=100, progress=False
    )
    assert result.contacts.contacts.min() > 60
    assert result.contacts.cone_residual.max() < 1e-10
    assert np.abs(result.velocities[-1]).max() < 1e-12


def test_a_struck_wall_gains_no_energy():
    result = fl.GeneralisedAlpha(radius=0.8).run(
        wall(4, struck=True), duration=0.2, step=5e-3, progress=False
    )
    energy = result.kinetic + result.potential
    assert result.contacts.contacts.max() > 60
    assert np.diff(energy).max() < 1e-9 * energy[0]
    assert energy[-1] < 0.9 * energy[0]
    assert result.contacts.penetration.max() < 1e-9


def test_a_struck_wall_needs_no_smaller_steps():
    """Redundant contacts left overlaps, which failed a larger wall in all sub-steps, too."""
    result = fl.GeneralisedAlpha(radius=0.8).run(
        wall(6, struck=True), duration=0.05, step=5e-3, progress=False
    )
    energy = result.kinetic + result.potential
    assert result.divided == 0
    assert result.contacts.contacts.max() > 250
    assert result.contacts.penetration.max() < 1e-11
    assert np.diff(energy).max() < 1e-12 * energy[0]


def test_a_brick_that_tips_has_the_energy_error_of_the_scheme():
    """On a contact that stays it is that of a hinge: third order in each step, second in all."""
    growth = []
    for step in (5e-3, 2.5e-3):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        box, (_, edge), _ = brick(scene, BRICK[0], 0.0, 0)
        law = fl.contact.Impact(friction=0.5)
        scene.add(fl.contact.Contact(box, fl.contact.Plane(fl.ground(), (0, 0, 1)), law))
        scene.bodies[0].add_velocity(omega=(0, 6.0, 0), about=(edge, 0, 0))
        result = fl.GeneralisedAlpha().run(scene, duration=0.2, step=step, progress=False)
        energy = result.kinetic + result.potential
        growth.append(np.diff(energy).max() / energy[0])
    assert growth[0] < 5e-6
    assert 7.0 < growth[0] / growth[1] < 9.0


def test_a_small_pile_reaches_its_residual_in_all_steps():
    result = fl.GeneralisedAlpha(radius=0.8).run(
        scene_of(at_rest(80)), duration=0.6, step=2e-3, save_every=300, progress=False
    )
    assert result.contacts.contacts.max() > 120
    assert result.contacts.cone_residual.max() <= 1e-6

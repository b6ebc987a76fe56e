"""Redundant contacts: walls at rest and struck by a ball, piles."""

import numpy as np

import fem_lie as fl
from benchmarks.piles import at_rest, scene_of
from benchmarks.walls import wall


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


def test_a_small_pile_reaches_its_residual_in_all_steps():
    result = fl.GeneralisedAlpha(radius=0.8).run(
        scene_of(at_rest(80)), duration=0.6, step=2e-3, save_every=300, progress=False
    )
    assert result.contacts.contacts.max() > 120
    assert result.contacts.cone_residual.max() <= 1e-6

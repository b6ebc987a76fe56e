"""Conserving schemes and beams that turn: elements, and beams that do nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from demos.spin_up import angle
from tests.random_scenes import CONSERVING, STEP, random_scene
from tests.scene_builder import build

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
SLENDER = fl.Section.from_stiffness(
    [2.8e7, 1e7, 1e7, 1.4e4, 1.4e4, 1.4e4], mass=1.2, rotary=(6e-4, 6e-4)
)


# --- beams ---


def free() -> tuple[fl.Scene, float]:
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (10, 0, 0), SLENDER, cells=20))
    beam.add_velocity(omega=(0, 0, 6.0), about=(5, 0, 0))
    return scene, 4e-3


def hinged() -> tuple[fl.Scene, float]:
    scene, _ = free()
    (beam,) = scene.bodies
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    beam.velocities[:] = 0.0
    beam.add_velocity(omega=(0, 0, 6.0), about=(0, 0, 0))
    return scene, 4e-3


def steel_bar(speed: float = 20.0) -> tuple[fl.Scene, float]:
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.01, STEEL)
    bar = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=20))
    scene.add(fl.joints.Revolute(fl.ground(), bar.point("start"), axis=(0, 0, 1)))
    bar.add_velocity(omega=(0, 0, speed), about=(0, 0, 0))
    return scene, 1e-4


def driven() -> tuple[fl.Scene, float]:
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (10, 0, 0), SLENDER, cells=10))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: angle(10.0 * t)))
    return scene, 2e-3


@pytest.mark.parametrize("make", [free, hinged, steel_bar, driven])
def test_a_beam_that_simply_turns_is_hardly_damped(make):
    """The decaying scheme: energy never rises, and matrices are kept."""
    scene, h = make()
    result = fl.EnergyDecaying(radius=0.8).run(scene, duration=400 * h, step=h)
    turned_over = max(result.kinetic.max(), np.abs(result.balance[:, 0]).max())
    closed = result.total_energy - result.balance[:, 0] + result.balance[:, 1]
    assert np.diff(closed).max() <= 1e-12 * turned_over
    assert 0.0 < result.balance[-1, 2] <= 1e-4 * turned_over
    # round-off of one run is a matter of chance: with steps per mille larger 3e-13 … 4e-12
    errors = [result.balance_error]
    for size in (1.001 * h, 1.002 * h):
        more = fl.EnergyDecaying(radius=0.8).run(make()[0], duration=400 * size, step=size)
        errors.append(more.balance_error)
    assert np.median(errors) < 2e-12
    assert result.iterations[-1] < 13 * 400
    assert result.factorisations < 80


@pytest.mark.parametrize("make", [free, hinged, steel_bar, driven])
def test_a_beam_that_simply_turns(make):
    """To round-off, with matrices that are kept."""
    scene, h = make()
    result = fl.EnergyMomentum().run(scene, duration=400 * h, step=h, save_every=20)
    assert result.balance_error < 2e-12
    assert result.factorisations < 200
    if make is not driven:
        assert result.angular_momentum_error < 2e-12


def test_a_scene_at_rest_stays_there():
    """Nothing but round-off is there to converge to."""
    data = random_scene(45, replace(CONSERVING, steps=10_000))
    scene = build(replace(data, loads=())).scene
    result = fl.EnergyMomentum().run(scene, duration=300 * STEP, step=STEP)
    assert result.kinetic.max() < 1e-17
    assert result.iterations[-1] < 10 * 300


def test_round_off_is_that_of_the_scene():
    """A stiff bar whose waves pass through it 50 times in a step: some digits less, no failure."""
    scene, _ = steel_bar(speed=2.0)
    result = fl.EnergyMomentum().run(scene, duration=1.0, step=1e-2)
    assert result.balance_error < 1e-10
    assert result.iterations[-1] < 20 * 100


def test_conservation_follows_the_tolerance():
    """And costs less; balance and momentum say how far it went."""
    errors, iterations = [], []
    for tolerance in (1e-6, 1e-8, 0.0):
        scene, h = hinged()
        result = fl.EnergyMomentum(tolerance=tolerance).run(scene, duration=200 * h, step=h)
        assert result.balance_error <= max(300.0 * tolerance, 1e-11)
        assert result.angular_momentum_error <= max(300.0 * tolerance, 1e-11)
        errors.append(result.balance_error)
        iterations.append(result.iterations[-1])
    assert errors == sorted(errors, reverse=True)
    assert iterations == sorted(iterations)

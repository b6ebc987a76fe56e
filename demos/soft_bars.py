"""Scenes of order_four.py, of soft bars that bend as they move."""

from __future__ import annotations

import numpy as np

import fem_lie as fl

SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))


def flying_beam() -> fl.Scene:
    """A soft beam that turns, flies and bends."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), SOFT, cells=6))
    beam.add_velocity(omega=(3, 1, -8), about=(0.2, 0, 0))
    beam.add_velocity((1.0, 0.0, 0.5))
    beam.velocities[:, 2] += 4.0 * np.sin(np.pi * beam.frames[:, 0, 0] / 0.5)
    return scene


def soft_pendulum() -> fl.Scene:
    """Two soft bars that fall."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.4, 0, 0), SOFT, cells=4))
    two = scene.add(fl.Beam.straight((0.4, 0, 0), (1, 0, 0), SOFT, cells=4))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(0, 1, 0.3)))
    return scene

"""The scenes whose first result is timed: ``python3 first_results.py SCENE`` computes one.

It stands alone, so that it runs with an installed package outside of a checkout.
"""

from __future__ import annotations

import sys

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)


def beam() -> None:
    """Statics of a cantilever of four cells."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.01, STEEL)
    rod = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.PointLoad(rod.point("end"), force=(0, 0, 100.0)))
    found = fl.statics(scene)
    assert 0 < found.position(rod.point("end"))[-1, 2] < 1


def shell() -> None:
    """Statics of a plate of three by three cells."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0), (3, 3))
    plate = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL)))
    plate.clamp("a=0")
    found = fl.statics(scene)
    assert -1 < found.position(plate.point("11"))[-1, 2] < 0


def two_beams() -> fl.Scene:
    """Two beams on ball joints, the second of which turns."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    section = fl.Section.rectangle(0.01, 0.01, STEEL)
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=4))
    two = scene.add(fl.Beam.straight((0.5, 0, 0), (0.5, 0.5, 0), section, cells=4))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Spherical(one.point("end"), two.point("start")))
    two.add_velocity(omega=(1, 0, -2), about=two.point("start"))
    return scene


def alpha() -> None:
    """Ten steps of generalised-alpha."""
    fl.GeneralisedAlpha().run(two_beams(), duration=0.01, step=1e-3)


def conserving() -> None:
    """Ten steps of the energy-momentum scheme."""
    fl.EnergyMomentum().run(two_beams(), duration=0.01, step=1e-3)


SCENES = {
    "statics of a beam": beam,
    "statics of a shell": shell,
    "generalised-α": alpha,
    "energy-momentum": conserving,
}

if __name__ == "__main__":
    SCENES[sys.argv[1]]()

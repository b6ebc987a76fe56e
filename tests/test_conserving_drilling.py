"""Shells of six parameters in conserving schemes: laws, other schemes, rotation without inertia."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl
from tests.test_composed import resumed_as_whole

TIME = 0.05
SCHEMES = {
    "energy-momentum": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(radius=0.8),
    "composed": fl.schemes.Composed(),
}
each = pytest.mark.parametrize("name", SCHEMES)
CELLS = ("quadrilateral", "triangle")


def sheet(cell: str = "quadrilateral") -> fl.Shell:
    """A bent strip of soft cells whose nodes have drilling rotation."""
    mesh = fl.mesh.parametric_surface(
        lambda a, b: (a, 0.4 * (b - 0.5), 0.1 * a * a), (2, 2), cell=cell
    )
    layer = fl.ShellSection.layer(0.03, fl.Material(4e6, 0.3, 1000.0))
    return fl.Shell(mesh, layer, drilling=True)


def flying(cell: str = "quadrilateral") -> fl.Scene:
    """Free, and turning."""
    scene = fl.Scene()
    scene.add(sheet(cell)).add_velocity(omega=(0.5, 2.0, 3.0), about=(0.5, 0, 0))
    return scene


def twisted() -> fl.Scene:
    """Clamped along an edge, with a moment about the normal that begins at once."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    shell = scene.add(sheet())
    shell.clamp("a=0")
    scene.add(fl.PointLoad(shell.points("a=1")[1], moment=(0.3, 0.2, -1.0)))
    return scene


def corner_of(scheme, scene: fl.Scene, step: float) -> tuple[np.ndarray, fl.Result]:
    """Where a corner is at the end."""
    (shell,) = scene.bodies
    result = scheme.run(scene, duration=TIME, step=step)
    return result.position(shell.points("a=1")[0])[-1], result


@each
@pytest.mark.parametrize("cell", CELLS)
def test_energy_and_momenta_are_exact(name, cell):
    _, result = corner_of(SCHEMES[name], flying(cell), 1e-3)
    assert result.balance_error < 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-10


@each
@pytest.mark.parametrize("scene", [flying, twisted])
def test_the_motion_of_generalised_alpha(name, scene):
    exact, _ = corner_of(fl.GeneralisedAlpha(), scene(), 1e-4)
    far, near = (corner_of(SCHEMES[name], scene(), step)[0] for step in (1e-3, 5e-4))
    assert np.linalg.norm(near - exact) < 3e-5
    assert np.linalg.norm(far - exact) < 1e-4


def test_rates_of_drilling_rotations_are_those_of_the_step():
    """They have no inertia: what the moment turns at once is turned in one step of any size."""
    found = [
        np.abs(corner_of(fl.EnergyMomentum(), twisted(), step)[1].velocities[1:, :, 5]).max()
        for step in (1e-3, 2.5e-4)
    ]
    assert found[1] < 5.0 * found[0]


def test_resumed_to_the_last_bit(tmp_path):
    plan = {"duration": 0.03, "step": 1e-3, "save_every": 3}
    scheme = SCHEMES["energy-momentum"]
    resumed_as_whole(scheme, twisted, plan, tmp_path / "run.h5")

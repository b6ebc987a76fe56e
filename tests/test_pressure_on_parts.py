"""Pressure on some cells of a body, and pressure that grows in time, by all schemes."""

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(2e9, 0.3, 1000.0)
LAYER = fl.ShellSection.layer(0.1, STEEL)
SECTION = fl.Section.rectangle(0.1, 0.1, STEEL)
SCHEMES = {
    "generalised-α": fl.GeneralisedAlpha(),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(radius=0.8),
}


def pushes(scene: fl.Scene) -> np.ndarray:
    """Forces of all pressures on the unloaded scene, global components, shape (n, 3)."""
    equations = fl.extend.Equations(scene, dynamics=False)
    H = equations.start.frames
    local = equations.prescribed(0.0).loads(H).reshape(-1, 6)
    return np.einsum("ni,nij->nj", local[:, :3], H[: len(local), 1:])


def scene_with(*items) -> fl.Scene:
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


def test_a_pressure_that_varies_is_that_at_the_cells_of_its_group():
    bare = fl.mesh.parametric_surface(lambda a, b: (2.0 * a, b, 0.0), (4, 1))
    mesh = fl.mesh.SurfaceMesh.from_cells(
        bare.points, bare.cells, bare.cell, groups={"half": [2, 3]}
    )
    shell = fl.Shell(mesh, LAYER)
    found = pushes(scene_with(shell, fl.loads.SurfacePressure(shell, lambda x: x[0], cells="half")))
    area = fl.AreaLoad(shell, lambda x: (0, 0, 1.25 if x[0] < 1.5 else 1.75), "half").nodal()
    np.testing.assert_allclose(found, area[:, :3], atol=1e-14)


def test_a_beam_under_pressure_on_some_of_its_cells():
    """``p (x_n − x_0) × w`` of these, half of each piece on each of its nodes."""
    mesh = fl.mesh.LineMesh.from_cells(
        np.outer([0.0, 0.5, 1.5, 2.0], [1, 0, 0]), [(0, 1), (1, 2), (2, 3)], groups={"far": [1, 2]}
    )
    beam = fl.Beam(mesh, SECTION, up=(0, 0, 1))
    found = pushes(scene_with(beam, fl.loads.PressureLoad(beam, 6.0, (0, 1, 0), cells="far")))
    np.testing.assert_allclose(
        found, np.outer([0, 3.0, 4.5, 1.5], beam.point(0).frame[2]), atol=1e-13
    )


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_free_beam_under_a_pressure_that_grows(scheme):
    """Everywhere the same over the mass: it flies straight, ``x = p t³/6 m``."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=3, up=(0, 0, 1))
    scene = scene_with(beam, fl.loads.PressureLoad(beam, 300.0, (0, 0, 1), history=lambda t: t))
    result = SCHEMES[scheme].run(scene, duration=0.5, step=0.01, progress=False)
    exact = 300.0 / (1000.0 * 0.01) * result.times**3 / 6
    moved = result.frames[:, :, 0] - result.frames[0, :, 0]
    np.testing.assert_allclose(
        moved[:, :, 2], np.tile(exact[:, np.newaxis], 4), atol=1e-3 * exact.max()
    )
    np.testing.assert_allclose(moved[:, :, :2], 0.0, atol=1e-6 * exact.max())


RUBBER = fl.ShellSection.layer(0.05, fl.Material(1e5, 0.3, 1000.0))


def saddle(a: float, b: float) -> tuple[float, float, float]:
    return a, b, 0.2 * a * b


SHELLS = {
    "five parameters": lambda: fl.Shell(fl.mesh.parametric_surface(saddle, (2, 2)), RUBBER),
    "drilling": lambda: fl.Shell(fl.mesh.parametric_surface(saddle, (2, 2)), RUBBER, drilling=True),
    "thin": lambda: fl.ThinShell(fl.mesh.smooth_patch(saddle, (2, 2)), RUBBER),
}


@pytest.mark.parametrize("kind", SHELLS)
def test_pressure_on_shells_in_conserving_steps(kind):
    """Hydrostatic pressure on a free shell: work and momenta balance, errors are of order two."""

    def run(steps: int) -> fl.Result:
        shell = SHELLS[kind]()
        scene = scene_with(shell, fl.loads.SurfacePressure(shell, 40.0, (0.0, 15.0, 60.0)))
        given = {"duration": 0.1, "step": 0.1 / steps, "progress": False}
        return fl.EnergyMomentum().run(scene, **given)

    coarse, middle, fine = (run(steps) for steps in (20, 40, 80))
    for result in (coarse, fine):
        assert result.balance_error < 1e-11
        assert max(result.momentum_error, result.angular_momentum_error) < 1e-11
    assert fine.total_energy[-1] > 0.1
    ends = [result.frames[-1, :, 0] for result in (coarse, middle, fine)]
    ratio = np.linalg.norm(ends[0] - ends[1]) / np.linalg.norm(ends[1] - ends[2])
    assert ratio == pytest.approx(4.0, rel=0.25)

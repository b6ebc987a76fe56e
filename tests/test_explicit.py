"""Explicit steps: momenta, order, the largest stable step, loads, interruption, bad input."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.combinations import free
from tests.scene_builder import build
from tests.test_composed import flying, resumed_as_whole
from tests.test_energy_momentum import SQUARE, plate
from tests.test_solids import brick
from tests.test_variational import spinning

SCHEME = fl.Explicit()
CABLE = fl.Section.from_stiffness([100.0] * 3 + [1e-4] * 3, mass=0.01)


def net(cells: int = 5, pinned: bool = True) -> tuple[fl.Scene, fl.Net]:
    """A square net that is hit in the middle; stretched by a tenth if its edges are pinned."""
    x = np.linspace(0, 1, cells + 1)
    positions = np.array([(a, b, 0) for a in x for b in x])
    grid = np.arange(len(positions)).reshape(cells + 1, cells + 1)
    cables = [list(row) for row in grid] + [list(column) for column in grid.T]
    body = fl.Net(positions, cables, CABLE, stretch=1.1 if pinned else 1.0)
    far = ((positions[:, :2] - 0.4) ** 2).sum(axis=1)
    body.velocities[:, 2] = 3.0 * np.exp(-far / 0.1)
    if not pinned:
        body.velocities *= 0.1
    scene = fl.Scene()
    scene.add(body)
    if pinned:
        edges = np.unique([*grid[[0, -1]].ravel(), *grid[:, [0, -1]].ravel()])
        body.pin(*(body.point(int(k)) for k in edges))
        body.velocities[edges] = 0.0
    return scene, body


def hermite() -> fl.Scene:
    """A cable of positions and slopes that flies."""
    scene = fl.Scene()
    rope = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), CABLE, cells=4))
    rope.velocities[:, 1] = np.sin(3 * rope.frames[:, 0, 0])
    rope.velocities[:, 2] = rope.frames[:, 0, 0]
    return scene


def bent(name: str) -> fl.Scene:
    """A body of points that are two nodes each; it flies, turns and vibrates."""
    built = build(free(name))
    body = built.bodies["body"]
    bends = body.frames[: body.model.points_count, 0] @ (3.0, 1.0, 0.5)
    body.velocities[: body.model.points_count, 2] += 2.0 * np.sin(bends)
    built.scene.gravity[:] = 0.0
    return built.scene


FREE = {
    "net": lambda: net(pinned=False)[0],
    "positions and position gradients": hermite,
    "beam": flying,
    "rigid body": spinning,
    "shell": lambda: plate("MITC4")[0],
    "ANCF beam": lambda: bent("ANCF beam"),
    "thin shell": lambda: bent("thin shell"),
    "ANCF shell": lambda: bent("ANCF shell"),
}


@pytest.mark.parametrize("name", FREE)
def test_momenta_and_energy(name):
    """Momenta are exact, and the energy stays about where it was."""
    scene = FREE[name]()
    limit = SCHEME.stable_step(scene)
    step = 1e-3 if np.isinf(limit) else 0.5 * limit
    result = SCHEME.run(scene, duration=2000 * step, step=step, save_every=10)
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12
    energy = result.total_energy
    assert np.ptp(energy) <= 0.05 * energy[0]
    halves = energy[:100], energy[100:]
    assert np.ptp(halves[1]) <= 1.5 * np.ptp(halves[0]) + 1e-12 * energy[0]
    if name != "rigid body":
        assert np.ptp(result.kinetic) >= 1e-3 * result.kinetic[0]


SCENES = FREE | {"net": lambda: net()[0]}


def test_a_free_body_turns_as_in_the_variational_scheme():
    """Both are that of Moser and Veselov."""
    plan = {"duration": 1.0, "step": 1e-2, "save_every": 20}
    here, there = SCHEME.run(spinning(), **plan), fl.schemes.Variational().run(spinning(), **plan)
    np.testing.assert_allclose(here.frames, there.frames, atol=1e-12)
    assert here.energy_error <= 1e-13


POINTS = {
    "ANCF beam": lambda given: fl.AncfBeam(
        fl.mesh.curve(lambda s: (s, 0, 0), 8), given, up=(0, 0, 1)
    ),
    "thin shell": lambda given: fl.ThinShell(fl.mesh.smooth_patch(*FLAT), LAYER),
    "ANCF shell": lambda given: fl.AncfShell(fl.mesh.smooth_patch(*FLAT), LAYER),
}
FLAT = (lambda a, b: (a, 0.1 * b, 0.0), (8, 1))
LAYER = fl.ShellSection.layer(0.01, fl.Material(1e7, 0.0, 1000.0))


@pytest.mark.parametrize("name", POINTS)
def test_a_strip_of_points_vibrates_as_a_beam(name):
    """A cantilever that is hit: the tip after half a period, against the consistent mass."""
    ends = []
    for scheme, step in ((SCHEME, 2e-5), (fl.GeneralisedAlpha(), 1e-3)):
        body = POINTS[name](fl.Section.rectangle(0.1, 0.01, fl.Material(1e7, 0.0, 1000.0)))
        body.clamp(*((body.point("start"),) if name == "ANCF beam" else ("a=0",)))
        x = body.frames[: body.model.points_count, 0, 0]
        body.velocities[: body.model.points_count, 2] = 0.1 * x**2
        scene = fl.Scene()
        scene.add(body)
        result = scheme.run(scene, duration=0.15, step=step, save_every=10**6)
        ends.append(result.frames[-1][: body.model.points_count, 0])
    moved = np.abs(ends[1][:, 2]).max()
    assert moved > 3e-3
    np.testing.assert_allclose(ends[0], ends[1], atol=0.03 * moved)


@pytest.mark.parametrize(
    "name", ["net", "positions and position gradients", "beam", "thin shell", "ANCF beam"]
)
def test_second_order(name):
    """In frames and velocities, by halved steps."""
    step = 0.2 * SCHEME.stable_step(FREE[name]())
    ends = [
        SCHEME.run(FREE[name](), duration=32 * step, step=step / parts, save_every=10**6)
        for parts in (1, 2, 4)
    ]
    for what in ("frames", "velocities"):
        far, near = (
            np.abs(getattr(a, what)[-1] - getattr(b, what)[-1]).max() for a, b in pairwise(ends)
        )
        assert np.log2(far / near) == pytest.approx(2.0, abs=0.1)


def test_the_stable_step_of_a_row_of_bars():
    """It is that of the highest frequency, ``2/ω = ℓ √(μ/EA)``, if bending is none."""
    soft = fl.Section.from_stiffness([100.0] * 3 + [1e-9] * 3, mass=0.01)
    positions = np.zeros((9, 3))
    positions[:, 0] = np.arange(9) / 8
    scene = fl.Scene()
    body = scene.add(fl.Net(positions, [range(9)], soft))
    body.pin(body.point(0), body.point(8))
    limit = SCHEME.stable_step(scene)
    assert limit == pytest.approx(0.125 * np.sqrt(0.01 / 100.0), rel=1e-3)


@pytest.mark.parametrize("courant", [0.9])
def test_courant_number(courant):
    """Steps just below the largest one are stable for long, those well above would not be."""
    scene, _ = net(4)
    limit = SCHEME.stable_step(scene)
    step = courant * limit
    result = SCHEME.run(scene, duration=20_000 * step, step=step, save_every=100)
    energy = result.total_energy
    assert np.abs(energy / energy[0] - 1.0).max() <= 0.1
    assert np.abs(np.mean(energy[-50:]) / np.mean(energy[:50]) - 1.0) <= 0.02


def test_steps_that_are_not_stable():
    scene, _ = net()
    limit = SCHEME.stable_step(scene)
    with pytest.raises(ValueError, match=r"stable step, at most .* around node \d+ of net 1, got"):
        SCHEME.run(scene, duration=1.1 * limit, step=1.1 * limit)


DAMPED = [name for name in FREE if name not in ("rigid body", "shell")]


@pytest.mark.parametrize("name", DAMPED)
def test_damping_of_mass(name):
    """Momenta of what flies fall as ``exp(−α t)``, exactly; the balance is of second order."""
    scene = FREE[name]()
    step = 0.4 * SCHEME.stable_step(scene)
    rate = 1e-3 / step
    for body in scene.bodies:
        body.model.damping = fl.sections.Damping(mass=rate)
    runs = [
        SCHEME.run(scene, duration=200 * step, step=step / parts, save_every=10 * parts)
        for parts in (1, 2)
    ]
    for run in runs:
        left = np.exp(-rate * run.times)[:, np.newaxis]
        assert left[-1] < 0.9
        for found in (run.momentum, run.angular_momentum):
            np.testing.assert_allclose(found, left * found[0], atol=1e-12 * np.abs(found).max())
        assert run.balance[-1, 1] > 0.0
    assert runs[1].balance_error <= 0.3 * runs[0].balance_error


def test_loads_and_supports():
    """Work of gravity and supports is accounted for step by step, in the compiled loop."""
    scene, _ = net()
    scene.gravity[:] = (0, 0, -9.81)
    step = 0.5 * SCHEME.stable_step(scene)
    result = SCHEME.run(scene, duration=500 * step, step=step, save_every=7)
    assert np.abs(result.impulses[-1]).max() > 1e-4
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def test_loads_in_time():
    """They are known at the ends of steps."""
    scene, body = net()
    push = fl.PointLoad(body.point(14), force=(0, 0, 0.1), history=lambda t: np.sin(40 * t))
    scene.add(push)
    step = 0.1 * SCHEME.stable_step(scene)
    runs = [
        SCHEME.run(scene, duration=100 * step, step=step / parts, save_every=10**6)
        for parts in (1, 2, 4)
    ]
    far, near = (np.abs(a.frames[-1] - b.frames[-1]).max() for a, b in pairwise(runs))
    assert np.log2(far / near) == pytest.approx(2.0, abs=0.1)
    assert runs[0].momentum_error <= 1e-12
    assert runs[1].balance_error <= 0.3 * runs[0].balance_error
    still = SCHEME.run(net()[0], duration=100 * step, step=step, save_every=10**6)
    assert np.abs(runs[0].frames[-1] - still.frames[-1]).max() > 1e-4


@pytest.mark.parametrize("name", ["net", "beam", "thin shell"])
def test_resumed_to_the_last_bit(tmp_path, name):
    scene = SCENES[name]
    step = 0.5 * SCHEME.stable_step(scene())
    plan = {"duration": 30 * step, "step": step, "save_every": 3}
    resumed_as_whole(SCHEME, scene, plan, tmp_path / "run.h5")


# --- bad input ---


def test_damping_by_strain_rates():
    scene, damping = fl.Scene(), fl.sections.Damping(stiffness=1e-3)
    scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), CABLE, cells=2, damping=damping))
    with pytest.raises(ValueError, match=r"Explicit does not support damping by strain rates"):
        SCHEME.run(scene, duration=1e-3, step=1e-4)


def test_damping_that_differs_around_a_frame():
    scene = fl.Scene()
    first, second = (
        scene.add(fl.Beam.straight((x, 0, 0), (x + 1, 0, 0), SQUARE, cells=2, damping=damping))
        for x, damping in ((0, fl.sections.Damping(mass=1.0)), (1, fl.sections.Damping()))
    )
    scene.add(fl.joints.RigidLink(first.point("end"), second.point("start")))
    with pytest.raises(ValueError, match=r"differs around node \d of beam 1"):
        SCHEME.run(scene, duration=1e-5, step=1e-7)


def test_no_stable_step():
    """Mass of quadratic tetrahedra at their corners, which lumping makes less than none."""
    scene = fl.Scene()
    scene.add(brick((1, 1, 1), cell="tetrahedron", degree=2))
    with pytest.raises(ValueError, match=r"no explicit step is stable .* no mass .* node \d+ of "):
        SCHEME.stable_step(scene)


def test_steps_that_change():
    with pytest.raises(ValueError, match=r"constant steps.* got AdaptiveStep"):
        SCHEME.run(net()[0], duration=0.1, step=fl.schemes.AdaptiveStep(1e-4))


def test_forces_in_the_loop_are_those_of_the_equations():
    """The loop sums cells by itself, in the same order."""
    scene, _ = net()
    equations = SCHEME._equations(scene)
    run = SCHEME._integration(equations, 0.5 * SCHEME.stable_step(scene))
    run.start()
    n = equations.unknowns.moving
    rest, none, r = np.zeros((n, 6)), np.zeros(0), np.zeros(6 * n)
    equations.residual(fl.extend.TimeState(run.H, rest, rest, none), none, r)
    r[equations.unknowns.held.ravel()] = 0.0
    assert np.abs(r).max() > 0.0
    np.testing.assert_array_equal(run.r, r)

"""Elastic forces of a step on cells of places: work, resultant, moment, and whose gradient."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.vector_cells.cells import Energies, Nodes, energies_at
from fem_lie.solve.conserving.vector_cells.position_cells import add_position_cells

STIFFNESS = 1e3


def started(clamped: bool) -> Run:
    """A run of two threads that cross and are bent, or of a cable that is clamped."""
    scene, s = fl.Scene(), np.linspace(-1.0, 1.0, 13)
    one = np.column_stack([s, 0.2 * s**2, 0.1 * np.sin(3.0 * s)])
    section = fl.Section.from_stiffness([STIFFNESS] * 3 + [2.0] * 3, mass=1.0)
    if clamped:
        rope = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 12)
        cable = fl.Cable(rope, section, formulation=fl.elements.DiscreteCable())
        scene.add(cable)
        cable.clamp(cable.point("start"))
    else:
        points = np.vstack([one, np.delete(one, 6, axis=0)[:, [1, 0, 2]]])
        threads = [range(13), [*range(13, 19), 6, *range(19, 25)]]
        own = fl.elements.DiscreteCable(natural=True)
        scene.add(fl.Net(points, threads, section, formulation=own))
    scheme = fl.EnergyMomentum()
    run = Run(scheme.options(), scheme.equations(scene), 1e-3)
    run.start()
    return run


def energy(run: Run, step: np.ndarray) -> float:
    """Of all cells, where nodes have gone by these increments (n, 6)."""
    H, W = run.s.H.copy(), np.zeros(len(run.s.W))
    H[: len(step), 0] += step[:, :3]
    energies_at(run.model.rows, H, run.s.rest, W)
    return float(W.sum())


def forces(run: Run, step: np.ndarray) -> np.ndarray:
    """On places (n, 3), over a step by these increments (n, 6)."""
    out, (W, account) = np.zeros_like(step), (run.s.W, run.s.account)
    energies = Energies(W, account, np.zeros_like(W), np.zeros_like(W))
    add_position_cells(
        run.model.rows, Nodes(run.s.H, run.s.rest, step), energies, (0.0, 0.0, 0.0), out
    )
    assert not out[:, 3:].any()
    np.testing.assert_allclose(energies.work, energies.end - W, atol=1e-12 * STIFFNESS)
    return out[:, :3]


def steps(run: Run, size: float, count: int) -> np.ndarray:
    """Increments (count, n, 6) of places, at random."""
    found = np.zeros((count, len(run.this.step), 6))
    found[:, :, :3] = size * np.random.default_rng(3).standard_normal(found[:, :, :3].shape)
    return found


@pytest.mark.parametrize("clamped", [False, True])
def test_work_is_the_change_of_energy(clamped):
    """Of large steps; free cells have neither resultant nor moment about the mean."""
    run = started(clamped)
    for step in steps(run, 0.02, 5):
        f = forces(run, step)
        change = energy(run, step) - energy(run, np.zeros_like(step))
        assert change > 1e-3 * STIFFNESS
        assert abs((f * step[:, :3]).sum() - change) < 1e-12 * change
        if not clamped:
            mean = run.s.H[: len(step), 0] + 0.5 * step[:, :3]
            size = np.abs(f).sum()
            assert np.abs(f.sum(axis=0)).max() < 1e-14 * size
            assert np.abs(np.cross(mean, f).sum(axis=0)).max() < 1e-14 * size


@pytest.mark.parametrize("clamped", [False, True])
def test_forces_of_a_small_step_are_the_gradient(clamped):
    """In the middle of the step."""
    run = started(clamped)
    step, along = steps(run, 1e-3, 2)
    found, ε = (forces(run, step) * along[:, :3]).sum(), 1e-3
    ends = (energy(run, 0.5 * step + sign * ε * along) for sign in (1.0, -1.0))
    slope = (next(ends) - next(ends)) / (2.0 * ε)
    assert abs(found - slope) < 0.02 * abs(slope)


def test_a_rigid_step_has_no_forces():
    """Of threads that are naturally as they are: a third of a turn about any axis, and on."""
    run = started(clamped=False)
    turn = lie.so3_exp(2.0 * np.pi / 9.0 * np.array([2.0, -1.0, 2.0]))
    step, before = np.zeros_like(run.this.step), run.s.H[: len(run.this.step), 0]
    step[:, :3] = before @ turn.T - before + np.array([0.3, -2.0, 1.0])
    assert np.abs(forces(run, step)).max() < 1e-11 * STIFFNESS

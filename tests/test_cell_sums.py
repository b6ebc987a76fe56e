"""Sums over cells of any stencil, and forces over a step on cells of positions."""

from __future__ import annotations

from itertools import pairwise

import numba
import numpy as np
import pytest
from numba import types

import fem_lie as fl
from demos.space_net import square_net
from fem_lie import lie
from fem_lie.forms.cell_sums import CellSum, Pattern
from fem_lie.forms.cells import VISCOUS, CellArrays, viscous_forces
from fem_lie.solve.conserving.run import Run
from fem_lie.solve.conserving.vector_cells.cells import Energies, Nodes, energies_at
from fem_lie.solve.conserving.vector_cells.position_cells import add_position_cells
from fem_lie.system.parts import Parts, Sharing
from tests.test_point_nodes import GRAVITY

DOUBLES = types.CPointer(types.float64)
UFCX = types.void(
    DOUBLES, DOUBLES, DOUBLES, DOUBLES, types.CPointer(types.int32), types.CPointer(types.uint8)
)
"""W = ½ k |x₀ − 2 x₁ + x₂|² of three successive nodes; k is a number of the cell, twice as much
where the constant says so."""


@numba.cfunc(UFCX)
def energy_kernel(A, w, c, x, entity, permutation):
    q, value = numba.carray(w, (37,)), numba.carray(A, (1,))
    for j in range(3):
        e = q[j] - 2.0 * q[12 + j] + q[24 + j]
        value[0] += 0.5 * c[0] * q[36] * e * e


@numba.cfunc(UFCX)
def force_kernel(A, w, c, x, entity, permutation):
    q, r = numba.carray(w, (37,)), numba.carray(A, (3, 6))
    for j in range(3):
        e = c[0] * q[36] * (q[j] - 2.0 * q[12 + j] + q[24 + j])
        r[0, j] += e
        r[1, j] -= 2.0 * e
        r[2, j] += e


@numba.cfunc(UFCX)
def matrix_kernel(A, w, c, x, entity, permutation):
    q, K = numba.carray(w, (37,)), numba.carray(A, (3, 6, 3, 6))
    for a in range(3):
        for b in range(3):
            factor = (-2.0 if a == 1 else 1.0) * (-2.0 if b == 1 else 1.0)
            for j in range(3):
                K[a, j, b, j] += c[0] * q[36] * factor


COUNT = 7
STENCILS = {
    "overlapping triples": np.array([[i, i + 1, i + 2] for i in range(COUNT - 2)]),
    "anywhere": np.array([[6, 0, 3], [3, 5, 6], [2, 1, 4]]),
    "none": np.empty((0, 3), dtype=np.int64),
}


def sums(cells, kernel, separate):
    values = np.zeros((len(cells), 37))
    values[:, 36] = 1.0 + np.arange(len(cells))
    values = values[:, 36:] if separate else values
    given = values, np.array([2.0]), np.zeros((len(cells), 1))
    return CellSum(cells, kernel.address, *given, written=36 if separate else 0)


@pytest.mark.parametrize("separate", [False, True], ids=["in a workspace", "separate"])
@pytest.mark.parametrize("cells", STENCILS.values(), ids=STENCILS.keys())
def test_any_stencil(cells, separate):
    """Energy, forces and matrix against dense sums, all from the same quadratic form."""
    H = np.random.default_rng(4).normal(size=(COUNT, 4, 3))
    dense = np.zeros((COUNT, COUNT))
    for k, cell in enumerate(cells):
        second = np.zeros(COUNT)
        second[cell] = 1.0, -2.0, 1.0
        dense += 2.0 * (1.0 + k) * np.outer(second, second)
    x = H[:, 0]
    energy = sums(cells, energy_kernel, separate).scalar(H)
    assert energy == pytest.approx(0.5 * np.vdot(x, dense @ x), rel=1e-13)
    forces = np.zeros(6 * COUNT)
    sums(cells, force_kernel, separate).add_vector(H, forces)
    expected = np.zeros((COUNT, 6))
    expected[:, :3] = dense @ x
    np.testing.assert_allclose(forces.reshape(-1, 6), expected, atol=1e-12)
    pattern = Pattern.of(cells, COUNT)
    sum_of_cells = sums(cells, matrix_kernel, separate)
    blocks = sum_of_cells.matrix(H, pattern)
    found = np.zeros((COUNT, 6, COUNT, 6))
    rows = np.repeat(np.arange(COUNT), np.diff(pattern.indptr))
    for row, column, block in zip(rows, pattern.indices, blocks, strict=True):
        found[row, :, column] = block
    wanted = np.einsum("ij,ab->iajb", dense, np.diag([1.0, 1, 1, 0, 0, 0]))
    np.testing.assert_allclose(found, wanted, atol=1e-13)


def test_pattern():
    """Each node with itself and with all with which it shares a cell, in order."""
    pattern = Pattern.of(np.array([[4, 1], [1, 2]]), 5)
    rows = [pattern.indices[a:b].tolist() for a, b in pairwise(pattern.indptr)]
    assert rows == [[0], [1, 2, 4], [1, 2], [3], [1, 4]]
    assert pattern.pair_index.tolist() == [8, 7, 3, 1, 1, 2, 4, 5]


def test_too_little_data_is_refused():
    with pytest.raises(ValueError, match="36"):
        CellSum(np.array([[0, 1, 2]]), 1, np.zeros((1, 20)), np.zeros(1), np.zeros((1, 1)))


# --- cells of any number of nodes, in compiled loops ---

NODES = (3, 150)


def dashpots(count: int):
    """Compiled kernel of a cell whose nodes are damped, by a number each, without each other."""

    @numba.cfunc(UFCX)
    def kernel(A, w, c, x, entity, permutation):
        v, r = numba.carray(w, (18 * count,))[12 * count :], numba.carray(A, (6 * count,))
        for i in range(6 * count):
            r[i] += c[0] * (1 + i // 6) * v[i]

    return kernel


def test_viscous_forces_have_space_for_all_nodes_of_a_cell():
    """Small cells beside large ones; nothing is written beyond what a cell has."""
    kernels, constant, x = [dashpots(n) for n in NODES], np.array([2.0]), np.zeros(1)
    packed = [np.zeros(18 * n) for n in NODES]
    none, one = np.zeros((len(NODES), 4), dtype=np.int64), np.zeros(len(NODES), dtype=np.int64)
    kernel, w, c, at = (none.copy() for _ in range(4))
    kernel[:, VISCOUS] = [each.address for each in kernels]
    w[:, VISCOUS] = [each.ctypes.data for each in packed]
    c[:, VISCOUS], at[:, VISCOUS] = constant.ctypes.data, 12 * np.array(NODES)
    rng, first = np.random.default_rng(0), np.cumsum([0, *NODES])
    nodes = np.concatenate([rng.permutation(max(NODES))[:n] for n in NODES])
    table = CellArrays(kernel, w, c, at, one + x.ctypes.data, one, one + 6, one, first, nodes)
    H, v = np.zeros((max(NODES), 4, 3)), rng.normal(size=(max(NODES), 6))
    F = np.full((len(nodes), 6), np.nan)
    viscous_forces(table, H, v, F)
    factors = np.concatenate([2.0 * np.arange(1, n + 1) for n in NODES])
    np.testing.assert_array_equal(F, factors[:, np.newaxis] * v[nodes])


def test_shares_of_positions_sum_to_one():
    """To their columns A and K have the same blocks, and the sum is that of parts kept separate."""
    scene = square_net(2, cells=3)
    scene.gravity = (0, 0, -GRAVITY)
    equations = fl.extend.Equations(scene, dynamics=True)
    n, m, rng = equations.unknowns.moving, equations.unknowns.m, np.random.default_rng(3)
    v, a = rng.normal(size=(2, n, 6))
    state = fl.extend.TimeState(equations.start.frames, v, a, rng.normal(size=m))
    forces = equations.residual(state, np.ones(m), np.empty(equations.unknowns.size))
    plans = (
        fl.extend.Plan(0.1 * rng.normal(size=(n, 6)), np.ones(m), mass=3.0, damping=2.0),
        fl.extend.Plan(np.zeros((n, 6)), np.ones(m), mass=3.0),
        fl.extend.Plan(np.zeros((n, 6)), at_rest=0.5),
    )
    tangent, found = equations.system.tangent, []
    for separate in (False, True):
        if separate:
            tangent.separate_blocks()
        assert tangent.parts.separate == separate
        for plan in plans:
            equations.fill(state, forces, plan)
            found.append(equations.matrix.csr[0].copy())
    for one, two in zip(found[:3], found[3:], strict=True):
        np.testing.assert_allclose(one, two, rtol=0.0, atol=1e-13 * np.abs(two).max())
    # all but the masses at the corners are positions
    pairs = len(equations.matrix.indices)
    parts = Parts(equations.unknowns.kinds, equations.matrix.indices, Sharing.POSITIONS)
    assert len(parts.blocks) < 1.2 * pairs


# --- forces of a step on cells of positions: work, resultant, moment, and whose gradient ---


STIFFNESS = 1e3


def started(clamped: bool) -> Run:
    """A run of two cables that cross and are bent, or of a cable that is clamped."""
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
        cables = [range(13), [*range(13, 19), 6, *range(19, 25)]]
        own = fl.elements.DiscreteCable(natural=True)
        scene.add(fl.Net(points, cables, section, formulation=own))
    scheme = fl.EnergyMomentum()
    run = Run(scheme.options(), scheme.equations(scene), 1e-3)
    run.start()
    return run


def energy(run: Run, step: np.ndarray) -> float:
    """Of all cells, where nodes have gone by these increments (n, 6)."""
    H, W = run.s.H.copy(), np.zeros(len(run.s.W))
    H[: len(step), 0] += step[:, :3]
    energies_at(run.model.vector_cells, H, run.s.rest, W)
    return float(W.sum())


def forces(run: Run, step: np.ndarray) -> np.ndarray:
    """On positions (n, 3), over a step by these increments (n, 6)."""
    out, (W, account) = np.zeros_like(step), (run.s.W, run.s.account)
    energies = Energies(W, account, np.zeros_like(W), np.zeros_like(W))
    add_position_cells(
        run.model.vector_cells, Nodes(run.s.H, run.s.rest, step), energies, (0.0, 0.0, 0.0), out
    )
    assert not out[:, 3:].any()
    np.testing.assert_allclose(energies.work, energies.end - W, atol=1e-12 * STIFFNESS)
    return out[:, :3]


def steps(run: Run, size: float, count: int) -> np.ndarray:
    """Increments (count, n, 6) of positions, at random."""
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
    """Of cables that are naturally as they are: a third of a turn about any axis, and on."""
    run = started(clamped=False)
    turn = lie.so3_exp(2.0 * np.pi / 9.0 * np.array([2.0, -1.0, 2.0]))
    step, before = np.zeros_like(run.this.step), run.s.H[: len(run.this.step), 0]
    step[:, :3] = before @ turn.T - before + np.array([0.3, -2.0, 1.0])
    assert np.abs(forces(run, step)).max() < 1e-11 * STIFFNESS

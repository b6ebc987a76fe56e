"""Records and arrays that compiled code reads by their addresses are those that were packed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

import fem_lie as fl
from demos.double_pendulum import pendulum
from fem_lie._jit import compiled
from fem_lie._jit.packed_arrays import (
    Frames,
    Integers1,
    Integers2,
    Numbers1,
    PackedArrays,
    unpacking,
)
from fem_lie._jit.records import Fields, block_of
from fem_lie.forms.cells import Cells
from fem_lie.solve.conserving.model import (
    incidences_of,
    model_of,
    start_state,
    step_workspace,
    vector_cells_of,
)
from fem_lie.solve.conserving.step import packing, records
from fem_lie.system import System
from tests.random_scenes import CONSERVING, random_scene
from tests.scene_builder import build


def leaves(record: Any, name: str) -> Iterator[tuple[str, Any]]:
    """All that is no record in a record, by its names."""
    if not isinstance(record, tuple):
        yield name, record
        return
    names = getattr(record, "_fields", range(len(record)))
    for field, value in zip(names, record, strict=True):
        yield from leaves(value, f"{name}.{field}")


@pytest.fixture(scope="module")
def given() -> dict[str, Any]:
    """Records of a scene with beams, a joint and springs."""
    scene = build(random_scene(0, replace(CONSERVING, steps=1))).scene
    equations = fl.extend.Equations(scene, dynamics=True)
    cells = Cells(list(equations.arrays.assemblies))
    incidences = incidences_of(equations, current_jacobian=True)
    rows = vector_cells_of(equations)
    room = equations, cells, rows, incidences
    return {
        "model": model_of(equations, cells, rows, records.Scheme(1e-3, 0.1, 0.9), incidences),
        "state": start_state(*room, dissipates=True),
        "step": step_workspace(*room, dissipates=True),
    }


@compiled
def model_arrays(table: np.ndarray) -> records.Model:
    return packing.model_of(table)


@compiled
def state_arrays(table: np.ndarray) -> records.State:
    return packing.state_of(table)


@compiled
def step_arrays(table: np.ndarray) -> records.Step:
    return packing.step_of(table)


@pytest.mark.parametrize("name", ["model", "state", "step"])
def test_compiled_code_reads_each_record_as_it_was_packed(given, name):
    """Every field has the name, the shape and the position in memory that it has in Python."""
    packed = packing.Packed(**given)
    read = {"model": model_arrays, "state": state_arrays, "step": step_arrays}[name](
        getattr(packed, name)
    )
    wanted, found = dict(leaves(given[name], name)), dict(leaves(read, name))
    assert found.keys() == wanted.keys()
    for field, value in wanted.items():
        if isinstance(value, Fields):
            value = block_of(value)
        if not isinstance(value, np.ndarray):
            assert found[field] == value, field
            continue
        assert found[field].shape == value.shape and found[field].dtype == value.dtype, field
        if value.size:
            assert found[field].ctypes.data == value.ctypes.data, field


# --- arrays passed by their addresses, and sums computed with them in one call ---


@pytest.mark.parametrize(
    "array", [np.zeros((4, 4))[:, :2], np.zeros(3, dtype=np.int32)], ids=["strided", "int32"]
)
def test_what_is_not_as_compiled_code_reads_it_is_refused(array):
    with pytest.raises(TypeError, match="contiguous doubles or integers"):
        PackedArrays([array])


class Inner(NamedTuple):
    x: Numbers1
    cells: Integers2


class Outer(NamedTuple):
    H: Frames
    sees: bool
    count: int
    h: float
    inner: Inner
    joints: tuple[Numbers1, Integers1]


unpacked = unpacking(Outer)


@compiled
def total(table: np.ndarray) -> float:
    this = unpacked(table)
    this.H[1, 2, 1] = this.h
    size = this.H.shape[0] * this.count if this.sees else 0
    return size + this.inner.x[3] + this.inner.cells[2, 1] + this.joints[1][0] + len(this.joints[0])


def test_compiled_code_reads_and_writes_records_by_their_annotations():
    """Arrays, numbers, records within records; numbers may change, arrays stay."""
    H, x, cells = np.zeros((3, 4, 3)), np.array([0.0, 0.0, 0.0, 0.5]), np.arange(6).reshape(3, 2)
    record = Outer(H, True, 7, 0.25, Inner(x, cells), (np.zeros(2), np.array([100])))
    fixed = PackedArrays(record)
    assert total(fixed.addresses) == 21 + 0.5 + 5 + 100 + 2
    assert H[1, 2, 1] == 0.25
    assert np.count_nonzero(H) == 1
    fixed.set(record._replace(sees=False, h=-1.5))
    assert total(fixed.addresses) == 0.5 + 5 + 100 + 2
    assert H[1, 2, 1] == -1.5


def moving_system() -> tuple[System, tuple[np.ndarray, ...]]:
    """Two hinged bars with gravity, a load in time and a spring, in motion."""
    scene, one, two = pendulum(3)
    scene.gravity = np.array((0.0, 0.0, -9.81))
    scene.add(fl.PointLoad(two.point("end"), force=(1.0, 2.0, 3.0), history=lambda t: 1.0 + t))
    scene.add(fl.PointLoad(one.point("end"), moment=(0.3, 0.2, 0.1)))
    system = System(scene, dynamics=True)
    rng = np.random.default_rng(1)
    H = system.frames.copy()
    H[: system.count, 0] += 1e-3 * rng.normal(size=(system.count, 3))
    v, a = rng.normal(size=(2, system.count, 6))
    return system, (H, v, a, rng.normal(size=system.m), np.ones(system.m))


@pytest.mark.parametrize("time", [0.0, 0.7])
def test_residual_in_one_call_is_the_sum_of_its_parts(time):
    """Bit for bit, also when loads have changed."""
    system, state = moving_system()
    assert system.terms.all_in_tables
    system.set_time(time)
    r, parts = np.empty((2, system.size))
    now, scale = fl.extend.TimeState(*state[:4]), state[4]
    system.with_reactions(now, scale, r)
    system.applied(now, scale, parts)
    system.terms.add_forces(now.H, parts)
    assert np.array_equal(r, parts)


def test_cells_whose_nodes_follow_others_are_in_the_same_call():
    """Forces of cells with attached nodes equal those of each term."""
    scene, section = fl.Scene(), fl.Section.tube(2e-3, 3e-3, fl.Material(2e11, 0.3, 7850.0))
    corner = np.array((0.4, 0.0, 0.0))
    one, other = (
        scene.add(fl.Beam.straight(*ends, section, cells=3))
        for ends in ((np.zeros(3), corner), (corner, corner + np.array((0.0, 0.2, 0.1))))
    )
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.RigidLink(one.point("end"), other.point("start")))
    system = System(scene, dynamics=True)
    assert system.in_one_sum
    assert [term.attached_cells is None for term in system.terms] == [False]
    rng = np.random.default_rng(2)
    H = system.frames.copy()
    H[: system.count, 0] += 1e-3 * rng.normal(size=(system.count, 3))
    v, a = rng.normal(size=(2, system.count, 6))
    now, scale = fl.extend.TimeState(H, v, a, rng.normal(size=system.m)), np.ones(system.m)
    r, parts = np.empty((2, system.size))
    system.with_reactions(now, scale, r)
    system.applied(now, scale, parts)
    for term in system.terms:
        term.add_forces(H, parts[: 6 * system.count].reshape(-1, 6))
    np.testing.assert_allclose(r, parts, rtol=0.0, atol=1e-13 * np.abs(parts).max())


def test_rows_are_what_the_equations_report():
    """Joints, invariants and energies of a run, from its frames, velocities and multipliers."""
    scene, one, _ = pendulum(1)
    scene.gravity = np.array((0.0, -9.81, 0.0))
    scene.add(
        fl.PointLoad(one.point("end"), force=(0.0, 0.0, 1.0), history=lambda t: np.sin(50 * t))
    )
    result = fl.GeneralisedAlpha().run(scene, duration=5e-3, step=1e-4, progress=False)
    equations = fl.extend.Equations(scene, dynamics=True)
    system = equations.system
    H = np.concatenate([result.frames[-1], system.frames[system.count :]])
    v, invariants = result.velocities[-1], np.empty(7)
    potential = system.report(H, v, invariants)
    np.testing.assert_allclose(result.potential[-1], potential, rtol=1e-12)
    np.testing.assert_allclose(result.kinetic[-1], invariants[0], rtol=1e-12)
    np.testing.assert_allclose(result.angular_momentum[-1], invariants[4:], rtol=1e-12)
    np.testing.assert_allclose(result.elastic[-1], system.terms.energy(H), rtol=1e-12)
    violations = equations.report(H, v).joints.violations
    np.testing.assert_allclose(result.joint_violations[-1], violations, rtol=0, atol=1e-15)

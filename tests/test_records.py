"""Records at the door of compiled code: what is read there is what was packed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.forms.cells import Cells
from fem_lie.solve.conserving.model import (
    cells_of_rows,
    incidences_of,
    model_of,
    start_state,
    step_workspace,
)
from fem_lie.solve.conserving.step import packing, records
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
    cells = Cells(list(equations.tables.assemblies))
    incidences = incidences_of(equations, follows=True)
    rows = cells_of_rows(equations)
    room = equations, cells, rows, incidences
    return {
        "model": model_of(equations, cells, rows, records.Scheme(1e-3, 0.1, 0.9), incidences),
        "state": start_state(*room, dissipates=True),
        "step": step_workspace(*room, dissipates=True),
    }


@pytest.mark.parametrize("name", ["model", "state", "step"])
def test_compiled_code_reads_each_record_as_it_was_packed(given, name):
    """Every field has the name, the shape and the place in memory that it has in Python."""
    packed = packing.Packed(**given)
    read = {
        "model": packing.model_of,
        "state": packing.state_of,
        "step": packing.step_of,
    }[name](getattr(packed, name))
    wanted, found = dict(leaves(given[name], name)), dict(leaves(read, name))
    assert found.keys() == wanted.keys()
    for field, value in wanted.items():
        if not isinstance(value, np.ndarray):
            assert found[field] == value, field
            continue
        assert found[field].shape == value.shape and found[field].dtype == value.dtype, field
        if value.size:
            assert found[field].ctypes.data == value.ctypes.data, field

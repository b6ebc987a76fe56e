"""Memory of a run of a conserving scheme, and what of the scene its steps see."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.balances import TOTAL
from fem_lie.forms.cells import Cells
from fem_lie.scene.pressure import Pressure
from fem_lie.solve.conserving.step.records import Leaders, Model, Pieces, Scheme, State, Step
from fem_lie.solve.motion.convergence import ROTATION
from fem_lie.system import System
from fem_lie.system.acting import supported
from fem_lie.system.nodes.inertia import Inertia
from fem_lie.system.nodes.loads import Loads


def start_state(system: System, cells: Cells) -> State:
    """At rest at the frames of the start."""
    z = np.zeros
    n, m = system.count, system.m
    return State(
        H=system.frames.copy(),
        rest=z((n, 4, 3)),
        V=z((n, 4, 3)),
        weights=z(m),
        gap=z(m),
        F=z((cells.places, 6)),
        W=z(cells.count),
        account=z(cells.count),
        w=z((n, 4, 3)),
        w_F=z((cells.places, 6)),
        lag=z(11),
        carry=z((n, 6)),
        books=z(TOTAL),
        trend=z((n, 6)),
        earlier=z((2, m)),
        sizes=z(3),
    )


def room_for_step(system: System, cells: Cells) -> Step:
    """Memory of a step."""
    z = np.zeros
    n, m, total = system.count, system.m, system.numbering.total
    return Step(
        step=z((n, 6)),
        rows=np.stack([*[system.frames] * 3, z(system.frames.shape)]),
        V1=z((n, 4, 3)),
        F1=z((cells.places, 6)),
        W1=z(cells.count),
        work=z(cells.count),
        change=z(m),
        losses=z(TOTAL),
        start=z((total, 4, 3)),
        nodes=z((4, total, 4, 3)),
        exact=z((total, 4, 3)),
        steps=z((total, 6)),
        twists=z((total, 6)),
        on_nodes=z((total, 6)),
        forces=z((n, 6)),
        q=z((2, n, 4, 3)),
        F_viscous=z((cells.places, 6)),
        r=z((3, 6 * n + m)),
        weights=z(m),
        filtered=z((2, total, 6)),
    )


def model_of(system: System, cells: Cells, pressures: Sequence[Pressure], scheme: Scheme) -> Model:
    """What a step sees of the scene."""
    attachment = system.numbering.attachment
    turns = system.connections.angular
    lengths = np.tile(np.repeat([1.0 / system.length, ROTATION], 3), system.count)
    pieces = [pressure.pairs for pressure in pressures]
    return Model(
        cells=cells.table,
        joints=system.connections.packed,
        inertia=system.inertia,
        damping=system.mass_damping or Inertia.none(),
        leaders=Leaders(attachment.leader, attachment.offset, attachment.trivial),
        held=system.held,
        measure=np.concatenate([lengths, np.where(turns, ROTATION, 1.0 / system.length)]),
        scale=np.ones(system.m),
        loads=Loads(*(array.copy() for array in system.loads)),
        conservative=system.conservative,
        pressure=Pieces(
            np.concatenate([np.zeros((0, 2), dtype=np.int64), *pieces]),
            across(pressures),
        ),
        viscous=system.elastic.viscous,
        scheme=scheme,
        probes=system.connections.packed_probes,
        driven=np.zeros(system.m),
        supported=supported(system),
    )


def across(pressures: Sequence[Pressure]) -> Array:
    """Axes across the pieces under pressure, times the present pressure, shape (s, 3)."""
    parts = [pressure.across for pressure in pressures]
    return np.concatenate([np.zeros((0, 3)), *parts])

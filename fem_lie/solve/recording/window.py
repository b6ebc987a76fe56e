"""Buffer of rows of results during a run: kept in memory, or passed on to a file.

States recorded after every n-th step in memory stay in the arrays that the run fills. Results for a
file pass through these arrays, and so do states at requested times: the states on both sides of
each time are filled in and interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie.bodies import balances
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.results.record import INVARIANTS, WITH_BALANCE, Record, is_kept, row_shapes
from fem_lie.results.resampling import between
from fem_lie.solve.recording.checkpoints import WINDOW, Checkpoints
from fem_lie.solve.recording.plan import NEAR, Saving

BUFFER_BYTES = 2**26
"""Size of the buffer in bytes for rows that are passed on."""

FEWEST = 8
"""Smallest number of rows in the buffer, whatever their size."""


class Window:
    """Arrays of results and the next row to be filled.

    Attributes:
        row: Index of the next row.
        times: Times of the rows; the first axis of all arrays is the row.
        iterations: Number of iterations so far.
        balance: Work, damping, numerical dissipation, see :mod:`fem_lie.bodies.balances`, shape (T,
            3); zero where a row is not yet written, like ``impulses``.
        impulses: Impulses of loads and reactions, shape (T, 2, 6).
        arrays: Arrays that :mod:`fem_lie.solve.recording.result_row` fills.
        turns_far: Whether an element is near its rotation limit in the last row.
        filled: Computed quantities; arrays of others have no rows.
    """

    def __init__(
        self, info: SceneInfo, rows: int, saving: Saving, store: Checkpoints | None
    ) -> None:
        """Allocate all arrays.

        Args:
            info: Bodies and joints.
            rows: Largest number of rows, or the number at first.
            saving: Recorded quantities and times.
            store: File to which rows are passed on; ``None``: keep them in memory.
        """
        n, wanted = sum(len(body.nodes) for body in info.bodies), saving.times
        shapes, filled = row_shapes(info, n), saving.filled
        kept = {name: shape for name, shape in shapes.items() if is_kept(name, saving.record)}
        shapes = {name: shape for name, shape in shapes.items() if name not in INVARIANTS}
        self.filled, self._kept, self._wanted, self._store = filled, (*kept,), wanted, store
        self._passes = wanted is not None or store is not None
        self._kinds = info.node_types
        if store is not None:
            store.open(info, kept, rows if wanted is None else len(wanted))
        used = {name: shape for name, shape in shapes.items() if is_kept(name, filled)}
        if filled & WITH_BALANCE:
            used["invariants"] = (7,)
        self._names = (*used,)
        if self._passes:
            size = 8 * sum(int(np.prod(shape, dtype=np.int64)) for shape in used.values())
            rows = min(rows, max(FEWEST, BUFFER_BYTES // size))
            rows = rows if store is None else store.rows_at_once(rows)
        shapes["invariants"] = (7,)
        arrays = {
            name: np.empty((rows if name in used else 0, *shape)) for name, shape in shapes.items()
        }
        self.times, self.frames, self.velocities = (
            arrays[name] for name in ("times", "frames", "velocities")
        )
        # of the last state only: to continue a motion on another mesh
        there = rows if Record.VELOCITIES in filled else 0
        self.gradient_velocities: Array = np.full((there, len(info.gradient_nodes), 6), np.nan)
        self._end: tuple[float, Array] = np.nan, self.gradient_velocities[:0]
        self.joint_forces, self.invariants = arrays["joint_forces"], arrays["invariants"]
        self.reactions = arrays["reactions"]
        self.joint_violations = arrays["joint_violations"]
        self.joint_coordinates = arrays["joint_coordinates"]
        self.elastic, self.potential = arrays["elastic"], arrays["potential"]
        self.balance, self.impulses = arrays["balance"], arrays["impulses"]
        self.iterations = np.zeros(rows, dtype=np.int64)
        for array in (self.elastic, self.balance, self.impulses):
            array[:] = 0.0
        self.row, self._parts = 0, list[dict[str, Array]]()
        self.turns_far = False
        self._collect_arrays()
        self._first: Array = np.full(2 + balances.COLUMNS, np.nan)
        self._last_gap = 0.0
        # rows that were passed on
        self._gone, self._broken = 0, False
        if store is not None and store.state:
            self._restore(store)

    # --- rows that are filled ---

    @property
    def free_rows(self) -> int | None:
        """Number of rows that can be filled at a time, ``None`` for any number."""
        return len(self.times) - 1 if self._passes else None

    def ensure_rows(self, rows: int = 1) -> None:
        """Make sure that the next rows are free.

        Args:
            rows: Numbers of the nodes.
        """
        if self.row + rows > len(self.times):
            if self._passes:
                self._pass_on(last=False)
            else:
                self._grow()

    def _grow(self) -> None:
        for name in (*self._names, "gradient_velocities"):
            old = getattr(self, name)
            setattr(self, name, np.concatenate([old, np.full_like(old, old[-1:])]))
        self._collect_arrays()

    def _collect_arrays(self) -> None:
        joints = self.joint_forces, self.joint_coordinates, self.joint_violations
        others = self.invariants, self.balance, self.impulses
        numbers = self.potential, self.elastic, self.times, self.iterations
        motion = self.frames, self.velocities, self.gradient_velocities
        self.arrays = PackedArrays([*motion, *joints, *others, *numbers])

    @property
    def gap(self) -> float:
        """Error of the energy balance at the last row, see :mod:`fem_lie.bodies.balances`."""
        if self.row and Record.ENERGIES in self.filled:
            if np.isnan(self._first[0]):
                self._first = self._energies(0)
            stored, potential, *rest = np.transpose([self._first, self._energies(self.row - 1)])
            balance = np.transpose(rest)
            gaps = balances.energy_gaps(stored + potential, balance)
            scale = balances.energy_scale(stored, potential, balance)
            self._last_gap = balances.relative(float(abs(gaps[-1])), scale)
        return self._last_gap

    def _energies(self, row: int) -> Array:
        """Stored energy, potential and balance."""
        stored = self.invariants[row, 0] + self.elastic[row]
        return np.array([stored, self.potential[row], *self.balance[row]])

    # --- rows that are passed on ---

    def _pass_on(self, *, last: bool) -> None:
        """Empty the arrays; ``last``: no state after the last row will be needed."""
        _ = self.gap
        if not self.row:
            return
        self._end = self._last_row()
        rows = {name: getattr(self, name)[: self.row] for name in self._names}
        if self._wanted is None:
            self._put(rows, self.row)
            self.row = 0
            return
        # at a jump there may be another row with the time of the last one
        times, reached = rows["times"], rows["times"][-1]
        slack = NEAR * (reached - times[-2]) if len(times) > 1 else 0.0
        reached = reached + slack if last else reached - slack
        to = int(np.searchsorted(self._wanted, reached, side="right"))
        if to > self._gone:
            at = self._wanted[self._gone : to]
            self._put(between(rows, self._kinds, at), to - self._gone)
        for values in rows.values():
            values[0] = values[-1]
        self.row = 1

    def _split(self, rows: Mapping[str, Array]) -> dict[str, Array]:
        """Recorded quantities of rows, by the names of results."""
        invariants = rows.get("invariants")
        if invariants is not None:
            rows = {**rows, **{name: invariants[:, part] for name, part in INVARIANTS.items()}}
        return {name: rows[name] for name in self._kept}

    def _put(self, filled: dict[str, Array], count: int) -> None:
        rows = self._split(filled)
        if self._store is None:
            self._parts.append({name: values.copy() for name, values in rows.items()})
        else:
            reached, self._broken = float(self.times[self.row - 1]), True
            self._store.append(self._gone, rows, reached)
            self._broken = False
        self._gone += count

    def close(self, error: bool) -> None:
        """Pass on the remaining rows, if that is still possible.

        Args:
            error: Whether an error ended the run, which not all ranks may have.
        """
        reachable = self._store is None or not error or self._store.reachable()
        if self._passes and not self._broken and reachable:
            self._pass_on(last=False)

    def collected(self) -> dict[str, Array]:
        """All recorded rows."""
        if not self._passes:
            return self._split({name: getattr(self, name)[: self.row] for name in self._names})
        if not self._broken:
            self._pass_on(last=True)
        if self._store is not None:
            return self._store.rows(self._gone)
        empty = self._split({name: getattr(self, name)[:0] for name in self._names})
        return {
            name: np.concatenate([part[name] for part in (empty, *self._parts)]) for name in empty
        }

    def _last_row(self) -> tuple[float, Array]:
        """Time of the last row, and velocities of nodes with position gradients, (g, 6)."""
        last = self.gradient_velocities[self.row - 1 : self.row]
        return float(self.times[self.row - 1]), last.reshape(-1, 6).copy()

    def end_gradient_velocities(self, time: float) -> Array | None:
        """Velocities of nodes with position gradients at the last state, shape (g, 6).

        Args:
            time: Time of the last state of the result.

        Returns:
            ``None`` if there are no such nodes, or their velocities are not known at this time.
        """
        at, found = self._last_row() if self.row else self._end
        return found if at == time and len(found) and np.isfinite(found).all() else None

    # --- checkpoints ---

    @property
    def fresh(self) -> bool:
        """Whether the run was not restarted."""
        return self._store is None or not self._store.state

    def _saved_state(self) -> dict[str, Array]:
        """State on which the following rows depend."""
        self._pass_on(last=False)
        kept = {f"{WINDOW}first": self._first, "window.row": np.array(self.row)}
        if self.row:
            kept |= {f"{WINDOW}{name}": getattr(self, name)[0].copy() for name in self._names}
        return kept

    def _restore(self, store: Checkpoints) -> None:
        kept = store.state
        self._gone, self._first = store.row, kept[f"{WINDOW}first"]
        self.row = int(kept["window.row"])
        if self.row:
            for name in self._names:
                getattr(self, name)[0] = kept[f"{WINDOW}{name}"]

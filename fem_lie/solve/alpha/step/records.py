"""What the compiled loop of generalised-α takes and changes: counters, numbers, arrays, options."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie.forms.fixed_arrays import integers1, integers2, numbers1, numbers2, numbers3
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.lie.carried_axes import PlainSurroundings

BETWEEN, OPEN, WEIGHED, SOLVED, CHECKED, LEARNED = range(6)
"""Phases: between steps; a residual is wanted; it is known; the correction is; the step has
converged; what it cost has been learned."""

STEP, ITERATION, PHASE, UPDATE, TOTAL, ROW, WANTED, NEAR, COUNTERS = range(9)
"""Counters: the step that is made or was made last, its iteration, the phase; what is made anew,
see :class:`~fem_lie.solve.renewal.Update`; all iterations; the next row of results, how many of
the wanted ones were filled in, and whether an element turns nearly too far in the last (1)."""

RATIO, NOW, PREVIOUS, INCREMENT, MOTION, NUMBERS = range(6)
"""Numbers: ratio of increments that steps begin with and that of the present one, the increment
before and the present one, and the largest motion in a step."""


class Packed(NamedTuple):
    """What a run has in arrays that stay where they are, in the order of their table.

    Attributes:
        H: Start of a step, see :class:`~fem_lie.solve.alpha.step.nodes.State`.
        H1: Likewise.
        motion: Likewise.
        kinds: Likewise.
        scaling: Likewise.
        weights: Multipliers, shape (m,).
        first: Those at the start of the step.
        scale: Of the constraints.
        spread: Of scaled multipliers in the size of a correction, see
            :class:`~fem_lie.system.equations.Plan`, (m, w).
        joined: Which constraints are one vector with the one before.
        held: Which of the equations are those of held unknowns.
        r: Residual, shape (6 n + m,).
        dx: Correction.
        forces: Table of :func:`~fem_lie.system.nodes.sums.residual`.
        books: Table of :func:`~fem_lie.system.outer_forces.look_and_sum_up`.
        booked: Balance and impulses, shape (15,).
        targets: Of the constraints, shape (m,).
        joints: Numbers and integers of their table, and those of probes.
        cells: Those that have energy, two arrays.
        around: Places whose axes turn.
        counters: See :data:`STEP`.
        numbers: See :data:`RATIO`.
        known: What the policy has learned.
    """

    H: Array
    H1: Array
    motion: Array
    kinds: Indices
    scaling: Array
    weights: Array
    first: Array
    scale: Array
    spread: Array
    joined: Indices
    held: Indices
    r: Array
    dx: Array
    forces: Indices
    books: Indices
    booked: Array
    targets: Array
    joints: tuple[PackedJoints, PackedJoints]
    cells: tuple[Indices, Indices]
    around: PlainSurroundings
    counters: Indices
    numbers: Array
    known: Array

    @property
    def arrays(self) -> list[Array | Indices]:
        """One after the other."""
        found: list[Array | Indices] = []
        for part in self:
            for inner in part if isinstance(part, tuple) else (part,):
                found.extend(inner if isinstance(inner, tuple) else (inner,))
        return found


@inlined
def packed(table: Indices) -> Packed:
    """From the table of its arrays."""
    return Packed(
        numbers3(table, 0),
        numbers3(table, 1),
        numbers3(table, 2),
        integers1(table, 3),
        numbers2(table, 4),
        numbers1(table, 5),
        numbers1(table, 6),
        numbers1(table, 7),
        numbers2(table, 8),
        integers1(table, 9),
        integers1(table, 10),
        numbers1(table, 11),
        numbers1(table, 12),
        integers2(table, 13),
        integers2(table, 14),
        numbers1(table, 15),
        numbers1(table, 16),
        (
            (numbers1(table, 17), integers1(table, 18)),
            (numbers1(table, 19), integers1(table, 20)),
        ),
        (integers2(table, 21), integers1(table, 22)),
        (
            integers1(table, 23),
            integers1(table, 24),
            integers1(table, 25),
            numbers2(table, 26),
            numbers3(table, 27),
        ),
        integers1(table, 28),
        numbers1(table, 29),
        numbers1(table, 30),
    )


class Steps(NamedTuple):
    """How steps are made.

    Attributes:
        tolerance: Of the error that the iteration leaves, in the largest motion of a step.
        finest: What it may leave at most, whatever the motion.
        limit: Most iterations.
        factor: Of all solutions.
        summed: Whether residuals are one compiled sum.
        missing: Whether there is no matrix yet.
        checked: Whether constraints may contradict each other.
        ended: Whether steps are ended here: turns counted, all booked, rows filled in.
        turns: Whether joints count turns.
        booked: Whether there is anything to book.
        loads: Whether loads are looked at for it.
        joints: Whether joints are.
    """

    tolerance: float
    finest: float
    limit: int
    factor: float
    summed: bool
    missing: bool
    checked: bool
    ended: bool
    turns: bool
    booked: bool
    loads: bool
    joints: bool

    @property
    def plain(self) -> PlainSteps:
        """As compiled functions are quicker to call with."""
        return (*self,)


PlainSteps: TypeAlias = tuple[
    float, float, int, float, bool, bool, bool, bool, bool, bool, bool, bool
]
"""A :class:`Steps` at the door from Python."""

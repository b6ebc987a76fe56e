"""Convergence of a step at round-off, and acceleration of corrections in one direction.

A step has converged when only round-off changes any more. Increments decrease until they are
round-off, and the level at which they stop depends on the scene. A level that earlier steps reached
is expected again; an increment that no longer decreases, and is as small as an increment can be, is
round-off; one that no longer decreases and is larger may be, which the loop then tests.
"""

from __future__ import annotations

from math import log, sqrt
from typing import Annotated, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie._jit.packed_arrays import one, unpacking
from fem_lie._jit.records import Record, Records, record_type
from fem_lie._jit.stack import stack, vector_at
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.solve.conserving.step.ranks import Ranks, add_up
from fem_lie.solve.convergence import DIVERGED, contraction, to_come

_ALIKE, _SHARE = 0.2, 0.5
"""Largest relative difference of corrections in one direction, and the largest part that one
leaves."""
WINDOW, LEARNING, HALVED = 3, 8, 0.5
"""Small increments are round-off if this many iterations did not bring them below that fraction;
for nodes with vector coordinates. Corrections with secants do not decrease monotonically and are
given more iterations."""
LOST = 25
"""Iterations without halving an increment above round-off after which a step has failed, if there
are such nodes."""
PROGRESS = record_type(
    steps=int,
    iteration=int,
    total=int,
    fewest=int,
    asked=int,
    stalls=int,
    last=int,
    needed=int,
    growths=int,
    row=int,
    wanted=int,
    near=int,
    previous=float,
    ratio=float,
    motion=float,
    excess=float,
    increment=float,
    least=float,
    floor=float,
    mark=float,
    felt=float,
    aside=float,
    recent=(float, LEARNING),
    history=(float, LOST),
)
"""Progress of a run: steps made, iterations of the current one and of all, fewest, iteration of the
last test, iterations since the increment fell to its least, iterations of the last step, iterations
of the current one that a better matrix might have saved, successive growing increments at the end;
next row of results, how many requested rows are filled in, and whether an element is near its
rotation limit in the last one (1); last increment, ratio, largest motion, excess iterations,
increment, the least of the current step, the round-off level reached by earlier steps, the
increment ``patience`` iterations before, the measured effect of round-off in this step, the
reduction per term of the series for changes of the matrix, the last increments of nodes other than
frames, the newest first, and the last increments in a ring."""
_GROWING = 7
"""Successive growing increments after which it has failed."""
UNKNOWN, NEW = 0, -1
"""In place of the fewest iterations: none was counted with this matrix; none of a whole step."""
ULPS = 1e3 * float(np.finfo(np.float64).eps)
"""Increments, in lengths of the model, that may be round-off."""
FINE = 1e-2 * ULPS
"""Increments that are round-off."""
SURE = 1e-3
"""Ratio of increments at which the matrix is good and round-off need not be tested."""
_FLIPS, _SHORTER, _FARTHEST = 3, 0.5, 0.05
"""Increments with contacts that no longer decrease, after which corrections are shortened to this
fraction; and the largest increment of an iteration, in lengths of the model: beyond it, other
contacts act."""
_STAGNANT = 6
"""Iterations of a step without progress."""
CYCLES = 50
"""Iterations of a step in contact without progress, after which it has failed."""
STALLED = 0.8
"""Ratio of increments above which there is no progress."""


class _One(NamedTuple):
    """The progress alone."""

    progress: Annotated[Records, one(PROGRESS)]


progress_of = unpacking(_One)


@inlined
def forget(progress: Record) -> None:
    """Forget the increments of earlier steps."""
    for k in range(LEARNING):
        progress.recent[k] = np.inf
    for k in range(LOST):
        progress.history[k] = np.inf


@compiled
def accelerate(
    measure: Array,
    x: Array,
    slow: Array,
    known: Array,
    flags: tuple[bool, bool],
    sizes: tuple[float, float],
    ranks: Ranks,
) -> None:
    """Extrapolate corrections that continue in one direction.

    The factor β of dissipation makes one direction of the matrix wrong by a few per cent: each
    correction leaves the same fraction of the error there, and this is a geometric series.

    Args:
        measure: Norm weight of each unknown and scaled multiplier.
        x: Correction, updated.
        slow: That direction, of unit length, and the previous correction, (2, size), updated.
        known: The fraction, and the amount added before along the direction, (2,), updated.
        flags: Whether β is less than one, and whether the correction is the first one of a step.
        sizes: Size of the correction, and its round-off level.
        ranks: Ranks on which the correction is.
    """
    (direction, before), (cut, first) = (slow[0], slow[1]), flags
    added, known[1] = known[1], 0.0
    if cut:
        products = vector_at(stack(6), 6)
        _set_products(measure, x, direction, before, ranks, products)
        xx, along, xb = products[0], products[1], products[2]
        dd, db, bb = products[3], products[4], products[5]
        if not first and sizes[0] > sizes[1]:
            # the part that the previous correction has left, of the total
            square, share = xx + 2.0 * added * along + added * added * dd, (xb + added * db) / bb
            alike = square - share * share * bb <= _ALIKE**2 * square
            if alike and abs(share) < _SHARE:
                known[0], along = share, xb / sqrt(bb)
                for k in range(x.shape[0]):
                    direction[k] = before[k] / sqrt(bb)
            elif db * db > 0.5 * bb:
                known[0] = 0.0
        if along * along > 0.5 * xx:
            known[1] = known[0] / (1.0 - known[0]) * along
    for k in range(x.shape[0]):
        x[k] += known[1] * direction[k]
        before[k] = x[k]


@inlined
def _set_products(measure: Array, x: Array, d: Array, b: Array, ranks: Ranks, out: Array) -> None:
    """Products of x with itself, d, b; of d with itself and b; of b with itself; (6,)."""
    n = 6 * ranks.owned.shape[0]
    for k in range(6):
        out[k] = 0.0
    for k in range(x.shape[0]):
        weight = measure[k] * measure[k]
        if k < n:
            weight *= ranks.owned[k // 6]
        out[0] += weight * x[k] * x[k]
        out[1] += weight * x[k] * d[k]
        out[2] += weight * x[k] * b[k]
        out[3] += weight * d[k] * d[k]
        out[4] += weight * d[k] * b[k]
        out[5] += weight * b[k] * b[k]
    add_up(ranks, out)


@inlined
def size(measure: Array, x: Array) -> float:
    """Norm of the largest part; nan if any is."""
    largest = 0.0
    for k in range(x.shape[0]):
        part = abs(x[k]) * measure[k]
        if part > largest or part != part:
            largest = part
    return largest


@compiled
def size_of(measure: Array, x: Array) -> float:
    """:func:`size`, from Python."""
    return size(measure, x)


@inlined
def lags(progress: Record, tolerance: float, patience: int, spare: float, round_off: float) -> bool:
    """Whether the iteration would need more than ``spare`` further iterations at its current rate.

    Increments below ``round_off`` are round-off.
    """
    increment, before = progress.increment, progress.mark
    progress.mark = increment
    target = max(tolerance * progress.motion, progress.floor, round_off)
    if increment <= ULPS or increment <= target:
        return False
    rate = log(increment / before) / patience
    return rate >= 0.0 or log(target / increment) < spare * rate


@inlined
def count(progress: Record) -> None:
    """Record the excess over the fewest iterations with the current matrix.

    A matrix that was refactorised within this step has no record yet.
    """
    counted = max(progress.needed, 2)
    progress.last = progress.iteration
    if progress.fewest == NEW:
        progress.fewest = UNKNOWN
        return
    if progress.fewest == UNKNOWN or counted < progress.fewest:
        progress.fewest = counted
    progress.excess += counted - progress.fewest


@inlined
def is_round_off(progress: Record, steadily: bool) -> bool:
    """Whether only round-off is left: no decrease, or as small as the last stagnant increment.

    With ``steadily`` increments are compared with the last one that decreased: a slow, but steady
    decrease is no round-off.
    """
    increment, least = progress.increment, progress.least
    if increment > STALLED * least:
        progress.stalls += 1
        if steadily:
            increment = least
    else:
        progress.stalls = 0
    progress.least = min(increment, least)
    increment = progress.increment
    if increment <= 2.0 * progress.floor:
        # an accidental zero must not make the next steps wait for another
        progress.floor = max(min(increment, progress.floor), 0.9 * progress.floor)
        return True
    if increment > ULPS or progress.stalls < (2 if increment < FINE else _STAGNANT):
        return False
    progress.floor = progress.least
    return True


@inlined
def shorten(x: Array, increment: float, stalls: int) -> None:
    """Shorten a correction ``x`` of size ``increment`` in a step with active contacts.

    Contacts that alternate between stick and slip converge in between.
    """
    factor = _SHORTER if stalls >= _FLIPS else 1.0
    if increment > _FARTHEST:
        factor = min(factor, _FARTHEST / increment)
    if factor < 1.0:
        for k in range(x.shape[0]):
            x[k] *= factor


@inlined
def larger(a: float, b: float) -> float:
    """The larger one of two numbers; nan if either is."""
    return b if b > a or b != b else a


@inlined
def size_of_vectors(kinds: Indices, measure: Array, x: Array) -> float:
    """Norm of the largest part of a correction ``x`` of nodes other than frames.

    As :func:`size`.
    """
    largest = 0.0
    for i in range(kinds.shape[0]):
        if kinds[i] >= POSITION_GRADIENT:
            part = size(measure[6 * i : 6 * i + 6], x[6 * i : 6 * i + 6])
            if part > largest or part != part:
                largest = part
    return largest


@inlined
def stalls(progress: Record, increment: float, window: int) -> bool:
    """Whether an increment is more than half of that ``window`` iterations before; records it.

    In stiff cells even the smallest increments change forces. So nodes with vector coordinates are
    corrected while increments decrease, and the level that an earlier step reached is no measure of
    round-off.
    """
    recent = progress.recent
    before = recent[window - 1]
    for k in range(LEARNING - 1, 0, -1):
        recent[k] = recent[k - 1]
    recent[0] = increment
    return increment > HALVED * before


@inlined
def is_lost(progress: Record, before: float) -> bool:
    """Whether the iteration has failed, if nodes have vector coordinates.

    Its increments have not been halved for long, grow steadily, or exceed the length of the model.

    Args:
        progress: Progress of the run, updated.
        before: The previous increment.
    """
    increment, at, history = progress.increment, progress.iteration % LOST, progress.history
    progress.growths = progress.growths + 1 if increment > before else 0
    long_ago, history[at] = history[at], increment
    grows = progress.growths >= _GROWING or not increment < DIVERGED
    return grows or increment > HALVED * long_ago


@inlined
def stagnates(progress: Record) -> bool:
    """Whether increments have ceased to decrease, and it is unknown whether this is round-off."""
    increment = progress.increment
    return progress.stalls >= _STAGNANT and increment > ULPS


@inlined
def converged(progress: Record, tolerance: float, iteration: int, known: bool) -> bool:
    """Whether the estimated further increments are below the tolerance, or round-off.

    Round-off is recognised by the rate if the matrix is ``known`` to be good. Near configurations
    in which constraints lose rank it is not: increments are small there, but the error is not.
    """
    increment = progress.increment
    if iteration > 1 and (tolerance > 0.0 or (known and progress.floor > 0.0)):
        ratio = contraction(increment, progress.previous, progress.ratio)
        progress.ratio = ratio
        if tolerance == 0.0:
            # the last digits converge most slowly
            ratio = max(ratio, SURE)
        allowed = max(tolerance * progress.motion, 2.0 * progress.floor)
        if to_come(increment, ratio) <= allowed:
            return True
    return increment == 0.0

"""The rule by which policies decide when a matrix is made anew, compiled: for Python and for loops.

It depends on a few numbers, which are the policy, and on what it has learned in the run.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple, TypeAlias

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined


class Update(IntEnum):
    """What of the iteration matrix is made anew.

    ``CONSTRAINTS``: their Jacobian Φ_q, which turns with the bodies, while mass and stiffness,
    which hardly change in local frames, stay with their factorisation. ``ALL``: both.
    """

    NONE = 0
    CONSTRAINTS = 1
    ALL = 2


class Rule(NamedTuple):
    """When to make what anew; see :class:`~fem_lie.solve.motion.policies.Automatic`.

    Attributes:
        patience: Iterations of one step after which something is made anew at once.
        cost: Iterations lost for which all is made anew at the start of a step.
        refresh: Those for which the constraints are.
        most: What is made anew at most, see :class:`Update`.
        bound: Whether there are constraints that may be made anew by themselves.
        asks: Whether it is found out whether age is to blame before all is made anew.
    """

    patience: int
    cost: float
    refresh: float
    most: int
    bound: bool
    asks: bool

    @property
    def plain(self) -> PlainRule:
        """As compiled functions are quicker to call with."""
        most = int(self.most)
        return int(self.patience), self.cost, self.refresh, most, self.bound, self.asks


PlainRule: TypeAlias = tuple[int, float, float, int, bool, bool]
"""A :class:`Rule` at the door from Python."""

BEST, BASE, EXCESS, LOST, SIZE = 0, 1, 2, 3, 4
"""What is learned: fewest iterations of a step since something was made anew, and since all was (0:
not known); iterations beyond the first, and what of these is lost in spite of new constraints."""

_NONE, _CONSTRAINTS, _ALL = (int(update) for update in Update)


@inlined
def is_due(iteration: int, patience: int, lost: float, cost: float) -> bool:
    """Whether a matrix is due before an iteration of a step, counted from 1.

    At the start of a step if the iterations ``lost`` by the frozen matrix have reached the ``cost``
    of a new one; within it each time that ``patience`` is at an end.
    """
    return lost >= cost if iteration == 1 else (iteration - 1) % patience == 0


@compiled
def due(rule: PlainRule, known: Array, iteration: int) -> int:
    """What to make anew before an iteration of a step, counted from 1: if it pays, or is bad.

    ``known`` (4,) is updated.
    """
    patience, cost, refresh, most, bound, _ = rule
    if is_due(iteration, patience, known[LOST if bound else EXCESS], cost):
        # within a step constraints first
        update = _CONSTRAINTS if bound and iteration - 1 == patience else _ALL
    else:
        refreshed = iteration == 1 and bound and known[EXCESS] >= refresh
        update = _CONSTRAINTS if refreshed else _NONE
    update = min(update, most)
    if update != _NONE:
        known[BEST] = known[EXCESS] = 0.0
    if update == _ALL:
        known[BASE] = known[LOST] = 0.0
    return update


@compiled
def learn(rule: PlainRule, known: Array, iterations: int) -> bool:
    """Add up what the kept matrix has cost in a step; returns whether :attr:`Rule.asks` wants.

    That is when all would be made anew at the next step, and the constraints might do.
    """
    # one iteration is luck of the prediction, and says nothing of the matrix
    counted = max(float(iterations), 2.0)
    known[BEST] = counted if known[BEST] == 0.0 else min(known[BEST], counted)
    known[BASE] = known[BEST] if known[BASE] == 0.0 else min(known[BASE], known[BEST])
    known[EXCESS] += counted - known[BEST]
    known[LOST] += known[BEST] - known[BASE]
    _, cost, _, _, bound, asks = rule
    return asks and bound and known[LOST] >= cost

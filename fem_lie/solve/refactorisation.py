"""Rule by which policies decide when a matrix is refactorised, compiled for Python and for loops.

It depends on a few numbers, the options of the policy, and on iteration counts recorded in the run.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple, TypeAlias

from fem_lie._jit import compiled, inlined
from fem_lie._jit.records import Record, record_type


class Refactorisation(IntEnum):
    """Which part of the iteration matrix is refactorised.

    ``CONSTRAINTS``: the constraint Jacobian Φ_q, which rotates with the bodies; mass and tangent
    stiffness, which hardly change in local frames, keep their factorisation. ``ALL``: both.
    """

    NONE = 0
    CONSTRAINTS = 1
    ALL = 2


class Rule(NamedTuple):
    """Parameters of the rule; see :class:`~fem_lie.solve.motion.policies.Automatic`.

    Attributes:
        patience: Iterations within a step after which something is refactorised at once.
        cost: Excess iterations after which the whole matrix is refactorised at the start of a step.
        refresh: Excess iterations after which the constraint Jacobian is updated.
        most: The most that may be refactorised, see :class:`Refactorisation`.
        bound: Whether there are constraints whose Jacobian may be updated separately.
        asks: Whether the staleness of mass and stiffness is measured before all is refactorised.
    """

    patience: int
    cost: float
    refresh: float
    most: int
    bound: bool
    asks: bool

    @property
    def plain(self) -> PlainRule:
        """The rule as a plain tuple, with which compiled functions are called faster."""
        most = int(self.most)
        return int(self.patience), self.cost, self.refresh, most, self.bound, self.asks


PlainRule: TypeAlias = tuple[int, float, float, int, bool, bool]
"""Plain tuple of a :class:`Rule`."""

KNOWN = record_type(fewest=float, fewest_since_all=float, excess=float, lost=float)
"""What the rule records: the fewest iterations of a step since the last update, and since the whole
matrix was refactorised (0: unknown); excess iterations, and those in spite of an updated constraint
Jacobian."""

_NONE, _CONSTRAINTS, _ALL = (int(update) for update in Refactorisation)


@inlined
def is_due(iteration: int, patience: int, lost: float, cost: float) -> bool:
    """Whether a refactorisation is due before an iteration of a step, counted from 1.

    At the start of a step it is due if the iterations ``lost`` to the frozen matrix have reached
    the ``cost`` of a new one; within a step, after each ``patience`` iterations.
    """
    return lost >= cost if iteration == 1 else (iteration - 1) % patience == 0


@compiled
def due(rule: PlainRule, known: Record, iteration: int) -> int:
    """What to refactorise before an iteration of a step, counted from 1.

    ``known``, of type :data:`KNOWN`, is updated.
    """
    patience, cost, refresh, most, bound, _ = rule
    if is_due(iteration, patience, known.lost if bound else known.excess, cost):
        # within a step the constraint Jacobian is updated first
        update = _CONSTRAINTS if bound and iteration - 1 == patience else _ALL
    else:
        refreshed = iteration == 1 and bound and known.excess >= refresh
        update = _CONSTRAINTS if refreshed else _NONE
    update = min(update, most)
    if update != _NONE:
        known.fewest = known.excess = 0.0
    if update == _ALL:
        known.fewest_since_all = known.lost = 0.0
    return update


@compiled
def learn(rule: PlainRule, known: Record, iterations: int) -> bool:
    """Record the cost of the frozen matrix in a step; return whether to measure its staleness.

    That is so (:attr:`Rule.asks`) if all would be refactorised at the next step and updating the
    constraint Jacobian might suffice.
    """
    # a single iteration is due to a good prediction and says nothing about the matrix
    counted = max(float(iterations), 2.0)
    known.fewest = counted if known.fewest == 0.0 else min(known.fewest, counted)
    before = known.fewest_since_all
    known.fewest_since_all = known.fewest if before == 0.0 else min(before, known.fewest)
    known.excess += counted - known.fewest
    known.lost += known.fewest - known.fewest_since_all
    _, cost, _, _, bound, asks = rule
    return asks and bound and known.lost >= cost

"""Types of constraint sets; a system has one set of each type that is not empty.

Multipliers are numbered in this order, those of velocity constraints last.
"""

from __future__ import annotations

from collections.abc import Sequence

from fem_lie.system.constraint_sets.bushings import Bushings
from fem_lie.system.constraint_sets.constraint_set import (
    ConstraintSet,
    Numbered,
    Start,
    SystemFrames,
)
from fem_lie.system.constraint_sets.on_attachments import OnAttachments, on_attachments
from fem_lie.system.constraint_sets.relative_motions import RelativeMotions
from fem_lie.system.constraint_sets.rolls import Rolls
from fem_lie.system.constraint_sets.slides import Slides
from fem_lie.system.constraint_sets.ties import Ties

KINDS: tuple[type[ConstraintSet], ...] = (RelativeMotions, Slides, Bushings, Ties, Rolls)


def sets_of(
    items: Sequence[Numbered], constrained: SystemFrames
) -> tuple[RelativeMotions, list[ConstraintSet]]:
    """Sets of connections between nodes, and between attachment frames, type by type.

    Returns:
        The set in the compiled sum over nodes, which may be empty, and all other sets that are not.
    """
    attached = [item for item in items if on_attachments(item)]
    plain = [item for item in items if not on_attachments(item)] if attached else items
    first = RelativeMotions(plain, constrained, Start())
    found: list[ConstraintSet] = [first]
    for kind in KINDS:
        if kind is not RelativeMotions:
            _add(kind(plain, constrained, _after(found)), found)
        if attached:
            _add(OnAttachments(kind, attached, constrained, _after(found)), found)
    return first, found[1:]


def _add(one: ConstraintSet, found: list[ConstraintSet]) -> None:
    if not one.empty:
        found.append(one)


def _after(found: Sequence[ConstraintSet]) -> Start:
    """Start of the next set."""
    return Start(sum(each.m for each in found), sum(len(each.incidences.nodes) for each in found))

"""Treatment of redundant constraints."""

from enum import Enum


class RedundantConstraints(Enum):
    """Treatment of redundant constraints, which follow from other constraints.

    ``REFUSE``: an error that names them. ``MINIMUM_NORM``: the solver keeps all of them; results
    report the joint forces with the least sum of squares, moments divided by the length of the
    model, among all that cause the same motion. Rigid-body mechanics does not determine these
    forces.
    """

    REFUSE = "refuse"
    MINIMUM_NORM = "minimum norm"

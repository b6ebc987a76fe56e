"""What to do with constraints that follow from others."""

from enum import Enum


class Redundant(Enum):
    """What to do with constraints that follow from others.

    ``REFUSE``: an error that names them. ``MINIMUM_NORM``: all are kept; of the joint forces that
    make the same motion, results report those whose sum of squares is least, with moments over the
    length of the model. What only elasticity can decide is decided by that, not by mechanics.
    """

    REFUSE = "refuse"
    MINIMUM_NORM = "minimum norm"

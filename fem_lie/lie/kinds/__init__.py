r"""What nodes are, and all in which one kind differs from another.

Every node is four rows ``H (4, 3)``, a place and three vectors, and has a velocity ``v`` in its own
axes ``R``; forces, tangents and the unknowns of Newton's method are in these axes, too. What the
rows mean, and what ``v`` does to them, is the node's *kind*:

============  ================================  ================================  ==============
              FRAME, on one of two groups       SLOPE                             POINT
============  ================================  ================================  ==============
rows          place ``x``, directors ``R e_k``  ``x``, slope ``x'``; 2, 3         ``x``; 1 to 3
                                                carried                           carried
axes ``R``    the directors                     tangent ``x'/|x'|``, rows 2, 3    rows 1 to 3
``v``         ``(Rᵀẋ, ω)``                      ``(Rᵀẋ, Rᵀẋ')``                   ``(Rᵀẋ, 0)``
of the group  see :mod:`fem_lie.lie.motions`    ``(ẋ, ẋ')``, ``(ẍ, ẍ')``, added   ``ẋ``, ``ẍ``
``q̇ = L v``   ``ẋ``, ``ḋ_k = R (ω × e_k)``      ``ẋ``, ``ẋ'``; zero beyond        ``ẋ``
============  ================================  ================================  ==============

The axes of a slope are carried along by the smallest rotation, without any about the tangent; those
of a point do not turn, so that what a joint holds of its directions it holds in space.

:mod:`.kind` is what a kind is, and what one has to write for a new one; :mod:`.motion` and
:mod:`.forces` are what all do with one node, and :mod:`.all_nodes` loops over these.
"""

from fem_lie.lie.kinds.all_nodes import (
    advance,
    all_axes,
    all_from_group,
    all_from_local,
    all_to_group,
    bend_all,
    follow_all,
    move_all,
    pull_all,
    push_all,
    rigid_motions,
    shown_all,
    turn_all,
    turn_all_back,
    twists,
)
from fem_lie.lie.kinds.forces import (
    acceleration,
    acceleration_derivatives,
    pull,
    pull_derivative,
    push,
    wrench,
)
from fem_lie.lie.kinds.kind import (
    POINT,
    SLOPE,
    TRAITS,
    NodeKind,
    Traits,
    at_rest,
    axes,
    kinds_of,
    on_r3,
)
from fem_lie.lie.kinds.motion import (
    bend,
    follow,
    from_group,
    from_local,
    move,
    rigid,
    settle,
    shown,
    tangent,
    to_group,
    to_local,
    turn,
    turn_back,
)

__all__ = [
    "POINT",
    "SLOPE",
    "TRAITS",
    "NodeKind",
    "Traits",
    "acceleration",
    "acceleration_derivatives",
    "advance",
    "all_axes",
    "all_from_group",
    "all_from_local",
    "all_to_group",
    "at_rest",
    "axes",
    "bend",
    "bend_all",
    "follow",
    "follow_all",
    "from_group",
    "from_local",
    "kinds_of",
    "move",
    "move_all",
    "on_r3",
    "pull",
    "pull_all",
    "pull_derivative",
    "push",
    "push_all",
    "rigid",
    "rigid_motions",
    "settle",
    "shown",
    "shown_all",
    "tangent",
    "to_group",
    "to_local",
    "turn",
    "turn_all",
    "turn_all_back",
    "turn_back",
    "twists",
    "wrench",
]

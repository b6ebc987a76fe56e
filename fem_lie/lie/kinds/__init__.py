r"""What nodes are, and all in which one kind differs from another.

Every node is four rows ``H (4, 3)``, a place and three vectors, and has a velocity ``v`` in its own
axes ``R``; forces, tangents and the unknowns of Newton's method are in these axes, too. What the
rows mean, and what ``v`` does to them, is the node's *kind*:

============  =========================  ===================  ==============  =====================
              FRAME, on one of two       SLOPE                POINT           SURFACE; CROSSING
              groups
============  =========================  ===================  ==============  =====================
rows          place ``x``, directors     ``x``, slope         ``x``; 1 to 3   ``x``, ``x_u``; 2, 3
              ``R e_k``                  ``x'``; 2, 3         carried         carried | ``x_uv``,
                                         carried                              ``x_v``; 0, 3 carried
axes ``R``    the directors              ``x'/|x'|``, rows    rows 1 to 3     as rows 2, 3; exp of
                                         2, 3                                 row 3
``v``         ``(Rᵀẋ, ω)``               ``(Rᵀẋ, Rᵀẋ')``      ``(Rᵀẋ, 0)``    along ``R`` of both
of the group  :mod:`fem_lie.lie.motions` rates, added         ``ẋ``, ``ẍ``    rates, added
``q̇ = L v``   ``ẋ``,                     ``ẋ``, ``ẋ'``; zero  ``ẋ``           rates; zero beyond
              ``ḋ_k = R (ω × e_k)``      beyond
============  =========================  ===================  ==============  =====================

The axes of a slope are carried along by the smallest rotation, without any about the tangent; those
of a point do not turn, so that what a joint holds of its directions it holds in space.

A point with more than six unknowns is several nodes of six. One of a surface with all of ``x``,
``x_u``, ``x_v`` and ``x_uv`` (times lengths, so that units agree) is a SURFACE and a CROSSING. The
second has no place of its own: row 0 is a copy of that of the first, which nothing depends on, and
rigid motion turns its other rows without moving them. The axes of both do not turn within a step:
they are set by :func:`set_axes` where a state is accepted, as all rows of a body say together.

An AMPLITUDE is six numbers, rows 1 and 2: how much of each shape a reduced body has. Its axes are
those of space and say nothing, and rigid motion leaves it as it is.

:mod:`.kind` is what a kind is, and what one has to write for a new one; :mod:`.motion` and
:mod:`.forces` are what all do with one node, and :mod:`.all_nodes` loops over these.
"""

from fem_lie.lie.kinds.all_nodes import (
    Written,
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
    set_all_axes,
    shown_all,
    turn_all,
    turn_all_back,
    twists,
    write_in_new_axes,
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
    AMPLITUDE,
    CROSSING,
    POINT,
    SLOPE,
    SURFACE,
    TRAITS,
    NodeKind,
    Traits,
    at_rest,
    axes,
    kinds_of,
    on_r3,
    placed,
    set_axes,
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
    "AMPLITUDE",
    "CROSSING",
    "POINT",
    "SLOPE",
    "SURFACE",
    "TRAITS",
    "NodeKind",
    "Traits",
    "Written",
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
    "placed",
    "pull",
    "pull_all",
    "pull_derivative",
    "push",
    "push_all",
    "rigid",
    "rigid_motions",
    "set_all_axes",
    "set_axes",
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
    "write_in_new_axes",
]

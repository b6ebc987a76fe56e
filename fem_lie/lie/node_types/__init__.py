"""Node types: coordinates, velocities and inertia of nodes, and all in which one type differs.

Every node has coordinates ``H`` (4, 3), a position and three vectors, and a velocity ``v`` (6,)
along its own axes ``R``; forces, tangents and the unknowns of Newton's method are along these axes,
too. The *node type* defines the meaning of the coordinates, and their rates for a given ``v``:

====================  ===========================  =============================================
type                  rows 0 to 3 of ``H``         ``v``
====================  ===========================  =============================================
FRAME                 position ``x``, directors    ``(Rᵀẋ, ω)``, with ``ḋ_k = R (ω × e_k)``; on
                      ``R e_k``                    SE(3) or R³×SO(3)
POSITION_GRADIENT     ``x``, ``x'``; axes e₂, e₃   ``(Rᵀẋ, Rᵀẋ')``
POSITION              ``x``; axes e₁, e₂, e₃       ``(Rᵀẋ, 0)``
SURFACE_GRADIENT      ``x``, ``x_u``; e₂, e₃       ``(Rᵀẋ, Rᵀẋ_u)``
MIXED_DERIVATIVE      copy of ``x``; ``x_uv``,     ``(Rᵀẋ_uv, Rᵀẋ_v)``
                      ``x_v``; rotation vector
MODAL                 zero; six modal amplitudes   rates of the amplitudes
                      in rows 1 and 2
====================  ===========================  =============================================

With ``q = H`` the rates are ``q̇ = L v``. Increments of frames are those of their group
(:mod:`fem_lie.lie.motions`); increments of all others add. The axes of a position-gradient node are
``x'/|x'|`` and rows 2, 3; within a step they rotate with the tangent, without rotation about it.
The axes of a position node do not rotate, so that the directions in which a joint holds it are
fixed in space.

A point with more than six unknowns is several nodes of six. A point of a thin shell with ``x``,
``x_u``, ``x_v`` and ``x_uv``, times lengths so that units agree, is a SURFACE_GRADIENT and a
MIXED_DERIVATIVE node. The second has no position of its own: nothing depends on its row 0, and
rigid motion rotates its vectors without translating them. The axes of both are constant within a
step; :func:`set_axes` updates them where a state is accepted, from all nodes of the body.

A MODAL node holds six amplitudes of the modes of a reduced-order body, or of a section that
distorts. Its axes are the global ones, and rigid motion does not change it.

:mod:`.node_type` defines the types and what a new one has to provide; :mod:`.motion` and
:mod:`.forces` hold the operations on one node, and :mod:`.all_nodes` the loops over nodes.
"""

from fem_lie.lie.node_types.all_nodes import (
    Written,
    advance,
    all_axes,
    all_cubic_terms,
    all_from_group,
    all_from_local,
    all_result_twists,
    all_to_global_components,
    all_to_group,
    all_to_local,
    all_to_nodal_components,
    change_axes,
    go_all_on,
    move_all,
    pull_all_back,
    push_all_forward,
    retract_all,
    rigid_motions,
    set_all_axes,
    twists,
)
from fem_lie.lie.node_types.forces import (
    acceleration,
    acceleration_derivatives,
    pull_back,
    pull_back_derivative,
    push_forward,
    wrench,
)
from fem_lie.lie.node_types.motion import (
    cubic_term,
    from_group,
    from_local,
    move,
    reorthonormalise,
    result_twist,
    retract,
    rigid_twists,
    tangent,
    tangent_inverse,
    to_global_components,
    to_group,
    to_local,
    to_nodal_components,
)
from fem_lie.lie.node_types.node_type import (
    MIXED_DERIVATIVE,
    MODAL,
    POSITION,
    POSITION_GRADIENT,
    SURFACE_GRADIENT,
    TRAITS,
    WITH_GRADIENTS,
    NodeType,
    Traits,
    at_rest,
    axes,
    has_position,
    node_types_of,
    on_r3,
    set_axes,
)

__all__ = [
    "MIXED_DERIVATIVE",
    "MODAL",
    "POSITION",
    "POSITION_GRADIENT",
    "SURFACE_GRADIENT",
    "TRAITS",
    "WITH_GRADIENTS",
    "NodeType",
    "Traits",
    "Written",
    "acceleration",
    "acceleration_derivatives",
    "advance",
    "all_axes",
    "all_cubic_terms",
    "all_from_group",
    "all_from_local",
    "all_result_twists",
    "all_to_global_components",
    "all_to_group",
    "all_to_local",
    "all_to_nodal_components",
    "at_rest",
    "axes",
    "change_axes",
    "cubic_term",
    "from_group",
    "from_local",
    "go_all_on",
    "has_position",
    "move",
    "move_all",
    "node_types_of",
    "on_r3",
    "pull_all_back",
    "pull_back",
    "pull_back_derivative",
    "push_all_forward",
    "push_forward",
    "reorthonormalise",
    "result_twist",
    "retract",
    "retract_all",
    "rigid_motions",
    "rigid_twists",
    "set_all_axes",
    "set_axes",
    "tangent",
    "tangent_inverse",
    "to_global_components",
    "to_group",
    "to_local",
    "to_nodal_components",
    "twists",
    "wrench",
]

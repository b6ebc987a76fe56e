"""How flat coordinates of an element move with its nodes: a few functions, by their addresses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fem_lie._jit import callback
from fem_lie.forms.kernels.addresses import MAP_SIGNATURE

frame_function = callback(MAP_SIGNATURE)


@dataclass(frozen=True)
class FrameMap:
    """How flat element coordinates ``y`` move with the local-frame twists ``h`` of the nodes.

    Four compiled functions of signature :data:`MAP_SIGNATURE`, ``(state, y, given, out, nodes)``,
    made with :func:`frame_function`. ``state`` is what the nodes store (``values`` doubles each).
    They must live as long as the forms, as functions of a module do.

    Attributes:
        coordinates: ``y`` from the state; ``None`` if the state of the cell's nodes is ``y``.
        pull: ``out += Lᵀ given``, a force on ``y`` as forces and moments in the nodal frames.
        push: ``out = L given``, twists of the nodes as a variation of ``y``.
        geometric: ``out += ∂(Lᵀ given)/∂h``, a row-major square matrix; ``None`` if zero.
        values: Doubles stored per node.
        unknowns: Local-frame unknowns per node.
    """

    coordinates: Any
    pull: Any
    push: Any
    geometric: Any
    values: int
    unknowns: int

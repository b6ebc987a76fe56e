"""Records of a step as tables of addresses, for calls of compiled code.

A call from Python takes longer the more arrays there are, and longer with records than with plain
tuples.
"""

from __future__ import annotations

from fem_lie._jit.packed_arrays import PackedArrays, unpacking
from fem_lie.solve.conserving.step.records import Model, State, Step


class Packed:
    """Records by the addresses of their arrays, which must not be replaced.

    Attributes:
        model: Argument of :func:`model_of`.
        state: Argument of :func:`state_of`.
        step: Argument of :func:`step_of`.
    """

    def __init__(self, model: Model, state: State, step: Step) -> None:
        """Pack the records."""
        self._fixed = tuple(PackedArrays(record) for record in (model, state, step))
        self.model, self.state, self.step = (fixed.addresses for fixed in self._fixed)

    def set_scheme(self, model: Model) -> None:
        """Take the scheme of a ``model`` that differs in the scheme only."""
        self._fixed[0].set(model)


model_of = unpacking(Model)
state_of = unpacking(State)
step_of = unpacking(Step)

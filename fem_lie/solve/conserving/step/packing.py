"""Records of a step as tables of addresses, which is what Python hands to compiled code.

A call from Python takes the longer the more arrays there are, and records longer than plain tuples.
"""

from __future__ import annotations

from typing import TypeAlias

from fem_lie._arrays import Flags, Indices
from fem_lie._jit import inlined
from fem_lie.forms.cells import CellTable
from fem_lie.forms.fixed_arrays import (
    FixedArrays,
    integers1,
    integers2,
    numbers1,
    numbers2,
    numbers3,
    numbers4,
)
from fem_lie.lie.kinds.inertia import Inertia
from fem_lie.solve.conserving.step.records import Leaders, Legs, Model, Pieces, Scheme, State, Step
from fem_lie.system.nodes.loads import Loads

PackedModel: TypeAlias = tuple[Indices, Flags, Flags, tuple[bool, bool], tuple[float, float, float]]
"""Table of the arrays of a :class:`Model`; ``held`` and ``supported``; whether all lead themselves,
and ``viscous``; the scheme."""


class Packed:
    """Records by the addresses of their arrays, which must not be replaced by others.

    Attributes:
        model: For :func:`model_of`.
        state: For :func:`state_of`.
        step: For :func:`step_of`.
    """

    def __init__(self, model: Model, state: State, step: Step) -> None:
        """In the order of the fields."""
        self._fixed = (
            FixedArrays(
                (
                    *model.cells,
                    *model.joints,
                    *model.inertia,
                    *model.damping,
                    model.leaders.leader,
                    model.leaders.offset,
                    model.measure,
                    model.scale,
                    *model.loads,
                    model.conservative,
                    *model.pressure,
                    *model.probes,
                    model.driven,
                    *model.legs,
                )
            ),
            FixedArrays(state),
            FixedArrays(step),
        )
        self.state, self.step = (fixed.table for fixed in self._fixed[1:])
        self.model = self._model(model)

    def _model(self, model: Model) -> PackedModel:
        flags = model.leaders.trivial, model.viscous
        return self._fixed[0].table, model.held, model.supported, flags, (*model.scheme,)

    def set_scheme(self, model: Model) -> None:
        """Take the scheme of a ``model`` that differs in it alone."""
        self.model = self._model(model)


@inlined
def model_of(packed: PackedModel) -> Model:
    """The model of :class:`Packed`."""
    table, held, supported, (trivial, viscous), (h, loss, learning) = packed
    return Model(
        CellTable(
            integers2(table, 0),
            integers2(table, 1),
            integers2(table, 2),
            integers2(table, 3),
            integers1(table, 4),
            integers1(table, 5),
            integers1(table, 6),
            integers1(table, 7),
            integers1(table, 8),
        ),
        (numbers1(table, 9), integers1(table, 10)),
        Inertia(integers1(table, 11), integers1(table, 12), numbers3(table, 13)),
        Inertia(integers1(table, 14), integers1(table, 15), numbers3(table, 16)),
        Leaders(integers1(table, 17), numbers3(table, 18), trivial),
        held,
        numbers1(table, 19),
        numbers1(table, 20),
        Loads(numbers3(table, 21), numbers2(table, 22), numbers2(table, 23)),
        numbers3(table, 24),
        Pieces(integers2(table, 25), numbers2(table, 26)),
        viscous,
        Scheme(h, loss, learning),
        (numbers1(table, 27), integers1(table, 28)),
        numbers1(table, 29),
        supported,
        Legs(integers1(table, 30), integers1(table, 31)),
    )


@inlined
def state_of(table: Indices) -> State:
    """The state of :class:`Packed`."""
    return State(
        numbers3(table, 0),
        numbers3(table, 1),
        numbers3(table, 2),
        numbers1(table, 3),
        numbers1(table, 4),
        numbers2(table, 5),
        numbers1(table, 6),
        numbers1(table, 7),
        numbers3(table, 8),
        numbers2(table, 9),
        numbers1(table, 10),
        numbers2(table, 11),
        numbers1(table, 12),
        numbers2(table, 13),
        numbers2(table, 14),
        numbers1(table, 15),
        numbers3(table, 16),
        numbers2(table, 17),
        numbers1(table, 18),
        numbers1(table, 19),
    )


@inlined
def step_of(table: Indices) -> Step:
    """The step of :class:`Packed`."""
    return Step(
        numbers2(table, 0),
        numbers4(table, 1),
        numbers3(table, 2),
        numbers2(table, 3),
        numbers1(table, 4),
        numbers1(table, 5),
        numbers1(table, 6),
        numbers1(table, 7),
        numbers3(table, 8),
        numbers4(table, 9),
        numbers3(table, 10),
        numbers2(table, 11),
        numbers2(table, 12),
        numbers2(table, 13),
        numbers2(table, 14),
        numbers4(table, 15),
        numbers2(table, 16),
        numbers2(table, 17),
        numbers1(table, 18),
        numbers3(table, 19),
        numbers3(table, 20),
        numbers4(table, 21),
        numbers4(table, 22),
        numbers3(table, 23),
    )

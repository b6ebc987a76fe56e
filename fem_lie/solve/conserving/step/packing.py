"""Records of a step as packed arrays (tables of addresses), for calls of compiled code.

A call from Python takes longer the more arrays there are, and longer with records than with plain
tuples.
"""

from __future__ import annotations

from typing import TypeAlias

import numba

from fem_lie._arrays import Indices
from fem_lie._jit import inlined
from fem_lie.forms.cells import CellTable
from fem_lie.forms.fixed_arrays import (
    FixedArrays,
    frames,
    integer_sixes,
    integers1,
    integers2,
    many_frames,
    many_sixes,
    numbers1,
    numbers2,
    numbers3,
    numbers4,
    records,
    sixes,
)
from fem_lie.forms.kernels.addresses import integer_pointer
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.solve.conserving.step.records import (
    FILTER,
    IncidencePositions,
    Incidences,
    Masters,
    Model,
    Scheme,
    Segments,
    State,
    Step,
)
from fem_lie.solve.conserving.vector_cells.cell_table import CellTable as RowCells
from fem_lie.system.nodes.masses import Loads

PackedModel: TypeAlias = tuple[Indices, tuple[bool, bool], tuple[float, float, float]]
"""Addresses of the arrays of a :class:`Model`; ``trivial`` and ``viscous``; the scheme."""


class Packed:
    """Records by the addresses of their arrays, which must not be replaced.

    Attributes:
        model: Argument of :func:`model_of`.
        state: Argument of :func:`state_of`.
        step: Argument of :func:`step_of`.
    """

    def __init__(self, model: Model, state: State, step: Step) -> None:
        """Pack the records in the order of their fields."""
        self._fixed = (
            FixedArrays(
                (
                    *model.cells,
                    *model.joints,
                    *model.inertia,
                    *model.damping,
                    model.masters.master,
                    model.masters.offset,
                    model.measure,
                    model.scale,
                    *model.loads,
                    model.conservative,
                    *model.pressure,
                    *model.probes,
                    model.driven,
                    *model.incidences,
                    model.held,
                    model.supported,
                    *model.ends,
                    model.kinds,
                    model.arms,
                    *model.rows,
                    model.of_frames,
                    model.addresses,
                    model.masters.edges,
                    *model.bodies,
                    model.light,
                )
            ),
            FixedArrays(state),
            FixedArrays(step),
        )
        self.state, self.step = (fixed.table for fixed in self._fixed[1:])
        self.model = self._model(model)

    def _model(self, model: Model) -> PackedModel:
        flags = model.masters.trivial, model.viscous
        return self._fixed[0].table, flags, (*model.scheme,)

    def set_scheme(self, model: Model) -> None:
        """Take the scheme of a ``model`` that differs in the scheme only."""
        self.model = self._model(model)


@inlined
def _integers3(table: Indices, k: int) -> Indices:
    """Array ``k`` of ``table``, with three dimensions of integers."""
    shape = table[k, 1], table[k, 2], table[k, 3]
    return numba.carray(integer_pointer(table[k, 0]), shape)


@inlined
def model_of(packed: PackedModel) -> Model:
    """The model of :class:`Packed`."""
    table, (trivial, viscous), (h, dissipation, filter_gain) = packed
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
            integers1(table, 9),
        ),
        (numbers1(table, 10), integers1(table, 11)),
        Inertia(integers1(table, 12), integers1(table, 13), numbers3(table, 14)),
        Inertia(integers1(table, 15), integers1(table, 16), numbers3(table, 17)),
        Masters(integers1(table, 18), frames(table, 19), trivial, integers2(table, 50)),
        integer_sixes(table, 33),
        numbers1(table, 20),
        numbers1(table, 21),
        Loads(frames(table, 22), numbers2(table, 23), sixes(table, 24)),
        frames(table, 25),
        Segments(integers2(table, 26), numbers2(table, 27)),
        viscous,
        Scheme(h, dissipation, filter_gain),
        (numbers1(table, 28), integers1(table, 29)),
        numbers1(table, 30),
        integer_sixes(table, 34),
        Incidences(integers1(table, 31), integers1(table, 32)),
        IncidencePositions(
            integers1(table, 35), integers2(table, 36), numbers2(table, 37), numbers2(table, 38)
        ),
        integers1(table, 39),
        numbers2(table, 40),
        RowCells(
            _integers3(table, 41),
            integers1(table, 42),
            integers1(table, 43),
            integers1(table, 44),
            numbers2(table, 45),
            integers1(table, 46),
            numbers1(table, 47),
        ),
        numbers1(table, 48),
        integers1(table, 49),
        (integers1(table, 51), numbers1(table, 52)),
        numbers3(table, 53),
    )


@inlined
def state_of(table: Indices) -> State:
    """The state of :class:`Packed`."""
    return State(
        frames(table, 0),
        frames(table, 1),
        frames(table, 2),
        numbers1(table, 3),
        numbers1(table, 4),
        sixes(table, 5),
        numbers1(table, 6),
        numbers1(table, 7),
        frames(table, 8),
        sixes(table, 9),
        records(table, 10, FILTER),
        sixes(table, 11),
        numbers1(table, 12),
        sixes(table, 13),
        numbers2(table, 14),
        numbers1(table, 15),
        many_sixes(table, 16),
        numbers2(table, 17),
        numbers1(table, 18),
        numbers1(table, 19),
        numbers4(table, 20),
        many_sixes(table, 21),
        numbers1(table, 22),
    )


@inlined
def step_of(table: Indices) -> Step:
    """The step of :class:`Packed`."""
    return Step(
        sixes(table, 0),
        many_frames(table, 1),
        frames(table, 2),
        sixes(table, 3),
        numbers1(table, 4),
        numbers1(table, 5),
        numbers1(table, 6),
        numbers1(table, 7),
        frames(table, 8),
        many_frames(table, 9),
        frames(table, 10),
        sixes(table, 11),
        sixes(table, 12),
        sixes(table, 13),
        sixes(table, 14),
        many_frames(table, 15),
        sixes(table, 16),
        numbers2(table, 17),
        numbers1(table, 18),
        many_sixes(table, 19),
        many_sixes(table, 20),
        numbers4(table, 21),
        many_frames(table, 22),
        numbers3(table, 23),
        numbers1(table, 24),
        numbers4(table, 25),
        many_sixes(table, 26),
        sixes(table, 27),
        frames(table, 28),
        frames(table, 29),
        numbers2(table, 30),
    )

"""The arrays of a run of the variational scheme, as a table of addresses for its compiled loop."""

from __future__ import annotations

from typing import Any, NamedTuple

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie.forms.fixed_arrays import integers1, integers2, numbers1, numbers2, numbers3
from fem_lie.lie.kinds import inertia
from fem_lie.solve.variational import momenta


class Packed(NamedTuple):
    """Arrays of a run, in the order of :func:`packed`.

    Attributes:
        H: Frames of all rows, (N, 4, 3).
        rest: Digits that they have no room for, (n, 4, 3).
        last: The last step, and the one before, each (n, 6).
        earlier_step: The latter.
        step: The present one.
        before: Momenta at the start, (n, 6).
        after: Those at the end.
        multipliers: Present ones, and those of the last step, each (m,).
        earlier: The latter.
        gap: Violation of the constraints, (m,).
        delta: What lies between the ends, see :func:`~.momenta.between`, each (N, 4, 3).
        mean: See there.
        end: See there.
        middle: See there.
        twists: See there, (N, 6).
        still: Zeros, (N, 6).
        none: Zeros, (m,).
        driven: Zeros, (m,).
        change: Of the constraints, (m,).
        forces: Of nodes, (n, 6), likewise ``constraints``.
        constraints: Of joints.
        r: Residual, solution and room, each (6 n + m,).
        x: The solution.
        y: Room.
        work: Room.
        scale: Of the constraints, (m,).
        measure: Of all unknowns.
        held: Which of the nodes' are zero, (n, 6).
        mass: Inertia.
        joints: Their table.
        known: What the rule has learned.
        counters: See :data:`MADE`.
        numbers: See :data:`MOTION`.
        table: Of :func:`~fem_lie.system.nodes.sums.residual`.
        books: Of :func:`~fem_lie.system.outer_forces.look_and_sum_up`.
        told: Twists that these are told, in space and in the nodes' frames, each (n, 6).
        local: The latter.
        ahead: Multipliers that they are told, (m,).
        targets: Of the constraints, (m,).
        kinds: Types of the nodes, (n,).
        within: Of reduced-order bodies, see :class:`~.momenta.Within`.
    """

    H: Array
    rest: Array
    last: Array
    earlier_step: Array
    step: Array
    before: Array
    after: Array
    multipliers: Array
    earlier: Array
    gap: Array
    delta: Array
    mean: Array
    end: Array
    middle: Array
    twists: Array
    still: Array
    none: Array
    driven: Array
    change: Array
    forces: Array
    constraints: Array
    r: Array
    x: Array
    y: Array
    work: Array
    scale: Array
    measure: Array
    held: Indices
    mass: inertia.PlainInertia
    joints: tuple[Array, Indices]
    known: Array
    counters: Indices
    numbers: Array
    table: Indices
    books: Indices
    told: Array
    local: Array
    ahead: Array
    targets: Array
    kinds: Indices
    within: momenta.PlainWithin

    @property
    def arrays(self) -> list[Any]:
        """One after the other."""
        bodies, *within = self.within
        return [*self[:28], *self.mass, *self.joints, *self[30:-1], *bodies, *within]


@inlined
def packed(t: Indices) -> Packed:
    """The arrays whose addresses are in a table."""
    return Packed(
        numbers3(t, 0),
        numbers3(t, 1),
        numbers2(t, 2),
        numbers2(t, 3),
        numbers2(t, 4),
        numbers2(t, 5),
        numbers2(t, 6),
        numbers1(t, 7),
        numbers1(t, 8),
        numbers1(t, 9),
        numbers3(t, 10),
        numbers3(t, 11),
        numbers3(t, 12),
        numbers3(t, 13),
        numbers2(t, 14),
        numbers2(t, 15),
        numbers1(t, 16),
        numbers1(t, 17),
        numbers1(t, 18),
        numbers2(t, 19),
        numbers2(t, 20),
        numbers1(t, 21),
        numbers1(t, 22),
        numbers1(t, 23),
        numbers1(t, 24),
        numbers1(t, 25),
        numbers1(t, 26),
        integers2(t, 27),
        (integers1(t, 28), integers1(t, 29), numbers3(t, 30)),
        (numbers1(t, 31), integers1(t, 32)),
        numbers1(t, 33),
        integers1(t, 34),
        numbers1(t, 35),
        integers2(t, 36),
        integers2(t, 37),
        numbers2(t, 38),
        numbers2(t, 39),
        numbers1(t, 40),
        numbers1(t, 41),
        integers1(t, 42),
        (
            (integers1(t, 43), numbers1(t, 44)),
            numbers3(t, 45),
            numbers2(t, 46),
            numbers3(t, 47),
            numbers3(t, 48),
        ),
    )

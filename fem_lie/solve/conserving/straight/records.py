"""What compiled steps of nodes of any kind know: the model, the state, the step.

An increment of a node is six numbers along global axes: of a frame its translation and the vector
of Cayley's map, of other nodes those of the halves, see :mod:`..rows.halves`. Rates are of all
rows.
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import inlined
from fem_lie.forms.cells import CellTable as FrameCells
from fem_lie.lie.kinds.inertia import Inertia
from fem_lie.solve.conserving.rows.halves import CellTable
from fem_lie.solve.conserving.step.records import Products

ENERGY, SQUARES, LEAK, LIMIT = 0, 1, 2, 3
"""Of :attr:`State.told`."""


class Model(NamedTuple):
    """What does not change in a step.

    Attributes:
        cells: All cells of nodes that are no frames; they come first where cells are counted.
        framed: Those of frames.
        kinds: Of the nodes, (n,).
        arms: Moment arm of each half, by which what acts on it is a force: 1 of those that are
            lengths, that of the model of others, (n, 2).
        inertia: Mass matrix.
        turning: Angular velocities of rates of directors, see
            :func:`~fem_lie.lie.kinds.inertia.turning_of`, (n, 3, 3, 3).
        held: Which unknowns are zero, (n, 6).
        supported: Which of these from outside, (n, 6).
        dead: Loads fixed in space in the middle of the step, (n, 4, 3); they may be changed.
        conservative: Those of them that have a potential, (n, 4, 3).
        following: Loads along the axes of the nodes, (n, 6); they may be changed.
        moment: Moments fixed in space on frames, (n, 3); they may be changed.
        damping: As ``inertia``, of damping that goes with mass; without rows there is none.
        loss: χ of :mod:`fem_lie.solve.conserving.step.dissipation`.
        learning: μ.
    """

    cells: CellTable
    framed: FrameCells
    kinds: Indices
    arms: Array
    inertia: Inertia
    turning: Array
    held: Flags
    supported: Flags
    dead: Array
    conservative: Array
    following: Array
    moment: Array
    damping: Inertia
    loss: float
    learning: float


class State(NamedTuple):
    """Start of a step.

    Attributes:
        H: Rows of all nodes, ground last, (n + 1, 4, 3).
        rest: Digits of ``H`` that do not fit into it, (n, 4, 3).
        V: Rates of all rows, (n, 4, 3).
        trend: Half the change of the rate of increments in the last step, per time, (n, 6).
        carry: Forces left over by the last step, (n, 6); on frames with moments about where they
            are now.
        F: Forces of the cells of frames, in these, (places, 6).
        W: Energies of the cells, (M,).
        account: Work done on them, (M,).
        books: See :mod:`fem_lie.bodies.balances`, (15,).
        told: The scene's largest energy, the sum of ``|s|²`` of the last step, energy that came of
            what steps left over, and how large a force that was in the last one, (4,).
        weights: Multipliers over the last step, (m,).
        earlier: Those over the two before, the later one first, (2, m).
        gap: What the constraints violate, (m,).
        scale: Factor of each in the matrix, (m,).
        lag: Numbers of dissipation, see :mod:`fem_lie.solve.conserving.step.dissipation`, (11,).
        w: Memory of changes of velocity, (n, 4, 3).
        w_F: Of changes of ``F``, (places, 6).
        lasting: Forces of other cells, and memory of their changes, see :mod:`..rows.changes`,
            (2, places, 2, 3); without dissipation no places.
    """

    H: Array
    rest: Array
    V: Array
    trend: Array
    carry: Array
    F: Array
    W: Array
    account: Array
    books: Array
    told: Array
    weights: Array
    earlier: Array
    gap: Array
    scale: Array
    lag: Array
    w: Array
    w_F: Array
    lasting: Array


class Step(NamedTuple):
    """One step.

    Attributes:
        step: Increments, (n, 6).
        delta: Of the rows, (n, 4, 3).
        mean: Means of the rows, likewise.
        middle: Nodes in the middle of the step, whose axes those of the unknowns are, likewise.
        end: At the end.
        V1: Rates at the end, likewise.
        F1: Forces of the cells of frames at the end, in these, (places, 6).
        W1: Energies at the end, (M,).
        work: Done on the cells, (M,).
        forces: Of the balance, as the increments, (n, 6).
        losses: In this step, as ``books``, (15,).
        told: The sum of ``|s|²``, and the factor of forces beside, (2,).
        r: What is wrong with the balance, along the axes in the middle, and with the constraints,
            (6 n + m,).
        q: For inertia, (2, n, 4, 3).
        outer: Forces of joints, and viscous ones, (n, 6).
        change: Increments of the constraints less those of their targets, (m,).
        lasting: Forces of cells at the end, changes and what is kept of the memory, see
            :mod:`..rows.changes`, (3, places, 2, 3).
        filtered: Changes of elastic forces and their memory, (2, n, 6).
        own: Of :class:`~fem_lie.solve.conserving.step.records.Products`, (3, n, 4, 3).
        sums: Likewise, (3, 3, 3, 3).
    """

    step: Array
    delta: Array
    mean: Array
    middle: Array
    end: Array
    V1: Array
    F1: Array
    W1: Array
    work: Array
    forces: Array
    losses: Array
    told: Array
    r: Array
    q: Array
    outer: Array
    change: Array
    lasting: Array
    filtered: Array
    own: Array
    sums: Array


@inlined
def products_of(this: Step) -> Products:
    """Of velocities in the metric of inertia."""
    return Products(this.own[0], this.own[1], this.own[2], this.sums)

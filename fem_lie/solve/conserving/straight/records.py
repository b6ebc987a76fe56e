"""What compiled steps of nodes that are no frames know: the model, the state, the step."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.lie.kinds.inertia import Inertia
from fem_lie.solve.conserving.straight.rows import CellTable

ENERGY, SQUARES, LEAK, LIMIT = 0, 1, 2, 3
"""Of :attr:`State.told`."""


class Model(NamedTuple):
    """What does not change in a step.

    Attributes:
        cells: All cells.
        kinds: Of the nodes, (n,).
        inertia: Mass matrix.
        held: Which unknowns are zero, (n, 6).
        supported: Which of these from outside, (n, 6).
        dead: Loads fixed in space in the middle of the step, (n, 4, 3); they may be changed.
        conservative: Those of them that have a potential, (n, 4, 3).
        following: Loads along the axes of the nodes, (n, 6); they may be changed.
        damping: As ``inertia``, of damping that goes with mass; without rows there is none.
    """

    cells: CellTable
    kinds: Indices
    inertia: Inertia
    held: Flags
    supported: Flags
    dead: Array
    conservative: Array
    following: Array
    damping: Inertia


class State(NamedTuple):
    """Start of a step; halves are along global axes.

    Attributes:
        H: Rows of all nodes, ground last, (n + 1, 4, 3).
        rest: Digits of ``H`` that do not fit into it, (n, 4, 3).
        V: Rates of both halves, (n, 6).
        trend: Half their change in the last step, per time, (n, 6).
        carry: Forces left over by the last step, (n, 6).
        W: Energies of the cells, (M,).
        account: Work done on them, (M,).
        books: See :mod:`fem_lie.bodies.balances`, (15,).
        told: The scene's largest energy, the sum of ``|s|²`` of the last step, energy that came of
            what steps left over, and how large a force that was in the last one, (4,).
        weights: Multipliers over the last step, (m,).
        earlier: Those over the two before, the later one first, (2, m).
        gap: What the constraints violate, (m,).
        scale: Factor of each in the matrix, (m,).
    """

    H: Array
    rest: Array
    V: Array
    trend: Array
    carry: Array
    W: Array
    account: Array
    books: Array
    told: Array
    weights: Array
    earlier: Array
    gap: Array
    scale: Array


class Step(NamedTuple):
    """One step.

    Attributes:
        step: Increments of both halves, (n, 6).
        mean: Rows in the middle, (n, 4, 3).
        end: At the end.
        V1: Rates at the end, (n, 6).
        W1: Energies at the end, (M,).
        work: Done on the cells, (M,).
        forces: Of the balance, both halves, (n, 6).
        losses: In this step, as ``books``, (15,).
        told: The sum of ``|s|²``, and the factor of forces beside, (2,).
        r: What is wrong with the balance, along the axes in the middle, and with the constraints,
            (6 n + m,).
        q: For inertia, (2, n, 4, 3).
        outer: Forces of joints, and viscous ones, on both halves, (n, 6).
        change: Increments of the constraints less those of their targets, (m,).
    """

    step: Array
    mean: Array
    end: Array
    V1: Array
    W1: Array
    work: Array
    forces: Array
    losses: Array
    told: Array
    r: Array
    q: Array
    outer: Array
    change: Array

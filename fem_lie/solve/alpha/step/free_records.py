"""What steps of free rigid bodies work on: ``n`` bodies, and one of them."""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array, Indices


class Bodies(NamedTuple):
    """What bodies are.

    Attributes:
        mass: Shape (n,).
        J: Inertia tensors about the centre of mass, shape (n, 3, 3).
        scaling: Weights of translation and rotation in the size of increments, shape (n, 2).
        group: Of each, see :class:`fem_lie.lie.motions.Group`, shape (n,).
    """

    mass: Array
    J: Array
    scaling: Array
    group: Indices


class Loads(NamedTuple):
    """Forces and moments, fixed in space and then following, 12 numbers.

    Attributes:
        constant: Those without history, shape (n, 12).
        first: First of the loads with history of each body, shape (n + 1,).
        vary: Those, shape (k, 12).
        column: Their columns in the amplitudes, shape (k,).
    """

    constant: Array
    first: Indices
    vary: Array
    column: Indices


RATIO, MOTION, FEWEST, BEYOND = 0, 1, 2, 3
"""Places in the memory of a body."""


class State(NamedTuple):
    """Start of a step and what is kept between steps.

    Attributes:
        H: Frames, shape (n, 4, 3).
        v: Velocities of the group, shape (n, 6).
        vdot: Accelerations, shape (n, 6).
        a: Algorithmic accelerations, shape (n, 6).
        memory: Last ratio of increments, largest motion, fewest iterations with the kept matrix,
            iterations beyond those; shape (n, 4).
        kept: Rows of the inverse block of the rotation, columns of the block that couples it to the
            translation, rows of the inverse block of the translation; shape (n, 9, 3).
        rates: Power of the loads on each body, force and moment about the origin, shape (n, 7).
        booked: Their work and impulses so far, shape (n, 7).
    """

    H: Array
    v: Array
    vdot: Array
    a: Array
    memory: Array
    kept: Array
    rates: Array
    booked: Array


class Options(NamedTuple):
    """Of the iteration.

    Attributes:
        tolerance: Error that may be left, as a part of the largest motion.
        limit: Most iterations of a step.
        patience: As of :class:`~fem_lie.solve.motion.policies.Automatic`.
        cost: Likewise.
        rescue: Whether a step that fails is tried with a new matrix in each iteration.
    """

    tolerance: float
    limit: int
    patience: int
    cost: float
    rescue: bool


class Plan(NamedTuple):
    """Which steps are made, and what is kept of them.

    Attributes:
        first: Step.
        last: Step.
        row: Of the first one that will be kept.
        total: Number of steps of the run.
        every: How many lie between two that are kept.
    """

    first: int
    last: int
    row: int
    total: int
    every: int


class Kept(NamedTuple):
    """Where to.

    Attributes:
        frames: Shape (rows, n, 4, 3).
        velocities: Twists, shape (rows, n, 6).
        done: What loads have done, work before impulses, at the rows of these steps, to which that
            of each body is added, shape (kept, 7).
        iterations: Of each step, of the body that takes most, shape (last − first + 1,).
        failed: Of the earliest failure: body, last increment and residual; shape (3,).
    """

    frames: Array
    velocities: Array
    done: Array
    iterations: Indices
    failed: Array


class Body(NamedTuple):
    """One body.

    Attributes:
        group: It moves on.
        m: Mass.
        J: Inertia tensor about the centre of mass, shape (3, 3).
        scaling: As of :class:`Bodies`, shape (2,).
    """

    group: int
    m: float
    J: Array
    scaling: Array


class Start(NamedTuple):
    """Of one body, see :class:`State`.

    Attributes:
        H: Shape (4, 3).
        v: Shape (6,).
        vdot: Shape (6,).
        a: Shape (6,).
        memory: Shape (4,).
        kept: Shape (9, 3).
    """

    H: Array
    v: Array
    vdot: Array
    a: Array
    memory: Array
    kept: Array


class End(NamedTuple):
    """Of a step of one body, overwritten.

    Attributes:
        d: Increment, shape (6,).
        H1: Frame, shape (4, 3).
        v1: Velocity, shape (6,).
        vdot1: Acceleration, shape (6,).
        dx: Correction, shape (6,).
    """

    d: Array
    H1: Array
    v1: Array
    vdot1: Array
    dx: Array


BODY, INCREMENT, RESIDUAL = 0, 1, 2
"""Places in what is noted of a failure."""

"""Consistent initial values: velocities that joints allow, accelerations and joint forces."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array
from fem_lie.linear.equilibrated import InaccurateSolutionError, SingularMatrixError
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import KEPT, Iterated, iterate
from fem_lie.solve.renewal import Update
from fem_lie.system.equations import Plan, TimeState

if TYPE_CHECKING:
    from fem_lie.linear.direct import DirectSolver
    from fem_lie.system.equations import Equations

_LARGEST = 1e150  # the square of more is no number


def check_velocities(equations: Equations, step: float) -> None:
    """Check the initial velocities of the bodies against clamps and joints.

    Args:
        equations: Of the scene.
        step: Step size; velocities may be wrong by what is not felt in one.

    Raises:
        ValueError: They break a clamp or a joint; the message names it.
    """
    unknowns, master = equations.unknowns, equations.tables.master
    for clamp in equations.scene.clamps:
        body, node = clamp.point.body, clamp.point.node
        assert body is not None
        v = equations.start.velocities[master[unknowns.bodies[body][node]]]
        if v.any():
            raise ValueError(
                f"{clamp.point.label} is clamped, but has the initial velocity {v} (translation, "
                "rotation, in its frame); it must be zero"
            )
    velocities, first = _rates_at_start(equations, step)
    _, finer = _rates_at_start(equations, 0.5 * step)
    # of nodes, and of frames that are prescribed
    units = np.full(velocities.shape, np.repeat([unknowns.length, 1.0], 3))
    units[: unknowns.moving] = unknowns.units.reshape(-1, 6)
    speed = float(np.abs(velocities / units).max())
    # below the second bound the error of a whole step is less than 1e-9 of the size
    bound = max(1e-6 * speed, 1e-9 / step)
    _check_held(equations, bound)
    # rates of drives and motions are differences, which are wrong by about what half a step changes
    left = np.maximum(np.abs(finer) - np.abs(first - finer), 0.0)
    rates = left / np.where(unknowns.angular, 1.0, unknowns.length)
    if (rates > bound).any():
        c = int(rates.argmax())
        joint = equations.info.joints[int(equations.tables.owner[c])]
        raise ValueError(
            f"the initial velocities break {joint.name}: its constraint changes at the rate "
            f"{first[c]:g}; give both bodies velocities that the joint allows"
        )


def _rates_at_start(equations: Equations, step: float) -> tuple[Array, Array]:
    """Velocities with those of motions, and rates of all constraints less those of their drives."""
    frames, given, _ = equations.start
    prescribed = equations.prescribed(0.0, step)
    velocities = _moved(equations, given, prescribed.velocities)
    first, _ = equations.constraints(frames).rates(velocities)
    return velocities, np.asarray(first - prescribed.target_rates[0])


def _check_held(equations: Equations, bound: float) -> None:
    """Check the velocities of what bodies hold; shells of five parameters may be said to drill."""
    unknowns, (frames, given, _) = equations.unknowns, equations.start
    v = given[: unknowns.moving].copy()
    equations.supports.turn(frames, v)
    wrong = unknowns.held & (np.abs(v) > bound * unknowns.units.reshape(-1, 6))
    wrong[:, 5] = False
    if wrong.any():
        node = int(np.flatnonzero(wrong.any(axis=1))[0])
        which, bodies = int(unknowns.masters[node]), unknowns.bodies.items()
        body, own = next((b, np.flatnonzero(n == which)) for b, n in bodies if which in n)
        raise ValueError(
            f"node {own[0]} of {body.label} is held, but has the initial velocity {v[node]} "
            "(translation, rotation) along what is held; it must be zero"
        )


def _moved(equations: Equations, velocities: Array, prescribed: Array) -> Array:
    """Velocities of all rows with those of the prescribed motions, (p, 6)."""
    v = velocities.copy()
    v[equations.unknowns.moving + 1 :] = prescribed
    return v


def accelerations(
    equations: Equations,
    solver: DirectSolver,
    H: Array,
    v: Array,
    time: float,
    step: float,
    sweeps: int = 1,
) -> tuple[Array, Array]:
    """``v̇`` and multipliers from the equations of motion and twice differentiated constraints.

    ::

        M v̇ + Bᵀ λ = f(H, v, t)          B v̇ = −Ḃ v

    They are solved with ``M + h² K/4``, so that modes of which a step is no part of a period do not
    take part. That is wrong by the order ``h²`` for the others; each sweep more, with what is left
    of the equations, takes two orders away.

    Args:
        equations: Of the scene; their matrix and loads are overwritten.
        solver: For that matrix.
        H: Frames of all rows.
        v: Local velocities of all rows; those of prescribed motions are found here.
        time: The time.
        step: Over which prescribed motions are differentiated; ``h``.
        sweeps: How often they are solved.

    Returns:
        Shapes (n, 6) and (m,).

    Raises:
        ValueError: The mass matrix is singular, forces are beyond the range of numbers, or no
            solver could solve the equations.
    """
    n = equations.unknowns.moving
    prescribed = equations.prescribed(time, step)
    v = _moved(equations, v, prescribed.velocities)
    prescribed.act()
    H = np.concatenate([H[: n + 1], prescribed.frames])
    rate = np.zeros_like(v)
    rate[n + 1 :] = prescribed.accelerations
    # ẍ = R (u̇ + ω × u) = 0, of which supports hold a part
    guided = equations.supports.nodes
    rate[guided, :3] = -np.cross(v[guided, 3:], v[guided, :3])
    start = _AtStart(equations, solver, (H, v, rate), prescribed.target_rates[1], step)
    iterate(start, sweeps, KEPT)
    return rate[:n], start.weights


class _AtStart(Iterated):
    """Accelerations and multipliers at given frames and velocities.

    The equations are linear, but the matrix is that of a step: each iteration more corrects what
    that leaves.

    Attributes:
        weights: Multipliers, shape (m,).
    """

    def __init__(
        self,
        equations: Equations,
        solver: DirectSolver,
        motion: tuple[Array, Array, Array],
        targets: Array,
        step: float,
    ) -> None:
        self._equations, self._solver, self._step, self._targets = equations, solver, step, targets
        self._H, self._v, self._rate = motion
        self.weights = np.zeros(equations.unknowns.m)
        self._constraints = equations.constraints(self._H)
        _, self._second = self._constraints.rates(self._v)
        self._scale: Array | None = None

    @property
    def missing(self) -> bool:
        return self._scale is None

    def evaluate(self, iteration: int) -> bool:
        """Evaluate what is left of the equations; residuals do not end the iteration."""
        n, r = self._equations.unknowns.moving, self._solver.right_hand_side
        now = TimeState(self._H, self._v, self._rate[:n], self.weights)
        self._equations.residual(now, np.ones(len(self.weights)), r, carried=True)
        drive, _ = self._constraints.rates(self._rate)
        r[6 * n :] = self._second + drive - self._targets
        largest = float(np.abs(r).max(initial=0.0))
        if not largest < _LARGEST:
            raise ValueError(f"forces at the start are {largest:.1e}: they cannot be computed with")
        return False

    def renew(self, update: Update) -> None:
        self._scale = _fill(self._equations, self._H, self._step)
        with _solvable():
            self._solver.factorise()

    def correct(self) -> float:
        """Solve for a correction and apply it; returns its size."""
        assert self._scale is not None
        n, solver = self._equations.unknowns.moving, self._solver
        solver.right_hand_side[6 * n :] *= self._scale
        with _solvable():
            solver.solve()
        found, nodes = solver.solution, solver.solution[: 6 * n].reshape(n, 6)
        self._equations.supports.turn_back(self._H, nodes)
        self._rate[:n] -= nodes
        self.weights -= self._scale * found[6 * n :]
        return float(np.abs(found).max(initial=0.0))

    def judge(self, size: float) -> Verdict:
        return Verdict.GOES_ON


@contextmanager
def _solvable() -> Iterator[None]:
    """Name the cause where the equations at the start have no solution."""
    try:
        yield
    except InaccurateSolutionError as error:
        raise ValueError(f"initial accelerations cannot be computed: {error}") from error
    except SingularMatrixError as error:
        raise ValueError(
            "the mass matrix is singular: a body or section lacks (rotary) inertia"
        ) from error


def _fill(equations: Equations, H: Array, step: float) -> Array:
    """The matrix for that, in which steps of a size do not feel what they do not resolve."""
    none = np.zeros((equations.unknowns.moving, 6))
    still = TimeState(H, none, none, np.zeros(equations.unknowns.m))
    return equations.fill(still, None, Plan(none, at_rest=step))


def allowed_velocities(
    equations: Equations, solver: DirectSolver, H: Array, twist: Array, time: float, step: float
) -> Array:
    """Velocities ``twist`` (≥ n, 6) without what joints and motions forbid, by an impulse in them.

    Args:
        equations: Of the scene; their matrix is overwritten.
        solver: For that matrix.
        H: Frames of all rows.
        twist: Local velocities.
        time: The time.
        step: As in :func:`accelerations`.
    """
    prescribed = equations.prescribed(time, step)
    v = _moved(equations, twist, prescribed.velocities)
    if equations.unknowns.m == 0:
        return v
    rates, _ = equations.constraints(H).rates(v)
    rates -= prescribed.target_rates[0]
    v[: equations.unknowns.moving] -= across_joints(equations, solver, H, rates, step)
    return v


def across_joints(
    equations: Equations, solver: DirectSolver, H: Array, rates: Array, step: float
) -> Array:
    """Velocities that change constraints at given rates, the nearest to rest in them.

    Args:
        equations: Of the scene; their matrix is overwritten.
        solver: For that matrix.
        H: Frames of all rows.
        rates: Of the constraints, shape (m,).
        step: As in :func:`accelerations`.

    Returns:
        Twists of the moving nodes, shape (n, 6).
    """
    n = equations.unknowns.moving
    solver.right_hand_side[: 6 * n] = 0.0
    solver.right_hand_side[6 * n :] = rates * _fill(equations, H, step)
    solver.factorise()
    solver.solve()
    v = solver.solution[: 6 * n].reshape(n, 6).copy()
    equations.supports.turn_back(H, v)
    return v

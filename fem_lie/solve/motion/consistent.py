"""Consistent initial values: admissible velocities, accelerations and joint forces."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.node_types import push_all_forward
from fem_lie.linear.equilibrated import InaccurateSolutionError, SingularMatrixError
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import FROZEN, Iterated, iterate
from fem_lie.solve.motion.step_log import add_inertia_forces
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.system.equations import Plan, TimeState

if TYPE_CHECKING:
    from fem_lie.linear.direct import DirectSolver
    from fem_lie.system.equations import Equations

_LARGEST = 1e150  # the square of a larger number overflows

_MOST_SWEEPS, _ROUND_OFF = 50, 1e-15
"""Largest number of solutions with friction in joints, and corrections over the first that end."""


def check_velocities(equations: Equations, step: float) -> None:
    """Check the initial velocities of the bodies against clamps and joints.

    Args:
        equations: Equations of the scene.
        step: Step size; violations that are not resolved in one step are accepted.

    Raises:
        ValueError: Velocities violate a clamp or a joint; the message names it.
    """
    unknowns, master = equations.unknowns, equations.arrays.master
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
    # velocities of nodes and of prescribed frames
    units = np.full(velocities.shape, np.repeat([unknowns.length, 1.0], 3))
    units[: unknowns.moving] = unknowns.units.reshape(-1, 6)
    speed = equations.shared.largest(float(np.abs(velocities / units).max()))
    # below the second bound the error of a whole step is less than 1e-9 of the size
    bound = max(1e-6 * speed, 1e-9 / step)
    _check_held(equations, bound)
    # rates of drives and motions are difference quotients, with an error of about half a step
    left = np.maximum(np.abs(finer) - np.abs(first - finer), 0.0)
    rates = left / np.where(unknowns.angular, 1.0, unknowns.length)
    if (rates > bound).any():
        c = int(rates.argmax())
        joint = equations.info.joints[int(equations.arrays.owner[c])]
        raise ValueError(
            f"the initial velocities break {joint.name}: its constraint changes at the rate "
            f"{first[c]:g}; give both bodies velocities that the joint allows"
        )


def _rates_at_start(equations: Equations, step: float) -> tuple[Array, Array]:
    """Velocities with prescribed ones, and rates of all constraints minus those of drives."""
    frames, given, _ = equations.start
    prescribed = equations.prescribed(0.0, step)
    velocities = _moved(equations, given, prescribed.velocities)
    first, _ = equations.constraints(frames).rates(velocities)
    return velocities, np.asarray(first - prescribed.target_rates[0])


def _check_held(equations: Equations, bound: float) -> None:
    """Check velocities of unknowns that bodies fix, such as drilling rotations of shells."""
    unknowns, (frames, given, _) = equations.unknowns, equations.start
    v = given[: unknowns.moving].copy()
    equations.supports.rotate(frames, v)
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
    """Velocities of all nodes and prescribed motions, (p, 6)."""
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
    """Initial ``v̇`` and Lagrange multipliers from the equations of motion.

    Constraints enter as acceleration constraints::

        M v̇ + Bᵀ λ = f(H, v, t)          B v̇ = −Ḃ v

    They are solved with ``M + h² K/4``, so that modes that the step size does not resolve do not
    take part. For the others this is an error of order ``h²``; each further sweep, with the
    remaining residual, gains two orders. Friction in joints depends on the multipliers: then there
    is one sweep with the friction of the multipliers before, until these no longer change.

    Args:
        equations: Equations of the scene; their matrix and loads are overwritten.
        solver: Solver for that matrix.
        H: Frames of all nodes, ground and prescribed motions.
        v: Local velocities of all nodes; those of prescribed motions are computed here.
        time: The time.
        step: Step ``h`` of the difference quotients of prescribed motions.
        sweeps: Number of solutions, without friction in joints.

    Returns:
        Accelerations (n, 6) and multipliers (m,).

    Raises:
        ValueError: The mass matrix is singular, forces overflow, or the equations cannot be solved.
    """
    n = equations.unknowns.moving
    prescribed = equations.prescribed(time, step)
    v = _moved(equations, v, prescribed.velocities)
    prescribed.act()
    H = np.concatenate([H[: n + 1], prescribed.frames])
    rate = np.zeros_like(v)
    rate[n + 1 :] = prescribed.accelerations
    # ẍ = R (u̇ + ω × u) = 0, of which supports fix some components
    guided = equations.supports.nodes
    if len(guided):
        rate[guided, :3] = -np.cross(v[guided, 3:], v[guided, :3])
    start = _AtStart(equations, solver, (H, v, rate), prescribed.target_rates[1], step)
    iterate(start, _MOST_SWEEPS if start.nonlinear else sweeps, FROZEN)
    return rate[:n], start.multipliers


class _AtStart(Iterated):
    """Equations for accelerations and multipliers at given frames and velocities.

    Without friction the equations are linear, but the matrix is that of a step: each further
    iteration reduces the remaining residual. With it each iteration starts from zero accelerations,
    as unresolved modes would take part otherwise.

    Attributes:
        multipliers: Lagrange multipliers, shape (m,).
        nonlinear: Whether forces depend on them, by friction in joints.
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
        self.multipliers = np.zeros(equations.unknowns.m)
        self._constraints = equations.constraints(self._H)
        _, self._second = self._constraints.rates(self._v)
        self._scale: Array | None = None
        self.nonlinear, self._first = equations.unknowns.joint_friction, 0.0
        self._none = self._rate[: equations.unknowns.moving].copy()
        self._before = np.zeros(6 * equations.unknowns.moving)

    @property
    def missing(self) -> bool:
        return self._scale is None

    def evaluate(self, iteration: int) -> bool:
        """Evaluate the residual, which does not end the iteration."""
        n, r = self._equations.unknowns.moving, self._solver.right_hand_side
        if self.nonlinear:
            self._rate[:n] = self._none
        now = TimeState(self._H, self._v, self._rate[:n], self.multipliers)
        self._equations.residual(now, np.ones(len(self.multipliers)), r, linearised=True)
        drive, _ = self._constraints.rates(self._rate)
        r[6 * n :] = self._second + drive - self._targets
        largest = float(np.abs(r).max(initial=0.0))
        if not largest < _LARGEST:
            raise ValueError(f"forces at the start are too large ({largest:.1e})")
        return False

    def refactorise(self, update: Refactorisation) -> None:
        self._scale = _fill(self._equations, self._H, self._step)
        with _solvable():
            self._solver.factorise()

    def correct(self) -> float:
        """Solve for a correction and apply it; return its size."""
        assert self._scale is not None
        n, solver = self._equations.unknowns.moving, self._solver
        solver.right_hand_side[6 * n :] *= self._scale
        with _solvable():
            solver.solve()
        found, nodes = solver.solution, solver.solution[: 6 * n].reshape(n, 6)
        self._equations.supports.rotate_back(self._H, nodes)
        self._rate[:n] -= nodes
        self.multipliers -= self._scale * found[6 * n :]
        change = found.copy()
        if self.nonlinear:
            change[: 6 * n] -= self._before
            self._before[:] = nodes.ravel()
        size = float(np.abs(change).max(initial=0.0))
        self._first = self._first or size
        return size

    def judge(self, size: float) -> Verdict:
        ends = self.nonlinear and size <= _ROUND_OFF * self._first
        return Verdict.CONVERGED if ends else Verdict.GOES_ON


@contextmanager
def _solvable() -> Iterator[None]:
    """Name the cause if the equations at the start cannot be solved."""
    try:
        yield
    except InaccurateSolutionError as error:
        raise ValueError(f"initial accelerations cannot be computed: {error}") from error
    except SingularMatrixError as error:
        raise ValueError(
            "the mass matrix is singular: a body or section lacks (rotary) inertia"
        ) from error


def _fill(equations: Equations, H: Array, step: float) -> Array:
    """Assemble that matrix, with stiffness that suppresses unresolved modes."""
    none = np.zeros((equations.unknowns.moving, 6))
    still = TimeState(H, none, none, np.zeros(equations.unknowns.m))
    return equations.fill(still, None, Plan(none, at_rest=step))


def allowed_velocities(
    equations: Equations,
    solver: DirectSolver,
    H: Array,
    twist: Array,
    time: float,
    step: float,
    restitution: Array | None = None,
) -> Array:
    """Velocities ``twist`` (≥ n, 6) made admissible by an impulse in joints and prescribed motions.

    Args:
        equations: Equations of the scene; their matrix is overwritten.
        solver: Solver for that matrix.
        H: Frames of all nodes, ground and prescribed motions.
        twist: Local velocities.
        time: The time.
        step: As in :func:`accelerations`.
        restitution: Coefficient by which each constraint reverses its rate, shape (m,); default:
            none does.
    """
    prescribed = equations.prescribed(time, step)
    v = _moved(equations, twist, prescribed.velocities)
    if equations.unknowns.constraints == 0:
        return v
    rates, _ = equations.constraints(H).rates(v)
    rates -= prescribed.target_rates[0]
    if restitution is not None:
        rates *= 1.0 + restitution
    n = equations.unknowns.moving
    across = across_joints(equations, solver, H, rates, step)
    v[:n] -= across + _slowed_down(equations, solver, H, across)
    return v


def across_joints(
    equations: Equations, solver: DirectSolver, H: Array, rates: Array, step: float
) -> Array:
    """Velocities with given constraint rates and the least kinetic energy, to second order.

    The mass matrix is ``M + h² K/4``, see :func:`accelerations`.

    Args:
        equations: Equations of the scene; their matrix is overwritten.
        solver: Solver for that matrix.
        H: Frames of all nodes, ground and prescribed motions.
        rates: Rates of the constraints, shape (m,).
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
    equations.supports.rotate_back(H, v)
    return v


def _slowed_down(equations: Equations, solver: DirectSolver, H: Array, across: Array) -> Array:
    """What stiffness takes from the velocities of :func:`across_joints`, to fourth order.

    The solution satisfies ``(M + h² K/4) v + Bᵀ λ = 0``, so that ``h² K/4 v`` is the residual of
    the equations of an impulse. A solution with it is the second sweep of :func:`accelerations`:
    modes that a step resolves get the velocities of an impulse, others still take little part.

    Args:
        equations: Equations of the scene.
        solver: Solver with the matrix and the solution of :func:`across_joints`.
        H: Frames of all nodes, ground and prescribed motions.
        across: These velocities, shape (n, 6).

    Returns:
        Twists of the moving nodes, shape (n, 6).
    """
    unknowns = equations.unknowns
    kinds, shape, n = unknowns.kinds, across.shape, 6 * len(across)
    q, forces, x = np.zeros((len(across), 4, 3)), np.zeros(shape), solver.solution.copy()
    push_all_forward(kinds, H, across, q)
    add_inertia_forces(equations, H, q, 1.0, forces)
    equations.supports.rotate(H, forces)
    x[n:] = 0.0
    residual = solver.times(x)[:n].reshape(shape) - forces
    residual[unknowns.held] = 0.0
    solver.right_hand_side[:n] = residual.ravel()
    solver.right_hand_side[n:] = 0.0
    solver.solve()
    v = solver.solution[:n].reshape(shape).copy()
    equations.supports.rotate_back(H, v)
    return v

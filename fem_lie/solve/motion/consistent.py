"""Consistent initial values: admissible velocities, accelerations and joint forces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial

import numpy as np

from fem_lie._arrays import Array, instance, number, positive, shown
from fem_lie.joints.connection import Coordinate
from fem_lie.joints.springs import Drive
from fem_lie.lie.node_types import push_all_forward
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import InaccurateSolutionError, SingularMatrixError
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene.scene import Scene, require_scene
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import FROZEN, Iterated, iterate
from fem_lie.solve.motion.step_log import add_inertia_forces
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.solve.starting import starting_from
from fem_lie.system.equations import Equations, Plan, TimeState

_LARGEST = 1e150  # the square of a larger number overflows

_MOST_SWEEPS, _ROUND_OFF = 50, 1e-15
"""Largest number of solutions with friction in joints, and corrections over the first that end."""

_PREFIX = "fem_lie_initial_velocities_"
"""Prefix of the PETSc options of the solver that finds initial velocities."""

_TIMES = [10.0**k for k in range(5)]
"""Times, in steps, in which elastic bodies get their initial velocities."""

_SETTLED, _FAST, _STOPPED = 1e-10, 0.01, 0.9
"""Relative change of initial velocities that ends their iteration; ratios of changes above which it
is slow, and has stopped."""

_CONTRADICTED = 1e-9
"""Rates of constraints over the largest velocity: larger ones show that they contradict."""


def set_initial_velocities(
    scene: Scene,
    step: float,
    *,
    rates: Sequence[tuple[Coordinate, float]] = (),
    start: StaticResult | None = None,
) -> None:
    """Change the initial velocities of all bodies to those that joints allow.

    Joints, drives, prescribed motions and ``rates`` change the given velocities. Elastic bodies and
    springs keep their rates of strain where they can, so that no vibrations with periods of up to
    ten thousand steps are excited; of all velocities of that kind the bodies get those whose
    difference from the given ones has the least kinetic energy, as after an impulse in joints.
    Bodies whose stress is out of balance at their nodes also resist rotation by it.

    Args:
        scene: The scene; velocities of its bodies change, see
            :meth:`~fem_lie.extend.Body.add_velocity`.
        step: Step size of the run, time; rates of drives are differences over it.
        rates: Coordinates of joints that have no drive, and their rates, length or rad per time.
        start: Equilibrium from which the run starts, see :meth:`~fem_lie.GeneralisedAlpha.run`.

    Raises:
        ValueError: A rate is not finite, its joint is not in the scene, no velocities satisfy all
            constraints, or the scene is invalid. Velocities are then unchanged.

    Example:
        >>> crank = fl.RigidBody(1.0, (0.01, 0.01, 0.01), position=(0, 0, 0.5))
        >>> scene = fl.Scene()
        >>> _ = scene.add(crank)
        >>> centre = crank.point("centre")
        >>> hinge = fl.joints.Revolute(fl.ground(), centre, at=(0, 0, 0), axis=(0, 1, 0))
        >>> _ = scene.add(hinge)
        >>> fl.schemes.set_initial_velocities(scene, 1e-3, rates=[(hinge.angle, 2.0)])
        >>> crank.velocities.round(9)[0]
        array([1., 0., 0., 0., 2., 0.])
    """
    require_scene(scene)
    positive(step, "step")
    moved = scene if start is None else starting_from(scene, start)
    equations = Equations(_with_rates(moved.without_impacts(), rates), dynamics=True)
    frames, before, _ = equations.start
    prescribed = equations.prescribed(0.0, step)
    v = _moved(equations, before, prescribed.velocities)
    H, aims = frames, prescribed.target_rates[0]
    left = equations.constraints(H).rates(v)[0] - aims
    with _solvable():
        v[: equations.unknowns.moving] -= _without_strain(equations, H, left, step)
    _check_satisfied(equations, equations.constraints(H).rates(v)[0] - aims, v)
    change = equations.of_bodies((v - before)[: equations.unknowns.moving])
    for body, velocities in change.items():
        body.velocities = body.velocities + velocities


def _without_strain(equations: Equations, H: Array, rates: Array, step: float) -> Array:
    """Velocities with given constraint rates, least rates of strain, then least kinetic energy.

    Proximal points of the quadratic programme ::

        (M + τ² K) v⁺ + Bᵀ λ = M v          B v⁺ = rates

    reduce a vibration of the angular frequency ω by ``1/(1 + τ² ω²)`` each. Where they do so too
    slowly, τ grows, and not from the start: round-off in ``τ² K`` hides masses.

    Args:
        equations: Equations of the scene; their matrix is overwritten.
        H: Frames of all nodes, ground and prescribed motions.
        rates: Rates of the constraints, shape (m,).
        step: First ``2τ``.

    Returns:
        Twists of the moving nodes, shape (n, 6).
    """
    n, v = equations.unknowns.moving, np.zeros((equations.unknowns.moving, 6))
    solver = DirectSolver(equations.matrix, _PREFIX)
    solver.take_low_rank()
    for times in _TIMES:
        scale, change, fast = _fill(equations, H, times * step), np.inf, False
        solver.factorise()
        for sweep in range(_MOST_SWEEPS):
            solver.right_hand_side[: 6 * n] = _momentum(equations, H, v).ravel()
            solver.right_hand_side[6 * n :] = rates * scale
            solver.solve()
            found = solver.solution[: 6 * n].reshape(n, 6).copy()
            equations.supports.rotate_back(H, found)
            before, change = change, equations.shared.largest(float(np.abs(found - v).max()))
            v, slow = found, change > _FAST * before
            settled = change <= _SETTLED * equations.shared.largest(float(np.abs(v).max()))
            if settled or (fast and slow):
                return v
            if slow and (times < _TIMES[-1] or change > _STOPPED * before):
                break
            fast = sweep > 1  # the first change is that of all motions
    return v


def _with_rates(scene: Scene, rates: Sequence[tuple[Coordinate, float]]) -> Scene:
    """A copy of the scene in which coordinates are driven at given rates."""
    driven = scene.with_loads(*scene.loads)
    instance(rates, Sequence, "rates", "a list of pairs, as [(joint.angle, 2.0)]")
    for pair in rates:
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise TypeError(
                "rates: expected pairs of a coordinate and its rate, as (joint.angle, 2.0), got "
                f"{shown(pair)}"
            )
        coordinate, rate = pair
        Coordinate.require(coordinate, "rates: coordinate")
        given = number(rate, f"rate of the {coordinate.label}")
        at = coordinate.start()
        driven.add(Drive(coordinate, partial(_line, at, given)))
    return driven


def _line(start: float, rate: float, time: float) -> float:
    return start + rate * time


def _check_satisfied(equations: Equations, left: Array, v: Array) -> None:
    """Raise ``ValueError`` unless velocities (n + 1 + p, 6) leave no rates of constraints (m,)."""
    unknowns = equations.unknowns
    rates = np.abs(left) / np.where(unknowns.angular, 1.0, unknowns.length)
    speed = np.abs(v / np.repeat([unknowns.length, 1.0], 3)).max(initial=0.0)
    if rates.max(initial=0.0) > _CONTRADICTED * speed:
        c = int(rates.argmax())
        name = equations.info.joints[int(equations.arrays.owner[c])].name
        raise ValueError(
            "set_initial_velocities: expected constraints that some velocities satisfy, got "
            f"{name}, whose rate is wrong by {left[c]:.2g}"
        )


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
            f"{first[c]:g}; give both bodies velocities that the joint allows, for example by "
            "fl.schemes.set_initial_velocities"
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
    *,
    scale: Array | None = None,
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
        scale: Scale of the constraints in the matrix of which ``solver`` has factors, (m,);
            default: it gets new ones.

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
    given = (H, v, rate), prescribed.target_rates[1], step, scale
    start = _AtStart(equations, solver, *given)
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
        scale: Array | None,
    ) -> None:
        self._equations, self._solver, self._step, self._targets = equations, solver, step, targets
        self._H, self._v, self._rate = motion
        self.multipliers = np.zeros(equations.unknowns.m)
        self._constraints = equations.constraints(self._H)
        _, self._second = self._constraints.rates(self._v)
        self._scale = scale
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


def _momentum(equations: Equations, H: Array, v: Array) -> Array:
    """Momenta ``M v`` of velocities (n, 6), zero where unknowns are held, (n, 6)."""
    q, momentum = np.zeros((len(v), 4, 3)), np.zeros(v.shape)
    push_all_forward(equations.unknowns.kinds, H, v, q)
    add_inertia_forces(equations, H, q, 1.0, momentum)
    equations.supports.rotate(H, momentum)
    momentum[equations.unknowns.held] = 0.0
    return momentum


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
    shape, n, x = across.shape, 6 * len(across), solver.solution.copy()
    x[n:] = 0.0
    residual = solver.times(x)[:n].reshape(shape) - _momentum(equations, H, across)
    residual[equations.unknowns.held] = 0.0
    solver.right_hand_side[:n] = residual.ravel()
    solver.right_hand_side[n:] = 0.0
    solver.solve()
    v = solver.solution[:n].reshape(shape).copy()
    equations.supports.rotate_back(H, v)
    return v

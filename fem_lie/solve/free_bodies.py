"""Generalised-α for rigid bodies that nothing holds: one compiled loop, no matrix of the scene.

A free body has its own six equations, in its own frame at the centre of mass::

    m (u̇ + ω×u) = Rᵀf + f'           J ω̇ + ω×Jω = Rᵀm + m'                 on SE(3)
    m ü = Rᵀ(f + R₁ f')              the same                              on R³×SO(3)

with forces and moments ``f, m`` fixed in space and ``f', m'`` following; on R³×SO(3) the
translation is in components of the frame at the start of the step (:mod:`fem_lie.solve.scheme`).
Turning does not depend on the translation, so the 6×6 matrix of Newton's method is block
triangular, and its factorisation is two 3×3 inverses and the block between them. It is constant
in these frames but for the gyroscopic and load terms, and kept as the policy says.

Scheme, start, stopping rule and results are those of :mod:`fem_lie.solve.generalised_alpha`, for
every body by itself: its iteration does not depend on what else is in the scene.
"""

from __future__ import annotations

import time as clock
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fem_lie import inertia
from fem_lie._jit import Array, Indices, compiled, inlined
from fem_lie._lie_tuples import (
    Vector,
    blend,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    negative,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
    tangent_coefficients,
)
from fem_lie.info import SceneInfo
from fem_lie.loads import History as LoadHistory
from fem_lie.loads import amplitudes, histories
from fem_lie.numbering import Numbering
from fem_lie.results import Result
from fem_lie.rigid import RigidBody
from fem_lie.scene import Scene
from fem_lie.solve import scheme
from fem_lie.solve.linear import ConvergenceError
from fem_lie.solve.policies import Policy
from fem_lie.solve.recorder import History
from fem_lie.system import refuse_ranks

if TYPE_CHECKING:
    from fem_lie.solve.generalised_alpha import GeneralisedAlpha

_CHUNK = 200_000  # steps of bodies between two returns to Python: 0.1 s


def applies(scene: Scene, policy: Policy) -> bool:
    """Whether the scene is rigid bodies alone, and the policy a rule for compiled loops."""
    held = scene.joints or scene.clamps or scene.motions
    rigid = all(isinstance(body, RigidBody) and not body.gram[0, 1:].any() for body in scene.bodies)
    return bool(scene.bodies) and rigid and not held and policy.rule() is not None


class _Bodies(NamedTuple):
    """What a body is.

    Attributes:
        mass: Shape (n,).
        J: Inertia tensors about the centre of mass, shape (n, 3, 3).
        size: Length of the tolerance, shape (n,).
        group: :data:`scheme.SE3` or :data:`scheme.R3XSO3`, shape (n,).
    """

    mass: Array
    J: Array
    size: Array
    group: Indices


class _Loads(NamedTuple):
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


class _State(NamedTuple):
    """Start of a step and what is kept between steps.

    Attributes:
        memory: Last ratio of increments, largest motion, fewest iterations with the kept matrix,
            iterations beyond those; shape (n, 4).
        kept: Rows of the inverse block of the rotation, columns of the block that couples it to the
            translation, rows of the inverse block of the translation; shape (n, 9, 3).
    """

    H: Array
    v: Array
    vdot: Array
    a: Array
    memory: Array
    kept: Array


class _Options(NamedTuple):
    """Of the iteration; ``patience`` and ``cost`` as of :class:`policies.Automatic`."""

    tolerance: float
    limit: int
    patience: int
    cost: float
    rescue: bool


# --- one body -----------------------------------------------------------------------------------


@inlined
def _load(loads: tuple[Array, ...], amplitude: Array, i: int, f: Array) -> None:
    """Load of body ``i`` into ``f`` (12,)."""
    constant, first, vary, column = loads
    for k in range(12):
        f[k] = constant[i, k]
    for entry in range(first[i], first[i + 1]):
        for k in range(12):
            f[k] += amplitude[column[entry]] * vary[entry, k]


@inlined
def _residual(
    group: int, m: float, J: Array, f: Array, H: Array, H1: Array, v1: Array, vdot1: Array
) -> tuple[Vector, Vector]:
    """Inertia minus load at the end of a step: translation and rotation."""
    d1, d2, d3 = load_row(H1, 1), load_row(H1, 2), load_row(H1, 3)
    J1, J2, J3 = load_row(J, 0), load_row(J, 1), load_row(J, 2)
    ω = load(v1, 3)
    rate = rotate_back(J1, J2, J3, load(vdot1, 3))
    gyroscopic = cross(ω, rotate_back(J1, J2, J3, ω))
    moment = plus(rotate_back(d1, d2, d3, load(f, 3)), load(f, 9))
    turning = minus(plus(rate, gyroscopic), moment)
    acceleration = load(vdot1, 0)
    if group == scheme.SE3:
        acceleration = plus(acceleration, cross(ω, load(v1, 0)))
        force = plus(rotate_back(d1, d2, d3, load(f, 0)), load(f, 6))
    else:
        fixed = plus(load(f, 0), rotate(d1, d2, d3, load(f, 6)))
        force = rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), fixed)
    return minus(scaled(m, acceleration), force), turning


@inlined
def _inverse(a: Vector, b: Vector, c: Vector) -> tuple[Vector, Vector, Vector]:
    """Rows of the inverse of the matrix with columns ``a, b, c``."""
    bc = cross(b, c)
    s = 1.0 / dot(a, bc)
    return scaled(s, bc), scaled(s, cross(c, a)), scaled(s, cross(a, b))


@inlined
def _columns(
    parameters: tuple[float, ...],
    group: int,
    m: float,
    J: Array,
    f: Array,
    H: Array,
    H1: Array,
    v1: Array,
    d: Array,
    e: Vector,
) -> tuple[Vector, Vector, Vector]:
    """Derivatives of the residual along the unit vector ``e``.

    Of the rotation by ``d_θ``, of the translation by ``d_θ``, of the translation by ``d_u``.
    """
    _, _, _, _, _, mass, damping, _ = parameters
    d1, d2, d3 = load_row(H1, 1), load_row(H1, 2), load_row(H1, 3)
    J1, J2, J3 = load_row(J, 0), load_row(J, 1), load_row(J, 2)
    ω, θ = load(v1, 3), load(d, 3)
    Je, Jω = rotate_back(J1, J2, J3, e), rotate_back(J1, J2, J3, ω)
    k, _ = tangent_coefficients(dot(θ, θ))
    h = blend(k, θ, e)
    turning = combined(mass, Je, damping, plus(cross(ω, Je), cross(e, Jω)))
    turning = minus(turning, cross(rotate_back(d1, d2, d3, load(f, 3)), h))
    if group == scheme.SE3:
        coupling = scaled(m * damping, cross(e, load(v1, 0)))
        coupling = minus(coupling, cross(rotate_back(d1, d2, d3, load(f, 0)), h))
        return turning, coupling, combined(m * mass, e, m * damping, cross(ω, e))
    turned = rotate(d1, d2, d3, cross(h, load(f, 6)))
    coupling = rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), negative(turned))
    return turning, coupling, scaled(m * mass, e)


@compiled
def _factorise(
    parameters: tuple[float, ...],
    group: int,
    m: float,
    J: Array,
    f: Array,
    H: Array,
    H1: Array,
    v1: Array,
    d: Array,
    kept: Array,
) -> None:
    """Renew the kept matrix."""
    a = _columns(parameters, group, m, J, f, H, H1, v1, d, (1.0, 0.0, 0.0))
    b = _columns(parameters, group, m, J, f, H, H1, v1, d, (0.0, 1.0, 0.0))
    c = _columns(parameters, group, m, J, f, H, H1, v1, d, (0.0, 0.0, 1.0))
    for block in range(3):
        rows = (a[block], b[block], c[block])
        if block != 1:
            rows = _inverse(a[block], b[block], c[block])
        for k in range(3):
            store_row(kept, 3 * block + k, rows[k])


@inlined
def _solve(kept: Array, translation: Vector, turning: Vector, dx: Array) -> None:
    θ = rotate_back(load_row(kept, 0), load_row(kept, 1), load_row(kept, 2), turning)
    coupled = rotate(load_row(kept, 3), load_row(kept, 4), load_row(kept, 5), θ)
    right = minus(translation, coupled)
    store(dx, 0, rotate_back(load_row(kept, 6), load_row(kept, 7), load_row(kept, 8), right))
    store(dx, 3, θ)


@compiled
def _step(
    parameters: tuple[float, ...],
    options: tuple[float, int, int, float],
    body: tuple[int, float, Array],
    f: Array,
    state: tuple[Array, ...],
    end: tuple[Array, ...],
    failed: Array,
) -> tuple[int, int]:
    """Iterations, 0 if it failed, and factorisations of one step of one body."""
    tolerance, limit, patience, cost = options
    group, m, J = body
    H, v, vdot, a, memory, kept = state
    d, H1, v1, vdot1, dx = end
    memory[1] = max(scheme.predict(parameters, group, H, v, vdot, a, d, H1, v1, vdot1), memory[1])
    wanted = max(tolerance * memory[1], scheme.ROUND_OFF)
    previous, ratio, renewed, increment = np.inf, memory[0], 0, np.inf
    translation = turning = (0.0, 0.0, 0.0)
    failed[2] = 0.0
    for iteration in range(1, limit + 1):
        translation, turning = _residual(group, m, J, f, H, H1, v1, vdot1)
        due = memory[3] >= cost if iteration == 1 else (iteration - 1) % patience == 0
        if due:
            _factorise(parameters, group, m, J, f, H, H1, v1, d, kept)
            memory[2], memory[3] = 0.0, 0.0
            renewed += 1
        _solve(kept, translation, turning, dx)
        increment = scheme.correct(parameters, group, dx, H, d, H1, v1, vdot1)
        if previous < np.inf:
            ratio = max(increment / previous, 0.7 * ratio)
        remaining = increment * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf
        if remaining <= wanted or increment <= scheme.ROUND_OFF:
            memory[0] = ratio if iteration > 1 else ratio**0.8
            if memory[2] == 0.0 or iteration < memory[2]:
                memory[2] = iteration
            memory[3] += iteration - memory[2]
            scheme.accept(parameters, group, H, v, vdot, a, H1, v1, vdot1)
            H[:] = H1
            return iteration, renewed
        if not increment < scheme.DIVERGED:
            break
        previous = increment
    for k in range(3):
        failed[2] = max(failed[2], abs(translation[k]), abs(turning[k]))
    failed[1] = increment
    return 0, renewed


# --- all bodies ---------------------------------------------------------------------------------


@compiled
def _accelerations(
    bodies: tuple[Array, ...],
    loads: tuple[Array, ...],
    amplitude: Array,
    H: Array,
    H1: Array,
    v: Array,
    vdot: Array,
) -> None:
    """``v̇`` at the frames ``H1`` of a step that started at ``H``; ``v`` and ``v̇`` are of there."""
    mass, J, _, group = bodies
    f = np.empty(12)
    vdot[:] = 0.0
    for i in range(v.shape[0]):
        _load(loads, amplitude, i, f)
        r, turning = _residual(group[i], mass[i], J[i], f, H[i], H1[i], v[i], vdot[i])
        store(vdot[i], 0, scaled(-1.0 / mass[i], r))
        J1, J2, J3 = load_row(J[i], 0), load_row(J[i], 1), load_row(J[i], 2)
        store(vdot[i], 3, negative(rotate_back(*_inverse(J1, J2, J3), turning)))


@compiled
def _move_all(group: Indices, H: Array, d: Array, H1: Array) -> None:
    for i in range(d.shape[0]):
        scheme.move(group[i], H[i], d[i], H1[i])


@compiled
def _advance(
    parameters: tuple[float, ...],
    options: tuple[float, int, int, float, bool],
    bodies: tuple[Array, ...],
    loads: tuple[Array, ...],
    amplitude: Array,
    state: tuple[Array, ...],
    span: tuple[int, int, int],
    steps: tuple[int, int],
    frames: Array,
    velocities: Array,
    iterations: Indices,
    failed: Array,
) -> tuple[int, int]:
    """Steps ``first … last`` of all bodies.

    Args:
        parameters: Of the scheme.
        options: Of the iteration.
        bodies: What they are.
        loads: Their loads.
        amplitude: Of the loads with history, shape (last − first + 1, k).
        state: Of all bodies; updated.
        span: First and last step, and the row of the first one that will be kept.
        steps: Number of steps of the run, and how many lie between two that are kept.
        frames: Kept frames, shape (rows, n, 4, 3).
        velocities: Kept velocities, shape (rows, n, 6).
        iterations: Of each step, of the body that takes most, shape (last − first + 1,).
        failed: Of the earliest failure: body, last increment and residual; shape (3,).

    Returns:
        The last step that all bodies made, and the number of factorisations.
    """
    h, am, af, gamma, beta, damped, damping, _ = parameters
    tolerance, limit, patience, cost, rescue = options
    mass, J, size, group = bodies
    H, v, vdot, a, memory, kept = state
    first, last, kept_row = span
    total, every = steps
    end = (np.empty(6), np.empty((4, 3)), np.empty(6), np.empty(6), np.empty(6))
    f, note = np.empty(12), np.zeros(3)
    factorisations = 0
    for i in range(v.shape[0]):
        own = (h, am, af, gamma, beta, damped, damping, size[i])
        body = (group[i], mass[i], J[i])
        here = (H[i], v[i], vdot[i], a[i], memory[i], kept[i])
        row = kept_row
        for index in range(first, last + 1):
            _load(loads, amplitude[index - first], i, f)
            count, made = _step(own, (tolerance, limit, patience, cost), body, f, here, end, note)
            factorisations += made
            if count == 0 and rescue:
                count, made = _step(own, (tolerance, limit, 1, 0.0), body, f, here, end, note)
                factorisations += made
            if count == 0:
                # the others need not go farther than the step before
                last = index - 1
                failed[0], failed[1], failed[2] = i, note[1], note[2]
                break
            iterations[index - first] = max(count, iterations[index - first])
            if index % every == 0 or index == total:
                frames[row, i] = here[0]
                velocities[row, i] = here[1]
                row += 1
    return last, factorisations


@compiled
def _observe(
    frames: Array,
    velocities: Array,
    blocks: Array,
    loads: tuple[Array, ...],
    amplitude: Array,
    invariants: Array,
    potential: Array,
) -> None:
    """Energies and momenta of all rows; ``amplitude`` (rows, k), inertia ``blocks`` (n, 4, 4)."""
    n = blocks.shape[0]
    indptr, work, f = np.arange(n + 1), np.empty((2, n, 4, 3)), np.empty(12)
    for row in range(frames.shape[0]):
        values = inertia.invariants(
            frames[row], velocities[row], indptr, indptr, blocks, work[0], work[1]
        )
        for k in range(7):
            invariants[row, k] = values[k]
        potential[row] = 0.0
        for i in range(n):
            _load(loads, amplitude[row], i, f)
            potential[row] -= dot(load(f, 0), load_row(frames[row, i], 0))


class Run:
    """One integration.

    Attributes:
        p: Parameters of the scheme.
        s: State at the start of the next step.
    """

    def __init__(
        self,
        options: GeneralisedAlpha,
        scene: Scene,
        step: float,
        groups: Indices | None = None,
    ) -> None:
        """Collect bodies and loads.

        Args:
            options: Of the scheme.
            scene: One that :func:`applies`.
            step: Step size.
            groups: Group of each body, shape (n,); default: all :data:`scheme.SE3`.
        """
        refuse_ranks()
        rule = options.policy.rule()
        assert rule is not None
        self.options = _Options(
            float(options.tolerance),
            options.max_iterations,
            rule[0],
            float(rule[1]),
            options.policy.rescue,
        )
        self.scene, self.numbering = scene, Numbering(scene.bodies)
        n = self.numbering.count
        self.blocks = np.empty((n, 4, 4))
        size = np.empty(n)
        for body, nodes in self.numbering.nodes.items():
            assert isinstance(body, RigidBody)
            self.blocks[nodes], size[nodes] = body.gram, body.size
        trace = np.trace(self.blocks[:, 1:, 1:], axis1=1, axis2=2)
        J = trace[:, np.newaxis, np.newaxis] * np.eye(3) - self.blocks[:, 1:, 1:]
        group = np.zeros(n, dtype=np.int64) if groups is None else groups
        self.bodies = _Bodies(self.blocks[:, 0, 0].copy(), J, size, group)
        self.loads, self.histories = self._collect(scene)
        self.p = scheme.parameters(options.radius, step, 1.0)
        self.s = _State(
            self.numbering.frames.copy(),
            self.numbering.velocities.copy(),
            np.zeros((n, 6)),
            np.zeros((n, 6)),
            # no ratio and no matrix yet: the first step makes one, whatever it costs
            np.tile([1.0, 0.0, 0.0, np.inf], (n, 1)),
            np.zeros((n, 9, 3)),
        )

    def _collect(self, scene: Scene) -> tuple[_Loads, dict[int, LoadHistory]]:
        constant = np.zeros((self.numbering.count, 12))
        constant[:, :3] = self.bodies.mass[:, np.newaxis] * scene.gravity
        vary, owner, varying = [], [], histories(scene.loads)
        for k, given in enumerate(scene.loads):
            (node,) = self.numbering.nodes[given.body]
            load, at = np.zeros(12), 6 if given.following else 0
            load[at : at + 6] = given.nodal()[0]
            if k in varying:
                vary.append(load)
                owner.append(node)
            else:
                constant[node] += load
        nodes = np.array(owner, dtype=np.int64)
        order = np.argsort(nodes, kind="stable")
        first = np.searchsorted(nodes[order], np.arange(self.numbering.count + 1))
        table = np.array(vary).reshape(-1, 12)[order]
        return _Loads(constant, first, table, order), varying

    def start(self) -> None:
        """Consistent accelerations, and those that ``a`` stands for: α_m − α_f steps earlier."""
        p, s = self.p, self.s
        bodies, loads = tuple(self.bodies), tuple(self.loads)
        shift = (p.af - p.am) * p.h
        amplitude = amplitudes(self.histories, [0.0, shift])
        _accelerations(bodies, loads, amplitude[0], s.H, s.H, s.v, s.vdot)
        d, H1, later = shift * s.v + 0.5 * shift**2 * s.vdot, s.H.copy(), np.empty_like(s.vdot)
        _move_all(self.bodies.group, s.H, d, H1)
        v1 = s.v + shift * s.vdot
        _accelerations(bodies, loads, amplitude[1], s.H, H1, v1, later)
        s.a[:] = 2.0 * s.vdot - later

    def integrate(self, steps: int, save_every: int, progress: bool | None) -> Result:
        """All steps; see :meth:`GeneralisedAlpha.run`."""
        info = SceneInfo(self.numbering.bodies(), ())
        history = History(info, steps, self.p.h, save_every, progress)
        self.start()
        history.frames[0], history.velocities[0] = self.s.H, self.s.v
        start = np.zeros(1, dtype=np.int64)
        self._keep(history, start, start, amplitudes(self.histories, [0.0]))
        failed, count, factorisations = np.zeros(3), 0, 0
        self._advance(history, range(1, 1), failed)  # compilation is not integration
        begin = clock.perf_counter()
        chunk = max(1, min(history.refresh, _CHUNK // self.numbering.count))
        with history:
            for first in range(1, steps + 1, chunk):
                wanted = range(first, min(first + chunk, steps + 1))
                last, count, made = self._advance(history, wanted, failed, count)
                factorisations += made
                if last and history.show:
                    history.update_bar(last, count)
                if last < wanted[-1]:
                    result = history.result(factorisations, clock.perf_counter() - begin)
                    raise ConvergenceError(self._failure(last + 1, steps, failed), result)
        return history.result(factorisations, clock.perf_counter() - begin)

    def _advance(
        self, history: History, wanted: range, failed: Array, before: int = 0
    ) -> tuple[int, int, int]:
        """Make the steps ``wanted``, after ``before`` iterations: last step, iterations, matrices.

        Counts are of all steps so far and of these steps.
        """
        indices = np.arange(wanted.start, wanted.stop)
        amplitude = amplitudes(self.histories, indices * self.p.h)
        taken = np.zeros(len(indices), dtype=np.int64)
        last, factorisations = _advance(
            tuple(self.p),
            tuple(self.options),
            tuple(self.bodies),
            tuple(self.loads),
            amplitude,
            tuple(self.s),
            (wanted.start, wanted.stop - 1, history.row),
            (history.steps, history.every),
            history.frames,
            history.velocities,
            taken,
            failed,
        )
        count = before + np.cumsum(taken)
        kept = (indices <= last) & ((indices % history.every == 0) | (indices == history.steps))
        self._keep(history, indices[kept], count[kept], amplitude[kept])
        made = last - wanted.start + 1
        return last, int(count[made - 1]) if made else before, factorisations

    def _keep(
        self, history: History, indices: Indices, iterations: Indices, amplitude: Array
    ) -> None:
        """Energies and momenta of the steps ``indices``, whose frames are in the next rows."""
        rows = slice(history.row, history.row + len(indices))
        _observe(
            history.frames[rows],
            history.velocities[rows],
            self.blocks,
            tuple(self.loads),
            amplitude,
            history.invariants[rows],
            history.potential[rows],
        )
        history.keep(indices, iterations)

    def _failure(self, index: int, steps: int, failed: Array) -> str:
        name = self.scene.bodies[int(failed[0])].label
        limit, tolerance = self.options.limit, self.options.tolerance
        text = scheme.failure(index, steps, self.p, limit, failed[1], failed[2], tolerance)
        return f"{name}: {text}"

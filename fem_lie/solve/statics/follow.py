"""Statics along the equilibrium path: scenes for the load-capped arc length."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.body import Point
from fem_lie.bodies.model import FoldedElementError
from fem_lie.joints.connection import LostBranchError
from fem_lie.lie.node_types import all_to_global_components, has_position
from fem_lie.linear.choice import Solutions
from fem_lie.linear.direct import ConvergenceError, DirectSolver
from fem_lie.parts.part_scene import ScenePart, divided
from fem_lie.ranks.shared_factors import Subdomains
from fem_lie.ranks.together import all_stay
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.gathering import gathered
from fem_lie.results.path import EquilibriumState
from fem_lie.results.record import FrictionForces
from fem_lie.scene import Scene
from fem_lie.scene.load import StrainLoad
from fem_lie.scene.rotation import Rotation
from fem_lie.scene.scene import require_scene
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, iterate
from fem_lie.solve.progress_bars import Stopwatch
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.solve.statics.arc_length import ArcLength, Equilibrium, Path, increasing, plain_dot
from fem_lie.solve.statics.load_steps import move
from fem_lie.solve.statics.unstable import (
    POLISHED,
    FreeMotions,
    FreeRigidMotions,
    SingularStartError,
    maxima,
    negative_pivots,
    warn_if_unstable,
)
from fem_lie.system.equations import Equations, Plan, TimeState


def follow_loads(
    scene: Scene,
    levels: Sequence[float] = (1.0,),
    *,
    arc_length: ArcLength | None = None,
    petsc_options_prefix: str = "fem_lie_statics_",
) -> StaticResult:
    """Equilibrium at one or several load factors, by the load-capped arc length.

    All loads, and gravity, grow in proportion to the load factor.

    Args:
        scene: The scene.
        levels: Increasing positive load factors.
        arc_length: Options; see :class:`~fem_lie.solve.statics.arc_length.ArcLength`.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Raises:
        ValueError: Invalid scene or levels; no load; prescribed motions, initial strains or loads
            with a history, which are not in proportion to the load factor.
        ConvergenceError: Steps became too small; its ``result`` holds the states before.
    """
    options = ArcLength() if arc_length is None else arc_length
    result = followed(scene, levels, options, petsc_options_prefix)
    warn_if_unstable(result)
    return result


@all_stay("statics")
def followed(
    scene: Scene,
    levels: Sequence[float],
    options: ArcLength,
    prefix: str,
    free: FreeRigidMotions = FreeRigidMotions.REFUSED,
) -> StaticResult:
    """As :func:`follow_loads`, without a warning on stability."""
    check_proportion(scene)
    levels = beyond(scene, levels)
    model = SceneEquilibrium(scene, prefix, divided(scene, prefix))
    watch = Stopwatch()
    try:
        path = options.follow(model, levels, model.begin())
    except ConvergenceError as error:
        result = _result(model, error.result, levels, watch.seconds)
        raise ConvergenceError(str(error), result) from None
    result = _result(model, path, levels, watch.seconds)
    if free is FreeRigidMotions.REFUSED and (message := model.free_motions(levels[-1])):
        raise SingularStartError(message, result)
    return result


def beyond(scene: Scene, levels: Sequence[float]) -> list[float]:
    """Check requested load factors, at or beyond that of a restarted scene.

    Raises:
        ValueError: See :func:`~fem_lie.solve.statics.arc_length.increasing`, or one is below.
        TypeError: ``scene`` is not a scene.
    """
    require_scene(scene)
    wanted, factor = increasing(levels), scene.began.factor
    if wanted[0] < factor:
        raise ValueError(
            f"the scene restarts from the load factor {factor:g}; levels must not be below, got "
            f"{wanted[0]:g}"
        )
    return wanted


def in_proportion(scene: Scene) -> bool:
    """Whether all loads are in proportion to the load factor, and there is any."""
    acts = bool(scene.loads) or bool(scene.gravity.any())
    return acts and not scene.motions and not _out_of_proportion(scene)


def _out_of_proportion(scene: Scene) -> list[str]:
    """Loads and drives that are functions of time, or strains."""
    loads = [
        f"{type(load).__name__} on {load.body.label}"
        + (" with a history" if load.history is not None else "")
        for load in scene.loads
        if load.history is not None or isinstance(load, StrainLoad)
    ]
    return loads + [item.label for item in scene.connections if item.history is not None]


def check_proportion(scene: Scene) -> None:
    """Raise ``ValueError`` if a load is not in proportion to the load factor."""
    require_scene(scene)
    others = ["prescribed motions"] if scene.motions else _out_of_proportion(scene)
    if others:
        raise ValueError(
            "buckling, paths and the arc length expect loads in proportion to the load factor, got "
            f"{others[0]}: use load steps, fl.statics(scene, levels=...), whose negative_pivots "
            "say from which level on the equilibrium is unstable"
        )


_MOST = 30  # iterations from a restarted state
_SETTLED = 1e-11  # over the length of the model
_FARTHEST = 1.0  # larger corrections, over the length of the model, have diverged
_OF_TURNS = 1e-3  # rotations have a larger round-off in slender structures
_LEAST = 1e-3  # smallest increment of a preload


class SceneEquilibrium(Equilibrium):
    """:class:`~fem_lie.solve.statics.arc_length.Equilibrium` of a scene.

    Rows of nodes are those of the nodes that this rank owns, if the scene is divided.

    Attributes:
        equations: Equations of the scene.
        diameter: Length of the model, which converts rotations to lengths.
        placed: Which nodes have a position of their own, shape (n,).
    """

    def __init__(self, scene: Scene, prefix: str, part: ScenePart | None = None) -> None:
        """Number the unknowns; the stress is that of the unloaded frames.

        Args:
            scene: The scene.
            prefix: Prefix of the linear solver's options.
            part: What this rank has of the scene, if it is divided.
        """
        self.equations = equations = Equations(scene, dynamics=False, part=part)
        self._shared = equations.shared
        unknowns = equations.unknowns
        self.diameter, self._moving = unknowns.length, unknowns.moving
        self.placed = has_position(unknowns.kinds) & self._shared.owned
        self._H, self._multipliers = equations.start.frames.copy(), np.zeros(unknowns.m)
        self._zero = np.zeros((unknowns.moving, 6))
        self._scale: Array = np.ones(unknowns.m)
        self._solver = DirectSolver(equations.matrix, prefix, solutions=Solutions.FEW)
        self._solver.take_low_rank()
        equations.history_variables.update_stress(self._H)
        self._internal, self._load = np.empty(unknowns.size), np.zeros(unknowns.size)
        self._forces_known, self._preload = False, 1.0
        self._scratch = np.empty(unknowns.size)
        self._found = equations.residual(self._now, self._scale, self._scratch, linearised=True)
        self.forces()
        if not self._shared.any(bool(self._load.any())):
            raise ValueError(
                "paths and buckling follow the factor of a load: expected a load that is not zero "
                "on what can move, got none"
            )
        self._find(0.0)
        self._scale = equations.fill(self._now, self._found, Plan(self._zero))

    def dot(self, a: Array, b: Array) -> float:
        """Inner product of two arrays with a row for each node."""
        return float(self._shared.total(np.array(plain_dot(a, b))))

    def maximum(self, values: Array) -> float:
        """Largest magnitude of a vector."""
        return self._shared.largest(super().maximum(values))

    def forces(self) -> tuple[Array, Array]:
        """Internal forces, and external ones at λ = 1, in the current state."""
        equations = self.equations
        equations.prescribed(0.0).act(0.0, self._preload)
        equations.residual(self._now, self._scale, self._internal, self._found, linearised=True)
        self._load[: 6 * self._moving] = equations.prescribed(1.0).loads(self._H)
        self._forces_known = True
        return self._internal.copy(), self._load.copy()

    @property
    def _now(self) -> TimeState:
        return TimeState(self._H, self._zero, self._zero, self._multipliers)

    @property
    def factorisations(self) -> int:
        """Number of factorisations so far."""
        return self._solver.factorisations

    @property
    def subdomains(self) -> Subdomains | None:
        """Statistics of the solution on subdomains, if there are any."""
        return self._solver.subdomains

    def begin(self) -> float:
        """Bring a restarted state to equilibrium; returns its load factor.

        Raises:
            ConvergenceError: There is none near it.
        """
        factor = self.equations.scene.began.factor
        if factor and not self._converges(factor):
            raise ConvergenceError(
                f"no equilibrium at load factor {factor:g} near the restarted state",
                Path(),
            )
        if not factor and self.equations.unknowns.preloaded:
            self._strain()
        return factor

    def _converges(self, factor: float, most: int = _MOST) -> bool:
        """Iterate to a nearby equilibrium at a load factor; return whether there is one."""
        return iterate(_AtFactor(self, factor), most).converged

    def _strain(self) -> None:
        """Preload the springs step by step, without loads; on failure the state is restored."""
        part, step, before = 0.0, 1.0, self.state()
        while part < 1.0:
            kept = self.state()
            self._preload = min(1.0, part + step)
            try:
                if self._converges(0.0):
                    self.check_rotations(0.0)
                    part, step = self._preload, 2.0 * step
                    continue
            except (FoldedElementError, LostBranchError):
                pass  # a shorter step
            self.restore(kept)
            step /= 2.0
            if step < _LEAST:
                self._preload = 1.0
                self.restore(before)
                return

    def factorise(self, factor: float) -> None:
        """Assemble and factorise the tangent stiffness at a load factor, with updated stress."""
        self._fill(factor)
        self._solver.factorise()

    def _fill(self, factor: float) -> None:
        self._find(factor)
        self.equations.fill(self._now, self._found, Plan(self._zero, self._scale))

    def _find(self, factor: float) -> None:
        """Forces of the current state; those of nodes may already be known."""
        given, known = (self._scale, self._scratch, self._found), self._forces_known
        self.equations.prescribed(factor).act(factor, self._preload)
        self.equations.residual(self._now, *given, linearised=True, known=known)

    def solve(self, b: Array) -> Array:
        """Solve with the last tangent stiffness."""
        self._solver.right_hand_side[:] = b
        self._solver.solve()
        x = self._solver.solution.copy()
        nodes = x[: 6 * self._moving].reshape(-1, 6)
        self.equations.supports.rotate_back(self._H, nodes)
        return x

    def negative_pivots(self) -> int:
        """Negative pivots of the last tangent stiffness, restricted to the constraints."""
        return negative_pivots(self.equations, self._solver)

    def move(self, dx: Array) -> None:
        """Update the stress linearly by ``dx``, then move nodes and multipliers."""
        self._forces_known = False
        move(self.equations, self._H, -dx, linearised=True)
        self._multipliers += self._scale * dx[6 * self._moving :]

    def reactions(self, state: EquilibriumState, factor: float) -> Array:
        """Reactions of supports in a restored state, see :class:`~.report.Report`."""
        self.restore(state)
        self.equations.prescribed(factor).act(factor, self._preload)
        return self.equations.report(*self._now).reactions

    def joint_forces(self, state: EquilibriumState) -> Array:
        """Force and moment of each joint on its point ``a``, in its axes, shape (j, 6)."""
        return self.equations.report(state.frames, multipliers=state.multipliers).joints.forces

    def placed_node(self, point: Point) -> int | None:
        """Row of the node of a point in :meth:`positions`; ``None``: on another rank."""
        assert point.body is not None
        unknowns, part, node = self.equations.unknowns, self.equations.part, point.node
        bodies = {body.name: (body, nodes) for body, nodes in unknowns.bodies.items()}
        if point.body.name not in bodies:
            return None
        body, nodes = bodies[point.body.name]
        if part is not None:
            before = takewhile(lambda each: each.name != body.name, part.whole.bodies)
            first = sum(len(each.frames) for each in before)
            own = np.flatnonzero(part.nodes[body] == first + node)
            if not len(own):
                return None
            node = int(own[0])
        master = self.equations.arrays.master[nodes[node]]
        owned = bool(self._shared.owned[master])
        return int(np.count_nonzero(self.placed[:master])) if owned else None

    def positions(self) -> Array:
        """Positions of the nodes that have one, shape (n, 3)."""
        return self._H[: self._moving, 0][self.placed]

    def translations(self, dx: Array) -> Array:
        """Displacements of these nodes due to ``dx``, shape (n, 3), global components."""
        moved = dx[: 6 * self._moving].copy()
        all_to_global_components(self.equations.unknowns.kinds, self._H, moved)
        return moved.reshape(-1, 6)[self.placed, :3]

    def twists(self, dx: Array) -> Array:
        """Increments of the nodes due to ``dx``, (n, 6), in their own axes, as lengths."""
        units = self.equations.unknowns.units / self.diameter
        twists: Array = (dx[: 6 * self._moving] / units).reshape(-1, 6)
        return twists[self._shared.owned] if self._shared.several else twists

    def check_rotations(self, factor: float) -> None:
        """Raise an error if the current state is not valid.

        Raises:
            FoldedElementError: An element rotates too far for a unique state.
            LostBranchError: A joint rotates too far in the step.
        """
        self.equations.report(self._H).check_rotations(f"at load factor {factor:g}")

    def check_passage(self, before: EquilibriumState) -> None:
        """Raise ``PassedThroughError`` if surfaces passed through each other since a state."""
        self.equations.history_variables.check_passage(before.frames, self._H)

    def free_motions(self, factor: float) -> str:
        """Message on rigid motions that nothing resists in the current state, if there are any.

        The state is polished first.
        """
        search = FreeMotions(self.equations)
        if not len(search.allowed(self._H)):
            return ""
        # unbalanced forces would contribute resistance
        kept = self.state()
        if not iterate(_AtFactor(self, factor), POLISHED).size <= _FARTHEST:
            self.restore(kept)  # corrections of a singular matrix are round-off without bound
        internal, load = self.forces()
        self._fill(factor)
        free = search.unresisted(search.allowed(self._H), internal - factor * load)
        return search.message(free, factor) if len(free) else ""

    def rotation_hint(self) -> str:
        """Which element rotates far, if that may prevent convergence."""
        return self.equations.report(self._H).rotation_hint

    def state(self) -> EquilibriumState:
        """A copy of the current state; angles of joints are counted from here."""
        self.equations.history_variables.accept(self._H)
        return EquilibriumState(
            self._H.copy(), self._multipliers.copy(), self.equations.history_variables.saved_state()
        )

    def place(self, frames: Array, multipliers: Array) -> None:
        """Take an equilibrium of which only frames (n, 4, 3) and multipliers (m,) are known."""
        self._forces_known = False
        self._H[: self._moving], self._multipliers[:] = frames, multipliers
        self.equations.history_variables.update_stress(self._H)

    def restore(self, state: EquilibriumState) -> None:
        """Restore a copied state."""
        self._forces_known = False
        self._H[:], self._multipliers[:] = state.frames, state.multipliers
        self.equations.history_variables.restore(state.saved)


class _AtFactor(Iterated):
    """Equilibrium of a scene at a given load factor."""

    def __init__(self, model: SceneEquilibrium, factor: float) -> None:
        self._model, self._factor = model, factor
        self._residual: Array

    def evaluate(self, iteration: int) -> bool:
        internal, load = self._model.forces()
        self._residual = self._factor * load - internal
        return False

    def refactorise(self, update: Refactorisation) -> None:
        self._model.factorise(self._factor)

    def correct(self) -> float:
        """Solve for a correction and apply it; return its size over that of the model."""
        model = self._model
        dx = model.solve(self._residual)
        model.move(dx)
        moved = model.maximum(model.translations(dx))
        turned = model.maximum(model.twists(dx)[:, 3:])
        return max(moved, _OF_TURNS * turned) / model.diameter

    def judge(self, size: float) -> Verdict:
        if not size <= _FARTHEST:
            return Verdict.DIVERGED
        return Verdict.CONVERGED if size < _SETTLED else Verdict.GOES_ON


def friction_in(equations: Equations, states: Sequence[EquilibriumState]) -> FrictionForces | None:
    """Friction forces of contacts by penalty in states; ``None`` if there are none.

    Args:
        equations: Equations of the scene.
        states: The states.
    """
    history = equations.history_variables
    present, rows = history.saved_state(), list[Array | None]()
    at_rest = np.zeros((equations.unknowns.moving, 6))
    for state in states:
        history.restore(state.saved)
        rows.append(history.friction_forces(state.frames, at_rest))
    history.restore(present)
    return FrictionForces.of_states(rows)


def _result(
    model: SceneEquilibrium, path: Path, levels: Sequence[float], seconds: float
) -> StaticResult:
    equations, reached = model.equations, list(levels[: len(path.states)])
    unknowns, counts = equations.unknowns, np.cumsum([0, *path.iterations])
    ends = [1 + path.factors.index(f) if f in path.factors else 0 for f in reached]
    states: list[EquilibriumState] = path.states
    frames = [equations.report(state.frames).frames.copy() for state in states]
    forces = [model.joint_forces(state) for state in states]
    reactions = [model.reactions(*held) for held in zip(states, reached, strict=True)]
    result = StaticResult(
        factors=np.array(reached),
        frames=np.array(frames).reshape(len(states), unknowns.total, 4, 3),
        joint_forces=np.array(forces).reshape(len(states), unknowns.connections, 6),
        iterations=counts[ends],
        failed_iterations=path.failed_iterations,
        info=equations.info,
        steady_rotation=Rotation.of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        reactions=np.array(reactions).reshape(len(states), len(unknowns.supported), 6),
        load_steps=len(path.iterations),
        failed_steps=path.failed_steps,
        seconds=seconds,
        negative_pivots=np.array(path.negative, dtype=np.int64),
        factorisations=model.factorisations,
        subdomains=model.subdomains,
        load_maxima=maxima(path.factors),
        friction=friction_in(equations, states),
    )
    return gathered(result, equations.part)

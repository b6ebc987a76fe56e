"""Adaptive refinement: solve, estimate and refine until the error is below a tolerance.

A scene is a function of its mesh::

    def plate(mesh):                       # a scene on any mesh
        scene = fl.Scene()
        shell = scene.add(fl.Shell(mesh, section, name="plate"))
        ...
        return scene

    found = fl.adaptivity.adapt(plate, mesh, tolerance=0.02)
    print(found)                           # unknowns and error of each mesh
    found.result.picture("plate.png")

Refinement creates a new scene: names of points, curves and groups exist on each mesh, and loads,
sections, directors and imperfections that are functions are evaluated on it. So nothing has to be
transferred, and nothing refers to node numbers.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np

from fem_lie._arrays import Array, instance, positive, whole
from fem_lie._summary import Summarised
from fem_lie.adaptivity.discretisation_error import SpaceError, space_error
from fem_lie.adaptivity.estimates.estimate import ErrorEstimate, Refined
from fem_lie.adaptivity.goals import Goal, GoalError, goal_error
from fem_lie.adaptivity.refinement import Onto, Refinable, Sizes, check_refinable, order_of, refine
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Body
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.rods.cable import Cable
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.lie.node_types import TRAITS, NodeType
from fem_lie.linear.direct import ConvergenceError
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene
from fem_lie.solve.progress_bars import step_bar
from fem_lie.solve.statics.follow import follow_loads

_log = logging.getLogger("fem_lie")

_AIM = 0.95  # target error over the tolerance
_MEAN = 1.0  # mean of sizes over target sizes

Solve = Callable[[Scene], StaticResult]
Estimate = SpaceError | GoalError


@dataclass(frozen=True, eq=False, repr=False)
class Adapted(Summarised, Generic[Refinable]):
    """Result of :func:`adapt`.

    Attributes:
        mesh: The last mesh.
        scene: The scene on it.
        result: Its equilibrium.
        error: The error estimate for it.
        unknowns: Number of unknowns of the scene on each mesh, including fixed ones, shape (k,):
            six of a frame, five of a node of a shell without drilling rotation, three of a
            position, none of a node that is rigidly attached to another.
        relative: Estimated relative error on each mesh, shape (k,), with the calibration.
        values: Computed value of the goal on each mesh, shape (k,); nan without a goal.
        calibration: Factor of the estimate of a goal on each mesh, shape (k,), see :func:`adapt`;
            one without a goal and on the first mesh.
        meshes: All meshes.
    """

    mesh: Refinable
    scene: Scene
    result: StaticResult
    error: Estimate
    unknowns: Array
    relative: Array
    values: Array
    calibration: Array
    meshes: tuple[Refinable, ...]

    @property
    def value(self) -> float:
        """Value of the goal with its calibrated estimate, the most accurate value available.

        Raises:
            ValueError: There was no goal.
        """
        if isinstance(self.error, SpaceError):
            raise ValueError("there was no goal, and the energy norm has no value")
        return self.error.value + float(self.calibration[-1]) * self.error.estimate

    @property
    def rate(self) -> float:
        """Exponent of the error in the number of unknowns, from the first mesh to the last."""
        if len(self.unknowns) < 2:
            return float("nan")
        growth = np.log(self.unknowns[-1] / self.unknowns[0])
        return float(np.log(self.relative[-1] / self.relative[0]) / growth)

    def __str__(self) -> str:
        """One line for each mesh."""
        rows = zip(self.unknowns, self.relative, self.calibration, strict=True)
        return "\n".join(
            f"{int(n):8d} unknowns, error {100 * e:.3g} %"
            + (f", estimated {100 * e / c:.3g} % times {c:.2g}" if c > 1.0 else "")
            for n, e, c in rows
        )


def adapt(
    build: Callable[[Refinable], Scene],
    mesh: Refinable,
    *,
    tolerance: float,
    goal: Goal | None = None,
    body: str | None = None,
    solve: Solve | None = None,
    part: float = 0.5,
    fall: float | None = None,
    most: int = 200_000,
    onto: Onto | None = None,
    estimate: ErrorEstimate | None = None,
) -> Adapted[Refinable]:
    """Refine a mesh adaptively until the estimated error is below a tolerance.

    Each mesh is solved from the start. The refined elements are the fewest that have a given
    fraction of the squared error, which gives the best possible rate of convergence (R. Stevenson,
    Found. Comput. Math. 7 (2007) 245). With ``fall`` each mesh is generated from the first one,
    with equal target errors of all elements. It has fewer elements, in a few more iterations,
    because elements that turned out to be too small are coarsened.

    An estimate does not see errors of the stiffness of an element, only those of its stress: for
    example flat cells on a curved surface. Between two meshes the goal may then change by more than
    was estimated. The next estimate of a goal is multiplied by this ratio,
    ``(J_k − J_(k−1)) / (e_(k−1) − e_k)``, if it is above one.

    Args:
        build: Creates a scene with a beam, cable or shell on the given mesh.
        mesh: Initial mesh: lines, triangles or quadrilaterals of first degree, or smooth patches.
        tolerance: Relative error, in the energy norm or of the goal.
        goal: Quantity that has to be accurate, a displacement, a frequency or a critical load;
            default: the stress, in the energy norm.
        body: Name of the beam, cable or shell on the mesh; default: the only one in the scene.
        solve: Computes the equilibrium of a scene, or the path for a critical load; default: what
            the goal needs, or :func:`~fem_lie.solve.statics.follow.follow_loads`.
        part: Fraction of the squared error of the elements that are refined.
        fall: Error of each mesh over that of the one before, to generate each mesh from the initial
            one; default: elements are refined.
        most: Largest number of unknowns.
        onto: Projects new points onto the exact line or surface.
        estimate: Error estimate in the energy norm; default:
            :class:`~fem_lie.adaptivity.estimates.recovery.RecoveryEstimate`, which goals always
            use.

    Raises:
        ValueError: An argument is wrong, both a goal and an estimate are given, the mesh cannot be
            refined, or the scene has no beam, cable or shell on it; before anything is solved.
        ConvergenceError: The tolerance was not reached with this number of unknowns, or statics did
            not converge; its ``result`` is the :class:`Adapted` of the last mesh that was solved,
            if any.
    """
    _check(build, mesh, tolerance, goal, solve, part, onto)
    _check_fall(fall)
    instance(estimate, ErrorEstimate | None, "estimate", "a Recovery, a Residual or None")
    if goal is not None and estimate is not None:
        raise ValueError(f"a goal is estimated by recovered stress: omit {estimate!r}")
    whole(most, "most")
    first = mesh
    history: list[tuple[int, float, float, float]] = []
    meshes: list[Refinable] = []
    found: Adapted[Refinable] | None = None
    with step_bar("adaptivity", "mesh") as show:
        while True:
            scene = build(mesh)
            require_scene(scene)
            chosen = named_body(scene, body, mesh)
            count = sum(_unknowns(b, drilling=scene.has_drilling(b)) for b in scene.bodies)
            if count > most:
                raise ConvergenceError(
                    f"an error of {tolerance:g} needs more than {most} unknowns"
                    + (
                        f": it is {found.relative[-1]:.2g} with {found.unknowns[-1]:.0f}"
                        if found
                        else ""
                    ),
                    found,
                )
            if goal is not None:
                goal.check(scene)
            result = _solved(scene, goal, solve)
            error: Estimate = (
                space_error(result, chosen, scene, estimate=estimate)
                if goal is None
                else goal_error(result, [chosen], scene, goal)
            )
            factor = _calibration(found.error, error) if found else 1.0
            value = error.value if isinstance(error, GoalError) else float("nan")
            history.append((count, factor * error.relative, value, factor))
            meshes.append(mesh)
            counts, relative, values, factors = np.array(history, dtype=np.float64).T
            found = Adapted(
                mesh, scene, result, error, counts, relative, values, factors, tuple(meshes)
            )
            _log.info("%d unknowns: %s, times %.2g", count, error, factor)
            show(f"{count} unknowns, error {found.relative[-1]:.2g}, expected {tolerance:.2g}")
            if found.relative[-1] <= tolerance:
                return found
            if fall is None:
                mesh = refine(mesh, error.worst(part), onto=onto)
            else:
                aim = max(_AIM * tolerance, fall * found.relative[-1])
                mesh = _remeshed(first, found, aim, order_of(chosen), onto)


def _unknowns(body: Body, *, drilling: bool) -> int:
    """Number of unknowns of the nodes of a body in a scene, including fixed ones."""
    count = np.array([TRAITS[NodeType(kind)].unknowns for kind in body.model.node_types])
    there = (np.arange(6) < count[:, np.newaxis]) & ~body.model.missing_unknowns
    there[:, 5] &= drilling
    leads = body.model.masters == np.arange(len(body.frames))
    return int(there[leads].sum())


def _remeshed(
    first: Refinable, found: Adapted[Refinable], relative: float, order: int, onto: Onto | None
) -> Refinable:
    """A new mesh for a relative error, with equal errors of all elements."""
    error, factor = found.error, float(found.calibration[-1])
    # contributions to a goal are summed like squared errors in the energy norm
    allowed = (
        relative * np.sqrt(error.energy)
        if isinstance(error, SpaceError)
        else np.sqrt(relative * abs(found.value))
    )
    sizes = Sizes.of(found.mesh, factor * error.squares, allowed, order)
    return sizes.other_mesh(first, found.meshes, onto=onto, mean=_MEAN)


def _solved(scene: Scene, goal: Goal | None, solve: Solve | None) -> StaticResult:
    if solve is not None:
        return solve(scene)
    return follow_loads(scene) if goal is None else goal.solve(scene)


def _calibration(before: Estimate, now: Estimate) -> float:
    """Change of a goal over the change of its estimate, at least one."""
    if isinstance(before, SpaceError) or isinstance(now, SpaceError):
        return 1.0
    said = before.estimate - now.estimate
    return max(1.0, (now.value - before.value) / said) if said else 1.0


def _check(
    build: object,
    mesh: object,
    tolerance: float,
    goal: object,
    solve: object,
    part: float,
    onto: object,
) -> None:
    instance(build, Callable, "build", "a function from a mesh to a Scene")
    check_refinable(mesh, onto)
    positive(tolerance, "tolerance")
    instance(goal, Goal | None, "goal", "a PointDisplacement, a Frequency, a CriticalLoad or None")
    instance(solve, Callable | None, "solve", "a function from a Scene to its equilibrium, or None")
    if not 0.0 < positive(part, "part") <= 1.0:
        raise ValueError(f"part must be above 0 and at most 1, got {part!r}")


def _check_fall(fall: object) -> None:
    if fall is not None and not 0.0 < positive(fall, "fall") < 1.0:
        raise ValueError(f"fall must be between 0 and 1, got {fall!r}")


def named_body(
    scene: Scene, name: str | None, mesh: LineMesh | SurfaceMesh | SplineMesh
) -> Refined:
    """The beam, cable or shell that is refined.

    Raises:
        ValueError: There is none, or there are several and no name is given, or it has other
            elements than the mesh.
    """
    bodies = [body for body in scene.bodies if isinstance(body, Refined)]
    known = ", ".join(repr(body.name) for body in bodies) or "none"
    chosen = [body for body in bodies if name in (None, body.name)]
    if len(chosen) != 1:
        wanted = (
            "one beam, cable or shell, or body=..."
            if name is None
            else f"a beam, cable or shell {name!r}"
        )
        raise ValueError(f"build must make {wanted}; it made {known}")
    (body,) = chosen
    own = _elements(body)
    if own != len(mesh.cells):
        raise ValueError(
            f"{body.label} must be on the mesh that build is given, of {len(mesh.cells)} cells; it "
            f"has {own}"
        )
    return body


def _elements(body: Refined) -> int:
    if isinstance(body, Beam | Cable | AncfBeam):
        return len(body.model.elements)
    return len(body.model.connectivity if isinstance(body, ThinShell) else body.model.mesh.cells)

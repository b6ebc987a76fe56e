"""Equilibrium under increasing loads, with meshes adapted to the error.

A scene is a function of its mesh, as for :func:`~fem_lie.adaptivity.adapt`::

    found = fl.adaptivity.adapt_loads(shell, mesh, [0.25, 0.5, 0.75, 1.0], tolerance=0.05)
    print(found)                           # elements and error at each load factor
    found.displacement("shell.tip"), found.segments[-1].result

The state is continued from one load factor to the next. If the stress error exceeds the tolerance,
a new mesh is generated, and the load increment is repeated on it. Elements that are smaller than
needed are coarsened.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np

from fem_lie._arrays import Array, Indices, instance, positive, whole
from fem_lie._summary import Summarised
from fem_lie.adaptivity.discretisation_error import SpaceError, space_error
from fem_lie.adaptivity.estimates.estimate import ErrorEstimate
from fem_lie.adaptivity.following.transfer import Transferred, transfer
from fem_lie.adaptivity.loop import named_body
from fem_lie.adaptivity.refinement import Onto, Refinable, Sizes, check_refinable, order_of
from fem_lie.linear.direct import ConvergenceError
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.solve.statics.arc_length import ArcLength, increasing
from fem_lie.solve.statics.follow import check_proportion, follow_loads

_log = logging.getLogger("fem_lie")

_AIM = 0.75  # target error over the allowed error
_FEWER = 0.7  # ratio of numbers of elements below which coarsening is worth a new mesh
_TRIES = 8  # meshes for one load factor


@dataclass(frozen=True, eq=False, repr=False)
class LoadSegment(Summarised, Generic[Refinable]):
    """A load increment up to one load factor, on one mesh.

    Attributes:
        mesh: Mesh of the refined body.
        scene: Scene on this mesh.
        result: Result of the increment; its last state is at the load factor.
        error: Error estimate at the load factor.
        change: Energies and momenta before and after the change to this mesh; ``None`` for the
            first.
    """

    mesh: Refinable
    scene: Scene
    result: StaticResult
    error: SpaceError
    change: Transferred | None


@dataclass(frozen=True, eq=False, repr=False)
class AdaptedLoads(Summarised, Generic[Refinable]):
    """Result of :func:`~fem_lie.adaptivity.adapt_loads`.

    Attributes:
        segments: One for each load factor.
        tolerance: Requested relative error.
        solved: Number of equilibria that were computed, including repeated increments.
    """

    segments: tuple[LoadSegment[Refinable], ...]
    tolerance: float
    solved: int

    @property
    def factors(self) -> Array:
        """Load factors, shape (k,)."""
        return np.array([part.result.factors[-1] for part in self.segments])

    @property
    def cells(self) -> Indices:
        """Number of elements at each load factor, shape (k,)."""
        return np.array([len(part.mesh.cells) for part in self.segments], dtype=np.int64)

    @property
    def relative(self) -> Array:
        """Estimated error at each load factor, relative to the norm of the stress, shape (k,)."""
        return np.array([part.error.relative for part in self.segments])

    @property
    def iterations(self) -> Indices:
        """Number of linear solutions on all meshes kept, up to each load factor, shape (k,)."""
        counts = [part.result.total_iterations for part in self.segments]
        return np.cumsum(counts, dtype=np.int64)

    def position(self, point: str) -> Array:
        """Position of a named point such as "beam.end", global components, shape (k, 3).

        Args:
            point: As for :meth:`displacement`.

        Raises:
            ValueError: There is no such point.
        """
        return np.array([part.result.position(point)[-1] for part in self.segments])

    def displacement(self, point: str) -> Array:
        """Displacement of a named point such as "beam.end", global components, shape (k, 3).

        Args:
            point: Name of a point with that of its body, such as "beam.end".

        Raises:
            ValueError: There is no such point.
        """
        return np.array([part.result.displacement(point)[-1] for part in self.segments])

    def __str__(self) -> str:
        """One line for each load factor."""
        rows = zip(self.factors, self.cells, self.relative, strict=True)
        return "\n".join(f"factor {f:g}: {n} elements, error {100 * e:.3g} %" for f, n, e in rows)


def adapt_loads(
    build: Callable[[Refinable], Scene],
    mesh: Refinable,
    levels: Sequence[float],
    *,
    tolerance: float,
    body: str | None = None,
    arc_length: ArcLength | None = None,
    estimate: ErrorEstimate | None = None,
    most: int = 200_000,
    onto: Onto | None = None,
) -> AdaptedLoads[Refinable]:
    """Equilibrium at increasing load factors, each on a mesh that meets the tolerance.

    Args:
        build: Creates a scene with a beam, cable or shell on the given mesh.
        mesh: The coarsest mesh: lines, cells of first degree, or smooth patches.
        levels: Increasing positive load factors; the mesh changes only at these.
        tolerance: Relative error in the energy norm, at each load factor.
        body: Name of the beam, cable or shell on the mesh; default: the only one in the scene.
        arc_length: Options; see :class:`~fem_lie.stability.ArcLength`.
        estimate: Error estimate; default: :class:`~fem_lie.adaptivity.RecoveryEstimate`.
        most: Largest number of elements.
        onto: Projects new points onto the exact line or surface.

    Raises:
        ValueError: An argument is wrong, the mesh cannot be refined, or the scene has no beam,
            cable or shell on it, or loads that are not proportional to the factor; before anything
            is solved.
        ConvergenceError: The tolerance needs more elements, or equilibrium was not found; its
            ``result`` is the :class:`AdaptedLoads` up to there, if there is any.

    Example:
        >>> def build(mesh):
        ...     steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        ...     scene = fl.Scene()
        ...     beam = scene.add(fl.Beam(mesh, fl.Section.circle(0.01, steel), name="beam"))
        ...     _ = scene.add(fl.Clamp(beam.point("start")))
        ...     _ = scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 500.0)))
        ...     return scene
        >>> line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 2)
        >>> found = fl.adaptivity.adapt_loads(build, line, [0.5, 1.0], tolerance=0.05)
        >>> bool((found.relative <= 0.05).all())
        True
    """
    _check(build, mesh, tolerance, estimate, onto)
    whole(most, "most")
    segments: list[LoadSegment[Refinable]] = []
    now, solved = mesh, 0
    for level in increasing(levels):
        coarse: list[Refinable] = []
        for _ in range(_TRIES):
            _require_few(now, most, level, _found(segments, tolerance, solved))
            try:
                part = _stretch(build, now, level, body, arc_length, estimate, segments)
            except ConvergenceError as error:
                raise ConvergenceError(str(error), _found(segments, tolerance, solved)) from None
            solved += 1
            sizes = _sizes(part, tolerance)
            if part.error.relative <= tolerance:
                break
            _log.info("factor %g: %s: again", level, part.error)
            coarse.append(now)
            now = sizes.other_mesh(mesh, coarse, onto=onto)
        else:
            raise ConvergenceError(
                f"at load factor {level:g} the error is {part.error.relative:.2g} after {_TRIES} "
                f"meshes, expected {tolerance:g}",
                _found(segments, tolerance, solved),
            )
        segments.append(part)
        fitted = sizes.mesh(mesh, onto=onto)
        now = fitted if len(fitted.cells) < _FEWER * len(now.cells) else now
    return AdaptedLoads(tuple(segments), tolerance, solved)


def _found(
    segments: list[LoadSegment[Refinable]], tolerance: float, solved: int
) -> AdaptedLoads[Refinable] | None:
    return AdaptedLoads(tuple(segments), tolerance, solved) if segments else None


def _stretch(
    build: Callable[[Refinable], Scene],
    mesh: Refinable,
    level: float,
    body: str | None,
    arc_length: ArcLength | None,
    estimate: ErrorEstimate | None,
    before: list[LoadSegment[Refinable]],
) -> LoadSegment[Refinable]:
    """The increment to a load factor, from the last state, on this mesh."""
    scene = build(mesh)
    check_proportion(scene)
    chosen = named_body(scene, body, mesh)
    change = transfer(before[-1].result, before[-1].scene, scene) if before else None
    result = follow_loads(scene, [level], arc_length=arc_length)
    error = space_error(result, chosen, scene, estimate=estimate)
    return LoadSegment(mesh, scene, result, error, change)


def _sizes(part: LoadSegment[Refinable], tolerance: float) -> Sizes:
    """Sizes for equal errors of all elements, for the allowed error."""
    error = part.error
    allowed = _AIM * tolerance * float(np.sqrt(error.energy))
    return Sizes.of(part.mesh, error.squares, allowed, order_of(error.body))


def _require_few(
    mesh: LineMesh | SurfaceMesh | SplineMesh, most: int, level: float, found: object | None
) -> None:
    if len(mesh.cells) > most:
        raise ConvergenceError(
            f"at load factor {level:g} the tolerance needs {len(mesh.cells)} elements, more than "
            f"{most}",
            found,
        )


def _check(
    build: object, mesh: Refinable, tolerance: float, estimate: object, onto: Onto | None
) -> None:
    instance(build, Callable, "build", "a function from a mesh to a Scene")
    instance(mesh, LineMesh | SurfaceMesh | SplineMesh, "mesh", "a Line-, Surface- or SplineMesh")
    positive(tolerance, "tolerance")
    instance(estimate, ErrorEstimate | None, "estimate", "a Recovery, a Residual or None")
    check_refinable(mesh, onto)

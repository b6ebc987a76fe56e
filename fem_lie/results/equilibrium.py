"""Results of statics: equilibrium states, with tables, forces and pictures."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import SCENE_RECORDS, SceneInfo
from fem_lie.pictures import bodies
from fem_lie.pictures.bodies import Arrows
from fem_lie.pictures.page.page import Diagram, along_a_load
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.ranks.shared_factors import Subdomains
from fem_lie.results.files.tables import Columns
from fem_lie.results.files.written import Rows, Saved
from fem_lie.results.record import FrictionForces
from fem_lie.results.states import StateSeries, evenly, label_of, nearest
from fem_lie.scene.rotation import Rotation

if TYPE_CHECKING:
    from fem_lie.joints.connection import Connection
    from fem_lie.results.plotted_quantities import Curves, Quantity
    from fem_lie.results.reactions import Support


@dataclass(frozen=True, repr=False)
class StaticResult(StateSeries, Saved):
    """Equilibrium states.

    Attributes:
        factors: Load factors of the accepted steps, shape (k,); the last is 1.
        frames: Frames of all nodes at these factors, shape (k, nodes, 4, 3).
        joint_forces: Force and moment of each joint on its point ``a``, about the joint and in its
            axes on that side, shape (k, j, 6).
        iterations: Number of linear solutions in all accepted steps up to each state, shape (k,).
        failed_iterations: Number of linear solutions in rejected steps.
        info: Bodies and joints.
        steady_rotation: Rotation of the frame in which this is an equilibrium, at load factor 1.
        seconds: Wall time from the first assembly to the last solution, without set-up.
        reactions: Force and moment of each support on its node, about the node, global components,
            see :meth:`reaction`, shape (k, s, 6).
        negative_pivots: Number of negative eigenvalues of the tangent stiffness at each state, on
            the null space of the constraints, shape (k,); a state with none is stable. Where this
            stiffness is not symmetric there, as under loads without a potential, it is 1 if their
            number is odd, else 0; −1 if the matrix could not be factorised.
        factorisations: Number of factorisations of the matrix.
        load_steps: Number of accepted steps, including those between the returned states.
        failed_steps: Number of rejected steps.
        load_maxima: Load factors, approximately, at which the load had a maximum along the path.
        friction: Friction forces of contacts by penalty, if there are any.
        subdomains: Statistics of the domain decomposition, if it was used.
    """

    factors: Array
    frames: Array
    joint_forces: Array
    iterations: Indices
    failed_iterations: int
    info: SceneInfo
    steady_rotation: Rotation
    seconds: float
    reactions: Array
    negative_pivots: Indices = field(
        default_factory=lambda: np.empty(0, dtype=np.int64), kw_only=True
    )
    factorisations: int = field(default=0, kw_only=True)
    load_steps: int = field(default=0, kw_only=True)
    failed_steps: int = field(default=0, kw_only=True)
    load_maxima: tuple[float, ...] = field(default=(), kw_only=True)
    friction: FrictionForces | None = field(default=None, kw_only=True)
    subdomains: Subdomains | None = field(default=None, kw_only=True)

    def _summary(self) -> Iterator[tuple[str, object]]:
        """Load factors, displacement, iterations and stability."""
        yield "info.bodies", [body.name for body in self.info.bodies]
        yield "factors", self.factors
        yield "largest_displacement[-1]", float(self.largest_displacement[-1])
        yield "total_iterations", self.total_iterations
        yield from (("stable[-1]", bool(self.stable[-1])),) if len(self.negative_pivots) else ()
        yield "seconds", self.seconds

    _PLOTTED: ClassVar[Quantity] = "displacement"
    _PARTS: ClassVar[tuple[type, ...]] = (*SCENE_RECORDS, Rotation, FrictionForces)
    _NOT_SAVED: ClassVar[tuple[str, ...]] = ("subdomains",)

    def _rows(self) -> Rows:
        return Rows("load factor", self.factors)

    def _quantities(self) -> Columns:
        """Stability, and forces of joints and supports."""
        found: Columns = {}
        if len(self.negative_pivots) == len(self.factors):
            found["negative pivots"] = self.negative_pivots
        return found | super()._quantities()

    @property
    def stable(self) -> Flags:
        """Whether each state is stable, shape (k,), by ``negative_pivots``.

        Where the tangent stiffness is not symmetric on the null space of the constraints, an even
        number of negative eigenvalues is not detected: :func:`fem_lie.flutter` finds out.
        """
        return np.asarray(self.negative_pivots == 0)

    @property
    def largest_displacement(self) -> Array:
        """Largest displacement of a node in each state, over all bodies, shape (k,), length."""
        u = [np.linalg.norm(self.displacements(body.name), axis=-1) for body in self.info.bodies]
        return np.concatenate(u, axis=-1).max(axis=-1, initial=0.0)

    @property
    def total_iterations(self) -> int:
        """Number of linear solutions, including those of rejected steps."""
        return super().total_iterations + self.failed_iterations

    def picture(
        self,
        path: str | os.PathLike[str],
        at: Sequence[int | float] | None = None,
        *,
        trace: Sequence[Point | str | int] = (),
        frames: bool = False,
        arrows: Arrows | None = None,
        magnified: float = 1.0,
        title: str = "",
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw the undeformed bodies and equilibrium states; later states are darker.

        Args:
            path: Name of the ``.png`` file.
            at: States to draw: integers are indices, floats load factors, of which the nearest is
                taken. Default: all, or seven that are evenly spaced if there are more.
            trace: Points whose paths through all states are drawn.
            frames: Whether to draw the nodal frames of the last state.
            arrows: Forces in the last state, such as :meth:`~fem_lie.post.ContactForces.arrows`
                returns.
            magnified: Factor of displacements and rotations from the undeformed configuration, also
                of the paths of ``trace``; forces stay at their positions in the state.
            title: Title of the picture.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).

        Raises:
            ValueError: There is no such state.
        """
        rows = self._instants(_DRAWN) if at is None else [self._row(state) for state in at]
        moved = self._magnified(self.frames[rows], magnified)
        drawn = np.concatenate([self.info.undeformed[np.newaxis], moved])
        paths = self._traces(trace, magnified)
        canvas = Canvas(title, units, view=view)
        bodies.draw(
            self.info, drawn, path, paths=paths, triads=frames, arrows=arrows, canvas=canvas
        )

    def _row(self, state: int | float) -> int:
        """Index of a state that is given by its index or by a load factor."""
        count = len(self.factors)
        if isinstance(state, int | np.integer):
            if not -count <= state < count:
                raise ValueError(f"there are {count} states, got the index {state}")
            return int(state) % count
        return nearest(self.factors, state, "a load factor")

    def _curves(
        self, of: Sequence[Point | Connection | Support | str | int], name: Quantity, units: Units
    ) -> Curves:
        """As of all results; displacements begin with the undeformed state."""
        (factors, label, unit), series = super()._curves(of, name, units)
        if name == "displacement" and factors[0] > 0.0:
            factors = np.insert(factors, 0, 0.0)
            series = [s._replace(values=np.vstack([np.zeros(3), s.values])) for s in series]
        return (factors, label, unit), series

    def _along(self, units: Units) -> tuple[Array, str, str]:
        """Load factors, and their label."""
        return self.factors, "load factor", ""

    def _diagrams(
        self, rows: Indices, trace: Sequence[Point | str | int], units: Units
    ) -> Sequence[Diagram]:
        """Diagram of the displacement of the first traced point."""
        if not trace:
            return ()
        moved = np.linalg.norm(self.displacement(trace[0]), axis=-1)
        return (along_a_load(moved, self.factors, label_of(trace[0]), rows, units.length),)

    def _instants(self, images: int) -> Indices:
        """Indices of at most so many evenly spaced states."""
        return evenly(len(self.factors), images)

    def _traces(self, points: Sequence[Point | str | int], magnified: float = 1.0) -> list[Array]:
        """Paths of points through all states, starting from the undeformed configuration."""
        rest = self.info.undeformed
        starts = [self.info.frame(point, rest)[np.newaxis, 0] for point in points]
        return [
            np.vstack(parts)
            for parts in zip(starts, super()._traces(points, magnified), strict=True)
        ]


_DRAWN = 7  # states in a picture, without the undeformed configuration

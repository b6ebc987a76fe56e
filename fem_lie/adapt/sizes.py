"""A mesh whose elements are as large as a tolerance allows, made from a coarse one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from fem_lie._arrays import Array
from fem_lie.adapt.estimates.estimate import Estimated
from fem_lie.adapt.refinement import Onto, Refinable, refine
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.thin_shells.hierarchy import SplineMesh
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.surfaces import SurfaceMesh

_LARGEST = 1.2  # of the wanted size is small enough
_FINER, _COARSER = 0.125, 8.0  # what an estimate says beyond is not known
_LEVELS = 40
_OF_BICUBICS = 2  # curvatures


class Sizes(NamedTuple):
    """Sizes that elements are to have, at places.

    Attributes:
        middles: The places, shape (m, 3).
        wanted: Shape (m,).
    """

    middles: Array
    wanted: Array

    @classmethod
    def of(
        cls, mesh: LineMesh | SurfaceMesh | SplineMesh, squares: Array, allowed: float, order: int
    ) -> Sizes:
        """Those with which every element has the same error, and all together what is allowed.

        With errors of the order p in d dimensions ``η² ~ h^(2p + d)`` of an element. (O. C.
        Zienkiewicz & J. Z. Zhu, IJNME 24 (1987) 337.)

        Args:
            mesh: On which the error was estimated.
            squares: Square of the error of each element, shape (m,).
            allowed: Error of all of them.
            order: p.
        """
        middles, sizes = _middles(mesh)
        d = 1 if isinstance(mesh, LineMesh) else 2
        power = 2 * order + d
        total = float((squares ** (d / power)).sum())
        if total == 0.0:
            return cls(middles, _COARSER * sizes)
        each = (allowed**2 / total) ** (power / (power - d))
        with np.errstate(divide="ignore"):
            change = np.minimum((each / squares) ** (1.0 / power), _COARSER)
        return cls(middles, np.maximum(change, _FINER) * sizes)

    def mesh(
        self,
        coarse: Refinable,
        *,
        ahead: float = 0.0,
        onto: Onto | None = None,
        largest: float = _LARGEST,
    ) -> Refinable:
        """Cut a coarse mesh until no element is larger than is wanted in or beside it.

        Args:
            coarse: The mesh to begin with.
            ahead: So far around them sizes are wanted, too.
            onto: The true line or surface, for new points.
            largest: Of the wanted size.
        """
        tree, found = cKDTree(self.middles), coarse
        nearest = min(2, len(self.middles))
        for _ in range(_LEVELS):
            middles, sizes = _middles(found)
            _, beside = tree.query(middles, k=nearest)
            least = self.wanted[np.reshape(beside, (len(middles), -1))].min(axis=1)
            within = tree.query_ball_point(middles, 0.5 * sizes + ahead)
            least = [
                min(low, self.wanted[inside].min(initial=np.inf))
                for low, inside in zip(least, within, strict=True)
            ]
            large = np.flatnonzero(sizes > largest * np.array(least))
            if not len(large):
                break
            found = refine(found, large, onto=onto)
        return found


def order_of(body: Estimated) -> int:
    """With which the error in the energy norm falls with the size of elements."""
    if isinstance(body, ThinShell):
        return _OF_BICUBICS
    return body.elements.shape[1] - 1 if isinstance(body, Beam) else body.mesh.degree


def _middles(mesh: LineMesh | SurfaceMesh | SplineMesh) -> tuple[Array, Array]:
    """Middles of all cells (m, 3) and how large they are, (m,)."""
    if isinstance(mesh, SplineMesh):
        corners = mesh.rows[mesh.cells[:, [0, 1, 3, 2]], 0]
    else:
        corners = mesh.points[mesh.cells if isinstance(mesh, LineMesh) else mesh.corners]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    return corners.mean(axis=1), edges.max(axis=1)

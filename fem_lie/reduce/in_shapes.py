"""Forces of a body in few shapes at large motion: the equations of all nodes, pulled back."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.reduce.basis import Basis
from fem_lie.reduce.beside_rest import equations_of
from fem_lie.scene import Scene
from fem_lie.system.equations import Instant


class InShapes:
    """A body at ``Hᵢ = Hᵢ⁰ exp(Φᵢ η)``, whose virtual motions are ``T(Φᵢ η) Φᵢ δη``.

    Attributes:
        basis: The shapes.
    """

    def __init__(self, scene: Scene, basis: Basis) -> None:
        """Set the equations up; ``ValueError`` if the basis is not that of the only body."""
        body, self._equations = equations_of(scene)
        if body is not basis.body:
            raise ValueError(
                f"the basis is of {basis.body.label}, which is not the body of the scene"
            )
        if body.uncoupled:
            raise ValueError(
                f"nodes of {body.label} need not turn about their third directors: forces in few "
                "shapes are those of beams"
            )
        self.basis = basis
        unknowns = self._equations.unknowns
        if unknowns.total != unknowns.moving:
            raise ValueError(f"nodes of {body.label} follow others: forces in few shapes need none")
        self._free = ~unknowns.held
        self._scale, self._r = np.ones(unknowns.m), np.empty(unknowns.size)
        self._still = np.zeros((unknowns.moving, 6))

    def load(self, factor: float) -> None:
        """Let the loads act times a factor."""
        self._equations.prescribed(factor).act(factor)

    def frames(self, coordinates: Array) -> Array:
        """Frames of all nodes, (n, 4, 3)."""
        return np.asarray(lie.se3_retract(self.basis.body.frames, self._increments(coordinates)))

    def forces(self, coordinates: Array) -> Array:
        """What is left of equilibrium at all nodes, dual to increments, (n, 6); held ones none."""
        H = self._equations.start.frames.copy()
        H[: len(self._free)] = self.frames(coordinates)
        state = Instant(H, self._still, self._still, np.zeros(0))
        self._equations.residual(state, self._scale, self._r)
        forces = np.where(self._free, self._r.reshape(-1, 6), 0.0)
        T = lie.se3_tangent(self._increments(coordinates))
        return np.asarray(np.einsum("nij,ni->nj", T, forces))

    def residual(self, coordinates: Array) -> Array:
        """What is left of equilibrium in the shapes, (m,)."""
        shapes = self.basis.shapes
        return np.asarray(np.einsum("mni,ni->m", shapes, self.forces(coordinates)))

    def _increments(self, coordinates: Array) -> Array:
        return np.asarray(np.einsum("m,mni->ni", coordinates, self.basis.shapes))

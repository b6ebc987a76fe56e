"""Matrices and forces of a single body in a basis, at rest and at large motion."""

from __future__ import annotations

import numpy as np
import scipy.sparse.linalg

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, instance
from fem_lie.bodies.body import Body
from fem_lie.lie.node_types import NodeType
from fem_lie.linear.spectra.pencil import Pencil
from fem_lie.reduce.basis import Basis
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.system.equations import Equations, TimeState

_LOST = 1e-13  # of the largest pivot


class BesideRest:
    """A scene of one body, linearised beside rest, an equilibrium or a steady rotation.

    Attributes:
        body: The body.
        equations: Its own.
        free: Which unknowns of the nodes that lead are free, (l, 6).
        weight: Units of these: lengths of the model and angles, (l, 6).
        pencil: Matrices of the free unknowns.
        master: Number among these of the one that each node of the body follows, itself if it
            leads, (n,).
        leads: Which nodes of the body lead, in their order, (l,).
        inertia: Matrix of (x, d₁, d₂, d₃) of the nodes that lead.
    """

    def __init__(self, scene: Scene, at: StaticResult | None, *, loaded: bool = False) -> None:
        """Linearise; ``loaded``: loads may act on initial frames that they do not balance.

        Raises:
            ValueError: There are several bodies, joints, nodes that are no frames, supports in
                turned axes, or the state is no equilibrium.
        """
        instance(at, StaticResult | None, "at", "a result of fl.statics or None")
        self.body, self.equations = equations_of(scene)
        equations = self.equations
        still = Rotation.of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        state = equations.small_motions(still if at is None else at.steady_rotation)
        if at is not None:
            state.move(at.frames)
        elif not (loaded or state.balanced()):
            raise ValueError("the scene is not at rest as it is: give at=fl.statics(scene)")
        self.free: Flags = ~equations.unknowns.held
        self.weight: Array = state.weight.reshape(-1, 6)
        self.pencil: Pencil = state.pencil()
        tables, nodes = equations.tables, equations.unknowns.bodies[self.body]
        self.inertia = tables.inertia
        self.master: Indices = tables.master[nodes]
        place = np.argsort(nodes)
        self.leads: Indices = place[equations.unknowns.masters]
        # the twist of a node from that of its master node
        self._turn = lie.se3_adjoint(lie.se3_inverse(tables.offset[nodes]))

    def factor(self, some: Indices | None = None) -> scipy.sparse.linalg.SuperLU:
        """Factors of the stiffness of all or some of the free unknowns.

        Raises:
            ValueError: Round-off has lost rigid motions.
        """
        K = self.pencil.K.tocsc()
        try:
            factors = scipy.sparse.linalg.splu(K if some is None else K[some][:, some].tocsc())
        except RuntimeError:  # exactly singular
            factors = None
        if factors is not None:
            pivots = np.abs(factors.U.diagonal())
            if pivots.min() > _LOST * pivots.max():
                return factors
        raise ValueError(f"{self.body.label} can move rigidly: it needs an interface or a clamp")

    def shapes(self, vectors: Array) -> Array:
        """Shapes (m, n, 6) of vectors (m, f) of the free unknowns."""
        found = np.zeros((len(vectors), *self.free.shape))
        found[:, self.free] = vectors
        own = (found * self.weight)[:, self.master]
        return np.asarray(np.einsum("nij,mnj->mni", self._turn, own))

    def place(self, node: int) -> int:
        """Number of a node of the body among those that lead.

        Raises:
            ValueError: It follows another.
        """
        found = int(self.master[node])
        if self.leads[found] != node:
            raise ValueError(f"node {node} of {self.body.label} follows another one: take that one")
        return found

    def vectors(self, shapes: Array) -> Array:
        """Vectors (m, f) of shapes (m, n, 6).

        Raises:
            ValueError: They move what is held.
        """
        scaled = shapes[:, self.leads] / self.weight
        if np.abs(scaled[:, ~self.free]).max(initial=0.0) > 1e-9 * np.abs(scaled).max(initial=0.0):
            raise ValueError(f"shapes move nodes of {self.body.label} that are held")
        return np.asarray(scaled[:, self.free])


def equations_of(scene: Scene) -> tuple[Body, Equations]:
    """The only body of a scene, and its equations; ``ValueError`` as :class:`BesideRest` says."""
    instance(scene, Scene, "scene", "a Scene")
    if len(scene.bodies) != 1:
        raise ValueError(f"a basis is that of one body, the scene has {len(scene.bodies)}")
    body: Body = scene.bodies[0]
    if body.node_type != NodeType.FRAME:
        raise ValueError(f"shapes are those of nodal frames, and nodes of {body.label} are none")
    equations = Equations(scene, dynamics=True)
    if equations.unknowns.m:
        raise ValueError("a basis is that of one body: joints do not belong into its scene")
    if equations.supports:
        raise ValueError(
            f"nodes of {body.label} are held along turned axes: clamp it, or leave it free"
        )
    return body, equations


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
        state = TimeState(H, self._still, self._still, np.zeros(0))
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

"""Matrices of a linearised body, and forces of a body in a reduction basis."""

from __future__ import annotations

import numpy as np
import scipy.sparse.linalg

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, instance
from fem_lie.bodies.body import Body
from fem_lie.lie.node_types import NodeType
from fem_lie.linear.spectra.pencil import Pencil
from fem_lie.reduction.basis import Basis
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.system.equations import Equations, TimeState

_LOST = 1e-13  # relative to the largest pivot


class LinearisedBody:
    """A scene of a single body, linearised about rest, an equilibrium or a steady rotation.

    Attributes:
        body: The body.
        equations: Its equations.
        free: Whether each unknown of the independent nodes is free, (l, 6).
        weight: Scaling of these unknowns: lengths of the model and angles, (l, 6).
        pencil: Matrices of the free unknowns.
        master: Index among the independent nodes of the master of each node of the body, itself if
            it is independent, (n,).
        leads: Independent nodes of the body, in order, (l,).
        inertia: Mass matrix of (x, d₁, d₂, d₃) of the independent nodes.
    """

    def __init__(self, scene: Scene, at: StaticResult | None, *, loaded: bool = False) -> None:
        """Linearise; if ``loaded``, loads may act that the initial configuration does not balance.

        Raises:
            ValueError: The scene has several bodies, joints, nodes without frames, or supports
                along rotated axes, or the state is no equilibrium.
        """
        instance(at, StaticResult | None, "at", "a result of fl.statics or None")
        self.body, self.equations = equations_of(scene)
        equations = self.equations
        still = Rotation.of((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        state = equations.small_motions(still if at is None else at.steady_rotation)
        if at is not None:
            state.move(at.info.renumbered(at.frames, equations.unknowns.bodies))
        elif not (loaded or state.balanced()):
            raise ValueError(
                "the initial configuration is no equilibrium: give at=fl.statics(scene)"
            )
        self.free: Flags = ~equations.unknowns.held
        self.weight: Array = state.weight.reshape(-1, 6)
        self.pencil: Pencil = state.pencil()
        arrays, nodes = equations.arrays, equations.unknowns.bodies[self.body]
        self.inertia = arrays.inertia
        self.master: Indices = arrays.master[nodes]
        inverse = np.argsort(nodes)
        self.leads: Indices = inverse[equations.unknowns.masters]
        # maps the twist of the master to that of the node
        self._turn = lie.se3_adjoint(lie.se3_inverse(arrays.offset[nodes]))

    def factor(self, some: Indices | None = None) -> scipy.sparse.linalg.SuperLU:
        """Factors of the stiffness of all or some of the free unknowns.

        Raises:
            ValueError: The stiffness is singular to round-off, because of rigid-body modes.
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
        raise ValueError(
            f"{self.body.label} has rigid-body modes: it needs an interface or a clamp"
        )

    def modes_of(self, vectors: Array) -> Array:
        """Modes (m, n, 6) of vectors (m, f) of the free unknowns."""
        found = np.zeros((len(vectors), *self.free.shape))
        found[:, self.free] = vectors
        own = (found * self.weight)[:, self.master]
        return np.asarray(np.einsum("nij,mnj->mni", self._turn, own))

    def index_of(self, node: int) -> int:
        """Index of a node of the body among the independent ones.

        Raises:
            ValueError: The node is rigidly attached to another.
        """
        found = int(self.master[node])
        if self.leads[found] != node:
            raise ValueError(
                f"node {node} of {self.body.label} is rigidly attached to another: use its master"
            )
        return found

    def unknowns_of(self, mode_vectors: Array) -> Array:
        """Vectors (m, f) of modes (m, n, 6).

        Raises:
            ValueError: A mode moves fixed degrees of freedom.
        """
        scaled = mode_vectors[:, self.leads] / self.weight
        if np.abs(scaled[:, ~self.free]).max(initial=0.0) > 1e-9 * np.abs(scaled).max(initial=0.0):
            raise ValueError(f"modes move fixed nodes of {self.body.label}")
        return np.asarray(scaled[:, self.free])


def equations_of(scene: Scene) -> tuple[Body, Equations]:
    """The only body of a scene, and its equations; errors as in :class:`LinearisedBody`."""
    instance(scene, Scene, "scene", "a Scene")
    if len(scene.bodies) != 1:
        raise ValueError(f"expected a scene with one body for a basis, got {len(scene.bodies)}")
    body: Body = scene.bodies[0]
    if body.model.node_type != NodeType.FRAME:
        raise ValueError(f"a basis needs nodes with frames, and nodes of {body.label} have none")
    equations = Equations(scene, dynamics=True)
    if equations.unknowns.m:
        raise ValueError("expected a scene without joints for a basis of one body")
    if equations.supports:
        raise ValueError(
            f"nodes of {body.label} are held along rotated axes: clamp it, or leave it free"
        )
    return body, equations


class ReducedForces:
    """Forces of a body at ``Hᵢ = Hᵢ⁰ exp(Φᵢ η)``, with virtual motions ``T(Φᵢ η) Φᵢ δη``.

    Attributes:
        basis: The modes.
    """

    def __init__(self, scene: Scene, basis: Basis) -> None:
        """Set up the equations; ``ValueError`` if the basis is not that of the only body."""
        body, self._equations = equations_of(scene)
        if body is not basis.body:
            raise ValueError(
                f"the basis belongs to {basis.body.label}, which is not the body of the scene"
            )
        if body.model.separates_director:
            raise ValueError(
                f"nodes of {body.label} have no drilling rotation: reduced forces are implemented "
                "for beams only"
            )
        self.basis = basis
        unknowns = self._equations.unknowns
        if unknowns.total != unknowns.moving:
            raise ValueError(
                f"nodes of {body.label} are rigidly attached to others, which reduced forces do "
                "not support"
            )
        self._free = ~unknowns.held
        self._scale, self._r = np.ones(unknowns.m), np.empty(unknowns.size)
        self._still = np.zeros((unknowns.moving, 6))

    def load(self, factor: float) -> None:
        """Set the load factor."""
        self._equations.prescribed(factor).act(factor)

    def frames(self, coordinates: Array) -> Array:
        """Frames of all nodes, (n, 4, 3)."""
        return np.asarray(lie.se3_retract(self.basis.body.frames, self._increments(coordinates)))

    def forces(self, coordinates: Array) -> Array:
        """Residual of equilibrium at all nodes, dual to increments, (n, 6); zero if fixed."""
        H = self._equations.start.frames.copy()
        H[: len(self._free)] = self.frames(coordinates)
        state = TimeState(H, self._still, self._still, np.zeros(0))
        self._equations.residual(state, self._scale, self._r)
        forces = np.where(self._free, self._r.reshape(-1, 6), 0.0)
        T = lie.se3_tangent(self._increments(coordinates))
        return np.asarray(np.einsum("nij,ni->nj", T, forces))

    def residual(self, coordinates: Array) -> Array:
        """Residual of equilibrium in modal coordinates, (m,)."""
        mode_vectors = self.basis.modes
        return np.asarray(np.einsum("mni,ni->m", mode_vectors, self.forces(coordinates)))

    def _increments(self, coordinates: Array) -> Array:
        return np.asarray(np.einsum("m,mni->ni", coordinates, self.basis.modes))

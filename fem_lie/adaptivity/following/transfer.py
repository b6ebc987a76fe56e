"""Transfer of a state to other meshes of the same bodies, which conserves momenta.

The solver can restart from the transferred state::

    finer = build(fl.adaptivity.refine(mesh, error.worst()))
    changes = fl.adaptivity.transfer(result, scene, finer)  # sets frames and velocities
    print(changes)  # energy before and after; momenta are the same
    fl.GeneralisedAlpha().run(finer, duration=0.1, step=1e-3)

Frames of nodes inside old elements are interpolated by the element; on beams, on the geodesic of
SE(3). Positions and position gradients are sums of those of the old nodes (:mod:`.vector_maps`).
Velocities are those of the element at that point, with the least correction that restores the
momenta. Stress follows from the frames on the new mesh; the solver computes new accelerations and
joint forces.

*Velocities with given momenta* are the closest to the interpolated ones in the norm of the
consistent mass matrix::

    ½ (v − v̂)ᵀ M (v − v̂) → min,    Zᵀ M v = (p, l),    B v = rates of the constraints

``Z`` are the six rigid motions; the mass matrix ``M`` of twists is ``Lᵀ G L`` with the constant
matrix of (x, d₁, d₂, d₃).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fem_lie._arrays import Array, Flags
from fem_lie._summary import Summarised
from fem_lie.adaptivity.following.mesh_points import MeshPoints, mesh_points
from fem_lie.adaptivity.following.vector_maps import VectorMap
from fem_lie.bodies.body import Body
from fem_lie.lie.node_types import rigid_motions
from fem_lie.lie.node_types.inertia import invariants, mass_blocks
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.record import Record
from fem_lie.results.states import require_states, state_number
from fem_lie.scene import Scene
from fem_lie.scene.scene import Began, require_scene
from fem_lie.solve.starting import at_state, rotating, violated
from fem_lie.system.equations import Equations

_SAME = 1e-15  # relative to the momenta
_LOST = 1e-13  # relative size of conditions that count as linearly dependent
_KEPT = 1e-13  # relative to the momenta
_NO_INERTIA = 1e-12
_ROUNDS = 3


def with_momenta(
    equations: Equations, H: Array, v: Array, momenta: Array, free: Flags, rates: Array
) -> Array:
    """Twists of all nodes with given momenta.

    Args:
        equations: Equations of the scene.
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists of all nodes, to which the result is closest.
        momenta: Linear and angular momentum about the origin, global components, shape (6,).
        free: Whether each node may change its twist, shape (n,).
        rates: Rates of all constraints, shape (m,).
    """
    n, held = equations.unknowns.moving, equations.unknowns.held
    open_ = (free[:, np.newaxis] & ~held).ravel()
    M = mass_matrix(equations, H)
    rigid = rigid_motions(equations.unknowns.kinds, H[:n], np.zeros(3)).reshape(6 * n, 6)
    P = np.asarray((M @ rigid).T)
    constraints = equations.constraints(H)
    C = sp.vstack([sp.csr_matrix(P), constraints.jacobian]).tocsr()[:, open_]
    own = M[open_][:, open_]
    # scaled so that all unknowns have masses, and both momenta the same unit
    length = equations.unknowns.length
    units = (length / equations.unknowns.units)[open_]
    masses = own.diagonal() / units**2
    light = masses <= _NO_INERTIA * masses.max()
    factors = splu((own + sp.diags(np.where(light, masses.max() * units**2, 0.0))).tocsc())
    sizes = np.repeat([length, 1.0], 3)
    toward = factors.solve(C.toarray().T)
    S = C @ toward
    size = np.sqrt(np.maximum(np.diag(S), 1e-300))
    S = S / np.outer(size, size)
    found = v.copy()
    for _ in range(_ROUNDS):
        left = np.concatenate(
            [momenta - P @ found[:n].ravel(), rates - constraints.rates(found)[0]]
        )
        if np.abs(sizes * left[:6]).max() <= _SAME * np.abs(sizes * momenta).max():
            break
        weights, *_ = np.linalg.lstsq(S, left / size, rcond=_LOST)
        change = np.zeros(6 * n)
        change[open_] = toward @ (weights / size)
        found[:n] += change.reshape(n, 6)
    return found


def invariants_of(equations: Equations, H: Array, v: Array) -> tuple[float, Array]:
    """Kinetic energy, and linear and angular momentum about the origin, shape (6,)."""
    unknowns = equations.unknowns
    rates, workspace = np.empty((2, unknowns.moving, 4, 3))
    energy, *momenta = invariants(
        unknowns.kinds, H, v[: unknowns.moving], *equations.arrays.inertia, rates, workspace
    )
    return float(energy), np.array(momenta)


def mass_matrix(equations: Equations, H: Array) -> sp.csr_matrix:
    """Mass matrix of the twists of all moving nodes, shape (6 n, 6 n)."""
    n, inertia = equations.unknowns.moving, equations.arrays.inertia
    blocks = mass_blocks(equations.unknowns.kinds, H, inertia)
    indptr, indices, _ = inertia
    return sp.bsr_matrix((blocks, indices, indptr), shape=(6 * n, 6 * n)).tocsr()


_ENOUGH = 4  # number of new nodes from which only these are corrected


@dataclass(frozen=True, eq=False, repr=False)
class Transferred(Summarised):
    """Energies and momenta before and after a change of meshes; made by :func:`transfer`.

    Attributes:
        kinetic: Kinetic energy before and after.
        elastic: Elastic energy before and after.
        momentum: Linear momentum before and after, shape (2, 3).
        angular_momentum: Angular momentum about the origin, before and after, shape (2, 3).
    """

    kinetic: tuple[float, float]
    elastic: tuple[float, float]
    momentum: Array
    angular_momentum: Array

    @property
    def energy_change(self) -> float:
        """Change of kinetic and elastic energy."""
        return self.kinetic[1] + self.elastic[1] - self.kinetic[0] - self.elastic[0]

    @property
    def momentum_error(self) -> float:
        """Largest relative change of linear and angular momentum."""
        pairs = self.momentum, self.angular_momentum
        sizes = [float(np.linalg.norm(before)) for before, _ in pairs]
        gaps = [float(np.linalg.norm(after - before)) for before, after in pairs]
        return max((g / s for g, s in zip(gaps, sizes, strict=True) if s > 0.0), default=0.0)

    def __str__(self) -> str:
        """One line."""
        before = self.kinetic[0] + self.elastic[0]
        percent = f" ({100 * self.energy_change / before:.2g} %)" if before else ""
        return (
            f"energy changed by {self.energy_change:.3g}{percent}, momenta by "
            f"{self.momentum_error:.1g} of theirs"
        )


def transfer(
    result: Result | StaticResult, scene: Scene, onto: Scene, state: int = -1
) -> Transferred:
    """Set the initial state of a scene from a state of another scene with other meshes.

    Bodies are matched by name. Those of ``onto`` get the frames from which solvers start
    (``start_frames``) and velocities, those of its steady rotation from an equilibrium. ``onto``
    also gets the time (or load factor) at which its histories start, and the full rotations of its
    joints. Times of its results are relative to this time.

    Args:
        result: Result of dynamics, of statics or of a path of ``scene``.
        scene: The scene that was solved.
        onto: A scene with the same bodies on other meshes: beams, rods with frames, shells,
            cables, nets, thin shells, ANCF bodies, membranes and solids. Joints and their histories
            are those of ``scene`` if they have the same names; there may be more. It is modified.
        state: Index of the state; default: the last, the only one of a motion of bodies with
            position gradients (cables, thin shells, ANCF bodies).

    Raises:
        ValueError: The bodies differ, or meshes are of other lines or surfaces, or joints are at
            points that the new mesh has elsewhere, or the result has no velocities or momenta, or
            a file does not have the rates of position gradients.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> def build(mesh):
        ...     scene = fl.Scene()
        ...     beam = scene.add(fl.Beam(mesh, fl.Section.circle(0.01, steel), name="beam"))
        ...     beam.add_velocity(omega=(0, 0, 1), about=(0, 0, 0))
        ...     return scene
        >>> mesh = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)
        >>> coarse, fine = build(mesh), build(fl.adaptivity.refine(mesh, range(4)))
        >>> result = fl.GeneralisedAlpha().run(coarse, duration=0.1, step=0.02)
        >>> changes = fl.adaptivity.transfer(result, coarse, fine)
        >>> bool(changes.momentum_error < 1e-12), fine.bodies[0].start_frames.shape
        (True, (9, 4, 3))
    """
    require_states(result)
    require_scene(scene)
    require_scene(onto)
    moving = isinstance(result, Result)
    if (
        isinstance(result, Result)
        and Record.VELOCITIES | Record.MOMENTA | Record.ENERGIES not in result.recorded
    ):
        raise ValueError(
            "expected a result with recorded velocities, energies and momenta to transfer"
        )
    before, after = _bodies(scene), _bodies(onto)
    if set(before) != set(after):
        raise ValueError(f"bodies were {sorted(before)}, now there are {sorted(after)}")
    at = state_number(state, len(result.frames))
    found = {name: mesh_points(body, after[name]) for name, body in before.items()}
    equations = Equations(onto, dynamics=moving)
    H, v = _gathered(result, at, found, equations, after)
    if isinstance(result, Result) and result.velocities[at].any():
        v = _kept(result, at, found, equations, after, H, v)
    began = (
        Began(scene.began.time + float(result.times[at]), 0.0)
        if isinstance(result, Result)
        else Began(0.0, float(result.factors[at]))
    )
    # drives and prescribed motions at this time or load factor
    now = equations.prescribed(began.time + began.factor - onto.began.time)
    now.act(began.factor or 1.0)
    H[equations.unknowns.moving + 1 :] = now.frames
    connections = equations.system.connections
    if connections.first.turns or len(connections.sets) > 1:
        began = began._replace(turned=connections.history_from(_joint_turns(result, at, scene)))
    connections.remember(began.turned)
    changes = equations.report(H, v[: equations.unknowns.moving])
    if text := violated(equations, H):
        raise ValueError(
            f"{text} on the new mesh: its point was not a node; give it a named point of the mesh"
        )
    frames, twists = changes.frames, changes.twists
    twists[equations.unknowns.masters] = v[: equations.unknowns.moving]
    for body, own in equations.unknowns.bodies.items():
        body.model.start_frames = np.array(frames[own])
        body.velocities[:] = twists[own]
    onto.began = began
    return _report(result, at, scene, equations, H, v)


def _bodies(scene: Scene) -> dict[str, Body]:
    return {body.name: body for body in scene.bodies}


def _gathered(
    result: Result | StaticResult,
    at: int,
    found: Mapping[str, MeshPoints | VectorMap],
    equations: Equations,
    after: Mapping[str, Body],
) -> tuple[Array, Array]:
    """Frames and twists of the new nodes, interpolated by the elements of the old meshes."""
    unknowns = equations.unknowns
    frames, twists = np.empty((unknowns.total, 4, 3)), np.zeros((unknowns.total, 6))
    for name, points in found.items():
        own, nodes = result.info.body(name).nodes, unknowns.bodies[after[name]]
        v = _twists(result, at, name)
        frames[nodes], twists[nodes] = points.motion(result.frames[at, own], v)
    H, v = equations.start.frames.copy(), equations.start.velocities.copy()
    H[: unknowns.moving] = frames[unknowns.masters]
    v[: unknowns.moving] = twists[unknowns.masters]
    return H, v


def _twists(result: Result | StaticResult, at: int, name: str) -> Array:
    """Twists of the nodes of a body at a state; those of an equilibrium of its steady rotation."""
    own = result.info.body(name).nodes
    if not isinstance(result, Result):
        return rotating(result, at, own)
    v = np.array(result.velocities[at])
    gradients = result.info.gradient_nodes
    if np.isin(gradients, own).any():
        if result.gradient_velocities is None or at != len(result.frames) - 1:
            raise ValueError(
                f"{name} has position gradients, whose rates only the last state of a run on one "
                "rank has: expected its result as it was returned, and state=-1"
            )
        v[gradients] = result.gradient_velocities
    return np.asarray(v[own])


def _kept(
    result: Result,
    at: int,
    found: Mapping[str, MeshPoints | VectorMap],
    equations: Equations,
    after: Mapping[str, Body],
    H: Array,
    v: Array,
) -> Array:
    """Twists with the former momenta, corrected only at new nodes if all others remain."""
    unknowns, master = equations.unknowns, equations.arrays.master
    (new, changed), lost = np.zeros((2, unknowns.moving), dtype=bool), False
    for name, points in found.items():
        nodes, count = master[unknowns.bodies[after[name]]], len(result.info.body(name).nodes)
        new[nodes[points.between]] = True
        gone = len(np.unique(points.nodes[~points.between])) < count
        lost |= gone
        changed[nodes] |= gone or bool(points.between.any())
    if not changed.any():
        return v
    momenta = np.concatenate([result.momentum[at], result.angular_momentum[at]])
    wanted, _ = equations.constraints(H).rates(v)
    # if nodes were removed, a few new nodes cannot restore their momenta
    if np.count_nonzero(new) >= _ENOUGH and not lost:
        twists = with_momenta(equations, H, v, momenta, new, wanted)
        _, reached = invariants_of(equations, H, twists)
        sizes = np.repeat([equations.unknowns.length, 1.0], 3)
        if np.abs(sizes * (reached - momenta)).max() <= _KEPT * np.abs(sizes * momenta).max():
            return twists
    # nodes without rotations on a line have no moment about it
    return with_momenta(equations, H, v, momenta, changed, wanted)


def _joint_turns(
    result: Result | StaticResult, at: int, scene: Scene
) -> Mapping[tuple[str, str], float]:
    """Full rotations of joints up to a state, from all earlier states."""
    equations = Equations(at_state(scene, result, at), dynamics=isinstance(result, Result))
    return equations.history_variables.turns


def _report(
    result: Result | StaticResult,
    at: int,
    scene: Scene,
    equations: Equations,
    H: Array,
    v: Array,
) -> Transferred:
    """Energies and momenta on both meshes."""
    elastic = _elastic(equations, H)
    if not isinstance(result, Result):
        old = Equations(scene, dynamics=False)
        rows = old.start.frames.copy()
        (frames,) = result.info.renumbered(result.frames[at : at + 1], old.unknowns.bodies)
        rows[: old.unknowns.moving] = frames[old.unknowns.masters]
        return Transferred((0.0, 0.0), (_elastic(old, rows), elastic), *np.zeros((2, 2, 3)))
    kinetic, both = invariants_of(equations, H, v)
    momentum = np.array([result.momentum[at], both[:3]])
    angular = np.array([result.angular_momentum[at], both[3:]])
    energies = (float(result.kinetic[at]), kinetic), (float(result.elastic[at]), elastic)
    return Transferred(*energies, momentum, angular)


def _elastic(equations: Equations, H: Array) -> float:
    """Elastic energy of elements and springs."""
    equations.history_variables.update_stress(H)
    return equations.report(H).elastic + equations.system.connections.sets[0].spring_energy(H)

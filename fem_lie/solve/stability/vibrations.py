"""Free small vibrations about any equilibrium, and the scaling of modes.

The equations are those of :func:`~fem_lie.solve.stability.equilibrium_state.small_motions`.
Modes are scaled by their largest displacement, or by rotation if they consist of rotations only.
This is decided for each node: a node that rotates by θ, with cells of length l around it, moves by
a good part of l θ in any wave that the mesh can represent, however short it is and however large
the scene. The displacements of a mode of rotations only are round-off.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, whole
from fem_lie.bodies.body import Body
from fem_lie.linear.spectra.smallest import smallest
from fem_lie.parts.part_scene import divided
from fem_lie.ranks.together import all_stay
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.gathering import WholeScene
from fem_lie.results.vibrations.modes import Modes
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.stability.equilibrium_state import small_motions

Shape = npt.NDArray[np.float64] | npt.NDArray[np.complex128]

_NIL = 1e-5  # displacement over length of the cells and rotation: less is round-off


def node_lengths(nodes: Mapping[Body, Indices]) -> Array:
    """Length of the longest edge at each node, or the size of a body without cells, shape (N,).

    Args:
        nodes: Numbers of the nodes of each body among all.
    """
    lengths = np.zeros(sum(map(len, nodes.values())))
    for body, numbers in nodes.items():
        edges = _edges(body)
        along = np.linalg.norm(np.diff(body.frames[edges, 0], axis=1)[:, 0], axis=1)
        own = np.zeros(len(numbers))
        for end in edges.T:
            np.maximum.at(own, end, along)
        lengths[numbers] = np.where(own > 0, own, body.model.size)
    return lengths


def largest_elongation(nodes: Mapping[Body, Indices], frames: Array, twists: Array) -> float:
    """Largest elongation of a cell edge over its length, to first order; 0 without cells.

    Args:
        nodes: Numbers of the nodes of each body among all.
        frames: Frames of all nodes, shape (N, 4, 3).
        twists: Increments (translation, rotation) of all nodes along them, shape (N, 6).
    """
    moved, largest = np.einsum("nij,ni->nj", frames[:, 1:], twists[:, :3]), 0.0
    for body, numbers in nodes.items():
        edges = numbers[_edges(body)]
        chord, change = (np.diff(x[edges], axis=1)[:, 0] for x in (frames[:, 0], moved))
        elongation = np.abs((chord * change).sum(axis=1)) / (chord * chord).sum(axis=1)
        largest = max(largest, float(elongation.max(initial=0.0)))
    return largest


def _edges(body: Body) -> Indices:
    """Nodes at both ends of each edge of the cells, shape (e, 2)."""
    corners = body.model.faces
    pairs = np.stack([corners, np.roll(corners, 1, axis=1)], axis=-1).reshape(-1, 2)
    # triangles among quadrilaterals have one corner twice
    return np.concatenate([body.model.cells, pairs[pairs[:, 0] != pairs[:, 1]]])


def scaled(shape: Shape, lengths: Array) -> tuple[Shape, bool]:
    """A mode with the largest component of its largest displacement at +1, and False.

    If it consists of rotations only: with that of its largest rotation at +1, and True.

    Args:
        shape: Increments (translation, rotation) of all nodes, (N, 6).
        lengths: See :func:`node_lengths`.
    """
    shift, turn = (np.linalg.norm(shape[:, part], axis=1) for part in (slice(3), slice(3, 6)))
    rotation_only = bool(shift.max() <= _NIL * (lengths * turn).max())
    size = turn if rotation_only else shift
    node = int(size.argmax())
    vector = shape[node, 3:] if rotation_only else shape[node, :3]
    largest = vector[np.abs(vector).argmax()]
    return np.asarray(shape * (np.abs(largest) / largest) / size[node]), rotation_only


_MODES = 6  # by default

_log = logging.getLogger(__name__)


@all_stay("vibrations")
def vibrations(
    scene: Scene,
    count: int | None = None,
    *,
    at: StaticResult | None = None,
    spin: npt.ArrayLike = (0.0, 0.0, 0.0),
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
    load_steps: int = 1,
    petsc_options_prefix: str = "fem_lie_vibrations_",
) -> Modes:
    """Frequencies, damping and mode shapes of the slowest small vibrations.

    The equilibrium is the initial configuration if that is one under the full loads (unloaded
    bodies, or a top that stands upright), or else the result of
    :func:`~fem_lie.solve.statics.statics.statics`, which finds none for a mechanism that moves
    freely: create it where it is at rest. Bodies may be free: rigid motions have
    eigenvalues zero. An unstable equilibrium is not an error: see ``Modes.unstable``.

    Args:
        scene: The scene; initial velocities do not matter.
        count: Number of modes; default: six, or all degrees of freedom if they are fewer.
        at: Equilibrium of this scene, the last state of it; its rotation is taken with it.
        spin: Angular velocity of the frame in which there is equilibrium, global components, rad
            per time; frequencies and shapes are relative to it.
        about: A point on its axis.
        load_steps: For statics.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Invalid scene or options; no inertia; more modes than degrees of freedom.
        ConvergenceError: No equilibrium, or no method computes all modes to their residuals.
    """
    if count is not None:
        whole(count, "count")
    part = divided(scene, petsc_options_prefix)
    rotation = Rotation.of(spin, about)
    equations, state = small_motions(scene, at, rotation, load_steps, part)
    unknowns = equations.unknowns
    count = unknowns.mode_count(count, _MODES)
    s, vectors, residuals = smallest(state.pencil(), count, state.rate, petsc_options_prefix)
    own = np.array([state.twists(vector) for vector in vectors])
    whole_scene = WholeScene(equations.info, part)
    lengths = node_lengths(whole_scene.bodies(unknowns.bodies))
    found = [scaled(shape, lengths) for shape in whole_scene.on_all(own)]
    modes = Modes(
        eigenvalues=s,
        shapes=np.array([shape if turns else unknowns.length * shape for shape, turns in found]),
        rotation_only=np.array([turns for _, turns in found], dtype=np.bool_),
        frames=whole_scene.on_all(equations.report(state.H).frames[np.newaxis])[0].copy(),
        size=unknowns.length,
        residuals=residuals,
        info=whole_scene.info,
    )
    if modes.unstable.any():
        _log.warning("the equilibrium is unstable: eigenvalues %s", s[modes.unstable])
    return modes

"""Runs and statics that start from a state of a result of the same bodies.

Nodes get the frames of that state. Joints count their turns along all states of the result.
Independent stress, local unknowns of mixed elements and Lagrange multipliers follow from frames,
velocities and loads at the start.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import BodyInfo, element_of
from fem_lie.bodies.initial_state import InitialState
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.scene import Scene
from fem_lie.scene.scene import require_scene, started
from fem_lie.system.equations import Equations, TimeState

_SAME = 1e-9  # distance of the same nodes in two scenes, relative to the size of the body
_VIOLATED = 1e-6  # relative to the length of the model, or rad


def starting_from(scene: Scene, result: Result | StaticResult) -> Scene:
    """A scene whose runs and statics start from the last state of a result of the same bodies.

    Bodies are matched by name. Velocities are those of the bodies along the axes of their nodes,
    and in addition those of the steady rotation of an equilibrium.

    Args:
        scene: The scene; its loads, supports and joints need not be those of the result.
        result: Result of statics, of a path or of dynamics.

    Raises:
        ValueError: Bodies, meshes or elements differ from those of the result, or contacts have
            friction, whose displacements before slip no result has.
    """
    require_scene(scene)
    _check_bodies(scene, result)
    for contact in scene.contacts:
        if contact.has_friction:
            raise ValueError(
                f"start: expected contacts without friction, whose elastic displacements no result "
                f"has, got {contact.label}"
            )
    return at_state(scene, result, len(result.frames) - 1)


def at_state(scene: Scene, result: Result | StaticResult, state: int) -> Scene:
    """A scene that starts from a state of its own result, see :func:`starting_from`.

    Args:
        scene: The scene.
        result: The result.
        state: Index of the state, not negative.
    """
    nodes = {body: result.info.body(body.name).nodes for body in scene.bodies}
    velocities = np.zeros((result.frames.shape[1], 6))
    for body, own in nodes.items():
        velocities[own] = body.velocities
        if isinstance(result, StaticResult) and result.steady_rotation:
            velocities[own] += rotating(result, state, own)
    return started(scene, InitialState(result.frames[: state + 1], velocities, nodes))


def rotating(result: StaticResult, state: int, nodes: Indices) -> Array:
    """Twists of nodes in the steady rotation of an equilibrium, along their axes, shape (n, 6).

    Args:
        result: The equilibria.
        state: Index of the state.
        nodes: Numbers of the nodes in the result, shape (n,).
    """
    kinds, H = result.info.node_types[nodes], result.frames[state, nodes]
    # centrifugal forces have the load factor
    return result.steady_rotation.velocities(kinds, H, np.sqrt(result.factors[state]))


def _check_bodies(scene: Scene, result: Result | StaticResult) -> None:
    """Raise ``ValueError`` unless a result has a state of the bodies of a scene."""
    before = {body.name: body for body in result.info.bodies}
    given = [body.name for body in scene.bodies]
    if set(before) != set(given):
        raise ValueError(
            f"start: expected a result of the bodies {sorted(given)}, got one of {sorted(before)}"
        )
    if not len(result.frames):
        raise ValueError("start: expected a result with a state, got one without any")
    for body in scene.bodies:
        _check_same(body, before[body.name])


def _check_same(body: Body, before: BodyInfo) -> None:
    """Raise ``ValueError`` unless a body has the element and the mesh of that of a result."""
    now = BodyInfo.of(body, np.arange(len(body.frames)))
    where = f"start: {body.label}"
    if now.kind != before.kind:
        raise ValueError(f"{where}: expected a result of a {now.kind}, got one of a {before.kind}")
    element = element_of(body.model)
    if before.element and element != before.element:
        raise ValueError(f"{where}: expected a result with {element}, got {before.element}")
    if len(now.nodes) != len(before.nodes):
        raise ValueError(
            f"{where}: expected a result with its mesh of {len(now.nodes)} nodes, got "
            f"{len(before.nodes)} nodes (fl.adaptivity.transfer changes meshes)"
        )
    if before.undeformed is None or before.node_types is None:
        raise ValueError(
            f"{where}: expected a result with its undeformed configuration, got a file of an "
            "earlier version; run the scene again"
        )
    places = body.frames[:, 0]
    length = max(body.model.size, float(np.abs(places).max()))
    away = np.abs(body.frames - before.undeformed).max(axis=-1)
    away[:, 0] /= length or 1.0
    away = away.max(axis=1)
    if (now.node_types != before.node_types).any() or (away > _SAME).any():
        node = int(away.argmax())
        raise ValueError(
            f"{where}: expected a result with its mesh, got another one: node {node} was at "
            f"{before.undeformed[node, 0]}, is at {places[node]}"
        )


def violated(equations: Equations, H: Array) -> str:
    """Which joint is violated most, and how much; empty if none is, for any unit of length.

    Args:
        equations: Equations of the scene.
        H: Frames of all nodes, ground and prescribed motions.
    """
    unknowns = equations.unknowns
    r, still = np.empty(unknowns.size), np.zeros((len(H), 6))
    state = TimeState(H, still, still[: unknowns.moving], np.zeros(unknowns.m))
    equations.residual(state, np.ones(unknowns.m), r)
    violations = np.abs(r[6 * unknowns.moving :])
    sizes = violations / np.where(unknowns.angular, 1.0, unknowns.length)
    if not sizes.max(initial=0.0) > _VIOLATED:
        return ""
    worst = int(sizes.argmax())
    joint = equations.info.joints[int(equations.arrays.owner[worst])]
    unit = "rad" if unknowns.angular[worst] else f"of a model of the size {unknowns.length:.1e}"
    return f"{joint.name} is violated by {violations[worst]:.1e} {unit}"

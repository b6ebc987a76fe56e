"""Free rigid bodies of a scene, and their loads, as compiled steps have them."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.rigid import RigidBody
from fem_lie.lie.motions import Group
from fem_lie.scene import Scene
from fem_lie.scene.load import History as LoadHistory
from fem_lie.scene.load import NodalLoad, histories
from fem_lie.solve.alpha.step.free_records import Bodies, Loads
from fem_lie.solve.convergence import ROTATION
from fem_lie.solve.motion.policies import Policy
from fem_lie.system.equations import Equations


def applies(scene: Scene, policy: Policy) -> bool:
    """Whether a run has free rigid bodies only, and the policy is a rule for compiled loops.

    They may touch by impacts, between which they move on R³×SO(3).
    """
    if scene.contacts or (scene.impacts and not _on_r3_so3(scene)):
        return False
    holding = scene.joints, scene.connections, scene.clamps, scene.motions, scene.links
    held = any(holding) or any(body.held.any() for body in scene.bodies)
    rigid = all(isinstance(body, RigidBody) and not body.gram[0, 1:].any() for body in scene.bodies)
    nodal = [load for load in scene.loads if isinstance(load, NodalLoad)]
    simple = len(nodal) == len(scene.loads) and not any(load.on_directors().any() for load in nodal)
    return bool(scene.bodies) and rigid and simple and not held and policy.rule() is not None


def _on_r3_so3(scene: Scene) -> bool:
    return all(body.group == Group.R3xSO3 for body in scene.bodies)


def packed_bodies(equations: Equations) -> tuple[Array, Array, Bodies]:
    """Inertia blocks (n, 4, 4), lengths (n,), and what compiled steps have of n bodies."""
    unknowns = equations.unknowns
    n = unknowns.moving
    blocks, sizes = np.empty((n, 4, 4)), np.empty(n)
    for body, nodes in unknowns.bodies.items():
        assert isinstance(body, RigidBody)
        blocks[nodes], sizes[nodes] = body.gram, body.size
    trace = np.trace(blocks[:, 1:, 1:], axis1=1, axis2=2)
    J = trace[:, np.newaxis, np.newaxis] * np.eye(3) - blocks[:, 1:, 1:]
    scaling = np.column_stack([1.0 / sizes, np.full(n, ROTATION)])
    return blocks, sizes, Bodies(blocks[:, 0, 0].copy(), J, scaling, unknowns.kinds)


def packed_loads(equations: Equations, mass: Array) -> tuple[Loads, dict[int, LoadHistory]]:
    """Loads on the bodies, whose masses have the shape (n,), and the histories of some of them."""
    scene, unknowns = equations.scene, equations.unknowns
    constant = np.zeros((unknowns.moving, 12))
    constant[:, :3] = mass[:, np.newaxis] * scene.gravity
    vary, owner, varying = [], [], histories(scene.loads)
    for k, load in enumerate(scene.loads):
        assert isinstance(load, NodalLoad)
        (node,) = unknowns.bodies[load.body]
        twelve, at = np.zeros(12), 6 if load.following else 0
        twelve[at : at + 6] = load.nodal()[0]
        if k in varying:
            vary.append(twelve)
            owner.append(node)
        else:
            constant[node] += twelve
    nodes = np.array(owner, dtype=np.int64)
    order = np.argsort(nodes, kind="stable")
    first = np.searchsorted(nodes[order], np.arange(unknowns.moving + 1))
    table = np.array(vary).reshape(-1, 12)[order]
    return Loads(constant, first, table, order), varying

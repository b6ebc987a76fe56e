"""What joints do to a body, against its change of momentum in steps of generalised-alpha."""

from __future__ import annotations

import numpy as np

import fem_lie as fl


def forces_on_hub(result: fl.Result, joints: list[fl.joints.Joint]) -> np.ndarray:
    """Of all joints together, global components, shape (steps, 3), and of each."""
    found = []
    for joint in joints:
        axes = result.rotation(joint.a) @ joint.frame()[1:].T
        found.append(np.einsum("tij,tj->ti", axes, result.joint_force(joint)[:, :3]))
    return np.array(found)


def momentum(result: fl.Result, body: fl.Solid, density: float) -> np.ndarray:
    """Of the hub, shape (steps, 3)."""
    nodes = result.info.body(body.name).nodes
    masses = fl.loads.BulkLoad(body, (density, 0, 0)).nodal()[:, 0]
    axes, local = result.frames[:, nodes, 1:], result.velocities[:, nodes, :3]
    return np.einsum("n,tnij,tni->tj", masses, axes, local)


def balance(
    result: fl.Result,
    body: fl.Solid,
    joints: list[fl.joints.Joint],
    step: float,
    density: float,
    radius: float,
) -> float:
    """Largest difference of the impulse of joints and the momentum."""
    alpha_m, alpha_f = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
    gamma = 0.5 + alpha_f - alpha_m
    each, P = forces_on_hub(result, joints), momentum(result, body, density)
    F = each.sum(axis=0)
    mixed = (1 - alpha_f) * F[1:] + alpha_f * F[:-1]
    force = gamma * mixed[1:] + (1 - gamma) * mixed[:-1]
    change = np.diff(P, axis=0) / step
    gap = (1 - alpha_m) * change[1:] + alpha_m * change[:-1] - force
    return float(np.abs(gap[1:]).max() / np.abs(each).max())

"""Reactions of clamps, supports of bodies and prescribed motions, and axes of joint forces.

Reactions are the residuals of the equations of motion, or of equilibrium, at constrained degrees of
freedom. A prescribed motion is a joint to a moving frame; its reaction is the force of that joint.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, shown
from fem_lie.bodies.body import Point
from fem_lie.bodies.catalogue import JointInfo, SceneInfo
from fem_lie.scene.supports import Clamp, PrescribedMotion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fem_lie.joints.connection import Connection

Support = Clamp | PrescribedMotion | Point | str


def reaction(
    supports: Sequence[Support],
    info: SceneInfo,
    frames: Array,
    joint_forces: Array,
    reactions: Array,
) -> Array:
    """Resultant force and moment of supports, global components, shape (k, 6).

    Args:
        supports: Clamps, prescribed motions, or points (or their names) at which a body is held.
            Supports of the same node count once. Moments are about the first support, at its
            position in each state.
        info: Bodies, joints and supports.
        frames: Frames of all nodes in k states, shape (k, N, 4, 3).
        joint_forces: Forces of all joints, shape (k, j, 6).
        reactions: Forces of all supports, each about its node, shape (k, s, 6).

    Raises:
        TypeError: A support is of another type, such as a joint.
        ValueError: No support is given, or one of them holds nothing.
    """
    if not supports:
        raise ValueError("give at least one clamp, support or prescribed motion")
    for support in supports:
        if not isinstance(support, Support):
            raise TypeError(
                "reaction: expected a Clamp, a PrescribedMotion, or a point at which a body is "
                f"held, or its name, got {shown(support)}; result.joint_force(joint) has the force "
                "of a joint"
            )
    about = info.frame(_point(supports[0]), frames)[:, 0]
    total, counted = np.zeros((len(about), 6)), set[tuple[str, int]]()
    for support in supports:
        key, at, wrench = _of(support, info, frames, joint_forces, reactions)
        if key not in counted:
            counted.add(key)
            arm = at - about
            total += wrench
            total[:, 3:] += np.cross(arm, wrench[:, :3])
    return total


def joint_axes(joint: Connection | str, info: SceneInfo, frames: Array) -> Array:
    """Axes of the force of a joint as rows, global components, shape (k, 3, 3).

    Args:
        joint: A joint of the scene, or its name.
        info: Bodies and joints.
        frames: Frames of all nodes in k states, shape (k, N, 4, 3).

    Raises:
        ValueError: There is no such joint, or its axes are not known: it slides along a beam, or it
            is on an attachment and only its name is given.
    """
    known = info.joints[info.joint(joint)]
    if (found := recorded_axes(known, frames)) is not None:
        return found
    side = None if isinstance(joint, str) else joint.force_side
    if side is None:
        raise ValueError(
            f"joint_force: the axes of the force of {known.kind} {known.name!r} are not in the "
            "results, as they follow an attachment or a section along which it slides; expected "
            "axes='joint', or, for an attachment, the joint itself instead of its name"
        )
    point, axes = side
    return np.asarray(axes @ point.frame[1:].T @ info.frame(point, frames)[:, 1:])


def recorded_axes(joint: JointInfo, frames: Array) -> Array | None:
    """Axes of the force of a joint, shape (k, 3, 3), as :func:`joint_axes` if they are known."""
    if joint.axes is None:
        return None
    R = np.eye(3) if joint.side < 0 else frames[:, joint.side, 1:]
    return np.broadcast_to(joint.axes @ R, (len(frames), 3, 3))


def in_space(wrench: Array, axes: Array) -> Array:
    """Force and moment (k, 6) along axes (k, 3, 3), in global components."""
    parts = wrench.reshape(-1, 2, 3)
    return np.asarray(np.einsum("kpi,kij->kpj", parts, axes).reshape(-1, 6))


def _point(support: Support) -> Point | str:
    return support.point if isinstance(support, Clamp | PrescribedMotion) else support


def _of(
    support: Support, info: SceneInfo, frames: Array, joint_forces: Array, reactions: Array
) -> tuple[tuple[str, int], Array, Array]:
    """Identifier of a support, its position (k, 3), and its force and moment, shape (k, 6)."""
    if isinstance(support, PrescribedMotion):
        joint = info.joint(f"motion of {support.point.label}")
        at = info.frame(support.point, frames)
        return ("motion", joint), at[:, 0], in_space(joint_forces[:, joint], at[:, 1:])
    row = info.supports.row(info.node(_point(support)))
    if row is None:
        names = [
            f"{body.name}.{name}"
            for body in info.bodies
            for name, own in body.points.items()
            if own in info.supports.nodes
        ]
        point = support.point if isinstance(support, Clamp) else support
        label = point if isinstance(point, str) else point.label
        raise ValueError(
            f"{label} is not held; {len(info.supports.nodes)} nodes are, those with names: "
            f"{', '.join(names) or 'none'}"
        )
    return ("support", row), frames[:, info.supports.at[row], 0], reactions[:, row]

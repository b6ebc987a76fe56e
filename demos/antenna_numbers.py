"""Numbers of hoop_antenna.py."""

from __future__ import annotations

import numpy as np
from antenna_scene import FOLDED, Antenna

import fem_lie as fl


def sizes(antenna: Antenna) -> dict[str, int]:
    """Unknowns of nodes, and equations of joints, gears and drives."""
    scene, net = antenna.scene, antenna.net
    bars = 6 * sum(len(bar.frames) for bar in antenna.bars)
    between = [*scene.joints, *scene.connections]
    return {
        "unknowns": bars + (0 if net is None else 3 * len(net.frames)),
        "constraints": sum(part.size for part in between),
    }


def shape(antenna: Antenna, result: fl.Result) -> dict[str, float]:
    """Where the tops are."""
    tops = np.array([result.position(bar.point("end")) for bar in antenna.uprights])
    radii = np.hypot(tops[..., 0], tops[..., 1])
    differ = [
        np.ptp(radii, axis=0),
        np.ptp(tops[::2, :, 2], axis=0),
        np.ptp(tops[1::2, :, 2], axis=0),
    ]
    rise = tops[::2, -1, 2].mean() - tops[1::2, -1, 2].mean()
    return {
        "width": float(radii[:, -1].max()),
        "off_posture": float(
            max(
                abs(radii[:, -1] - radii[0, 0] * np.cos(FOLDED)).max(),
                abs(rise - antenna.side * np.sin(FOLDED)),
            )
        ),
        "asymmetry": float(np.max(differ)),
    }


def forces(antenna: Antenna, result: fl.Result) -> dict[str, float]:
    """The largest of the joints, by their kinds, and of the telescopes."""
    late = result.times > 0.05 * result.times[-1]
    found = {
        f"{kind.__name__.lower()}_force": max(
            float(np.linalg.norm(result.joint_force(joint)[late, :3], axis=1).max())
            for joint in antenna.scene.joints
            if isinstance(joint, kind)
        )
        for kind in (fl.joints.Revolute, fl.joints.Spherical, fl.joints.Prismatic)
    }
    pushes = [np.abs(result.joint_force(drive)[late]).max() for drive in antenna.drives]
    return found | {"telescope_force": float(np.max(pushes))}

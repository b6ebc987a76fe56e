"""A bead on a straight wire: a joint that holds a point of one body on a line of another.

A joint sees its two sides as a relative motion: the displacement Δ of ``b`` from ``a`` in the axes
of ``a``, entries 0 to 2, and the rotation Q, entries 3 to 11 row by row. Its axis is e₃. What the
joint forbids is a selection of these entries: two rows for a line, Δ₁ = 0 and Δ₂ = 0.
"""

from __future__ import annotations

from math import cos, pi, sin

import fem_lie as fl
from fem_lie.extend import rows


class OnLine(fl.joints.Joint):
    """Point ``b`` stays on the line through ``a`` along ``axis``; it may turn as it likes."""

    selection = rows({0: 1.0}, {1: 1.0})


slope, duration = pi / 6, 0.5
bead = fl.RigidBody(0.1, (1e-5, 1e-5, 1e-5))
scene = fl.Scene(gravity=(0, 0, -9.81))
scene.add(bead)
scene.add(OnLine(fl.ground(), bead.point("centre"), axis=(cos(slope), 0, -sin(slope))))
result = fl.GeneralisedAlpha().run(scene, duration=duration, step=1e-3)

way = result.position(bead.point("centre"))[-1] @ (cos(slope), 0, -sin(slope))
exact = 0.5 * 9.81 * sin(slope) * duration**2
error = abs(way / exact - 1)
print(f"way {way:.6f} m, exact {exact:.6f} m")

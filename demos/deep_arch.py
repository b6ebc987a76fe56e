"""A deep circular arch, hinged at one end and clamped at the other, pushed down at its crown.

Radius R = 100, opening angle 215 degrees, EI = 1e6. The load P is fixed in space. Under it the arch
leans away from the clamp, the load passes a maximum at P R^2/EI = 8.97 and falls through zero to a
minimum, before the arch, turned inside out, hangs from its supports and takes any load (D. A. Da
Deppo & R. Schmidt, J. Appl. Mech. 42 (1975) 369). Between the two extrema the equilibrium is
unstable: the tangent has a negative pivot. The reference, a shooting method with an arc length, has
896.841 and -72.923 for EA = 3e6 without shear, 897.289 and -73.044 for EA = GA = 1e8.

`fl.follow_path` goes through both with its default settings: every state is polished, limit points
are located to 1e-6 of the load, and the number of negative pivots is counted on both sides.

That is the arch in its plane: it is a strip, a hundred times as stiff across the plane as in it.
With a round section (`--round`) of the same EI the arch leaves its plane long before, at a quarter
of that load: the first thing that the path meets is a bifurcation, and both limit points lie beyond
it, with one negative pivot more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

RADIUS, ANGLE, BENDING, FORCE = 100.0, np.radians(215.0), 1e6, 1000.0
# name: EA, GA (shear-rigid: very stiff), limit loads
VARIANTS = {
    "stretchable": (3e6, 3e10, (896.8413923, -72.92283728)),
    "stiff": (1e8, 1e8, (897.2891401, -73.04371536)),
}
UNITS = fl.post.Units(length="length")


def arch(elements: int, variant: str, *, across: float = 100.0) -> tuple[fl.Scene, fl.extend.Point]:
    """The arch and its crown; ``across`` is the stiffness across the plane over that in it."""
    EA, GA, _ = VARIANTS[variant]
    strip = [(-0.5, -4.0), (0.5, -4.0), (0.5, 4.0), (-0.5, 4.0)]  # for the picture only
    stiffness = [EA, GA, GA, across * BENDING, across * BENDING, BENDING]
    section = fl.Section.from_stiffness(stiffness, outline=strip)

    def position(s: float) -> tuple[float, float, float]:
        angle = ANGLE * (s - 0.5)
        return RADIUS * np.sin(angle), RADIUS * np.cos(angle), 0.0

    scene = fl.Scene()
    beam = scene.add(fl.Beam.curve(position, section, cells=elements, up=(0, 0, 1), name="arch"))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    scene.add(fl.Clamp(beam.point("end")))
    crown = beam.point(elements // 2)
    scene.add(fl.PointLoad(crown, force=(0, -FORCE, 0)))
    return scene, crown


def main(
    elements: int = 40, variant: str = "stretchable", round: bool = False, pictures: bool = True
) -> dict[str, Any]:
    if variant not in VARIANTS:
        raise ValueError(f"variant must be one of {', '.join(VARIANTS)}, got {variant!r}")
    if elements < 2 or elements % 2:
        raise ValueError(f"elements must be even, for a node at the crown, got {elements}")
    scene, crown = arch(elements, variant, across=1.0 if round else 100.0)
    path = fl.follow_path(scene, observe={"deflection": lambda s: -s.displacement(crown)[1]})
    upper, lower = path.limits[:2]
    reference = VARIANTS[variant][2]
    record = {
        "elements": elements,
        "variant": variant,
        "limit_load": FORCE * upper.factor,
        "lower_limit_load": FORCE * lower.factor,
        "limit_error": FORCE * upper.factor / reference[0] - 1.0,
        "lower_limit_error": FORCE * lower.factor / reference[1] - 1.0,
        "negative_pivots": [*upper.negative_pivots, *lower.negative_pivots],
        "bifurcation_loads": [FORCE * point.factor for point in path.bifurcations],
        "load_steps": path.load_steps,
        "rejected_steps": path.failed_steps,
        "iterations": path.total_iterations,
        "seconds": path.seconds,
    }
    if pictures:
        diagram, moving = in_results("deep_arch.png"), in_results("deep_arch.gif")
        path.plot_path(
            "deflection",
            diagram,
            label="deflection of the crown",
            load=(FORCE, "P"),
            units=UNITS,
        )
        path.animate(moving, title="Deep arch", units=UNITS)
    return record


if __name__ == "__main__":
    run(main, show=True)

"""The rod in the box by penalty beside cones, with friction: until when both agree, and why.

The scene of rod_in_box.py with the square section. Heights of the rod's first end, distances
between its positions by both laws, and by one law from starts that differ by 1e-9 m/s. The penalty
has 1e9 N/m; its damping is critical, or four times that. Where a corner hits a wall while others
slide, the motion depends on how normal forces follow each other within the impact: penalties with
both values of damping part there by as much as either from cones, which stop all corners at once.
Distances of neighbours say whether the motion is chaotic: by cones they do not grow.

    python -m studies.penalty_beside_cones [--duration 2]
"""

from __future__ import annotations

from typing import Any

import numpy as np

import fem_lie as fl
from demos import rod_in_box as demo
from demos.command_line import run
from demos.diagrams import diagram
from fem_lie.contact import Impact, Penalty

STEP, SHIFT = 1e-4, 1e-9
EDGE = {0.2: 0.4156, 0.4: 0.3168, 0.6: 0.2881}
"""Time at which a third corner hits the box while two slide, s."""


def positions(law: Impact | Penalty, duration: float, shift: float = 0.0) -> fl.extend.Array:
    """Positions of the rod's first end at all steps, shape (n, 3)."""
    scene, rod, _ = demo.rod_in_box("square", law)
    rod.add_velocity((shift, 0.0, 0.0))
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10)
    result = scheme.run(scene, duration=duration, step=STEP, progress=False)
    return result.position(rod.point(demo.FIRST))


def penalty(friction: float, times: float = 1.0) -> Penalty:
    """The penalty of the demo, with so many times its damping."""
    law = demo.law_of("penalty", friction, 0.0)
    assert isinstance(law, Penalty)
    damping, ramp = times * law.damping, times * law.ramp
    return Penalty(law.stiffness, damping, ramp, friction, law.holding)


def distance(a: fl.extend.Array, b: fl.extend.Array) -> fl.extend.Array:
    """Distances of positions, shape (n,)."""
    return np.asarray(np.linalg.norm(a - b, axis=1))


def compared(friction: float, duration: float) -> dict[str, fl.extend.Array]:
    """Heights by both laws, and distances, each of shape (n,)."""
    cones, soft = (positions(law, duration) for law in (Impact(friction), penalty(friction)))
    damped = positions(penalty(friction, 4.0), duration)
    return {
        "cones": cones[:, 2],
        "penalty": soft[:, 2],
        "apart": distance(cones, soft),
        "apart, 4 c": distance(cones, damped),
        "cones, shifted": distance(cones, positions(Impact(friction), duration, SHIFT)),
        "penalty, shifted": distance(soft, positions(penalty(friction), duration, SHIFT)),
    }


def main(duration: float = 2.0, pictures: bool = True) -> dict[str, Any]:
    """Duration of the motion."""
    found = {μ: compared(μ, duration) for μ in EDGE}
    if pictures:
        _draw(found)
    record: dict[str, Any] = {}
    for μ, each in found.items():
        before = round(min(EDGE[μ], duration) / STEP)
        after = min(before + round(0.03 / STEP), len(each["apart"]) - 1)
        record[f"until edge {μ}"] = float(each["apart"][round(0.1 / STEP) : before].max())
        for name in ("apart", "apart, 4 c"):
            record[f"{name}, 30 ms later {μ}"] = float(each[name][after])
            record[f"{name}, end {μ}"] = float(each[name][-1])
        for name in ("cones, shifted", "penalty, shifted"):
            record[f"{name} {μ}"] = float(each[name].max())
    return record


def _draw(found: dict[float, dict[str, fl.extend.Array]]) -> None:
    with diagram("penalty_beside_cones.png", 3) as panels:
        for (μ, each), axes in zip(found.items(), panels, strict=True):
            t = STEP * np.arange(len(each["apart"]))
            for name in ("apart", "apart, 4 c", "cones, shifted", "penalty, shifted"):
                axes.semilogy(t[1:], np.maximum(each[name][1:], 1e-13), label=name, lw=1.0)
            axes.axvline(EDGE[μ], color="#999999", ls=":")
            axes.set(title=f"μ = {μ}", xlabel="time, s", ylabel="distance, m")
    with diagram("penalty_beside_cones_heights.png") as axes:
        for (μ, each), colour in zip(found.items(), fl.extend.COLOURS, strict=False):
            t = STEP * np.arange(len(each["apart"]))
            axes.plot(t, each["cones"], color=colour, label=f"cones, μ = {μ}")
            axes.plot(t, each["penalty"], color=colour, ls="--", label="penalty")
        axes.set(xlabel="time, s", ylabel="height of the first end, m")


if __name__ == "__main__":
    run(main, show=True)

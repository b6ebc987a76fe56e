"""Picture of the demo own_energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from diagrams import COLOURS, diagram


def draw(curves: list[np.ndarray], arc: Callable[[float], np.ndarray]) -> None:
    """Nodes at all load steps on the exact arcs.

    Args:
        curves: Positions of the nodes at each load step, (n, 3) each.
        arc: Points of the exact arc, (3, k), at a fraction of the load above zero.
    """
    s, steps = np.linspace(0.0, 1.0, 200), len(curves) - 1
    with diagram("own_energy.png") as axes:
        for step, curve in enumerate(curves):
            x, y, _ = arc(step / steps) if step else (s, 0 * s, None)
            axes.plot(x, y, color="black", linewidth=0.8, label="" if step else "closed form")
            label = "" if step else "nodes of the elements"
            axes.plot(curve[:, 0], curve[:, 1], "o", color=COLOURS[0], markersize=3.5, label=label)
        axes.set(xlabel="x / L", ylabel="y / L", title="A strip that stiffens", aspect="equal")

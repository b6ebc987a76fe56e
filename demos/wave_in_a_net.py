"""A wave in a net, by explicit steps: no equations are solved, for each knot moves by itself.

A square net under tension is hit in its middle. The wave goes out along the cables, with the speed
of waves on strings, and comes back from the pinned edges. Steps may be as large as a wave along the
cables takes from knot to knot; fem_lie.Explicit computes that size, and refuses larger ones.

--courant is the step over the largest stable one. ns_per_element_step has the seconds of the
processor without those that the run takes to begin: those of two runs are compared.
"""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
from command_line import in_results, run
from matplotlib.figure import Figure

import fem_lie as fl

STRETCH, BLOW = 1.05, 2.0
CABLE = fl.Section.from_stiffness([100.0] * 3 + [1e-6] * 3, mass=0.01)


def square_net(cells: int) -> tuple[fl.Scene, fl.Net]:
    """A net of side 1 m with pinned edges, stretched, and hit in the middle."""
    x = np.linspace(0, 1, cells + 1)
    positions = np.array([(a, b, 0) for a in x for b in x])
    grid = np.arange(len(positions)).reshape(cells + 1, cells + 1)
    cables = [list(row) for row in grid] + [list(column) for column in grid.T]
    scene = fl.Scene()
    net = scene.add(fl.Net(positions, cables, CABLE, stretch=STRETCH))
    edge = np.unique([*grid[[0, -1]].ravel(), *grid[:, [0, -1]].ravel()])
    net.pin(*(net.point(int(k)) for k in edge))
    far = ((positions[:, :2] - 0.5) ** 2).sum(axis=1)
    blow = BLOW * np.exp(-far / 0.1**2)
    # along the axes of the knots
    net.velocities[:, :3] = blow[:, np.newaxis] * net.frames[:, 1:, 2]
    net.velocities[edge] = 0.0
    return scene, net


def main(
    cells: int = 40,
    steps: int = 800,
    courant: float = 0.9,
    pictures: bool = True,
) -> dict[str, Any]:
    scheme, (scene, net) = fl.Explicit(), square_net(cells)
    limit = scheme.stable_step(scene)
    step = courant * limit

    def timed(count: int, every: int) -> tuple[fl.Result, float]:
        start = process_time()
        result = scheme.run(scene, duration=count * step, step=step, save_every=every)
        return result, process_time() - start

    timed(1, 1)
    _, begun = timed(1, 1)
    # all that is kept takes time of its own
    _, seconds = timed(steps + 1, steps + 1)
    result, _ = timed(steps, max(1, steps // 50))
    elements, energy = len(net.model.elements), result.total_energy
    third = len(energy) // 3
    early, late = energy[:third].mean(), energy[-third:].mean()
    record: dict[str, Any] = {
        "elements": elements,
        "steps": steps,
        "stable_step": limit,
        "courant": courant,
        "energy_error": float(np.abs(energy / energy[0] - 1.0).max()),
        "energy_drift": float(abs(late / early - 1.0)),
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
        "highest": float(np.abs(result.frames[:, :, 0, 2]).max()),
        "ns_per_element_step": 1e9 * (seconds - begun) / (steps * elements),
    }
    if pictures:
        draw(result, result.info.body(net.name).nodes, cells)
    return record


def draw(result: fl.Result, nodes: np.ndarray, cells: int) -> None:
    """The height of the net at six times."""
    figure = Figure(figsize=(9.0, 6.0), dpi=150, layout="constrained")
    axes = figure.subplots(2, 3).ravel()
    rows = np.linspace(1, len(result.times) - 1, 6).astype(int)
    heights = result.frames[rows][:, nodes, 0, 2].reshape(6, cells + 1, cells + 1)
    most = float(np.abs(heights).max())
    for ax, row, height in zip(axes, rows, heights, strict=True):
        image = ax.imshow(height.T, origin="lower", cmap="RdBu", vmin=-most, vmax=most)
        ax.set(title=f"t = {1e3 * result.times[row]:.1f} ms", xticks=[], yticks=[])
    figure.colorbar(image, ax=axes.tolist(), label="height, m", shrink=0.7)
    figure.savefig(in_results("wave_in_a_net.png"))


if __name__ == "__main__":
    run(main, show=True)

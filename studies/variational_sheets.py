"""Variational steps of a cable, a membrane, a thin shell and a shell that tumble, 10⁵ of each.

The bodies are thrown and spin freely, so that momentum and angular momentum are constant, and are
soft, so that they stretch and bend as they go. A variational scheme keeps both momenta to
round-off; its energy swings with the step and does not drift: the mean over the last tenth of the
run is compared with that over the first one, over the kinetic energy.
"""

from __future__ import annotations

from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np

import fem_lie as fl

RUBBER = fl.Material(E=1e6, nu=0.3, density=1000.0)
LAYER = fl.ShellSection.layer(1e-2, RUBBER)
STEP = 1e-3


def flat(a: float, b: float) -> np.ndarray:
    """A unit square."""
    return np.array([a, b, 0.0])


BODIES: dict[str, Callable[[], Any]] = {
    "cable": lambda: fl.Cable(
        fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4),
        fl.Section.circle(0.02, RUBBER),
        formulation=fl.elements.DiscreteCable(),
    ),
    "membrane": lambda: fl.Membrane(fl.mesh.parametric_surface(flat, (2, 2)), LAYER),
    "membrane that wrinkles": lambda: fl.Membrane(
        fl.mesh.parametric_surface(flat, (2, 2)),
        LAYER,
        formulation=fl.elements.TensionField(1e-2),
    ),
    "thin shell": lambda: fl.ThinShell(fl.mesh.smooth_patch(flat, (1, 1)), LAYER),
    "shell": lambda: fl.Shell(fl.mesh.parametric_surface(flat, (2, 2)), LAYER),
}


def main(steps: int = 100_000, bodies: tuple[str, ...] = tuple(BODIES)) -> dict[str, Any]:
    """Drift of momenta and energy of each body, and seconds per step."""
    record: dict[str, Any] = {}
    for name in bodies:
        body, scene = BODIES[name](), fl.Scene()
        scene.add(body)
        body.add_velocity((0.5, 0.2, 0.1), omega=(0.3, 0.4, 2.0), about=(0.5, 0.4, 0.0))
        start = process_time()
        options = {"duration": steps * STEP, "step": STEP, "save_every": 10, "progress": False}
        result = fl.schemes.Variational().run(scene, **options)
        seconds = process_time() - start
        energy, tenth = result.total_energy, max(1, len(result.times) // 10)
        kinetic = result.kinetic.max()
        drift = abs(energy[-tenth:].mean() - energy[1 : tenth + 1].mean()) / kinetic
        record[name] = {
            "momentum": _change(result.momentum),
            "angular_momentum": _change(result.angular_momentum),
            "swing": float(np.ptp(energy[1:]) / kinetic),
            "drift": float(drift),
            "milliseconds": 1e3 * seconds / steps,
        }
        print(f"{name:24}" + "  ".join(f"{k} {v:.2e}" for k, v in record[name].items()), flush=True)
    return record


def _change(values: np.ndarray) -> float:
    """Largest change over the size of the first value."""
    return float(np.abs(values - values[0]).max() / np.linalg.norm(values[0]))


if __name__ == "__main__":
    main()

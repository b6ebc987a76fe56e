"""A stiff pendulum in steps that do not resolve its vibrations: who gains energy, and who fails.

The double pendulum of double_pendulum.py, case 1: bars of aluminium whose waves are a hundred times
faster than their swinging. Without damping the motion has no force but those of the joints, and its
energy is constant. In steps of STEP the axial waves are not resolved.

The trapezoidal rule, which is generalised-alpha with the spectral radius 1, is stable for linear
problems. For nonlinear ones nothing bounds its energy: what the step does not resolve is fed by the
motion and grows until the iteration fails. Numerical damping (radius 0.8) helps, at the price of
energy. The energy-momentum scheme is not damped and cannot gain: the work of all forces in a step
is the change of an energy. The energy-decaying scheme damps the same waves, and loses only them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram
from double_pendulum import pendulum

import fem_lie as fl

SCHEMES = {
    "trapezoidal": fl.GeneralisedAlpha(radius=1.0),
    "generalised_alpha": fl.GeneralisedAlpha(radius=0.8),
    "energy_momentum": fl.EnergyMomentum(),
    "energy_decaying": fl.EnergyDecaying(radius=0.8),
}


def main(
    step: float = 2e-3, duration: float = 6.0, elements: int = 4, pictures: bool = True
) -> dict[str, Any]:
    record: dict[str, Any] = {"step": step, "duration": duration, "elements": elements}
    histories = {}
    for name, scheme in SCHEMES.items():
        scene, _, _ = pendulum(1, elements)
        try:
            result, failed = scheme.run(scene, duration=duration, step=step), False
        except fl.ConvergenceError as error:
            result, failed = error.result, True
        energy = result.total_energy / result.total_energy[0]
        histories[name] = result.times, energy
        record |= {
            f"{name}_failed": failed,
            f"{name}_until": float(result.times[-1]),
            f"{name}_energy_least": float(energy.min()),
            f"{name}_energy_largest": float(energy.max()),
            f"{name}_angular_momentum_error": result.angular_momentum_error,
            f"{name}_iterations_per_step": float(
                result.iterations[-1] / max(1, round(result.times[-1] / step))
            ),
        }
    if pictures:
        draw(histories)
    return record


def draw(histories: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """Leave a diagram of the energies."""
    with diagram("stiff_energy.png") as axes:
        for (name, (times, energy)), colour in zip(histories.items(), COLOURS, strict=False):
            axes.plot(times, energy - 1.0, lw=0.9, label=name.replace("_", "-"), color=colour)
        axes.set(xlabel="time [s]", ylabel="energy over that at the start, less 1")


if __name__ == "__main__":
    run(main, show=True)

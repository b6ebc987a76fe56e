"""A flexible plate tumbles in free flight: energy, momentum and angular momentum over long times.

A rectangular plate of rubber, 0.3 m x 0.2 m x 4 mm, is thrown with a spin about an axis that is
none of its principal axes, while its halves fold against each other. It bends by a good part of its
length as it flies. Nothing acts on it: energy, momentum and angular momentum must stay as they are.

fem_lie.EnergyMomentum does not know what a shell is. It takes the forces of every element at both
ends of a step, rotated to the midpoint with the element, takes out the net force and moment of
their mean, and adds the multiple of the element's own deformation with which their work is the
change of the stored energy. That works for displacement elements (MITC4), Hellinger-Reissner and
Hu-Washizu elements alike, on quadrilaterals and triangles, and for any law of the material.

--formulation displacement, hr, hw; --decaying RADIUS damps what the step does not resolve: the
energy then falls in every step, momenta stay.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

FORMULATIONS = {
    "displacement": fl.elements.DisplacementBased(),
    "hr": fl.elements.HellingerReissner(),
    "hw": fl.elements.HuWashizu(),
}


def thrown(formulation: str, along: int, across: int) -> tuple[fl.Scene, fl.Shell]:
    """The scene and the plate."""
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([0.3 * a, 0.2 * b, 0.0]), (along, across)
    )
    rubber = fl.Material(E=2e7, nu=0.45, density=1100.0)
    scene = fl.Scene()
    plate = scene.add(
        fl.Shell(
            mesh,
            fl.ShellSection.layer(4e-3, rubber),
            formulation=FORMULATIONS[formulation],
            name="plate",
        )
    )
    plate.add_velocity(omega=(4.0, 9.0, 3.0), about=(0.15, 0.1, 0.0))
    plate.add_velocity((0.4, 0.2, 1.0))
    # the halves fold
    plate.velocities[:, 2] += 6.0 * (np.abs(plate.frames[:, 0, 0] - 0.15) - 0.075)
    return scene, plate


def main(
    formulation: str = "hr",
    along: int = 6,
    across: int = 4,
    steps: int = 10_000,
    step: float = 1e-3,
    save_every: int = 0,
    decaying: float | None = None,
    pictures: bool = True,
) -> dict[str, Any]:
    if formulation not in FORMULATIONS:
        known = ", ".join(FORMULATIONS)
        raise ValueError(f"formulation must be one of {known}, got {formulation!r}")
    scheme = fl.EnergyMomentum() if decaying is None else fl.EnergyDecaying(radius=decaying)
    scene, plate = thrown(formulation, along, across)
    every = save_every or max(1, steps // 1000)
    result = scheme.run(scene, duration=steps * step, step=step, save_every=every)
    x = result.frames[:, :, 0]
    corners = [plate.point(name) for name in ("00", "10", "11", "01")]
    a, b, c, d = (result.position(corner) for corner in corners)
    fold = np.linalg.norm(a + c - b - d, axis=1).max() / 0.3
    record: dict[str, Any] = {
        "formulation": formulation,
        "cells": along * across,
        "steps": steps,
        "step": step,
        "energy_error": result.energy_error,
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
        "largest_energy_gain": float(np.diff(result.total_energy).max() / result.total_energy[0]),
        "elastic_share": float((result.elastic / result.total_energy[0]).max()),
        "twist": float(fold),
        "size": float(np.ptp(x[-1], axis=0).max()),
        "iterations_per_step": float(result.iterations[-1] / steps),
        "factorisations": result.factorisations,
        "seconds": result.seconds,
        "ms_per_step": 1e3 * result.seconds / steps,
    }
    if pictures:
        draw(result)
    return record


def draw(result: fl.Result) -> None:
    """Leave pictures of the flight, the energies and the momenta."""
    name = in_results("tumbling_plate")
    times = np.linspace(0.0, min(0.5, float(result.times[-1])), 6)
    result.picture(f"{name}.png", times=times, title="A tumbling plate")
    result.plot_energies(f"{name}_energies.png")
    result.plot_momentum(f"{name}_momenta.png")


if __name__ == "__main__":
    run(main, show=True)

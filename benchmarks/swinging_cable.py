"""Cables that swing, whirl, are taut and go slack, against those of Exudyn.

Published motions of such cables are curves on paper; here are numbers of an independent program,
whose cable is that of J. Gerstmayr & H. Irschik, J. Sound Vib. 318 (2008) 461, integrated with five
and three of Gauss' points. Cables of 2 m, 1 kg/m and EA = 1e4 N under gravity:

- swinging: hinged at one end, from rest in the horizontal, EI = 1; length, mass and stiffnesses
  are those of Exudyn's example finiteSegmentMethod.py
- whirling: hinged, EI = 0.1, from the horizontal with 6 rad/s about the vertical
- taut: between two points, stretched by 1 %, EI = 0.01, hit along a half wave with 5 m/s
- slack: between two points along an arch, EI = 0.1, that falls down and is caught

The error is the largest distance of any ninth of it at any time from where Exudyn has it with 64
elements, over the length; beside it is how far that moves from 32 to 64 elements. Both by
generalised-alpha with the same step.

    python -m benchmarks.swinging_cable [--step 2.5e-4] [--scene NAME]
"""

from __future__ import annotations

import argparse
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl
from benchmarks.peer_scenes.environment import interpreters
from fem_lie.mesh.curves import curve

LENGTH, STRETCH, RADIUS = 2.0, 1e4, 0.9
GRAVITY = (0.0, 0.0, -9.81)
PARTS = 8
PEER = Path(__file__).parent / "peer_scenes" / "exudyn_cables.py"
ELEMENTS = {"cable": fl.elements.HermiteCable(), "discrete": fl.elements.DiscreteCable()}


def laid(
    line: Callable[[float], Any], cells: int, EI: float, element: str, stretch: float = 1.0
) -> fl.Cable:
    """Along a line, so many times as long as it is unstretched."""
    own = fl.Section.from_stiffness([STRETCH] * 3 + [EI] * 3, mass=1.0)
    mesh = curve(line, cells)
    plain = fl.Cable(mesh, own, formulation=ELEMENTS[element])
    return fl.Cable(
        mesh, own, length=plain.model.lengths.sum() / stretch, formulation=ELEMENTS[element]
    )


def hinged(cells: int, element: str, EI: float, spin: float) -> fl.Cable:
    cable = laid(lambda s: (LENGTH * s, 0, 0), cells, EI, element)
    cable.pin(cable.point("start"))
    cable.add_velocity(omega=(0, 0, spin), about=(0.0, 0, 0))
    return cable


def taut(cells: int, element: str) -> fl.Cable:
    cable = laid(lambda s: (LENGTH * s, 0, 0), cells, 1e-2, element, stretch=1.01)
    wave, speed = np.pi / LENGTH, 5.0
    x = cable.frames[:, 0, 0]
    rates = np.zeros((len(x), 2, 3))
    rates[:, 0, 2] = speed * np.sin(wave * x)
    rates[:, 1, 2] = speed * 1.01 * wave * np.cos(wave * x)
    axes = own_axes(cable)
    cable.velocities[:, :3] = np.einsum("nij,nj->ni", axes, rates[:, 0])
    if element == "cable":
        cable.velocities[:, 3:] = np.einsum("nij,nj->ni", axes, rates[:, 1])
    cable.velocities[[0, -1], :3] = 0.0
    cable.pin(cable.point("start"), cable.point("end"))
    return cable


def slack(cells: int, element: str) -> fl.Cable:
    cable = laid(lambda s: (LENGTH * s, 0, 1.2 * s * (1 - s)), cells, 0.1, element)
    cable.pin(cable.point("start"), cable.point("end"))
    return cable


SCENES: dict[str, tuple[Callable[[int, str], fl.Cable], float]] = {
    "swinging": (lambda cells, element: hinged(cells, element, 1.0, 0.0), 2.0),
    "whirling": (lambda cells, element: hinged(cells, element, 0.1, 6.0), 1.0),
    "taut": (taut, 1.0),
    "slack": (slack, 0.8),
}
"""Each with its duration."""


def own_axes(cable: fl.Cable) -> np.ndarray:
    """Of the nodes, as rows, shape (n, 3, 3)."""
    axes = cable.frames[:, 1:].copy()
    axes[:, 0] /= np.linalg.norm(axes[:, 0], axis=1, keepdims=True)
    return axes


def positions(cable: fl.Cable, times: np.ndarray, step: float) -> np.ndarray:
    """Of ends of equal parts at these times, shape (times, parts + 1, 3)."""
    scene = fl.Scene(gravity=GRAVITY)
    scene.add(cable)
    scheme = fl.GeneralisedAlpha(radius=RADIUS)
    result = scheme.run(scene, duration=float(times[-1]), step=step)
    rows = np.rint(times / step).astype(int)
    return result.frames[rows][:, :: len(cable.model.lengths) // PARTS, 0]


def of_peer(python: Path, cable: fl.Cable, times: np.ndarray, step: float) -> np.ndarray:
    """The same of Exudyn."""
    axes, count = own_axes(cable), len(cable.frames)
    rates = np.einsum("nij,nki->nkj", axes, cable.velocities.reshape(count, 2, 3))
    request = {
        "rows": cable.frames[:, :2].reshape(count, 6).tolist(),
        "rates": rates.reshape(count, 6).tolist(),
        "lengths": cable.model.lengths.tolist(),
        "EA": STRETCH,
        "EI": float(cable.model.stiffness[0, 4, 4]),
        "mass": 1.0,
        "gravity": GRAVITY,
        "pinned": np.flatnonzero(cable.model.held[:, 0]).tolist(),
        "asked": list(range(0, count, len(cable.model.lengths) // PARTS)),
        "times": times.tolist(),
        "step": step,
        "radius": RADIUS,
    }
    answer = subprocess.run(
        [python, PEER], input=json.dumps(request), capture_output=True, text=True, check=True
    )
    return np.array(json.loads(answer.stdout.splitlines()[-1]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--step", type=float, default=2.5e-4)
    parser.add_argument("--scene", choices=[*SCENES, "all"], default="all")
    options = parser.parse_args()
    python = interpreters("exudyn")["exudyn"]
    print("scene      element   elements 8       16       32       64   Exudyn, 32 to 64")
    for name in SCENES if options.scene == "all" else [options.scene]:
        make, duration = SCENES[name]
        times = np.linspace(0.05, duration, round(duration / 0.05))
        coarse, exact = (of_peer(python, make(n, "cable"), times, options.step) for n in (32, 64))
        own = float(np.linalg.norm(coarse - exact, axis=-1).max()) / LENGTH
        for element in ELEMENTS:
            errors = [
                np.linalg.norm(positions(make(n, element), times, options.step) - exact, axis=-1)
                for n in (8, 16, 32, 64)
            ]
            table = "".join(f"{error.max() / LENGTH:9.1e}" for error in errors)
            print(f"{name:10} {element:10}     {table}  {own:15.1e}", flush=True)


if __name__ == "__main__":
    main()

"""A cantilever and a frame under harmonic loads, and a cantilever on a shaker.

The members are shear-rigid with Kelvin-Voigt damping, so that each vibrates as an Euler-Bernoulli
beam with complex stiffness EI (1 + i w tau). The references are exact: the dynamic stiffness of a
member has the solutions cos, sin, cosh and sinh, and members are joined by adding stiffness. The
first sweep factorises the equations at each frequency, the second one solves them in the span of
the slowest modes.

The same cantilever is then run in time until its start is forgotten: under the load, and on a
support whose motion is prescribed. Amplitude and phase of its tip are those of the sweep.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from reference.harmonic_frames import loaded, shaken

import fem_lie as fl

EA, EI, MASS, TAU = SECTION = 1e4, 1.0, 1.0, 5e-3
SLOW, TINY, OMEGA, WAYS = 2.0, 1e-6, np.linspace(0.5, 70.0, 60), ("load", "base")
POINTS = {"cantilever": [(0, 0), (1, 0)], "frame": [(0, 0), (0, 1), (0.8, 1)]}
UP, PERIOD = np.array([0.0, 0.0, 1.0]), 2 * np.pi / SLOW


def structure(name: str, cells: int, tau: float) -> tuple[fl.Scene, fl.Rod]:
    """Rods in the plane of x and z."""
    section = fl.Section.from_stiffness([EA, EA, EA, EI, EI, EI], mass=MASS)
    line = fl.mesh.polyline([(x, 0.0, z) for x, z in POINTS[name]], cells)
    damping, scene = fl.sections.Damping(stiffness=tau), fl.Scene()
    return scene, scene.add(fl.Rod(line, section, damping=damping, name="rod"))


def sweep(name: str, cells: int, pictures: bool) -> dict[str, float]:
    """Errors of the displacement of the end, over the largest amplitude."""
    scene, rod = structure(name, cells, TAU)
    scene.add(fl.Clamp(rod.point("start")))
    load, exact = fl.PointLoad(rod.point("end"), UP), loaded(POINTS[name], OMEGA, *SECTION)
    runs, errors = {"direct": (load, None, exact), "modal": (load, 14, exact)}, {}
    if name == "cantilever":
        runs["base_excitation"] = fl.post.BaseExcitation(UP), None, shaken(OMEGA, *SECTION[1:])
    for way, (excitation, modes, expected) in runs.items():
        found = fl.post.frequency_response(scene, excitation, OMEGA, modes=modes)
        gap = found.displacement("rod.end")[:, 2] - expected
        errors[way] = float(np.abs(gap).max() / np.abs(expected).max())
        if pictures and way == "direct":
            found.picture("rod.end", in_results(f"frequency_response_{name}.png"))
    return errors


def in_time(excitation: str, steps: int, periods: int = 8) -> float:
    """Error of the last period of a motion, compared with the response at its frequency."""
    (scene, rod), (still, held) = (structure("cantilever", 4, 0.1) for _ in range(2))
    still.add(fl.Clamp(held.point("start")))
    rise, foot = np.outer([TINY / SLOW**2, 0, 0, 0], UP), rod.point("start").frame
    if excitation == "base":
        unit = fl.post.BaseExcitation(UP)
        moved = fl.PrescribedMotion(rod.point(0), lambda t: foot + (1 - np.cos(SLOW * t)) * rise)
    else:
        unit, moved = fl.PointLoad(held.point("end"), UP), fl.Clamp(rod.point("start"))
        scene.add(fl.PointLoad(rod.point("end"), TINY * UP, history=lambda t: np.cos(SLOW * t)))
    scene.add(moved)
    motion = fl.GeneralisedAlpha().run(scene, duration=periods * PERIOD, step=PERIOD / steps)
    z = (motion.position("rod.end") - motion.position("rod.start"))[-steps:, 2]
    amplitude = 2 * np.mean(z * np.exp(-1j * SLOW * motion.times[-steps:]))
    expected = fl.post.frequency_response(still, unit, [SLOW]).displacement("rod.end")[0, 2]
    return float(abs(amplitude / (TINY * expected) - 1))


def main(cells: int = 24, steps: int = 200, pictures: bool = True) -> dict[str, Any]:
    errors = {name: sweep(name, cells, pictures) for name in POINTS}
    return {"errors": errors, "errors_in_time": {way: in_time(way, steps) for way in WAYS}}


if __name__ == "__main__":
    run(main, show=True)

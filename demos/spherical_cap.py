"""A shallow clamped spherical cap under pressure: it snaps at a part of what a sphere would bear.

A cap of rise H, radius of its rim a and thickness t is described by one number,

    s = 2 (3 (1 - nu^2))^(1/4) sqrt(H/t),

and its pressure is compared with that at which a whole sphere of radius R = a^2/(2 H) buckles,
p = 2 E t^2/(R^2 sqrt(3 (1 - nu^2))). Below s = 3.3 it does not snap; up to about 5.5 it snaps
without losing its symmetry, and beyond that it buckles into waves around its axis first (N. C.
Huang, J. Appl. Mech. 31 (1964) 447).

The reference is the theory of E. Reissner for shallow axisymmetric shells, with the slope b and
n = r N_r as unknowns and z' = -2 H r/a^2,

    D (b'' + b'/r - b/r^2) = n (z' + b)/r - p r/2,
    r n'' + n' - n/r = -E t (z' b + b^2/2),     b = 0 and a n' = nu n at the rim,

solved by collocation at given deflections of the centre; the largest pressure is the snap. The
shell knows nothing of that: a quarter in cells, a load, one call of `fl.follow_path`. The load is
vertical and fixed in space, which is pressure as far as the cap is shallow, here H/a = 0.05.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

import fem_lie as fl
from fem_lie.plot import Units

RESULTS = Path(__file__).parents[1] / "results"
RISE, RIM = 0.05, 1.0
MATERIAL = fl.Material(1.0, 0.3, 1.0)
SHELL = np.sqrt(3 * (1 - MATERIAL.nu**2))
RADIUS = (RIM**2 + RISE**2) / (2 * RISE)
UNITS = Units(length="a")


def thickness_of(number: float) -> float:
    """That of the cap with this s."""
    return float(RISE * 4 * SHELL / number**2)


def classical(thickness: float) -> float:
    """Pressure at which the whole sphere buckles."""
    return float(2 * MATERIAL.E * thickness**2 / (RADIUS**2 * SHELL))


def reissner(thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Deflections of the centre over t, and pressures over the classical one."""
    E, nu, p_c = MATERIAL.E, MATERIAL.nu, classical(thickness)
    D = E * thickness**3 / (12 * (1 - nu**2))
    r = np.linspace(1e-4 * RIM, RIM, 60)

    def rates(r: np.ndarray, y: np.ndarray, q: np.ndarray) -> np.ndarray:
        b, db, n, dn, _ = y
        slope = -2 * RISE * r / RIM**2
        bend = (n * (slope + b) / r - q[0] * p_c * r / 2) / D
        stretch = -E * thickness * (slope * b + b * b / 2) / r
        return np.array([db, bend - db / r + b / r**2, dn, stretch - dn / r + n / r**2, b])

    guess, q = np.zeros((5, len(r))), np.array([0.01])
    deflections = np.linspace(0.05, 3.0, 60) * thickness
    pressures = []
    for w in deflections:

        def rim(a: np.ndarray, b: np.ndarray, q: np.ndarray, w: float = w) -> np.ndarray:
            return np.array([a[0], a[2], a[4] + w, b[0], RIM * b[3] - nu * b[2], b[4]])

        found = solve_bvp(rates, rim, r, guess, p=q, tol=1e-5, max_nodes=20000)
        if not found.success:
            break
        guess, q = found.sol(r), found.p
        pressures.append(float(q[0]))
    return deflections[: len(pressures)] / thickness, np.array(pressures)


def place(a: float, b: float) -> np.ndarray:
    """A quarter of the cap from a square; its rim is a = 1 and b = 1."""
    x, y = RIM * a * np.sqrt(1 - b * b / 2), RIM * b * np.sqrt(1 - a * a / 2)
    return np.array([x, y, np.sqrt(RADIUS**2 - x * x - y * y) - RADIUS + RISE])


def cap(thickness: float, mesh: int) -> tuple[fl.Scene, fl.Point]:
    """A quarter of the cap under the classical pressure, and its top."""
    shell = fl.Shell(
        fl.surface(place, (mesh, mesh)),
        fl.ShellSection.layer(thickness, MATERIAL),
        director=lambda x: (x - [0.0, 0.0, RISE - RADIUS]) / RADIUS,
        name="cap",
    )
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    shell.clamp("a=1")
    shell.clamp("b=1")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, force=(0, 0, -classical(thickness))))
    return scene, shell["00"]


def main(number: float = 5.0, mesh: int = 16, pictures: bool = True) -> dict[str, Any]:
    """``number``: s."""
    if not 3.3 < number < 5.5:
        raise ValueError(f"number must be 3.3 … 5.5, for a cap that snaps in symmetry: {number}")
    thickness = thickness_of(number)
    deflections, pressures = reissner(thickness)
    exact = float(pressures[: int(np.argmax(np.diff(pressures) < 0)) + 1].max())
    scene, top = cap(thickness, mesh)
    path = fl.follow_path(
        scene, observe={"w": lambda state: -state.displacement(top)[2] / thickness}
    )
    snap = path.limits[0]
    record = {
        "number": number,
        "mesh": mesh,
        "slenderness": RADIUS / thickness,
        "snap": snap.factor,
        "reference": exact,
        "error": snap.factor / exact - 1.0,
        "negative_pivots": [point.negative_pivots for point in path.critical],
        "load_steps": int((path.iterations > 0).sum()) - 1,
        "rejected_steps": path.failed_steps,
        "iterations": path.total_iterations,
        "seconds": path.seconds,
    }
    for point in path.critical:
        print(f"w/t = {path.observed['w'][point.index]:.3f}: {point}")
    print("it snaps at {snap:.4f} of the classical pressure".format(**record))
    print("Reissner:   {reference:.4f}, deviation {error:+.2%}".format(**record))
    print(
        "{iterations} linear solutions in {load_steps} steps, {rejected_steps} rejected, "
        "{seconds:.2f} s".format(**record)
    )
    if pictures:
        RESULTS.mkdir(exist_ok=True)
        diagram = RESULTS / "spherical_cap.png"
        path.plot_path(
            "w",
            diagram,
            label="deflection of the top over t",
            load_label="pressure over that of a sphere",
            reference=(deflections, pressures, "Reissner's equations"),
            units=UNITS,
        )
        print(f"picture: {diagram}")
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)

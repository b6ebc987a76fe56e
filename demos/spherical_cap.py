"""A shallow clamped spherical cap under pressure: it snaps at a part of what a sphere would bear.

A cap of rise H, radius of its rim a and thickness t is described by one number,

    s = 2 (3 (1 - nu^2))^(1/4) sqrt(H/t),

and its pressure is compared with that at which a whole sphere of radius R = a^2/(2 H) buckles,
p = 2 E t^2/(R^2 sqrt(3 (1 - nu^2))). Below s = 3.3 it does not snap; up to about 5.5 it snaps
without losing its symmetry, and beyond that it buckles into waves around its axis first (N. C.
Huang, J. Appl. Mech. 31 (1964) 447).

Two references, both solved by collocation at given deflections of the centre; the largest pressure
is the snap.

- The theory of E. Reissner for shallow axisymmetric shells, which the published values are of, with
  the slope b and n = r N_r as unknowns and z' = -2 H r/a^2,

      D (b'' + b'/r - b/r^2) = n (z' + b)/r - p r/2,
      r n'' + n' - n/r = -E t (z' b + b^2/2),     b = 0 and a n' = nu n at the rim.

- The same without the word shallow: finite rotations, shear, and a pressure that stays normal to
  the surface and acts on its present area. On the unloaded meridian with arc length s and radius
  r0 the state is (r, z, f, A, B, m): place, angle of the director, r0 times the horizontal and the
  vertical force and the bending moment,

      r' = (1 + e) cos f - g sin f,   z' = (1 + e) sin f + g cos f,   f' = f0' + k,
      A' = N_t - p r z',   B' = p r r',   m' = M_t cos f - r0 ((1 + e) Q - g N),

  where N, Q and e, k, g are force, shear force and strains along the meridian and N_t, M_t those
  around. This is what the shell solves, but for the cells.

The shell knows nothing of that: a quarter in cells, a `fl.SurfacePressure`, which follows it, one
call of `fl.follow_path`.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

import fem_lie as fl
from fem_lie.pictures.units import Units

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

    def ends(w: float) -> Callable[..., np.ndarray]:
        return lambda a, b, q: np.array([a[0], a[2], a[4] + w, b[0], RIM * b[3] - nu * b[2], b[4]])

    return pressures_at(r, np.zeros((5, len(r))), rates, ends, thickness)


def pressures_at(
    x: np.ndarray,
    guess: np.ndarray,
    rates: Callable[..., np.ndarray],
    ends: Callable[[float], Callable[..., np.ndarray]],
    thickness: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Solutions at growing deflections of the centre, each from the last one."""
    deflections, pressures, q = np.linspace(0.05, 3.0, 60) * thickness, [], np.array([0.01])
    for w in deflections:
        found = solve_bvp(rates, ends(w), x, guess, p=q, tol=1e-6, max_nodes=20000)
        if not found.success:
            break
        guess, q = found.sol(x), found.p
        pressures.append(float(q[0]))
    return deflections[: len(pressures)] / thickness, np.array(pressures)


def largest(deflections: np.ndarray, pressures: np.ndarray) -> float:
    """The first maximum, of the polynomial through the five values around it."""
    k = int(np.argmax(np.diff(pressures) < 0))
    x, p = deflections[k - 2 : k + 3] - deflections[k], pressures[k - 2 : k + 3]
    return float(np.polyval(np.polyfit(x, p, 4), np.linspace(x[1], x[3], 1001)).max())


def exact(thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """As :func:`reissner`, with finite rotations and a pressure that follows."""
    E, nu, p_c = MATERIAL.E, MATERIAL.nu, classical(thickness)
    C, G = E * thickness / (1 - nu**2), 5 / 6 * MATERIAL.G * thickness
    D = C * thickness**2 / 12
    s = np.linspace(1e-4, np.arcsin(RIM / RADIUS), 60) * RADIUS
    s[0] = 1e-4 * RIM

    def strains(s: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
        """``r0``, strain, bending and shear along the meridian, stretch and bending around."""
        r, _, f, A, B, m = y
        r0, slope = RADIUS * np.sin(s / RADIUS), -s / RADIUS
        around, bent = r / r0 - 1, (np.sin(f) - np.sin(slope)) / r0
        along = (A * np.cos(f) + B * np.sin(f)) / (r0 * C) - nu * around
        shear = (B * np.cos(f) - A * np.sin(f)) / (r0 * G)
        return r0, along, m / (r0 * D) - nu * bent, shear, around, bent

    def rates(s: np.ndarray, y: np.ndarray, q: np.ndarray) -> np.ndarray:
        r, f = y[0], y[2]
        r0, e, k, g, around, bent = strains(s, y)
        dr = (1 + e) * np.cos(f) - g * np.sin(f)
        dz = (1 + e) * np.sin(f) + g * np.cos(f)
        N, N_t = C * (e + nu * around), C * (around + nu * e)
        dm = D * (bent + nu * k) * np.cos(f) - r0 * ((1 + e) * G * g - g * N)
        p = q[0] * p_c
        return np.array([dr, dz, k - 1 / RADIUS, N_t - p * r * dz, p * r * dr, dm])

    def ends(w: float) -> Callable[..., np.ndarray]:
        def conditions(a: np.ndarray, b: np.ndarray, q: np.ndarray) -> np.ndarray:
            r0, e, k, _, around, bent = strains(s[0], a)
            top = [e - around, k - bent, a[4] / C - q[0] * p_c * r0**2 / (2 * C), a[1] - RISE + w]
            return np.array([*top, b[0] - RIM, b[1], b[2] + s[-1] / RADIUS])

        return conditions

    r, z = RADIUS * np.sin(s / RADIUS), RADIUS * (np.cos(s / RADIUS) - 1) + RISE
    guess = np.vstack([r, z, -s / RADIUS, np.zeros((3, len(s)))])
    return pressures_at(s, guess, rates, ends, thickness)


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
    # a positive one pushes to the side of the directors
    scene.add(fl.SurfacePressure(shell, -classical(thickness)))
    return scene, shell["00"]


def main(number: float = 5.0, mesh: int = 16, pictures: bool = True) -> dict[str, Any]:
    """``number``: s."""
    if not 3.3 < number < 5.5:
        raise ValueError(f"number must be 3.3 … 5.5, for a cap that snaps in symmetry: {number}")
    thickness = thickness_of(number)
    deflections, pressures = exact(thickness)
    reference, shallow = largest(deflections, pressures), largest(*reissner(thickness))
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
        "reference": reference,
        "error": snap.factor / reference - 1.0,
        "shallow": shallow,
        "shallow_error": snap.factor / shallow - 1.0,
        "negative_pivots": [point.negative_pivots for point in path.critical],
        "load_steps": int((path.iterations > 0).sum()) - 1,
        "rejected_steps": path.failed_steps,
        "iterations": path.total_iterations,
        "seconds": path.seconds,
    }
    for point in path.critical:
        print(f"w/t = {path.observed['w'][point.index]:.3f}: {point}")
    print("it snaps at {snap:.4f} of the classical pressure".format(**record))
    print("meridian:   {reference:.4f}, deviation {error:+.2%}".format(**record))
    print("if shallow: {shallow:.4f}, deviation {shallow_error:+.2%}".format(**record))
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
            load=(1.0, "pressure over that of a sphere"),
            reference=(deflections, pressures, "equations of the meridian"),
            units=UNITS,
        )
        print(f"picture: {diagram}")
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)

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
  r0 the state is (r, z, f, A, B, m): point, angle of the director, r0 times the horizontal and the
  vertical force and the bending moment,

      r' = (1 + e) cos f - g sin f,   z' = (1 + e) sin f + g cos f,   f' = f0' + k,
      A' = N_t - p r z',   B' = p r r',   m' = M_t cos f - r0 ((1 + e) Q - g N),

  where N, Q and e, k, g are force, shear force and strains along the meridian and N_t, M_t those
  around. This is what the shell solves, but for the cells.

The shell knows nothing of that: a quarter in cells, a `fl.loads.SurfacePressure`, which follows it,
one call of `fl.follow_path`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from records import of_path
from reference.spherical_cap import (
    MATERIAL,
    RADIUS,
    RIM,
    RISE,
    classical,
    exact,
    largest,
    reissner,
    thickness_of,
)

import fem_lie as fl

UNITS = fl.post.Units(length="a")


def position(a: float, b: float) -> np.ndarray:
    """A quarter of the cap from a square; its rim is a = 1 and b = 1."""
    x, y = RIM * a * np.sqrt(1 - b * b / 2), RIM * b * np.sqrt(1 - a * a / 2)
    return np.array([x, y, np.sqrt(RADIUS**2 - x * x - y * y) - RADIUS + RISE])


def cap(thickness: float, mesh: int) -> tuple[fl.Scene, fl.extend.Point]:
    """A quarter of the cap under the classical pressure, and its top."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (mesh, mesh)),
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
    scene.add(fl.loads.SurfacePressure(shell, -classical(thickness)))
    return scene, shell.point("00")


def main(number: float = 5.0, mesh: int = 16, pictures: bool = True) -> dict[str, Any]:
    """``number``: s."""
    if not 3.3 < number < 5.5:
        raise ValueError(f"number must be 3.3 … 5.5, for a cap that snaps in symmetry: {number}")
    thickness = thickness_of(number)
    deflections, pressures = exact(thickness)
    reference, shallow = largest(deflections, pressures), largest(*reissner(thickness))
    scene, top = cap(thickness, mesh)
    observe = {"w": lambda state: -state.displacement(top)[2] / thickness}
    path = fl.follow_path(scene, observe=observe)
    snap = path.limits[0].factor
    if pictures:
        path.plot_path(
            "w",
            in_results("spherical_cap.png"),
            label="deflection of the top over t",
            load=(1.0, "pressure over that of a sphere"),
            reference=(deflections, pressures, "equations of the meridian"),
            units=UNITS,
        )
    return {
        "number": number,
        "mesh": mesh,
        "slenderness": RADIUS / thickness,
        "snap": snap,
        "reference": reference,
        "error": snap / reference - 1.0,
        "shallow": shallow,
        "shallow_error": snap / shallow - 1.0,
        "negative_pivots": [point.negative_pivots for point in path.critical],
        **of_path(path),
    }


if __name__ == "__main__":
    run(main, show=True)

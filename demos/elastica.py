"""A cantilever under a shear force at its tip, up to two thirds of its length: Euler's elastica.

Length L, bending stiffness EI, no extension and no shear, and a force P fixed in space across the
unloaded axis. With alpha = P L^2/EI and the slope phi at the tip, p^2 = (1 + sin phi)/2 and
sin t = 1/(p sqrt 2), elliptic integrals give the whole path (K. E. Bisshopp & D. C. Drucker, Quart.
Appl. Math. 3 (1945) 272):

    sqrt(alpha) = K(p) - F(t, p)
    deflection  = L (1 - 2 (E(p) - E(t, p)) / sqrt(alpha))
    shortening  = L (1 - sqrt(2 sin phi / alpha))

The load goes to alpha = 4, as in the problem of K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal.
Des. 40 (2004) 1551, for shells: L = 10, EI = 100, P = 4. The stiffness ratio EA L^2/EI = 1e10
leaves less than 1e-9 of extension and shear; the element does not lock and needs no more iterations
for it (demos/rollup.py).

tip_x, tip_y, tip_z are the *displacement* of the tip: tip_x = -shortening, tip_z = deflection.
"""

from __future__ import annotations

from math import asin, log2, sqrt
from typing import Any

import numpy as np
from command_line import in_results, run
from diagrams import COLOURS, diagram
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

import fem_lie as fl

LENGTH, BENDING, FORCE = 10.0, 100.0, 4.0
UNITS = fl.post.Units(length="length")


def elastica(force: float) -> np.ndarray:
    """Displacement of the tip under ``force``, to about 1e-12 of the length."""
    alpha = force * LENGTH**2 / BENDING

    def rest(m: float) -> float:
        return float(ellipk(m) - ellipkinc(asin(1 / sqrt(2 * m)), m) - sqrt(alpha))

    m = brentq(rest, 0.5 + 1e-12, 1.0 - 1e-12, xtol=1e-15)  # m = p^2
    ends = ellipe(m) - ellipeinc(asin(1 / sqrt(2 * m)), m)
    shortening = LENGTH * (1 - sqrt(2 * (2 * m - 1) / alpha))
    return np.array([-shortening, 0.0, LENGTH * (1 - 2 * ends / sqrt(alpha))])


def solve(elements: int, load_steps: int, stiffness_ratio: float) -> tuple[Any, fl.StaticResult]:
    """Load it; displacements of the tip over the load factors, and the equilibrium states."""
    EA = stiffness_ratio * BENDING / LENGTH**2
    strip = [(-0.5, -0.05), (0.5, -0.05), (0.5, 0.05), (-0.5, 0.05)]  # for the picture only
    section = fl.Section.from_stiffness([EA, EA / 2, EA / 2, *[BENDING] * 3], outline=strip)
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=elements, name="strip")
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, FORCE)))
    result = fl.statics(scene, load_steps=load_steps)
    return result.position(beam.point("end")) - beam.point("end").position, result


def main(
    elements: int = 16, load_steps: int = 20, stiffness_ratio: float = 1e10, pictures: bool = True
) -> dict[str, Any]:
    errors = {}
    for count in sorted({4, 8, 16, 32, elements}):
        tip, result = solve(count, load_steps, stiffness_ratio)
        exact = np.array([elastica(FORCE * factor) for factor in result.factors])
        gaps = np.linalg.norm(tip - exact, axis=1) / np.linalg.norm(exact[-1])
        errors[count], iterations = float(gaps[-1]), int(result.iterations[-1])
        if count == elements:
            path, chosen, shown = tip, result, exact
            record = {
                "elements": elements,
                "load_steps": load_steps,
                "stiffness_ratio": stiffness_ratio,
                **{f"tip_{axis}": float(u) for axis, u in zip("xyz", tip[-1], strict=True)},
                "tip_error": errors[count],
                "path_error": float(gaps.max()),
                "iterations": iterations + result.failed_iterations,
            }
    record["order"] = log2(errors[8] / errors[32]) / 2
    if pictures:
        bent = in_results("elastica.png")
        chosen.picture(bent, trace=["strip.end"], title="Cantilever, shear at the tip", units=UNITS)
        plot_path(chosen.factors, path, shown)
    return record


def plot_path(factors: np.ndarray, tip: np.ndarray, exact: np.ndarray) -> None:
    """Displacements over the load, computed and exact."""
    force = FORCE * factors
    with diagram("elastica_path.png") as axes:
        for k, (sign, name) in enumerate(((-1, "shortening"), (1, "deflection"))):
            axes.plot(force, sign * exact[:, 2 * k], color=COLOURS[k], label=f"{name}, exact")
            axes.plot(force, sign * tip[:, 2 * k], "o", color=COLOURS[k], markersize=4)
        axes.plot([], [], "ko", markersize=4, label="computed")
        axes.set(xlabel="force", ylabel="displacement of the tip [length]", title="Elastica")


if __name__ == "__main__":
    run(main, show=True)

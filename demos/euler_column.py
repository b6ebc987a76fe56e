"""Euler's column with its four boundary conditions: critical load, post-buckling, imperfections.

Length L, bending stiffness EI, compressed by P. It stays straight up to

    P = (beta)^2 EI/L^2:  beta = pi/2 (fixed-free), pi (pinned-pinned), 4.4934 = tan(4.4934)
                          (fixed-pinned), 2 pi (fixed-fixed)

and has a bent equilibrium beyond, Euler's elastica. With K and E the complete elliptic integrals
of the modulus p, the sine of half the largest slope, P/P_c = (2 K/pi)^2, and the deflection is
2 p/K times the length over which the slope grows from 0 to its largest value: L, L/2 and L/4 for
the first, second and fourth column. The third has no such symmetry; its end reaction leans on it,
and its load has a maximum 14 % above the critical one, at which it snaps.

Here the critical load is found in two ways: by linear buckling (one call, `fl.buckling`), and by
following the straight column until the tangent gets a negative pivot; that bifurcation is located
to 1e-6 of the load. Then the branch is entered (`fl.branch`) and followed as any other path. With
an imperfection in the shape of the first mode there is no bifurcation: the path bends into the
branch. The column stretches a little (EA L^2/EI = 1e6), so both loads differ by beta^2/1e6.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

import fem_lie as fl
from fem_lie.pictures.units import Units

RESULTS = Path(__file__).parents[1] / "results"
LENGTH, BENDING, RATIO = 1.0, 1.0, 1e6
BETA = {
    "fixed-free": np.pi / 2,
    "pinned-pinned": np.pi,
    "fixed-pinned": brentq(lambda x: np.tan(x) - x, 4.4, 4.6, xtol=1e-14),
    "fixed-fixed": 2 * np.pi,
}
GROWS = {"fixed-free": 1.0, "pinned-pinned": 0.5, "fixed-fixed": 0.25}  # over L
FARTHEST = {"fixed-free": 1.0, "pinned-pinned": 0.5, "fixed-pinned": 0.5, "fixed-fixed": 0.5}
UNITS = Units(length="length")


def elastica(over: float, ends: str) -> float:
    """Largest deflection at ``over`` times the critical load."""
    m = brentq(lambda m: (2 * ellipk(m) / np.pi) ** 2 - over, 1e-12, 0.99)
    lever = GROWS[ends] * LENGTH * 2 * np.sqrt(m) / ellipk(m)
    # clamped at both ends it goes that far to either side of its inflections
    return float(2 * lever if ends == "fixed-fixed" else lever)


def column(ends: str, elements: int) -> tuple[fl.Scene, fl.Beam]:
    """A column along z in the plane of x and z, under the critical load of Euler."""
    EA = RATIO * BENDING / LENGTH**2
    strip = [(-0.02, -0.005), (0.02, -0.005), (0.02, 0.005), (-0.02, 0.005)]  # for the picture
    section = fl.Section.from_stiffness(
        [EA, EA, EA, 100 * BENDING, BENDING, 100 * BENDING], outline=strip
    )
    scene, top = fl.Scene(), (0, 0, LENGTH)
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), top, section, cells=elements, up=(1, 0, 0), name="column")
    )
    bottom, head = ends.split("-")
    if bottom == "fixed":
        scene.add(fl.Clamp(beam.start))
    else:
        scene.add(fl.Revolute(fl.ground(), beam.start, axis=(0, 1, 0)))
    if head != "free":
        scene.add(fl.InPlane(fl.ground(), beam.end, axis=(1, 0, 0)))
    if head == "fixed":  # a stiff pin on top stays upright, too
        pin = (0, 0, 1.1 * LENGTH)
        scene.add(fl.InPlane(fl.ground(), beam.end, at=pin, axis=(1, 0, 0), name="pin"))
    load = BETA[ends] ** 2 * BENDING / LENGTH**2
    scene.add(fl.PointLoad(beam.end, force=(0, 0, -load)))
    return scene, beam


def study(ends: str, elements: int, imperfection: float, beyond: float) -> dict[str, Any]:
    """Critical load in two ways, branch, and imperfect path; loads over that of Euler."""
    scene, beam = column(ends, elements)
    modes = fl.buckling(scene, 1)
    middle = beam.node(round(FARTHEST[ends] * elements)).label
    bent = {"deflection": lambda state: abs(state.position(middle)[0])}
    straight = fl.follow_path(scene, 1.1, observe=bent)
    point = straight.bifurcations[0]
    branch = fl.follow_path(
        scene,
        fl.PathEnds(beyond, stop=lambda s: -s.position(beam.end)[2]),
        start=fl.branch(scene, point),
        observe=bent,
    )
    out_of_shape = fl.imperfect(scene, fl.ModeImperfection(modes, 1, imperfection * LENGTH))
    imperfect = fl.follow_path(
        out_of_shape, fl.PathEnds(beyond, stop=lambda s: -s.position(beam.end)[2]), observe=bent
    )
    end = branch.factors[-1], branch.observed["deflection"][-1]
    # the load is referred to the one at which this column buckles
    error = None
    if ends in GROWS:
        error = float(end[1]) / elastica(end[0] / point.factor, ends) - 1.0
    paths = straight, branch, imperfect
    return {
        "linear_buckling": float(modes.factors[0]),
        "critical_load": point.factor,
        "bracket": point.bracket,
        "negative_pivots": point.negative_pivots,
        "deflection": float(end[1]),
        "deflection_error": error,
        "branch_limit": branch.limits[0].factor if branch.limits else None,
        "branch_end": branch.reason,
        "load_steps": sum(int((path.iterations > 0).sum()) for path in paths),
        "rejected_steps": sum(path.failed_steps for path in paths),
        "iterations": sum(path.total_iterations for path in paths),
        "seconds": sum(path.seconds for path in paths),
        "paths": paths,
    }


def main(
    elements: int = 16, imperfection: float = 1e-3, beyond: float = 1.2, pictures: bool = True
) -> dict[str, Any]:
    if elements < 2 or elements % 2:
        raise ValueError(f"elements must be even, for a node in the middle, got {elements}")
    record: dict[str, Any] = {"elements": elements}
    print("                 load over Euler's − 1                 deflection on the branch")
    print("column           linear      path        pivots   at the end  error      steps  its")
    for ends in BETA:
        found = study(ends, elements, imperfection, beyond)
        paths = found.pop("paths")
        record[ends] = found
        known = found["deflection_error"] is not None
        error = f"{found['deflection_error']:+.1e}" if known else "none"
        print(
            f"{ends:15}  {found['linear_buckling'] - 1:+.2e}   {found['critical_load'] - 1:+.2e}"
            f"   {found['negative_pivots']}   {found['deflection']:.5f}    "
            f"{error:8}   {found['load_steps']:4}  {found['iterations']:4}"
        )
        if found["branch_limit"]:
            print(f"{'':17}the branch has a limit point at {found['branch_limit']:.4f}")
        if pictures:
            RESULTS.mkdir(exist_ok=True)
            diagram = RESULTS / f"euler_column_{ends}.png"
            straight, branch, imperfect = paths
            branch.plot_path(
                "deflection",
                diagram,
                label="deflection",
                load=(1.0, "load over Euler's"),
                others=[(path, path.observed["deflection"]) for path in (straight, imperfect)],
                units=UNITS,
            )
            print(f"picture: {diagram}")
    record["max_error"] = max(
        abs(record[ends][name] - 1.0)
        for ends in BETA
        for name in ("linear_buckling", "critical_load")
    )
    record["seconds"] = sum(record[ends]["seconds"] for ends in BETA)
    print("largest error of a critical load {max_error:.1e}; {seconds:.1f} s".format(**record))
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)

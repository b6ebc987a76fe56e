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
to 1e-6 of the load. Then the branch is entered (`fl.stability.switch_branch`) and followed as any
other path. With
an imperfection in the shape of the first mode there is no bifurcation: the path bends into the
branch. The column stretches a little (EA L^2/EI = 1e6), so both loads differ by beta^2/1e6.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from command_line import in_results, run
from records import of_path
from reference.euler_column import BETA, FARTHEST, LENGTH, deflection_error

import fem_lie as fl
from fem_lie.joints import InPlane, Revolute
from fem_lie.stability import ModeImperfection, PathEnds, apply_imperfections, switch_branch

BENDING, RATIO = 1.0, 1e6


def column(ends: str, elements: int) -> tuple[fl.Scene, fl.Beam]:
    """A column along z in the plane of x and z, under the critical load of Euler."""
    EA = RATIO * BENDING / LENGTH**2
    strip = [(-0.02, -0.005), (0.02, -0.005), (0.02, 0.005), (-0.02, 0.005)]  # for the picture
    stiffness = [EA, EA, EA, 100 * BENDING, BENDING, 100 * BENDING]
    section = fl.Section.from_stiffness(stiffness, outline=strip)
    scene, foot, top = fl.Scene(), (0, 0, 0), (0, 0, LENGTH)
    beam = fl.Beam.straight(foot, top, section, cells=elements, up=(1, 0, 0), name="column")
    scene.add(beam)
    bottom, head = ends.split("-")
    if bottom == "fixed":
        scene.add(fl.Clamp(beam.point("start")))
    else:
        scene.add(Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
    if head != "free":
        scene.add(InPlane(fl.ground(), beam.point("end"), axis=(1, 0, 0)))
    if head == "fixed":  # a stiff pin on top stays upright, too
        pin = (0, 0, 1.1 * LENGTH)
        scene.add(InPlane(fl.ground(), beam.point("end"), at=pin, axis=(1, 0, 0), name="pin"))
    load = BETA[ends] ** 2 * BENDING / LENGTH**2
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -load)))
    return scene, beam


def study(
    ends: str, elements: int, imperfection: float, beyond: float, file: Path | None
) -> dict[str, Any]:
    """Critical load in two ways, branch, and imperfect path; loads over that of Euler."""
    scene, beam = column(ends, elements)
    modes = fl.buckling(scene, 1)
    middle = beam.point(round(FARTHEST[ends] * elements)).label
    bent = {"deflection": lambda state: abs(state.position(middle)[0])}
    straight = fl.follow_path(scene, 1.1, observe=bent)
    point = straight.bifurcations[0]
    until = PathEnds(beyond, stop=lambda state: -state.position(beam.point("end"))[2])
    branch = fl.follow_path(scene, until, start=switch_branch(scene, point), observe=bent)
    out_of_shape = apply_imperfections(scene, ModeImperfection(modes, 1, imperfection * LENGTH))
    imperfect = fl.follow_path(out_of_shape, until, observe=bent)
    load, deflection = branch.factors[-1], float(branch.observed["deflection"][-1])
    if file is not None:
        others = [(path, path.observed["deflection"]) for path in (straight, imperfect)]
        over = (1.0, "load over Euler's")
        units = fl.post.Units(length="length")
        options = dict(label="deflection", load=over, others=others, units=units)
        branch.plot_path("deflection", file, **options)
    # the load is referred to the one at which this column buckles
    error = deflection_error(deflection, load / point.factor, ends)
    effort = of_path(straight, branch, imperfect)
    effort["load_steps"] += 3  # the first states were looked for, too
    return {
        "linear_buckling": float(modes.factors[0]),
        "critical_load": point.factor,
        "bracket": point.bracket,
        "negative_pivots": point.negative_pivots,
        "deflection": deflection,
        "deflection_error": error,
        "branch_limit": branch.limits[0].factor if branch.limits else None,
        "branch_end": branch.reason,
        **effort,
    }


def main(
    elements: int = 16, imperfection: float = 1e-3, beyond: float = 1.2, pictures: bool = True
) -> dict[str, Any]:
    if elements < 2 or elements % 2:
        raise ValueError(f"elements must be even, for a node in the middle, got {elements}")
    record: dict[str, Any] = {"elements": elements}
    for ends in BETA:
        file = in_results(f"euler_column_{ends}.png") if pictures else None
        record[ends] = study(ends, elements, imperfection, beyond, file)
    loads = [record[ends][way] for ends in BETA for way in ("linear_buckling", "critical_load")]
    record["max_error"] = max(abs(load - 1.0) for load in loads)
    record["seconds"] = sum(record[ends]["seconds"] for ends in BETA)
    return record


if __name__ == "__main__":
    run(main, show=True)

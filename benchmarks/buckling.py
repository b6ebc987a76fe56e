"""Load control and arc length, plain Newton and linearised stress on the scenes of buckling demos.

    python -m benchmarks.buckling [scene ...]

Load control: equal load steps of a twentieth, halved where they fail, until they are given up.
Arc length: to the wanted load with states between that are left unpolished. Path: every state
polished, critical points not located. Each with the stress carried as an iterate, and with plain
Newton. The tables of docs/measured/buckling.md are made here.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import fem_lie as fl
from demos import (
    bistable_strip,
    compressed_cylinder,
    deep_arch,
    euler_column,
    hinged_roof,
    lateral_torsional,
    pulled_cylinder,
    spherical_cap,
)
from fem_lie.solve.stability.equilibrium import StableEquilibrium


def bent_column() -> fl.Scene:
    """Pinned at both ends, 1e-3 of its length out of shape, to 1.2 times Euler's load."""
    scene, beam = euler_column.column("pinned-pinned", 16)
    load = scene.loads[0]
    assert isinstance(load, fl.PointLoad)
    scene.loads[0] = fl.PointLoad(beam.point("end"), force=[1.2 * f for f in load.force])
    return fl.stability.apply_imperfections(
        scene, fl.stability.ModeImperfection(fl.buckling(scene, 1), 1, 1e-3)
    )


def bent_strip() -> fl.Scene:
    """Out of shape by its thickness, to 1.2 times Prandtl's load."""
    section = fl.Section.rectangle(
        lateral_torsional.WIDTH, lateral_torsional.HEIGHT, lateral_torsional.STEEL
    )
    load = 1.2 * lateral_torsional.prandtl(section.stiffness, lateral_torsional.LENGTH)
    scene = lateral_torsional.cantilever(section, 16, load)
    mode = fl.stability.ModeImperfection(fl.buckling(scene, 1), 1, lateral_torsional.WIDTH)
    return fl.stability.apply_imperfections(scene, mode)


def dented_cylinder() -> fl.Scene:
    """R/t = 100, random waves of 0.3 t; it has a limit point at about half the classical load."""
    t = 0.01
    wave = 2 * compressed_cylinder.half_wave(t)
    waves = fl.stability.RandomImperfection(0.3 * t, wave, 1, along=compressed_cylinder.outward)
    return fl.stability.apply_imperfections(compressed_cylinder.cell(t, 6), waves)


def lopsided_strip() -> fl.Scene:
    """Bistable, its middle free, out of shape by a tenth of its thickness."""
    scene, _, h = bistable_strip.strip(6.0, 40, guided=False)
    mode = fl.stability.ModeImperfection(fl.buckling(scene, 1), 1, h / 60)
    return fl.stability.apply_imperfections(scene, mode)


SCENES: dict[str, Callable[[], fl.Scene]] = {
    "deep arch": lambda: deep_arch.arch(40, "stretchable")[0],
    "roof, t = 12.7": lambda: hinged_roof.roof(12.7, 8)[0],
    "roof, t = 6.35": lambda: hinged_roof.roof(6.35, 8)[0],
    "pulled cylinder": lambda: pulled_cylinder.cylinder(16, 12),
    "column": bent_column,
    "strip on edge": bent_strip,
    "dented cylinder": dented_cylinder,
    "spherical cap": lambda: spherical_cap.cap(spherical_cap.thickness_of(5.0), 8)[0],
    "bistable strip": lopsided_strip,
}


def load_control(make: Callable[[], fl.Scene], carried: bool) -> str:
    """Iterations, and how far it came if it did not arrive."""
    path = fl.follow_path(
        make(),
        control=fl.stability.LoadControl(),
        options=fl.stability.PathOptions(locate=None, linearised_stress=carried),
    )
    return _row(path.total_iterations, path.factors[-1], path.complete)


def arc_length(make: Callable[[], fl.Scene], carried: bool) -> str:
    """Likewise, from load to load."""
    model = StableEquilibrium(make(), "benchmark_", linearised_stress=carried)
    try:
        found = fl.stability.ArcLength().follow(model)
    except fl.ConvergenceError as error:
        found = error.result
        return _row(found.total_iterations, found.factors[-1] if found.factors else 0.0, False)
    return _row(found.total_iterations, 1.0, True)


def path(make: Callable[[], fl.Scene], carried: bool) -> str:
    """Likewise, all states polished."""
    found = fl.follow_path(
        make(), options=fl.stability.PathOptions(locate=None, linearised_stress=carried)
    )
    return _row(found.total_iterations, found.factors[-1], found.complete)


def _row(iterations: int, factor: float, arrived: bool) -> str:
    return f"{iterations}" if arrived else f"{iterations} to {factor:.3f}"


def main(names: list[str]) -> None:
    methods = (load_control, arc_length, path)
    print(
        "| | load control, carried | plain | arc length, carried | plain | path, carried | plain |"
    )
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in names or list(SCENES):
        begin = time.perf_counter()
        cells = [method(SCENES[name], carried) for method in methods for carried in (True, False)]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
        print(f"{name}: {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])

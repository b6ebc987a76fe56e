"""What each choice of matrix terms saves and costs: the table of docs/measured/choices.md.

Every row runs the same scene with one thing chosen otherwise. The error is that of the position of
one point at the end, over the length of the scene, against the same model with a step ten times
smaller (a hundred times for the heavy top); what is left out of the matrix must not change it.

    tools/run python3 benchmarks/choices.py
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

import fem_lie as fl
from fem_lie.scene.matrix_terms import MatrixTerms

ALUMINIUM = fl.Material(E=70e9, nu=0.3, density=2700.0)
Built = tuple[fl.Scene, fl.extend.Point]


@dataclass(frozen=True)
class Options:
    """What may be chosen."""

    choices: MatrixTerms = field(default_factory=MatrixTerms)
    group: fl.lie.Group | None = None
    rotary_inertia: bool = True
    links: bool = True


def pendulum(options: Options) -> Built:
    """Two aluminium bars of 5 mm × 5 mm on spherical joints; the second turns at 5 rad/s."""
    scene = fl.Scene(matrix_terms=options.choices)
    section = fl.Section.rectangle(5e-3, 5e-3, ALUMINIUM)
    group = options.group or fl.lie.Group.SE3

    def bar(start: tuple[float, ...], end: tuple[float, ...]) -> fl.Beam:
        mesh = fl.mesh.LineMesh.from_cells(
            np.linspace(start, end, 11),
            [(i, i + 1) for i in range(10)],
            named_points={"start": [0], "end": [10]},
        )
        beam = fl.Beam(mesh, section, rotary_inertia=options.rotary_inertia).set_group(group)
        return scene.add(beam)

    one, two = bar((0, 0, 0), (0.3, 0, 0)), bar((0.3, 0, 0), (0.3, 0.5, 0))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Spherical(one.point("end"), two.point("start")))
    two.add_velocity(omega=(3, 0, -4), about=two.point("start"))
    return scene, two.point("end")


def rubber(options: Options) -> Built:
    """The same bars, 10 mm × 10 mm of rubber, falling under gravity."""
    scene, tip = pendulum(options)
    soft = fl.Section.rectangle(1e-2, 1e-2, fl.Material(E=5e6, nu=0.3, density=2700.0))
    fallen = fl.Scene((0, 0, -9.81), matrix_terms=options.choices)
    for body in scene.bodies:
        assert isinstance(body, fl.Beam)
        body.model.stiffness = np.tile(soft.stiffness, (10, 1, 1))
        body.model.density = np.tile(soft.inertia, (10, 1, 1))
        body.name = ""
        fallen.add(body)
    for joint in scene.joints:
        fallen.add(joint)
    return fallen, tip


def top(options: Options) -> Built:
    """The heavy top at 150 rad/s."""
    scene = fl.Scene((0, 0, -9.81), matrix_terms=options.choices)
    group = fl.lie.Group.R3xSO3 if options.group is None else options.group
    inertia = (0.234375, 0.46875, 0.234375)
    body = scene.add(fl.RigidBody(15.0, inertia, (0, 1, 0)).set_group(group))
    body.add_velocity(omega=(0, 150, -4.61538), about=(0, 0, 0))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("centre"), at=(0, 0, 0)))
    return scene, body.point("centre")


def grid(options: Options) -> Built:
    """A grid of 24 flexible bars that tumbles, rigidly joined at its 16 knots."""
    scene = fl.Scene(matrix_terms=options.choices)
    section = fl.Section.rectangle(5e-3, 5e-3, ALUMINIUM)
    ends = [
        ((i, j), (i + di, j + dj))
        for di, dj in ((1, 0), (0, 1))
        for i in range(4 - di)
        for j in range(4 - dj)
    ]
    first: dict[tuple[int, int], fl.extend.Point] = {}
    for a, b in ends:
        start, end = ((0.2 * p[0], 0.2 * p[1], 0.0) for p in (a, b))
        bar = scene.add(fl.Beam.straight(start, end, section, cells=4))
        bar.add_velocity(omega=(1.0, 2.0, 5.0), about=(0.1, 0.1, 0))
        for knot, point in ((a, bar.point("start")), (b, bar.point("end"))):
            if knot not in first:
                first[knot] = point
            elif options.links:
                scene.add(fl.joints.RigidLink(first.point(knot), point))
            else:
                scene.add(fl.joints.Fixed(first.point(knot), point))
    return scene, first[3, 3]


LEFT_OUT = {
    "all as chosen": Options(),
    "gyroscopic terms in the matrix": Options(MatrixTerms(gyroscopic=True)),
    "no gyroscopic terms in the matrix": Options(MatrixTerms(gyroscopic=False)),
    "no geometric stiffness in the matrix": Options(MatrixTerms(geometric=False)),
}
GROUPS = {"SE(3)": Options(group=fl.lie.Group.SE3), "R³×SO(3)": Options(group=fl.lie.Group.R3xSO3)}
POLICIES: dict[str, fl.schemes.RefactorisationPolicy] = {
    "matrix kept: automatic": fl.schemes.Automatic(),
    "matrix kept until 4 iterations": fl.schemes.IterationLimit(4),
    "new matrix in every iteration": fl.schemes.EveryIteration(),
}
CASES: list[tuple[Callable[[Options], Built], float, float, dict[str, Options]]] = [
    (
        pendulum,
        1e-3,
        0.5,
        LEFT_OUT | {"no rotary inertia": Options(rotary_inertia=False)} | GROUPS,
    ),
    (rubber, 1e-3, 0.5, LEFT_OUT),
    (top, 1e-3, 0.2, LEFT_OUT | GROUPS),
    (grid, 1e-3, 0.2, {"rigid links": Options(), "fixed joints": Options(links=False)}),
]


def run(
    built: Built, step: float, duration: float, policy: fl.schemes.RefactorisationPolicy
) -> tuple[fl.Result, object]:
    scene, point = built
    scheme = fl.GeneralisedAlpha(policy=policy)
    result = scheme.run(scene, duration=duration, step=step, progress=False)
    return result, result.position(point)[-1]


def main() -> None:
    for build, step, duration, variants in CASES:
        refinement = 100 if build is top else 10
        _, exact = run(build(Options()), step / refinement, duration, fl.schemes.Automatic())
        print(f"\n{build.__doc__} h = {step:g} s, {duration:g} s\n")
        print("| | ms per step | iterations | matrices | error |\n|---|---|---|---|---|")
        rows = [(name, options, fl.schemes.Automatic()) for name, options in variants.items()]
        rows += [(name, Options(), policy) for name, policy in POLICIES.items()]
        for name, options, policy in rows:
            results = [run(build(options), step, duration, policy) for _ in range(3)]
            result, position = min(results, key=lambda pair: pair[0].seconds)
            steps = len(result.times) - 1
            size = np.ptp(result.frames[0, :, 0], axis=0).max() or 1.0
            error = np.linalg.norm(np.asarray(position) - np.asarray(exact)) / size
            print(
                f"| {name} | {1e3 * result.seconds / steps:.3f} | "
                f"{result.iterations[-1] / steps:.2f} | {result.factorisations} | {error:.1e} |"
            )


if __name__ == "__main__":
    main()

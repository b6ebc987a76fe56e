"""The benefit of local frames: the same motions with the iteration matrix in three kinds of frames.

In formulations of multibody dynamics with a global vector of velocity and rotation vectors along
fixed axes the iteration matrix turns with the bodies: as soon as one has turned by some 20 degrees,
the matrix of before is of no use. In the bodies' own frames the leading mass and stiffness do not
change when the bodies turn (V. Sonneville, A. Cardona & O. Brüls, CMAME 268 (2014) 451; A. Müller,
Proc. R. Soc. A 477 (2021) 20210303), so that one matrix serves for thousands of steps. Three
descriptions of each motion, with the same bodies, step and tolerance:

    local, SE(3)          screw motions; unknowns along the nodes' axes
    local, R3 x SO(3)     translations and rotations apart; unknowns along the nodes' axes
    inertial, R3 x SO(3)  as before, but unknowns along fixed axes: the classical description

The last two make the same steps, and hence the same error: what differs is the matrix alone. It is
made for the middle of its expected life in all of them, and renewed by the same policy: automatic,
when keeping it has cost as many iterations as a new one, or when a step takes more than 4. The
Cayley map in place of the exponential changes neither; its increments are rational. Nor does the
geometric stiffness, left out of the matrix in the last variant: next to mass over h^2 it is small.
In local components the elastic tangent is symmetric where nodal forces vanish, and its asymmetry is
exactly these forces; it is printed for the end of each motion.

    pendulum   the double pendulum of double_pendulum.py, case 1: its bars turn by a third of a
               revolution, as much relative to each other as in space
    spinning   the same pendulum, ten times as fast, in half the step: several revolutions
    net        4 x 4 meshes of flexible bars with welded knots, thrown and tumbling as a whole
    slack      the same with spherical joints: every bar goes its own way

What turns as a whole gains most. Joints between bodies that turn against each other do so in any
frames: their rows of the matrix are the relative rotation itself, and no components keep them.

Without --scene all four are run. The error is the largest distance of any node, over the run, from
a run with a quarter of the step on SE(3). In the record the scene's local and inertial numbers are
those of R3 x SO(3), which make the same steps, with the automatic policy.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie.extend import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
LOCAL, INERTIAL = fl.schemes.MatrixFrame.LOCAL, fl.schemes.MatrixFrame.INERTIAL
SE3, APART = fl.lie.Group.SE3, fl.lie.Group.R3xSO3
EXPONENTIAL, CAYLEY = fl.lie.Parametrisation.EXPONENTIAL, fl.lie.Parametrisation.CAYLEY


def pendulum(group: fl.lie.Group, speed: float = 1.0) -> fl.Scene:
    """Two bars of aluminium, 0.3 m and 0.5 m, on spherical joints."""
    b = 5e-3
    aluminium = fl.Material(E=70e9, nu=0.3, density=2700.0)
    square = fl.Section.rectangle(
        b, b, aluminium, shear_factor=5 / 6, torsion_constant=0.1406 * b**4
    )
    scene, corner = fl.Scene(), (0.3, 0, 0)
    one = scene.add(fl.Beam.straight((0, 0, 0), corner, square, cells=10).set_group(group))
    two = scene.add(fl.Beam.straight(corner, (0.3, 0.5, 0), square, cells=10).set_group(group))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Spherical(one.point("end"), two.point("start")))
    two.add_velocity(omega=(3 * speed, 0, -4 * speed), about=two.point("start"))
    return scene


def spinning(group: fl.lie.Group) -> fl.Scene:
    """The pendulum with ten times the speed."""
    return pendulum(group, speed=10.0)


def net(
    group: fl.lie.Group,
    joint: type[fl.joints.Joint] = fl.joints.Fixed,
    radius: float = 4e-3,
    meshes: int = 4,
) -> fl.Scene:
    """Bars of 0.25 m between the knots of a square net, thrown with a spin."""
    section = fl.Section.circle(radius, fl.Material(E=3e9, nu=0.35, density=1150.0))
    scene, side = fl.Scene(), 0.25
    knots: dict[tuple[int, int], list[fl.extend.Point]] = {}
    for i in range(meshes + 1):
        for j in range(meshes + 1):
            for k, m in ((i + 1, j), (i, j + 1)):
                if max(k, m) > meshes:
                    continue
                bar = fl.Beam.straight(
                    (side * i, side * j, 0), (side * k, side * m, 0), section, cells=2
                ).set_group(group)
                scene.add(bar)
                knots.setdefault((i, j), []).append(bar.point("start"))
                knots.setdefault((k, m), []).append(bar.point("end"))
    for first, *others in knots.values():
        for other in others:
            scene.add(joint(first, other))
    half = 0.5 * side * meshes
    for body in scene.bodies:
        body.add_velocity(omega=(6, 3, 12), about=(half, half, 0))
        body.add_velocity((1, 0, 2))
    return scene


def slack(group: fl.lie.Group) -> fl.Scene:
    """The net of thinner bars, on spherical joints."""
    return net(group, fl.joints.Spherical, 2e-3)


class Case(NamedTuple):
    """A scene, with the step and duration of its run."""

    build: Callable[[fl.lie.Group], fl.Scene]
    step: float
    duration: float


CASES = {
    "pendulum": Case(pendulum, 1e-4, 0.5),
    "spinning": Case(spinning, 5e-5, 1.0),
    "net": Case(net, 1e-3, 1.0),
    "slack": Case(slack, 1e-3, 0.3),
}


class Variant(NamedTuple):
    """A description of the motion."""

    group: fl.lie.Group
    components: fl.schemes.MatrixFrame
    parametrisation: fl.lie.Parametrisation = EXPONENTIAL
    geometric: bool | None = None

    @property
    def label(self) -> str:
        """For tables."""
        frames = self.components.name.lower()
        dropped = ", no geo." if self.geometric is False else ""
        return f"{frames}, {self.group.name}{', Cayley' if self.parametrisation else ''}{dropped}"


VARIANTS = (
    Variant(SE3, LOCAL),
    Variant(APART, LOCAL),
    Variant(APART, INERTIAL),
    Variant(SE3, LOCAL, CAYLEY),
    Variant(APART, LOCAL, CAYLEY),
    Variant(SE3, LOCAL, geometric=False),
)
POLICIES: dict[str, fl.schemes.RefactorisationPolicy] = {
    "automatic": fl.schemes.Automatic(),
    "limit": fl.schemes.IterationLimit(4),
}
KEPT = 50  # states of each run that are compared


def main(scene: str = "net", pictures: bool = True) -> dict[str, Any]:
    record, result = compare(scene)
    if pictures:
        draw({scene: record}, {scene: result})
    return record


def all_scenes(pictures: bool = True) -> dict[str, Any]:
    """All scenes; the record of the net, with those of the others under ``pendulum_…`` etc."""
    runs = {name: compare(name) for name in CASES}
    records = {name: record for name, (record, _) in runs.items()}
    if pictures:
        draw(records, {name: result for name, (_, result) in runs.items()})
    total = dict(records["net"])
    for name in ("pendulum", "spinning", "slack"):
        total |= {f"{name}_{key}": value for key, value in records[name].items()}
    return total


def compare(name: str) -> tuple[dict[str, Any], fl.Result]:
    """Run a scene in all variants with both policies; its record, and a result to draw."""
    if name not in CASES:
        raise ValueError(f"scene must be one of {', '.join(CASES)}, got {name!r}")
    case = CASES[name]
    reference = run(case, VARIANTS[0], fl.schemes.Automatic(), refined=4)
    turns = np.linalg.norm(reference.velocities[:, :, 3:], axis=2).mean(axis=0)
    turns *= case.duration / (2 * np.pi)
    print(f"\n{name}: {turns.min():.1f} to {turns.max():.1f} revolutions")
    record: dict[str, Any] = {
        "revolutions": float(turns.max()),
        "tangent_asymmetry": asymmetry(case.build(SE3), reference),
    }
    print(f"asymmetry of the elastic tangent at the end: {record['tangent_asymmetry']:.1e}")
    print(HEADER)
    for policy, decides in POLICIES.items():
        for variant in VARIANTS:
            result = run(case, variant, decides)
            error = float(np.abs(result.frames[:, :, 0] - reference.frames[:, :, 0]).max())
            row = numbers(result, case, error)
            print(line(variant.label, policy, row))
            key = names(variant, policy)
            record |= {f"{what}_{key}": value for what, value in row.items()}
    return record, reference


def run(
    case: Case, variant: Variant, policy: fl.schemes.RefactorisationPolicy, refined: int = 1
) -> fl.Result:
    """Integrate one variant; ``refined``: into how many a step is cut."""
    scheme = fl.GeneralisedAlpha(
        policy=policy, parametrisation=variant.parametrisation, matrix_frame=variant.components
    )
    every = round(case.duration / case.step) // KEPT * refined
    scene = case.build(variant.group)
    scene.matrix_terms = fl.schemes.MatrixTerms(geometric=variant.geometric)
    return scheme.run(scene, duration=case.duration, step=case.step / refined, save_every=every)


def asymmetry(scene: fl.Scene, result: fl.Result) -> float:
    """``|K - K^T| / |K|`` of the elastic tangent in local components, in the last state."""
    equations = fl.extend.Equations(scene, dynamics=True)
    n = equations.unknowns.moving
    H, none = equations.start.frames.copy(), np.zeros((n, 6))
    H[:n] = result.frames[-1][equations.unknowns.masters]
    state = fl.extend.TimeState(H, none, none, np.zeros(equations.unknowns.m))
    equations.fill(state, None, fl.extend.Plan(none, stressed=H))
    values, columns, pointers = equations.matrix.csr
    K = sp.csr_matrix((values, columns, pointers))[: 6 * n, : 6 * n]
    return float(abs(K - K.T).max() / abs(K).max())


def names(variant: Variant, policy: str) -> str:
    """End of the keys in the record: "local" and "inertial" make the same steps."""
    key = variant.components.name.lower()
    if variant.group is SE3:
        key += "_SE3"
    if variant.parametrisation is CAYLEY:
        key += "_cayley"
    if variant.geometric is False:
        key += "_no_geometric"
    return key if policy == "automatic" else f"{key}_{policy}"


def numbers(result: fl.Result, case: Case, error: float) -> dict[str, float]:
    """What is compared."""
    return {
        "factorisations": result.factorisations,
        "iterations_per_step": float(result.iterations[-1] * case.step / case.duration),
        "seconds": result.seconds,
        "error": error,
    }


HEADER = """\
                                   factor-  iterations             error
frames                 policy     isations    per step  seconds      [m]"""


def line(label: str, policy: str, row: dict[str, float]) -> str:
    return (
        f"{label:22} {policy:9} {row['factorisations']:9} {row['iterations_per_step']:11.2f}"
        f" {row['seconds']:8.2f} {row['error']:8.1e}"
    )


def draw(records: dict[str, dict[str, Any]], results: dict[str, fl.Result]) -> None:
    """Leave a diagram of factorisations and seconds, and pictures of the motions."""
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / "local_frame_claims.png"
    figure = Figure(figsize=(7.0, 3.6), dpi=150, layout="constrained")
    at = np.arange(len(records))
    for axes, what in zip(figure.subplots(1, 2), ("factorisations", "seconds"), strict=True):
        for k, frames in enumerate(("local", "inertial")):
            values = [record[f"{what}_{frames}"] for record in records.values()]
            axes.bar(at + 0.4 * k - 0.2, values, 0.38, color=COLOURS[k], label=frames)
        axes.set(yscale="log", title=what, ylim=(1 if what == "factorisations" else 0.1, None))
        axes.set_xticks(at, list(records))
        axes.grid(axis="y", color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False)
    figure.savefig(path)
    print(f"\npicture: {path}")
    for name, result in results.items():
        path = RESULTS / f"local_frame_claims_{name}.png"
        result.picture(path, title=name)
        print(f"picture: {path}")


if __name__ == "__main__":
    from demos.command_line import run as command

    command(main, without={"scene": all_scenes})

"""Reduced bodies in one frame or in several: where errors come from, and what more frames do.

The soft rod of reduced_mechanisms.py swings at ten times the angular velocity: with more shapes,
with and without answers to centrifugal forces, with smaller steps. Then it, and the soft rod of
slider_crank.py, in two and four reduced bodies that follow each other, each with its frame in its
middle. Errors are the largest distance of a node from its position in the full motion, over the
amplitude in mean axes, and over the largest deflection of the crank's rod.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

import fem_lie as fl
from benchmarks.reduced_mechanisms import WEIGHT, middle
from benchmarks.reduction import FAST, amplitude, straight_rod, swing
from demos import slider_crank as crank
from demos.records import off_chord

CELLS = 16
SPIN = np.array([0.0, 1.0, 1.0])


def part_of(
    body: fl.Beam, points: list[fl.extend.Point], modes: int, *, spinning: bool = True
) -> fl.reduction.ReducedOrderBody:
    """A rod as a reduced-order body."""
    scene = fl.Scene()
    scene.add(body)
    inner = fl.reduction.inertial_modes(scene, points, modes, spinning=spinning)
    return fl.reduction.reduced_order_body(scene, points, inner)


def pieces(
    whole: fl.Beam, section: fl.Section, parts: int, modes: int, *, last: bool
) -> list[fl.reduction.ReducedOrderBody]:
    """A straight rod in so many reduced bodies; ``last``: the end of all is an interface, too."""
    found, count = [], CELLS // parts
    for p in range(parts):
        start, end = (whole.frames[n, 0] for n in (count * p, count * (p + 1)))
        up = whole.frames[0, 3]
        rod = fl.Beam.straight(start, end, section, cells=count, up=up, name=f"rod {p}")
        points = [rod.point(count // 2), rod.point("start"), rod.point("end")]
        found.append(part_of(rod, points[: 3 if last or p + 1 < parts else 2], modes))
    return found


def put_in(scene: fl.Scene, rods: Sequence[fl.reduction.ReducedOrderBody]) -> None:
    """Add them, each fixed to the next."""
    for rod in rods:
        scene.add(rod)
    for one, other in pairwise(rods):
        scene.add(fl.joints.Fixed(one.point("end"), other.point("start")))


def positions(result: fl.Result, rods: Sequence[fl.reduction.ReducedOrderBody]) -> np.ndarray:
    """Of all nodes of the full rods, (s, n, 3); those that two have come once."""
    shown = fl.reduction.recover_full_motion(result, *rods)
    each = [shown.frames[:, shown.info.body(rod.name).nodes, 0] for rod in rods]
    return np.concatenate([each[0], *(x[:, 1:] for x in each[1:])], axis=1)


def swung(
    rods: Sequence[fl.reduction.ReducedOrderBody], spin: np.ndarray, step: float
) -> np.ndarray:
    """Positions in the swing of reduction.py."""
    scene = fl.Scene(gravity=WEIGHT)
    put_in(scene, rods)
    scene.add(fl.joints.Spherical(fl.ground(), rods[0].point("start")))
    for rod in rods:
        rod.add_velocity(omega=spin, about=(0, 0, 0))
    return positions(fl.GeneralisedAlpha().run(scene, duration=2.0, step=step), rods)


def largest(x: np.ndarray, full: fl.Result, name: str = "rod") -> float:
    """Largest distance of a node from its position."""
    wanted = full.frames[:, full.info.body(name).nodes, 0]
    return float(np.linalg.norm(x - wanted, axis=2).max())


def shapes_and_steps(modulus: float) -> dict[str, float]:
    """Ten times the velocity: what shapes, answers to centrifugal force and steps are worth."""
    record: dict[str, float] = {}
    fine = None
    for step in (1.25e-4, 5e-4):
        full, body, _ = swing(np.eye(3), CELLS, FAST, step, modulus)
        size = amplitude(full, body)
        if fine is not None:
            own = np.linalg.norm(full.frames[:, :, 0] - fine[::4], axis=2).max() / size
            record[f"{modulus:g}_full_step_{step:g}"] = float(own)
        fine = full.frames[:, :, 0]
        for modes, spinning in ((8, False), (8, True), (16, True), (32, True), (60, True)):
            rod = straight_rod(np.eye(3), CELLS, modulus)
            few = part_of(rod, middle(rod), modes, spinning=spinning)
            label = f"{modulus:g}_{modes}_{'spinning' if spinning else 'plain'}_{step:g}"
            record[label] = largest(swung([few], FAST * SPIN, step), full) / size
    return record


def swings(modulus: float, speed: float) -> dict[str, float]:
    """One, two and four frames."""
    full, body, _ = swing(np.eye(3), CELLS, speed, 5e-4, modulus)
    size, record = amplitude(full, body), {}
    for parts, modes in ((1, 8), (2, 2), (4, 0)):
        rod = straight_rod(np.eye(3), CELLS, modulus)
        rods = pieces(rod, body.model.sections[0], parts, modes, last=False)
        record[f"swing_{modulus:g}_{speed:g}_{parts}"] = (
            largest(swung(rods, speed * SPIN, 5e-4), full) / size
        )
    return record


def cranked(rods: Sequence[fl.reduction.ReducedOrderBody]) -> fl.Scene:
    """The mechanism of slider_crank.py with these for its rod."""
    scene = fl.Scene(gravity=WEIGHT)
    middle, along = 0.5 * (crank.PIVOT + crank.CRANK_END), (crank.SLIDER - crank.CRANK_END) / 0.3
    arm = scene.add(fl.RigidBody(0.12, (1e-4, 1e-4, 1e-5), middle, name="crank"))
    arm.add_velocity(omega=(crank.SPEED, 0, 0), about=crank.PIVOT)
    start = np.cross((crank.SPEED, 0, 0), crank.CRANK_END - crank.PIVOT)
    end = np.array([start @ along / along[0], 0, 0])
    slider = scene.add(fl.RigidBody(2.0, (1e-3, 1e-3, 1e-3), crank.SLIDER, name="slider"))
    slider.add_velocity(end)
    put_in(scene, rods)
    for rod in rods:
        rod.add_velocity(start)
        rod.add_velocity(omega=np.cross(along, end - start) / 0.3, about=crank.CRANK_END)
    scene.add(fl.joints.Revolute(fl.ground(), arm.point("centre"), at=crank.PIVOT, axis=(1, 0, 0)))
    scene.add(fl.joints.Spherical(arm.point("centre"), rods[0].point("start"), at=crank.CRANK_END))
    scene.add(fl.joints.Spherical(slider.point("centre"), rods[-1].point("end"), at=crank.SLIDER))
    scene.add(fl.joints.Prismatic(fl.ground(), slider.point("centre"), axis=(1, 0, 0)))
    return scene


def cranks(modulus: float) -> dict[str, float]:
    """One, two and four frames, and the full rod with half the step."""
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9)
    whole = crank.flexible(CELLS, modulus)
    full, fine = (
        scheme.run(crank.mechanism(crank.flexible(CELLS, modulus))[0], duration=1.0, step=step)
        for step in (5e-4, 2.5e-4)
    )
    nodes = full.info.body("rod").nodes
    size = float(off_chord(full.frames[:, nodes, 0])[0].max())
    record = {f"crank_{modulus:g}_full_step": largest(fine.frames[::2, nodes, 0], full) / size}
    for parts, modes in ((1, 8), (2, 2), (4, 0)):
        rods = pieces(whole, whole.model.sections[0], parts, modes, last=True)
        found = scheme.run(cranked(rods), duration=1.0, step=5e-4)
        record[f"crank_{modulus:g}_{parts}"] = largest(positions(found, rods), full) / size
    return record


def main(shapes: bool = True) -> dict[str, float]:
    """Figures, printed."""
    record: dict[str, float] = {}
    for modulus in (5e7, 5e6):
        record |= shapes_and_steps(modulus) if shapes else {}
        for speed in (1.0, FAST):
            record |= swings(modulus, speed)
    for modulus in (2e9, 2e8):
        record |= cranks(modulus)
    for key, value in record.items():
        print(f"{key:40}{value:.3g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--no-shapes", dest="shapes", action="store_false")
    main(**vars(parser.parse_args()))

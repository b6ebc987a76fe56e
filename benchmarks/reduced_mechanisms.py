"""Reduced bodies in mechanisms, in time: postures and speeds, a slider-crank, the deployable truss.

A soft rod swings on a ball joint under gravity: as all unknowns, as a reduced body that was made
once, where the first posture is, and loaded into scenes in ten other postures and with ten times
the angular velocity; and in fixed axes with the same shapes, where its matrices are constant and
small rotations take the position of the frame. The error is the largest distance of a node from its
position in the full motion, the amplitude that from its position in the body's mean axes.

The slider-crank is that of slider_crank.py with a rod of 16 elements; errors are over the largest
deflection of the rod. The truss is that of truss_deployment.py, two cells of thin tubes, a reduced
body for each bar: largest distance of a node from its position over the largest deflection of a
bar, and processor times per step.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
import scipy.linalg

import fem_lie as fl
from benchmarks.reduction import FAST, amplitude, straight_rod, swing
from demos.records import off_chord
from demos.slider_crank import flexible, mechanism
from demos.truss_deployment import DIAMETERS
from demos.truss_deployment import STEEL as TUBES
from demos.truss_scene import Truss
from fem_lie import lie
from fem_lie.reduction.linearised import LinearisedBody

WEIGHT = np.array([0.0, 0.0, -9.81])


def away(found: fl.Result, full: fl.Result, name: str = "rod") -> np.ndarray:
    """Largest distance of a node of a body from its position, over time."""
    positions = [r.frames[:, r.info.body(name).nodes, 0] for r in (found, full)]
    return np.asarray(np.linalg.norm(positions[0] - positions[1], axis=2).max(axis=1))


def part_of(
    body: fl.Beam, points: list[fl.extend.Point], modes: int, *, stretching: bool = True
) -> fl.reduction.ReducedOrderBody:
    """A rod as a reduced-order body."""
    scene = fl.Scene()
    scene.add(body)
    inner = fl.reduction.inertial_modes(scene, points, modes, spinning=True)
    return fl.reduction.reduced_order_body(scene, points, inner, stretching=stretching)


def middle(body: fl.Beam) -> list[fl.extend.Point]:
    """Interfaces with the frame in the middle of 16 elements, where ends turn least from it."""
    return [body.point(8), body.point("start")]


def few_swings(few: fl.reduction.ReducedOrderBody, spin: np.ndarray, step: float) -> fl.Result:
    """The swing of reduction.py."""
    scene = fl.Scene(gravity=WEIGHT)
    scene.add(few)
    scene.add(fl.joints.Spherical(fl.ground(), few.point("start")))
    few.add_velocity(omega=spin, about=few.point("start").position)
    return fl.reduction.recover_full_motion(
        fl.GeneralisedAlpha().run(scene, duration=2.0, step=step), few
    )


def in_fixed_axes(
    few: fl.reduction.ReducedOrderBody, spin: np.ndarray, times: np.ndarray
) -> np.ndarray:
    """Positions (s, n, 3) of the same shapes with small rotations about the state at rest."""
    part = fl.Scene()
    body = part.add(few.model.full)
    rest, X, axes = LinearisedBody(part, None), body.frames, few.frames[0, 1:]
    flat = few.model.modes.reshape(*few.model.modes.shape[:2], 2, 3) @ axes
    turns = np.zeros((3, len(X), 2, 3))
    turns[:, :, 1] = np.eye(3)[:, np.newaxis]
    turns[:, :, 0] = np.cross(np.eye(3)[:, np.newaxis], X[:, 0] - X[0, 0])
    fixed = np.concatenate([turns, flat])
    fixed[:, :, 0] -= fixed[:, :1, 0]  # the joint stays
    falls = np.zeros((1, len(X), 2, 3))
    falls[0, :, 0] = WEIGHT
    own = [np.einsum("nki,mnhi->mnhk", X[:, 1:], s).reshape(-1, len(X), 6) for s in (fixed, falls)]
    V, g = (rest.unknowns_of(s) for s in own)
    A = rest.pencil
    M, K, f = V @ (A.M @ V.T), V @ (A.K @ V.T), V @ (A.M @ g.T)
    k, Y = scipy.linalg.eigh(K, M)
    ω = np.sqrt(np.maximum(k, 1e-12 * k.max()))
    start = Y.T @ M @ np.concatenate([spin, np.zeros(len(V) - 3)])
    force, t = (Y.T @ f)[:, 0], times[:, np.newaxis]
    y = start / ω * np.sin(ω * t) + force / ω**2 * 2.0 * np.sin(0.5 * ω * t) ** 2
    return np.asarray(X[:, 0] + np.einsum("sm,mni->sni", y @ Y.T, fixed[:, :, 0]))


def postures(modulus: float, modes: int, count: int) -> dict[str, float]:
    """Two seconds: one body, ``count`` other postures, and ten times the angular velocity."""
    random = np.random.default_rng(1)
    others = [lie.so3_exp(random.uniform(-2.0, 2.0, 3)) for _ in range(count)]
    cases = [("made", np.eye(3), 1.0), ("fast", np.eye(3), FAST)]
    cases += [("other", turned, 1.0) for turned in others]
    step = 5e-4
    record: dict[str, float] = {}
    made = straight_rod(np.eye(3), 16, modulus)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rod.h5"
        fl.reduction.save_reduced(part_of(made, middle(made), modes), path)
        for name, turned, speed in cases:
            full, body, _ = swing(turned, 16, speed, step, modulus)
            few = fl.reduction.load_reduced(path, straight_rod(turned, 16, modulus))
            spin = speed * turned @ (0, 1, 1)
            found = few_swings(few, spin, step)
            size, fixed = amplitude(full, body), in_fixed_axes(few, spin, full.times)
            missed = np.linalg.norm(fixed - full.frames[:, :, 0], axis=2).max()
            error = away(found, full).max()
            way = np.linalg.norm(np.diff(full.frames[:, -1, 0], axis=0), axis=1).sum()
            values = {
                "amplitude": size,
                "local": error / size,
                "local_over_way": error / way,
                "fixed": missed / size,
            }
            for key, value in values.items():
                each = f"{modulus:g}_{modes}_{name}_{key}"
                record[each] = max(float(value), record.get(each, 0.0))
    return record


def crank_rod(rod: fl.Beam, modes: int, stretching: bool) -> fl.reduction.ReducedOrderBody:
    """With its frame in the middle."""
    points = [rod.point(8), rod.point("start"), rod.point("end")]
    return part_of(rod, points, modes, stretching=stretching)


def slider_crank(modulus: float, modes: int, *, stretching: bool = True) -> dict[str, float]:
    """Errors up to some times over the largest deflection within all of it."""
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9)
    full = scheme.run(mechanism(flexible(16, modulus))[0], duration=1.0, step=5e-4)
    few = crank_rod(flexible(16, modulus), modes, stretching)
    found = fl.reduction.recover_full_motion(
        scheme.run(mechanism(few)[0], duration=1.0, step=5e-4), few
    )
    x = full.frames[:, full.info.body("rod").nodes, 0]
    largest, errors = float(off_chord(x)[0].max()), away(found, full)
    label = f"crank_{modulus:g}_{modes if stretching else 'constant'}"
    record = {f"{label}_deflection": largest / 0.3}
    for end in (500, 1000, 2000):
        record[f"{label}_error_to_{5e-4 * end:g}"] = float(errors[: end + 1].max()) / largest
    return record


class FewTruss(Truss):
    """The truss with reduced bars, which are joined where full ones follow each other."""

    def _bar(self, start: np.ndarray, end: np.ndarray, up: np.ndarray) -> fl.Beam:
        name, part = f"bar {len(self.bars)}", fl.Scene()
        bar = fl.Beam.straight(start, end, self.section, cells=self.elements, up=up, name=name)
        part.add(bar)
        few = self.scene.add(
            fl.reduction.reduced_order_body(part, [bar.point("start"), bar.point("end")], 0)
        )
        self.bars.append(few)
        return few

    def _frame(self, level: int) -> list[fl.extend.Point]:
        battens = self._battens(level)
        for i in range(4):
            self.scene.add(fl.joints.Fixed(battens[i - 1].point("end"), battens[i].point("start")))
        return [batten.point("start") for batten in battens]

    def _lower_frame(self, cell: int) -> None:
        for i, batten in enumerate(self._battens(cell)):
            for corner, end in ((i, batten.point("start")), ((i + 1) % 4, batten.point("end"))):
                on = self.frames[cell][corner]
                self.scene.add(fl.Clamp(end) if on.is_ground else fl.joints.Fixed(on, end))


def truss(duration: float, step: float = 2e-3) -> dict[str, float]:
    """The first seconds of the law, two cells of thin tubes, ten elements for each bar."""
    section = fl.Section.tube(*(0.5 * d for d in DIAMETERS["thin"]), TUBES)
    scheme, steps, found, record = fl.GeneralisedAlpha(radius=0.8), round(duration / step), [], {}
    for name, kind in (("full", Truss), ("few", FewTruss)):
        began = time.process_time()
        scene = kind(2, section, 10, 1, fl.schemes.MatrixTerms())
        record[f"truss_{name}_set_up_seconds"] = time.process_time() - began
        scheme.run(scene.scene, duration=step, step=step)
        began = time.process_time()
        result = scheme.run(scene.scene, duration=duration, step=step, save_every=10)
        record[f"truss_{name}_ms"] = 1e3 * (time.process_time() - began) / steps
        record[f"truss_{name}_iterations"] = float(result.iterations[-1]) / steps
        found.append(
            fl.reduction.recover_full_motion(result, *scene.bars) if kind is FewTruss else result
        )
    names = [bar.name for bar in scene.bars]
    full, few = found
    bows = [
        [off_chord(r.frames[:, r.info.body(name).nodes, 0])[0] for name in names]
        for r in (full, few)
    ]
    largest, same = (float(np.max(bow)) for bow in bows)
    bent = max(float(np.abs(a - b).max()) for a, b in zip(*bows, strict=True))
    missed = max(float(away(few, full, name).max()) for name in names)
    return record | {
        "truss_deflection": largest,
        "truss_largest_error": abs(same / largest - 1.0),
        "truss_bow_error": bent / largest,
        "truss_error": missed / largest,
    }


def main(count: int = 10, truss_duration: float = 2.0) -> dict[str, float]:
    """Figures, printed."""
    record: dict[str, float] = {}
    for modulus, modes in ((5e6, 8), (5e7, 8)):
        record |= postures(modulus, modes, count)
    for modulus in (2e8, 2e9, 2e10):
        record |= slider_crank(modulus, 8)
    record |= slider_crank(2e9, 8, stretching=False) | truss(truss_duration)
    for key, value in record.items():
        print(f"{key:40}{value:.3g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--truss-duration", type=float, default=2.0)
    main(**vars(parser.parse_args()))

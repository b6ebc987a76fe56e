"""Shapes in local frames: projection errors over postures and speeds, and of a spinning blade.

A soft rod swings on a ball joint under gravity. Shapes of its local motion are made from one swing
in one posture (POD), and those of its body at rest (Craig-Bampton); other swings start in ten other
postures, and with ten times the angular velocity. The error is the largest distance of a node from
its position over all states; the amplitude is that from its position in the mean axes of the body.
For comparison: the same modes of POD in fixed axes, with small rigid motions. The
blade is that of rotating_beam.py, its speeds are over the scale of its lag frequencies: reduced
frequencies beside those of all unknowns. Last, a beam that is bent by a tenth of its length, in
equilibrium.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np
import scipy.sparse.linalg

import fem_lie as fl
from demos.rotating_beam import HEIGHT, LENGTH, STEEL, WIDTH, blade
from fem_lie import lie
from fem_lie.reduction.axes import expanded, local_motion
from fem_lie.reduction.linearised import LinearisedBody

RUBBER = fl.Material(E=5e6, nu=0.3, density=1100.0)
FAST = 10.0


def straight_rod(turned: np.ndarray, cells: int, modulus: float = RUBBER.E) -> fl.Beam:
    """A rod of 1 m along the first column of ``turned``, its section's last axis along the last."""
    along, _, up = turned.T
    section = fl.Section.rectangle(0.05, 0.05, replace(RUBBER, E=modulus))
    return fl.Beam.straight((0, 0, 0), along, section, cells=cells, up=up, name="rod")


def swing(
    turned: np.ndarray,
    cells: int,
    spin: float = 1.0,
    step: float = 4e-3,
    modulus: float = RUBBER.E,
) -> tuple[fl.Result, fl.Beam, fl.Scene]:
    """Two seconds of it."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(straight_rod(turned, cells, modulus))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("start")))
    body.add_velocity(omega=spin * turned @ (0.0, 1.0, 1.0), about=(0, 0, 0))
    return fl.GeneralisedAlpha().run(scene, duration=2.0, step=step), body, scene


def amplitude(result: fl.Result, body: fl.Beam) -> float:
    """Largest distance of a node from its position in the mean axes."""
    motion = local_motion(body, result.frames, fl.reduction.MeanAxes())
    still = expanded(body, motion._replace(increments=np.zeros_like(motion.increments)))
    return float(np.linalg.norm((result.frames - still)[:, :, 0], axis=2).max())


def missed_moments(
    basis: fl.reduction.Basis, result: fl.Result, body: fl.Beam, scene: fl.Scene
) -> float:
    """Largest error of a bending moment of all states, over the largest one."""
    shown = basis.project(result).within(result)
    full, found = (fl.post.section_forces(r, body, scene).ends[..., 4:] for r in (result, shown))
    return float(np.abs(found - full).max() / np.abs(full).max())


def missed_in_fixed_axes(basis: fl.reduction.Basis, result: fl.Result) -> float:
    """Largest distance of a node from where shapes in fixed axes have it, rigid ones beside them.

    As in linear theory: displacements are those of the shapes where they were made, and of small
    translations and rotations.
    """
    X = basis.body.frames
    shapes = np.einsum("mni,nij->mnj", basis.modes[:, :, :3], X[:, 1:])
    turns = np.cross(np.eye(3)[:, np.newaxis], X[:, 0])
    moves = np.broadcast_to(np.eye(3)[:, np.newaxis], turns.shape)
    flat = np.concatenate([shapes, turns, moves]).reshape(len(shapes) + 6, -1)
    moved = (result.frames - result.frames[0])[:, :, 0].reshape(len(result.times), -1)
    found = np.linalg.lstsq(flat.T, moved.T, rcond=None)[0]
    left = (moved - found.T @ flat).reshape(len(moved), -1, 3)
    return float(np.linalg.norm(left, axis=2).max())


def missed_by_displacements(trained: fl.Result, result: fl.Result, modes: int) -> float:
    """Likewise of POD of whole displacements in fixed axes, computed from the same training."""
    moved = [(r.frames - r.frames[0])[:, :, 0].reshape(len(r.times), -1) for r in (trained, result)]
    shapes = np.linalg.svd(moved[0], full_matrices=False)[2][:modes]
    left = (moved[1] - moved[1] @ shapes.T @ shapes).reshape(len(moved[1]), -1, 3)
    return float(np.linalg.norm(left, axis=2).max())


def postures(cells: int, modes: int, count: int) -> dict[str, float]:
    """One training, ``count`` other postures, and one swing at ten times the speed."""
    trained, body, _ = swing(np.eye(3), cells)
    local = fl.reduction.pod(trained, body, modes)
    alone = fl.Scene()
    free = alone.add(straight_rod(np.eye(3), cells))
    ends = fl.reduction.craig_bampton(alone, [free.point("start"), free.point("end")], modes)
    random = np.random.default_rng(1)
    others = [lie.so3_exp(random.uniform(-2.0, 2.0, 3)) for _ in range(count)]
    cases = [("trained", np.eye(3), 1.0), ("fast", np.eye(3), FAST)]
    cases += [("other", turned, 1.0) for turned in others]
    record: dict[str, float] = {}
    for name, turned, spin in cases:
        result, moved, scene = swing(turned, cells, spin)
        size = amplitude(result, moved)
        here = {
            "amplitude": size,
            "pod": float(local.project(result).errors.max()) / size,
            "craig_bampton": float(ends.project(result).errors.max()) / size,
            "pod_moments": missed_moments(local, result, moved, scene),
            "displacements": missed_by_displacements(trained, result, modes) / size,
            "fixed_axes": missed_in_fixed_axes(local, result) / size,
        }
        for key, value in here.items():
            record[f"{name}_{key}"] = max(value, record.get(f"{name}_{key}", 0.0))
    return record


def spinning(modes: int) -> dict[str, float]:
    """Largest errors of the first four frequencies of the blade, and seconds of both."""
    scene, beam = blade(16)
    lag = float(np.sqrt(beam.model.stiffness[0, 5, 5] / beam.model.density[0, 0, 0])) / LENGTH**2
    began = time.perf_counter()
    basis = fl.reduction.craig_bampton(scene, [], modes)
    record = {f"blade_{modes}_set_up_seconds": time.perf_counter() - began}
    for speed in (0.0, 2.0, 5.0, 10.0):
        at = fl.statics(scene, spin=(0, 0, speed * lag))
        full = fl.vibrations(scene, 4, at=at).frequencies
        error = fl.reduction.reduced_frequencies(scene, basis, 4, at=at) / full - 1
        record[f"blade_{modes}_error_at_{speed:g}"] = float(np.abs(error).max())
    return record


def spinning_reduced(modes: int, stretching: bool = True) -> dict[str, float]:
    """Likewise of the blade as a reduced body on its clamp: tension is that of its modes."""
    scene, beam = blade(16)
    lag = float(np.sqrt(beam.model.stiffness[0, 5, 5] / beam.model.density[0, 0, 0])) / LENGTH**2
    part, few = fl.Scene(), fl.Scene()
    section = fl.Section.rectangle(WIDTH, HEIGHT, STEEL)
    free = part.add(fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=16))
    began = time.perf_counter()
    inner = fl.reduction.inertial_modes(part, [free.point("start")], modes, spinning=True)
    body = few.add(
        fl.reduction.reduced_order_body(part, [free.point("start")], inner, stretching=stretching)
    )
    label = "body" if stretching else "constant"
    record = {f"{label}_{modes}_set_up_seconds": time.perf_counter() - began}
    few.add(fl.Clamp(body.point("start")))
    for speed in (0.0, 2.0, 5.0, 10.0):
        spin = (0, 0, speed * lag)
        found, full = (fl.vibrations(s, 4, spin=spin).frequencies for s in (few, scene))
        record[f"{label}_{modes}_error_at_{speed:g}"] = float(np.abs(found / full - 1).max())
    return record


def cantilever(force: float) -> tuple[fl.Scene, fl.Beam]:
    """A soft beam that is clamped at its start, with a force askew at its end."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.015, RUBBER)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=16, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    if force:
        scene.add(fl.PointLoad(beam.point("end"), force=force * np.array([0.0, 1.0, 1.5])))
    return scene, beam


def bent(modes: int) -> dict[str, float]:
    """Largest error of a position over the deflection of a tenth of the length, and its estimate.

    Linear modes, those with their derivatives, and half as many of POD, trained by the same load at
    up to 1.2 of its size.
    """
    scene, beam = cantilever(1.6e-3)
    still, same = cantilever(0.0)
    linear = fl.reduction.craig_bampton(still, [], modes)
    trained = fl.statics(cantilever(1.92e-3)[0], levels=np.linspace(0.1, 1.0, 10))
    bases = {
        "linear": linear,
        "derivatives": fl.reduction.with_derivatives(still, linear),
        "pod": fl.reduction.pod(trained, same, modes // 2, axes=fl.reduction.NodeAxes(0)),
    }
    full = fl.statics(scene).frames[-1, :, 0]
    away = float(np.linalg.norm(full - beam.frames[:, 0], axis=1).max())
    record = {"deflection": away}
    for name, basis in bases.items():
        found = fl.reduction.reduced_statics(
            scene, fl.reduction.Basis(beam, basis.modes), load_steps=8
        )
        error = np.linalg.norm(found.frames[:, 0] - full, axis=1).max()
        record[f"{name}_{modes}_shapes"] = float(len(basis))
        record[f"{name}_{modes}_error"] = float(error / away)
        record[f"{name}_{modes}_estimate"] = found.error / away
    return record


def answering(shapes: int) -> dict[str, float]:
    """Error where a load oscillates at half the first frequency: Krylov vectors, normal modes."""
    scene, beam = cantilever(0.0)
    rest = LinearisedBody(scene, None)
    wrench = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    load = np.zeros((17, 6))
    load[9] = wrench
    f = (load * rest.weight)[rest.free]
    square = (0.5 * fl.vibrations(scene, 1).frequencies[0]) ** 2
    dynamic = (rest.pencil.K - square * rest.pencil.M).tocsc()
    full = f @ scipy.sparse.linalg.spsolve(dynamic, f)
    record = {}
    bases = {
        "krylov": fl.reduction.krylov(scene, [(beam.point(9), wrench)], shapes),
        "normal": fl.reduction.craig_bampton(scene, [], shapes),
    }
    for name, basis in bases.items():
        V = rest.unknowns_of(basis.modes).T
        found = V.T @ f @ np.linalg.solve(V.T @ (dynamic @ V), V.T @ f)
        record[f"{name}_{shapes}_answer_error"] = float(abs(found / full - 1.0))
    return record


def main(cells: int = 16, modes: int = 16, count: int = 10) -> dict[str, float]:
    """Figures, printed."""
    record = postures(cells, modes, count)
    for shapes in (6, 8, 12):
        record |= spinning(shapes) | spinning_reduced(shapes)
    record |= spinning_reduced(6, stretching=False)
    for shapes in (2, 4, 6, 8):
        record |= bent(shapes) | answering(shapes)
    for key, value in record.items():
        print(f"{key:32}{value:.3g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=16)
    parser.add_argument("--modes", type=int, default=16)
    parser.add_argument("--count", type=int, default=10)
    main(**vars(parser.parse_args()))

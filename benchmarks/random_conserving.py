"""Conserving schemes and generalised-α on random scenes of bodies, joints, springs and drives.

Scenes come from tests/random_scenes.py, each from its seed: up to four beams, shells and rigid
bodies on random joints, with springs, gears, drives, prescribed motions and gravity. Loads are left
out: in so long a time a force that follows a free body makes it as fast as one likes. A step of 5
ms resolves the motion and not all waves. Where generalised-α runs, conserving schemes should, too.

    python3 -m benchmarks.random_conserving --scenes 50 --steps 10000
"""

from __future__ import annotations

import argparse
import logging
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import fem_lie as fl
from benchmarks.random_scenes import SCALES
from fem_lie.bodies.balances import energy_scale
from tests.random_scenes import CONSERVING, STEP, random_scene
from tests.scene_builder import build
from tests.scene_data import DriveData, SceneData

SCHEMES: dict[str, Any] = {
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(radius=0.8),
    "generalised-α": fl.GeneralisedAlpha(),
}


def scenes(count: int, steps: int, first: int = 0) -> Iterator[tuple[int, SceneData]]:
    """The first scenes with joints from a seed on, made for so many steps, without loads."""
    wanted, seed = replace(CONSERVING, steps=steps), first
    while count:
        data = random_scene(seed, wanted)
        if data.joints:
            yield seed, replace(data, loads=())
            count -= 1
        seed += 1


def measures(data: SceneData, scheme: Any, steps: int) -> dict[str, float]:
    """Steps made, largest errors, and work per step, of a run."""
    scene = build(data).scene
    every = max(1, steps // 1000)
    try:
        result = scheme.run(
            scene, duration=steps * STEP, step=STEP, save_every=every, progress=False
        )
        made = steps
    except fl.ConvergenceError as error:
        result = error.result
        made = int(np.round(result.times[-1] / STEP))
    follows = result.balance is not None
    return {
        "steps": made,
        "balance": result.balance_error * _turned_over(result) / _scale(result)
        if follows
        else np.nan,
        "gain": float(np.diff(_closed(result)).max() / _scale(result)) if follows else np.nan,
        "violation": float(result.joint_violations.max()),
        "iterations": float(result.iterations[-1] / max(made, 1)),
        "matrices": result.factorisations,
        "divided": result.divided,
        "ms": 1e3 * result.seconds / max(made, 1),
    }


def _closed(result: fl.Result) -> np.ndarray:
    """Energy less work plus what damping takes: it must not rise."""
    assert result.balance is not None
    return np.asarray(result.total_energy - result.balance[:, 0] + result.balance[:, 1])


def _turned_over(result: fl.Result) -> float:
    """The largest energy in play."""
    assert result.balance is not None
    stored = result.kinetic + result.elastic
    return energy_scale(stored, result.potential, result.balance)


def _scale(result: fl.Result) -> float:
    """Likewise; where nothing happens, that of a scene in which little does."""
    return max(_turned_over(result), SCALES["energy"])


def describe(data: SceneData) -> str:
    """Bodies, joints and drives in a few words."""
    bodies = ", ".join(type(body).__name__.removesuffix("Data").lower() for body in data.bodies)
    drives = sum(isinstance(action, DriveData) for action in data.actions)
    return f"{bodies}; {', '.join(joint.kind for joint in data.joints)}; {drives} driven"


def main() -> None:
    """Print the table, a scene a row, and what is largest."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=50)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--scheme", choices=SCHEMES, action="append")
    given = parser.parse_args()
    logging.disable(logging.WARNING)
    rows: dict[str, list[dict[str, float]]] = {name: [] for name in given.scheme or SCHEMES}
    print("| seed | scheme | steps | in parts | balance | iterations | matrices | ms/step |")
    print("|---|---|---|---|---|---|---|---|")
    for seed, data in scenes(given.scenes, given.steps, given.first):
        for name, found in rows.items():
            row = measures(data, SCHEMES[name], given.steps)
            found.append(row)
            print(
                f"| {seed} | {name} | {row['steps']:.0f} | {row['divided']} | {row['balance']:.1e} "
                f"| {row['iterations']:.1f} | {row['matrices']:.0f} | {row['ms']:.2f} |",
                flush=True,
            )
        print(f"| {seed} | {describe(data)} |", flush=True)
    summarise(rows, given.steps)


def summarise(rows: dict[str, list[dict[str, float]]], steps: int) -> None:
    """How many arrived, and medians and largest values of those that did."""
    print(
        "\n| scheme | arrived | scenes with parts | balance, median | largest | violation "
        "| iterations | matrices |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for name, found in rows.items():
        done = [row for row in found if row["steps"] == steps]
        if not done:
            print(f"| {name} | 0 of {len(found)} |")
            continue
        column = {key: np.array([row[key] for row in done]) for key in done[0]}
        print(
            f"| {name} | {len(done)} of {len(found)} | {np.count_nonzero(column['divided'])} "
            f"| {np.median(column['balance']):.1e} "
            f"| {column['balance'].max():.1e} | {column['violation'].max():.1e} "
            f"| {column['iterations'].mean():.1f} | {np.median(column['matrices']):.0f} |"
        )


if __name__ == "__main__":
    main()

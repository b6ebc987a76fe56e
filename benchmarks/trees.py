"""Chains of rigid links and a free body: explicit steps of order four, compared with other codes.

    python3 -m benchmarks.trees [--links 30 100 300] [--repeat 3] [--peers]

Rods of 2 m and 3 kg in all, on ball joints, fall from the horizontal for 0.7 s. Errors are those of
the end of the last rod against the finest steps of MuntheKaas. Seconds are processor time of the
solver in processes of one thread, least of some runs in turns, without set-up; only frames of the
end are recorded. The time at an error is interpolated between steps along straight lines of the
logarithms. With ``--peers`` pip installs Pinocchio (articulated-body algorithm and Runge-Kutta
steps written in Python), MuJoCo (its RK4) and Exudyn (its explicit RK44, free body only).

The free body is that of demos/free_rigid_body.py, whose error is that of a point after 1 s.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import fem_lie as fl
from benchmarks.peer_scenes import descriptions, environment
from benchmarks.peer_scenes.processes import Asked

DURATION, LENGTH, MASS, AT = 0.7, 2.0, 3.0, 1e-4
CHAIN_STEPS = {
    30: (1.25e-4, 1e-3, 2e-3, 3.5e-3, 5e-3),
    100: (5e-5, 5e-4, 1e-3, 1.4e-3, 2e-3),
    300: (2.5e-5, 1e-4, 1.4e-4, 2e-4, 2.5e-4),
}
"""Steps by number of links; the first is that of the reference."""
TOO_LARGE = {"pinocchio": 150, "mujoco": 100}
"""Most links: the data of Pinocchio grow with their cube, 6 GB for 150, and MuJoCo's time too."""
FREE_STEPS = (1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3)
FREE_AT = 1e-10


class Row(NamedTuple):
    """A run.

    Attributes:
        code: Which code.
        step: Its step size.
        error: Of the probe, m.
        seconds: Processor time, s.
    """

    code: str
    step: float
    error: float
    seconds: float


def chain(links: int) -> dict[str, Any]:
    """Description of a chain for all codes."""
    a, m = LENGTH / links, MASS / links
    r = 0.1 * a
    J = [m * r * r / 2] + [m * (a * a / 12 + r * r / 4)] * 2
    return {
        "bodies": [
            {"mass": m, "inertia": J, "centre": [(k + 0.5) * a, 0.0, 0.0]} for k in range(links)
        ],
        "anchors": [[k * a, 0.0, 0.0] for k in range(links)],
        "gravity": [0.0, 0.0, -9.81],
        "probe": [LENGTH, 0.0, 0.0],
    }


def free_body() -> dict[str, Any]:
    """Description of the free body."""
    given = descriptions.spinning()
    known = {"anchors": [], "probe": given["probe"]["at"], "gravity": given["gravity"]}
    return {"bodies": given["bodies"]} | known


def ours(scheme: Any, given: dict[str, Any], step: float, steps: int) -> tuple[Any, float]:
    """Where the probe ends, and seconds."""
    scene, before = fl.Scene(gravity=given["gravity"]), fl.ground()
    for k, body in enumerate(given["bodies"]):
        rigid = fl.RigidBody(body["mass"], np.diag(np.ravel(body["inertia"])[:3]), body["centre"])
        if np.ndim(body["inertia"]) == 2:
            rigid = fl.RigidBody(body["mass"], body["inertia"], body["centre"])
        scene.add(rigid)
        if given["anchors"]:
            at = given["anchors"][k]
            scene.add(fl.joints.Spherical(before, rigid.point("centre"), at=at))
        else:
            rigid.add_velocity(omega=body["spin"], about=body["centre"])
        before = rigid.point("centre")
    plan = {"step": step, "record": fl.schemes.Record.FRAMES, "progress": False}
    spent = [time.process_time()]
    for made in (1, steps):
        result = scheme.run(scene, duration=made * step, save_every=made, **plan)
        spent.append(time.process_time())
    H = result.frames[-1, -1]
    probe = np.array(given["probe"]) - given["bodies"][-1]["centre"]
    # the first run has the set-up of the second
    seconds = max(spent[2] - spent[1] - (spent[1] - spent[0]), result.seconds * 0.5)
    return H[0] + probe @ H[1:], seconds


def at_error(rows: list[Row], error: float) -> float:
    """Seconds at an error; not a number if no run reaches it, and none is worse."""
    ordered = sorted((row for row in rows if np.isfinite(row.error)), key=lambda r: r.error)
    errors = np.log([max(row.error, 1e-300) for row in ordered])
    if len(ordered) < 2 or not errors[0] <= np.log(error) <= errors[-1]:
        return float("nan")
    return float(np.exp(np.interp(np.log(error), errors, np.log([r.seconds for r in ordered]))))


def compare(
    runs: dict[str, Callable[[float, int], tuple[Any, float]]],
    steps: tuple[float, ...],
    duration: float,
    exact: Any,
    repeat: int,
) -> dict[str, list[Row]]:
    """Rows of all codes, in turns, printed as they come."""
    found: dict[str, list[Row]] = {code: [] for code in runs}
    for step in steps:
        best = dict.fromkeys(runs, np.inf)
        ends: dict[str, Any] = {}
        for _ in range(repeat):
            for code, run in runs.items():
                try:
                    ends[code], seconds = run(step, round(duration / step))
                except (fl.ConvergenceError, RuntimeError) as error:
                    ends[code], seconds = np.full(3, np.nan), np.nan
                    print(f"{code} {step:g}: {str(error)[:90]}")
                best[code] = min(best[code], seconds)
        for code in runs:
            error = float(np.linalg.norm(ends[code] - exact))
            found[code].append(Row(code, step, error, best[code]))
            print(f"| {code} | {step:g} | {error:.1e} | {1e3 * best[code]:.3g} |", flush=True)
    return found


def asked(peer: Asked, given: dict[str, Any]) -> Callable[[float, int], tuple[Any, float]]:
    """Runs of a peer."""

    def run(step: float, steps: int) -> tuple[Any, float]:
        request = given | {"code": peer.code, "step": step, "steps": steps}
        if peer.code == "exudyn":
            own = {"way": "explicit", "radius": 1.0, "duration": 1.0, "step": step}
            request = descriptions.spinning() | own
        answer = peer.ask(request)
        if "failed" in answer:
            raise RuntimeError(answer["failed"])
        return np.array(answer.get("position", answer.get("place"))), answer["seconds"]

    return run


def main() -> None:
    """Print tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--links", type=int, nargs="*", default=[30, 100, 300])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--peers", action="store_true", help="install and run other codes")
    parser.add_argument("--alpha", action="store_true", help="generalised-α as well")
    chosen = parser.parse_args()
    peers: dict[str, Asked] = {}
    if chosen.peers:
        pythons = environment.interpreters("pinocchio", "mujoco", "exudyn")
        peers = {code: Asked(code, python, 300.0) for code, python in pythons.items()}
    schemes = {"fem_lie, Munthe-Kaas": fl.schemes.MuntheKaas()}
    if chosen.alpha:
        schemes["fem_lie, generalised-α"] = fl.GeneralisedAlpha()
    print("| code | step, s | error, m | ms of the processor |\n|---|---|---|---|")
    try:
        for links in (*chosen.links, 0):
            given = chain(links) if links else free_body()
            steps = CHAIN_STEPS[links] if links else FREE_STEPS
            duration, target = (DURATION, AT) if links else (1.0, FREE_AT)
            finest = steps[0] if links else 2.5e-4
            exact, _ = ours(
                schemes["fem_lie, Munthe-Kaas"], given, finest, round(duration / finest)
            )
            runs: dict[str, Any] = {
                name: lambda step, count, scheme=scheme, given=given: ours(
                    scheme, given, step, count
                )
                for name, scheme in schemes.items()
            }
            for code, peer in peers.items():
                fits = links <= TOO_LARGE.get(code, 0) if links else code != "mujoco"
                if fits:
                    runs[code] = asked(peer, given)
            print(f"| {links or 'free body'} {'links' if links else ''} | | | |")
            found = compare(runs, steps[1:] if links else steps, duration, exact, chosen.repeat)
            first = at_error(next(iter(found.values())), target)
            for code, rows in found.items():
                own = at_error(rows, target)
                print(f"{code}: {1e3 * own:.3g} ms at {target:g}, {own / first:.2f} of the first")
    finally:
        for peer in peers.values():
            peer.stop()


if __name__ == "__main__":
    main()

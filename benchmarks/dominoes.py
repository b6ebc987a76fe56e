"""A row of dominoes beside MuJoCo: how wrong the times of impacts are, overlap, time per step.

    tools/run python3 -m benchmarks.dominoes

The scene is that of ``demos/dominoes.py``, and so is the reference. Ours are rigid impacts with
Coulomb's law; MuJoCo has elliptic cones with its own softness, at its defaults and with contacts as
stiff as a step allows (a time constant of two steps). Times are the processor's in solvers alone.
Peers come by pip where they can be had. With ``--stack``: ten cubes at rest for ten seconds.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from time import process_time

import numpy as np

import fem_lie as fl
from benchmarks.peer_scenes import environment

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "demos"))

from demos import dominoes as demo

COUNT, FRICTION, LIMIT = 12, 1.0, 240.0
STEPS = (1e-3, 2e-4)
EDGE, HEIGHT, STACK_STEP, REST = 0.2, 10, 1e-2, 10.0

MUJOCO = """
import json, sys, time
import mujoco, numpy as np
g = json.load(sys.stdin)
soft = f'solref="{g["time_constant"]} 1"' if g["time_constant"] else ""
def body(at, half, kind):
    x, y, z = at
    a, b, c = half
    return (f'<body pos="{x} {y} {z}"><freejoint/><geom type="box" size="{a} {b} {c}" mass="1" '
            f'friction="{g["between"]} 0 0" priority="{kind}" condim="3" {soft}/></body>')
pairs = "".join(body(at, g["half"], 0) for at in g["places"])
xml = (f'<mujoco><option timestep="{g["step"]}" cone="elliptic" gravity="0 0 -9.81"/><worldbody>'
       f'<geom type="plane" size="9 9 1" friction="{g["floor"]} 0 0" priority="1" condim="3" '
       f'{soft}/>'
       + pairs + '</worldbody></mujoco>')
model = mujoco.MjModel.from_xml_string(xml)
data, n = mujoco.MjData(model), len(g["places"])
if g["push"]:
    arm = np.array(g["arm"])
    data.qvel[:3], data.qvel[4] = np.cross([0, g["push"], 0], arm), g["push"]
seconds, deep, rates, tilts = 0.0, 0.0, [], []
start = data.qpos.reshape(n, 7)[:, :3].copy()
for _ in range(g["steps"]):
    before = time.process_time()
    mujoco.mj_step(model, data)
    seconds += time.process_time() - before
    deep = max(deep, -float(data.contact.dist.min(initial=0.0)))
    rates.append(data.qvel.reshape(n, 6)[:, 4].tolist())
    tilts.append((2 * data.qpos.reshape(n, 7)[:, 5]).tolist())
moved = float(np.abs(data.qpos.reshape(n, 7)[:, :3] - start).max())
print(json.dumps([seconds, deep, moved, rates, tilts]))
"""


def peer(inside: Path, given: dict[str, object]) -> tuple[list[object], str]:
    """What MuJoCo finds, or why not."""
    try:
        done = subprocess.run(
            [inside, "-c", MUJOCO],
            input=json.dumps(given),
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=True,
        )
    except subprocess.TimeoutExpired:
        return [], f"no answer in {LIMIT:.0f} s"
    except subprocess.CalledProcessError as error:
        return [], f"failed: {(error.stderr or error.stdout).strip().splitlines()[-1]}"
    return list(json.loads(done.stdout.splitlines()[-1])), ""


def first_times(rates: np.ndarray, tilts: np.ndarray, times: np.ndarray) -> np.ndarray:
    """When each domino but the first begins to turn."""
    found = []
    for rate, tilt in zip(rates.T[1:], tilts.T[1:], strict=True):
        hit = np.flatnonzero(np.abs(rate) > 0.05 * demo.PUSH)
        found.append(times[hit[0]] - tilt[hit[0]] / rate[hit[0]] if len(hit) else np.nan)
    return np.array(found)


def row(name: str, step: float, error: float, deep: float, seconds: float, steps: int) -> str:
    """A line of the table."""
    return f"{step:8.0e} {name:16} {error:10.1e} {deep:10.1e} {1e6 * seconds / steps:10.1f}"


def compare_rows(inside: Path | None) -> None:
    """Dominoes."""
    reference = demo.ROW.times(demo.PUSH, COUNT)
    print(f"{'step':>8} {'':16} {'times':>10} {'overlap m':>10} {'us / step':>10}")
    for step in STEPS:
        scene, bodies = demo.dominoes(COUNT, FRICTION)
        steps = int(np.ceil(1.1 * reference[-1] / step))
        fl.GeneralisedAlpha().run(scene, duration=step, step=step, progress=False)
        before = process_time()
        result = fl.GeneralisedAlpha().run(scene, duration=steps * step, step=step, progress=False)
        seconds = process_time() - before
        error = np.abs(demo.times_of_impact(result, bodies) / reference - 1).max()
        assert result.contacts is not None
        deep = float(result.contacts.penetration.max())
        print(row("ours", step, float(error), deep, seconds, steps))
        for name, constant in (("MuJoCo, default", 0.0), ("MuJoCo, stiff", 2 * step)):
            if inside is None:
                continue
            given = {
                "step": step,
                "steps": steps,
                "time_constant": constant,
                "places": [body.frames[0, 0].tolist() for body in bodies],
                "half": [demo.ROW.thickness / 2, demo.WIDTH / 2, demo.ROW.height / 2],
                "floor": FRICTION,
                "between": 1e-5,
                "push": demo.PUSH,
                "arm": [-demo.ROW.thickness / 2, 0, demo.ROW.height / 2],
            }
            found, why = peer(inside, given)
            if why:
                print(f"{step:8.0e} {name:16} {why}")
                continue
            seconds, deep, _, rates, tilts = found
            times = step * np.arange(1, steps + 1)
            starts = first_times(np.array(rates), np.array(tilts), times)
            error = np.nanmax(np.abs(starts / reference - 1))
            print(row(name, step, float(error), float(str(deep)), float(str(seconds)), steps))


def stack() -> tuple[fl.Scene, list[fl.RigidBody]]:
    """Cubes on each other and on the floor."""
    scene, law = fl.Scene(gravity=(0, 0, -9.81)), fl.contact.Impact(0.5)
    below: fl.contact.ContactSurface = fl.contact.Plane(fl.ground(), (0, 0, 1))
    bodies = []
    for k in range(HEIGHT):
        at = 0, 0, (k + 0.5) * EDGE
        bodies.append(scene.add(fl.RigidBody(1.0, 3 * (EDGE**2 / 6,), at)))
        above = fl.contact.Box(bodies[-1].point("centre"), 3 * (EDGE,))
        scene.add(fl.contact.Contact(above, below, law))
        below = above
    return scene, bodies


def compare_stacks(inside: Path | None) -> None:
    """Cubes at rest."""
    scene, bodies = stack()
    fl.GeneralisedAlpha().run(scene, duration=STACK_STEP, step=STACK_STEP, progress=False)
    before = process_time()
    steps = round(REST / STACK_STEP)
    result = fl.GeneralisedAlpha().run(scene, duration=REST, step=STACK_STEP, progress=False)
    seconds = process_time() - before
    moved = max(np.abs(np.ptp(result.position(b.point("centre")), axis=0)).max() for b in bodies)
    assert result.contacts is not None
    print(f"{'step':>8} {'':16} {'moved m':>10} {'overlap m':>10} {'us / step':>10}")
    deep = float(result.contacts.penetration.max())
    print(row("ours", STACK_STEP, float(moved), deep, seconds, steps))
    if inside is None:
        return
    given = {
        "step": STACK_STEP,
        "steps": steps,
        "time_constant": 0.0,
        "places": [body.frames[0, 0].tolist() for body in bodies],
        "half": 3 * [EDGE / 2],
        "floor": 0.5,
        "between": 0.5,
        "push": 0.0,
        "arm": [0, 0, 0],
    }
    found, why = peer(inside, given)
    if why:
        print(f"MuJoCo {why}")
        return
    seconds, deep, moved = (float(str(each)) for each in found[:3])
    print(row("MuJoCo, default", STACK_STEP, moved, deep, seconds, steps))


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--stack", action="store_true", help="cubes at rest instead")
    chosen = parser.parse_args()
    inside = environment.interpreters("mujoco").get("mujoco")
    if inside is None:
        print("MuJoCo is not there")
    (compare_stacks if chosen.stack else compare_rows)(inside)


if __name__ == "__main__":
    main()

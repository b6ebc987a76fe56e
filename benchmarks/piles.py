"""Piles of balls that fall from a lattice and come to rest: cost per contact, beside MuJoCo's.

    tools/run python3 -m benchmarks.piles --balls 100 1000 10000 --steps 150

Balls of 0.05 m are dropped with a jitter into a box, or in a drum of 24 flat staves that turns by
3 rad/s and is half full (``--drum``), friction 0.3, without restitution, steps of 2e-3 s. Printed
are the most contacts in a step, the largest residual of the cones and overlap in any step, sweeps,
and microseconds of the processor per contact and step, of the last third of the steps. MuJoCo
(elliptic cones, its own softness, the same steps) has a process of its own in turn with ours, where
pip can have it; it has Newton's method up to 300 balls and conjugate gradients beyond, and says by
how much balls overlap.
"""

from __future__ import annotations

import argparse
import json
import subprocess
from time import process_time

import numpy as np

import fem_lie as fl
from benchmarks.peer_scenes import environment

RADIUS, FRICTION, STEP, DENSITY, GRAVITY, STAVES = 0.05, 0.3, 2e-3, 1000.0, 9.81, 24
SPIN, HEAVY = 3.0, 1e6
MASS = DENSITY * 4 / 3 * np.pi * RADIUS**3
PACKAGE, MODULE = "mujoco==3.3.7", "mujoco"
LIMIT = 240.0  # seconds for MuJoCo's answer
MOST_NEWTON = 300  # balls, of more of which MuJoCo's Newton gives no answer in that time

Wall = tuple[np.ndarray, np.ndarray]

PEER = """
import json, sys, time
import mujoco, numpy as np
given = json.load(sys.stdin)
z = lambda v: " ".join(repr(float(x)) for x in v)
balls = "".join(
    f'<body pos="{z(p)}"><freejoint/><geom type="sphere" size="{given["radius"]}"'
    f' mass="{given["mass"]}"/></body>' for p in given["places"])
walls = "".join(
    f'<geom type="plane" size="0 0 1" pos="{z(p)}" zaxis="{z(n)}"/>' for p, n in given["walls"])
xml = (f'<mujoco><option timestep="{given["step"]}" cone="elliptic" jacobian="sparse"'
       f' solver="{given["solver"]}"'
       f' gravity="0 0 -{given["gravity"]}"/><size memory="2G"/>'
       f'<default><geom friction="{given["friction"]} 0 0" condim="3"/></default>'
       f'<worldbody>{walls}{balls}</worldbody></mujoco>')
model = mujoco.MjModel.from_xml_string(xml)
data, seconds, contacts, deep = mujoco.MjData(model), [], [], []
for _ in range(given["steps"]):
    before = time.process_time()
    mujoco.mj_step(model, data)
    seconds.append(time.process_time() - before)
    contacts.append(int((data.contact.dist < 0).sum()))
    deep.append(float(-data.contact.dist.min(initial=0.0)))
print(json.dumps([seconds, contacts, deep]))
"""


def jittered(positions: np.ndarray) -> np.ndarray:
    return positions + 0.02 * RADIUS * np.random.default_rng(1).standard_normal(positions.shape)


def in_box(count: int, layers: int = 0) -> tuple[np.ndarray, list[Wall]]:
    """Centres, shape (count, 3), and positions and normals of walls and floor.

    So many ``layers``, or as many as there are across.
    """
    gap = 2.1 * RADIUS
    across = max(4, round((count / layers) ** (1 / 2) if layers else count ** (1 / 3)))
    half = 0.5 * across * gap
    grid = np.array(list(np.ndindex(count // across**2 + 1, across, across)))[:count, ::-1]
    angles = 2 * np.pi * np.arange(4) / 4
    out = np.stack([np.cos(angles), np.sin(angles), np.zeros(4)], axis=1)
    walls = [(np.zeros(3), np.array([0, 0, 1.0])), *((half * n, -n) for n in out)]
    return jittered(gap * (grid + 0.5) - [half, half, 0.0]), walls


def in_drum(count: int) -> tuple[np.ndarray, list[Wall]]:
    """Likewise: half full, its axis along y, with flat staves and ends."""
    gap, long = 2.1 * RADIUS, max(4, round(0.8 * count ** (1 / 3)))
    radius = gap * np.sqrt(2 * count / long / np.pi) + 2 * gap
    side = range(-int(radius / gap), int(radius / gap) + 1)
    grid = np.array([(x, y, z) for z in side for x in side for y in range(long)], dtype=float)
    positions = gap * (grid - [0, 0.5 * (long - 1), 0])
    inside = np.hypot(positions[:, 0], positions[:, 2]) < radius - 1.2 * RADIUS
    angles = 2 * np.pi * np.arange(STAVES) / STAVES
    out = np.stack([np.cos(angles), np.zeros(STAVES), np.sin(angles)], axis=1)
    ends = [np.array([0, sign, 0.0]) for sign in (-1, 1)]
    walls = [*((radius * n, -n) for n in out), *((0.5 * long * gap * n, -n) for n in ends)]
    return jittered(positions[inside][:count]), walls


def pile(positions: np.ndarray, walls: list[Wall], spin: float = 0.0) -> fl.Scene:
    """All of them, which touch each other and the walls: ground, or a drum that turns.

    The drum is free, so heavy that it goes on as if it were driven, and its weight is carried.
    """
    scene, moment = fl.Scene(gravity=(0, 0, -GRAVITY)), np.full(3, 0.4 * MASS * RADIUS**2)
    centres = [
        scene.add(fl.RigidBody(MASS, moment, position)).point("centre") for position in positions
    ]
    balls, law, held_by = (
        fl.contact.Vertices(centres, RADIUS),
        fl.contact.Impact(FRICTION),
        fl.ground(),
    )
    if spin:
        drum = scene.add(fl.RigidBody(HEAVY, np.full(3, HEAVY), (0, 0, 0), name="drum"))
        drum.add_velocity(omega=(0, spin, 0), about=drum.point("centre"))
        scene.add(fl.PointLoad(drum.point("centre"), (0, 0, HEAVY * GRAVITY)))
        held_by = drum.point("centre")
    scene.add(fl.contact.Contact(balls, balls, law))
    for at, normal in walls:
        scene.add(fl.contact.Contact(balls, fl.contact.Plane(held_by, normal, at), law))
    return scene


def ours(positions: np.ndarray, walls: list[Wall], steps: int, spin: float = 0.0) -> str:
    """A row of the table."""
    scene, scheme, seconds = pile(positions, walls, spin), fl.GeneralisedAlpha(radius=0.8), []
    last = steps - steps // 3
    for count in (last, steps):  # the last third is what the longer run takes more
        before = process_time()
        result = scheme.run(
            scene, duration=count * STEP, step=STEP, save_every=steps, progress=False
        )
        seconds.append(process_time() - before)
    solved = result.contacts
    assert solved is not None
    cost = (seconds[1] - seconds[0]) / max(solved.contacts[last:].sum(), 1.0)
    return (
        f"{solved.contacts.max():.0f} contacts, residual {solved.cone_residual.max():.1e}, "
        f"overlap {solved.penetration.max():.1e} m, sweeps {solved.sweeps[last:].mean():.0f} on "
        f"average, {1e6 * cost:.0f} µs per contact and step"
    )


def peer(positions: np.ndarray, walls: list[Wall], steps: int) -> str:
    """A row of MuJoCo's."""
    environment.PACKAGES["mujoco"], environment.IMPORTS["mujoco"] = [PACKAGE], MODULE
    for python in environment.candidates():
        inside = environment.folder(python, "mujoco") / "bin" / "python"
        if environment.has(inside, "mujoco") or environment.install(python, "mujoco"):
            break
    else:
        return f"MuJoCo is skipped: no Python here can have {PACKAGE} by pip"
    given = {
        "places": positions.tolist(),
        "walls": [(at.tolist(), normal.tolist()) for at, normal in walls],
        "radius": RADIUS,
        "mass": MASS,
        "friction": FRICTION,
        "gravity": GRAVITY,
        "step": STEP,
        "steps": steps,
        "solver": "Newton" if len(positions) <= MOST_NEWTON else "CG",
    }
    try:
        done = subprocess.run(
            [inside, "-c", PEER],
            input=json.dumps(given),
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=True,
        )
    except subprocess.TimeoutExpired:
        return f"MuJoCo: no answer in {LIMIT:.0f} s"
    seconds, contacts, deep = (np.array(each) for each in json.loads(done.stdout))
    last = steps - steps // 3
    cost = seconds[last:].sum() / max(contacts[last:].sum(), 1.0)
    return (
        f"{contacts.max()} contacts, overlap {deep.max():.1e} m, "
        f"{1e6 * cost:.0f} µs per contact and step"
    )


def main() -> None:
    """Print the rows of each number of balls."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--balls", type=int, nargs="+", default=[100, 1000], metavar="N")
    parser.add_argument("--steps", type=int, default=150)
    parser.add_argument("--layers", type=int, default=0, help="0: as many as balls across")
    parser.add_argument("--drum", action="store_true", help="a drum that turns, without MuJoCo")
    given = parser.parse_args()
    ours(*in_box(30), 30)  # what is compiled is there then
    for count in given.balls:
        if given.drum:
            found = ours(*in_drum(count), given.steps, SPIN)
            print(f"{count} balls, drum, fem_lie: {found}", flush=True)
            continue
        positions, walls = in_box(count, given.layers)
        for name, run in (("fem_lie", ours), ("MuJoCo", peer)):
            found = run(positions, walls, given.steps)
            print(f"{count} balls, box, {name}: {found}", flush=True)


if __name__ == "__main__":
    main()

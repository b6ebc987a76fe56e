"""Piles of balls that fall from a lattice and come to rest: cost per contact, beside MuJoCo's.

    tools/run python3 -m benchmarks.piles --balls 100 1000 10000 --steps 150

Balls of 0.05 m are dropped with a jitter into a box, or in a drum of 24 flat staves that turns by
3 rad/s and is half full (``--drum``), friction 0.3, without restitution, steps of 2e-3 s. With
``--rest`` half of the balls have 0.035 m, gravity is tilted by 10°, and they come to rest (500
steps). With ``--joint`` the scene has a pendulum, too, so that its steps are those of jointed and
flexible bodies. Printed are, of the first and the last fifth of the steps, the most contacts in a
step, the largest residual of the cones and overlap, the most energy that contacts add in a step
(over the energy that lifts all balls by 0.05 m; negative: they always dissipate), sweeps,
milliseconds of the processor per step, and microseconds per contact and step. MuJoCo (elliptic
cones, contacts as stiff as the step allows, the same steps) has a process of its own in turn with
ours, where pip can have it; it has Newton's method up to 300 balls and conjugate gradients beyond,
and at rest.
"""

from __future__ import annotations

import argparse
import json
import subprocess
from itertools import combinations_with_replacement
from time import process_time
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from benchmarks.peer_scenes import environment

RADIUS, SMALL, FRICTION, STEP, DENSITY, GRAVITY, STAVES = 0.05, 0.035, 0.3, 2e-3, 1000.0, 9.81, 24
SPIN, HEAVY = 3.0, 1e6
LIMIT = 240.0  # seconds for MuJoCo's answer
MOST_NEWTON = 300  # balls, of more of which MuJoCo's Newton gives no answer in that time

Wall = tuple[np.ndarray, np.ndarray]


class Pile(NamedTuple):
    """Balls and what holds them.

    Attributes:
        positions: Centres, shape (n, 3).
        radii: Radii, shape (n,).
        walls: Positions and normals of walls and floor.
        tilt: Angle between gravity and the vertical.
        spin: Angular velocity of the walls, about y.
        jointed: Whether the scene has a pendulum, too, which touches nothing.
    """

    positions: np.ndarray
    radii: np.ndarray
    walls: list[Wall]
    tilt: float = 0.0
    spin: float = 0.0
    jointed: bool = False

    @property
    def gravity(self) -> np.ndarray:
        """Gravity, shape (3,)."""
        return GRAVITY * np.array([np.sin(self.tilt), 0.0, -np.cos(self.tilt)])


PEER = """
import json, sys, time
import mujoco, numpy as np
given = json.load(sys.stdin)
z = lambda v: " ".join(repr(float(x)) for x in v)
balls = "".join(
    f'<body pos="{z(p)}"><freejoint/><geom type="sphere" size="{r}" mass="{m}"/></body>'
    for p, r, m in zip(given["places"], given["radii"], given["masses"]))
walls, spin, thick, heavy = "", given["spin"], 0.1, given["heavy"]
for p, n in given["walls"]:  # planes cannot turn: a drum has plates
    p = np.array(p) - (thick if spin else 0.0) * np.array(n)
    kind = f'type="box" size="1 1 {thick}"' if spin else 'type="plane" size="0 0 1"'
    walls += f'<geom {kind} pos="{z(p)}" zaxis="{z(n)}"/>'
if spin:
    walls = (f'<body gravcomp="1"><joint type="hinge" axis="0 1 0"/><inertial pos="0 0 0" '
             f'mass="{heavy}" diaginertia="{heavy} {heavy} {heavy}"/>{walls}</body>')
xml = (f'<mujoco><option timestep="{given["step"]}" cone="elliptic" jacobian="sparse"'
       f' solver="{given["solver"]}" gravity="{z(given["gravity"])}"/><size memory="500M"/>'
       f'<default><geom friction="{given["friction"]} 0 0" condim="3"'
       f' solref="{2 * given["step"]} 1" solimp="0.99 0.999 1e-4"/></default>'
       f'<worldbody>{walls}{balls}</worldbody></mujoco>')
model = mujoco.MjModel.from_xml_string(xml)
data, seconds, contacts, deep = mujoco.MjData(model), [], [], []
if spin:
    data.qvel[0] = spin
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


def box_of(across: int, gap: float) -> list[Wall]:
    """Floor and walls of a square box, given by balls across."""
    angles = 2 * np.pi * np.arange(4) / 4
    out = np.stack([np.cos(angles), np.sin(angles), np.zeros(4)], axis=1)
    return [(np.zeros(3), np.array([0, 0, 1.0])), *((0.5 * across * gap * n, -n) for n in out)]


def lattice(count: int, across: int, gap: float) -> np.ndarray:
    """Layers of so many balls across, from the floor on, shape (count, 3)."""
    grid = np.array(list(np.ndindex(count // across**2 + 1, across, across)))[:count, ::-1]
    half = 0.5 * across * gap
    return np.asarray(gap * (grid + 0.5) - [half, half, 0.0])


def in_box(count: int, layers: int = 0) -> Pile:
    """Balls above the floor: so many ``layers``, or as many as there are across."""
    gap = 2.1 * RADIUS
    across = max(4, round((count / layers) ** (1 / 2) if layers else count ** (1 / 3)))
    positions = jittered(lattice(count, across, gap))
    return Pile(positions, np.full(count, RADIUS), box_of(across, gap))


def at_rest(count: int) -> Pile:
    """Balls of two sizes, one and a half times as many layers as balls across."""
    gap, across, random = 2.1 * RADIUS, round((count / 1.5) ** (1 / 3)), np.random.default_rng(1)
    positions = lattice(count, across, gap) + 1e-3 * random.uniform(-1, 1, (count, 3))
    radii = np.where(random.random(count) < 0.5, RADIUS, SMALL)
    return Pile(positions, radii, box_of(across, gap), np.deg2rad(10))


def in_drum(count: int) -> Pile:
    """Half a drum of balls, its axis along y, with flat staves and ends."""
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
    positions = jittered(positions[inside][:count])
    return Pile(positions, np.full(len(positions), RADIUS), walls, spin=SPIN)


def masses_of(radii: np.ndarray) -> np.ndarray:
    """Masses of balls, shape (n,)."""
    return np.asarray(DENSITY * 4 / 3 * np.pi * radii**3)


def scene_of(pile: Pile) -> fl.Scene:
    """All of them, which touch each other and the walls: ground, or a drum that turns.

    The drum is free, so heavy that it goes on as if it were driven, and its weight is carried.
    """
    scene, law, held_by = fl.Scene(gravity=pile.gravity), fl.contact.Impact(FRICTION), fl.ground()
    surfaces = []
    for radius in np.unique(pile.radii):
        mass = float(masses_of(radius))
        moment = np.full(3, 0.4 * mass * radius**2)
        balls = [
            scene.add(fl.RigidBody(mass, moment, position))
            for position in pile.positions[pile.radii == radius]
        ]
        surfaces.append(fl.contact.Vertices([ball.point("centre") for ball in balls], radius))
    if pile.spin:
        drum = scene.add(fl.RigidBody(HEAVY, np.full(3, HEAVY), (0, 0, 0), name="drum"))
        drum.add_velocity(omega=(0, pile.spin, 0), about=drum.point("centre"))
        scene.add(fl.PointLoad(drum.point("centre"), (0, 0, HEAVY * GRAVITY)))
        held_by = drum.point("centre")
    if pile.jointed:
        at = np.abs(pile.positions).max() + np.array([1.0, 0, 1.0])
        arm = scene.add(fl.RigidBody(1.0, np.full(3, 0.01), at, name="pendulum"))
        hinge = at - (0.5, 0, 0)
        scene.add(fl.joints.Revolute(fl.ground(), arm.point("centre"), axis=(0, 1, 0), at=hinge))
    for one, other in combinations_with_replacement(surfaces, 2):
        scene.add(fl.contact.Contact(one, other, law))
    for at, normal in pile.walls:
        plane = fl.contact.Plane(held_by, normal, at)
        for balls in surfaces:
            scene.add(fl.contact.Contact(balls, plane, law))
    return scene


def fifth(contacts: np.ndarray, seconds: float, steps: int) -> str:
    """Cost of some steps."""
    cost = 1e6 * seconds / max(contacts.sum(), 1.0)
    return f"{1e3 * seconds / steps:.1f} ms per step, {cost:.0f} µs per contact and step"


def ours(pile: Pile, steps: int) -> list[str]:
    """Rows of the first and the last fifth of the steps."""
    scene, scheme, part = scene_of(pile), fl.GeneralisedAlpha(radius=0.8), steps // 5
    seconds = {0: 0.0}
    for count in (part, steps - part, steps):  # the last fifth is what the longer run takes more
        before = process_time()
        result = scheme.run(
            scene, duration=count * STEP, step=STEP, save_every=count, progress=False
        )
        seconds[count] = process_time() - before
    solved, rows = result.contacts, []
    assert solved is not None
    size = float(masses_of(pile.radii).sum()) * GRAVITY * RADIUS
    gained = -(solved.impact_loss + solved.friction_loss) / size
    for first, last in ((0, part), (steps - part, steps)):
        these = slice(first, last)
        rows.append(
            f"{solved.contacts[these].max():.0f} contacts, "
            f"residual {solved.cone_residual[these].max():.1e}, "
            f"overlap {solved.penetration[these].max():.1e} m, "
            f"energy gained {gained[these].max():.1e}, "
            f"sweeps {solved.sweeps[these].mean():.0f} on average, "
            + fifth(solved.contacts[these], seconds[last] - seconds[first], part)
        )
    return rows


def peer(pile: Pile, steps: int) -> list[str]:
    """Rows of MuJoCo's."""
    inside = environment.interpreters("mujoco").get("mujoco")
    if inside is None:
        return ["MuJoCo is skipped"]
    given = {
        "places": pile.positions.tolist(),
        "walls": [(at.tolist(), normal.tolist()) for at, normal in pile.walls],
        "radii": pile.radii.tolist(),
        "masses": masses_of(pile.radii).tolist(),
        "friction": FRICTION,
        "gravity": pile.gravity.tolist(),
        "spin": pile.spin,
        "heavy": HEAVY,
        "step": STEP,
        "steps": steps,
        "solver": "CG" if pile.tilt or len(pile.positions) > MOST_NEWTON else "Newton",
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
        return [f"MuJoCo: no answer in {LIMIT:.0f} s"]
    seconds, contacts, deep = (np.array(each) for each in json.loads(done.stdout))
    part, rows = steps // 5, []
    for these in (slice(0, part), slice(steps - part, steps)):
        rows.append(
            f"{contacts[these].max()} contacts, overlap {deep[these].max():.1e} m, "
            + fifth(contacts[these], seconds[these].sum(), part)
        )
    return rows


def main() -> None:
    """Print the rows of each number of balls."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--balls", type=int, nargs="+", default=[100, 1000], metavar="N")
    parser.add_argument("--steps", type=int, default=0, help="default: 150, at rest 500")
    parser.add_argument("--layers", type=int, default=0, help="0: as many as balls across")
    parser.add_argument("--drum", action="store_true", help="a drum that turns")
    parser.add_argument("--joint", action="store_true", help="a pendulum, too, without MuJoCo")
    parser.add_argument("--rest", action="store_true", help="two sizes, until they are at rest")
    given = parser.parse_args()
    steps = given.steps or (500 if given.rest else 150)
    ours(in_box(30), 30)  # what is compiled is there then
    for count in given.balls:
        if given.drum:
            pile = in_drum(count)
        else:
            pile = at_rest(count) if given.rest else in_box(count, given.layers)
        pile = pile._replace(jointed=given.joint)
        peers = (("fem_lie", ours), ("MuJoCo", peer))
        for name, run in peers[:1] if given.joint else peers:
            for when, row in zip(("first fifth", "last fifth"), run(pile, steps), strict=False):
                print(f"{count} balls, {name}, {when}: {row}", flush=True)


if __name__ == "__main__":
    main()

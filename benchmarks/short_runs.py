"""Short runs of all schemes on all kinds of bodies, for :mod:`benchmarks.in_turns`.

A case builds a scene, runs it by one scheme and returns the number of iterations and the end of the
run. It takes between 0.2 and 3 seconds of the processor and uses only the public interface of
``fem_lie``, so that it runs with another version of the package, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np

import fem_lie as fl
from benchmarks import (
    asynchronous,
    conserving_any,
    conserving_contact,
    conserving_mixed,
    hamel,
    multi_rate,
    piles,
    pressed_cylinder,
    rings,
    swinging_cable,
)
from demos import (
    catenary,
    cooks_membrane,
    crossing_beams,
    deep_arch,
    double_pendulum,
    euler_column,
    governor,
    hemisphere,
    hinged_roof,
    net_scene,
    rod_in_box,
    rollup,
    rotating_beam,
    slider_crank,
    soft_bars,
    truss_deployment,
    truss_scene,
    tumbling_plate,
    wave_in_a_net,
)
from tests.random_scenes import MIXED, MIXED_CONSERVING, Wanted, random_scene
from tests.scene_builder import build
from tests.scene_data import SceneData


class Scheme(Protocol):
    """A scheme in time, of any version of the package."""

    def run(
        self,
        scene: fl.Scene,
        *,
        duration: float,
        step: float,
        save_every: int = ...,
        progress: bool = ...,
    ) -> fl.Result:
        """The motion of a scene."""


class Outcome(NamedTuple):
    """What two versions compare besides time.

    Attributes:
        iterations: Of the whole run; 0 where there are none.
        end: Positions of all nodes at the end, or the eigenvalues, of any shape.
    """

    iterations: int
    end: np.ndarray


class Case(NamedTuple):
    """A run.

    Attributes:
        scheme: Name of the scheme or the analysis.
        name: What is in the scene; of one scheme no two are the same.
        run: Builds the scene, runs it and returns the outcome.
    """

    scheme: str
    name: str
    run: Callable[[], Outcome]


class Motion(NamedTuple):
    """A scene that a scheme in time runs with equal steps.

    Attributes:
        scene: Builds it.
        step: Size of a step, s.
        steps: Their number.
    """

    scene: Callable[[], fl.Scene]
    step: float
    steps: int


MIXED_SEEDS, CONSERVING_SEEDS = (0, 1, 2, 3), (0, 1, 3, 4, 7)
"""Of random scenes; those of energy-momentum have nothing that it refuses."""

ALPHA = fl.GeneralisedAlpha(radius=0.8)
CONSERVING, DECAYING = fl.EnergyMomentum(), fl.EnergyDecaying()
RUBBER = fl.sections.NeoHooke(1e4, 0.3, 1.0)
SLENDER = fl.Section.circle(0.002, fl.Material(E=70e9, nu=0.3, density=2700.0))
SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))
DOWN = (0.0, 0.0, -9.81)


# --- how a scene is run ---------------------------------------------------------------------------


def moved(scheme: Scheme, motion: Motion) -> Outcome:
    """One state in ten is kept."""
    build_scene, step, steps = motion
    every = 10 if steps % 10 == 0 else 1
    result = scheme.run(
        build_scene(), duration=steps * step, step=step, save_every=every, progress=False
    )
    return Outcome(int(result.iterations[-1]), result.frames[-1, :, 0])


def balanced(build_scene: Callable[[], fl.Scene], load_steps: int = 1) -> Outcome:
    """Equilibrium under all loads."""
    result = fl.statics(build_scene(), load_steps=load_steps)
    return Outcome(result.total_iterations, result.frames[-1, :, 0])


def followed(build_scene: Callable[[], fl.Scene]) -> Outcome:
    """Equilibrium by the arc length."""
    result = fl.follow_loads(build_scene())
    return Outcome(result.total_iterations, result.frames[-1, :, 0])


def traced(build_scene: Callable[[], fl.Scene]) -> Outcome:
    """The path of equilibria with its critical points."""
    path = fl.follow_path(build_scene())
    return Outcome(path.total_iterations, path.frames[-1, :, 0])


def _built(data: SceneData) -> fl.Scene:
    return build(data).scene


def random_motions(scheme: Scheme, wanted: Wanted, seeds: Sequence[int]) -> Outcome:
    """Several random scenes, one after the other."""
    outcomes = []
    for seed in seeds:
        data = random_scene(seed, wanted)
        motion = Motion(partial(_built, data), data.duration / data.steps, data.steps)
        outcomes.append(moved(scheme, motion))
    return Outcome(sum(o.iterations for o in outcomes), np.concatenate([o.end for o in outcomes]))


# --- scenes that are in no demo -------------------------------------------------------------------


def pendulum(case: int, elements: int = 10) -> fl.Scene:
    """The double pendulum of beams."""
    return double_pendulum.pendulum(case, elements)[0]


def pendulum_beside(*beside: str) -> fl.Scene:
    """The double pendulum with other things at rest in its scene."""
    scene = pendulum(1)
    if "cable" in beside:
        cable = scene.add(fl.Cable.straight((5, 0, 0), (6, 0, 0), SLENDER, cells=2))
        cable.clamp(cable.point("start"))
    if "ball" in beside:
        ball = scene.add(fl.RigidBody(1.0, 4e-3 * np.eye(3), (9, 0, 0.11)))
        floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
        scene.add(
            fl.contact.Contact(
                fl.contact.Sphere(ball.point("centre"), 0.1), floor, fl.contact.Penalty(1e4)
            )
        )
    return scene


def truss(cells: int, elements: int) -> fl.Scene:
    """The deployable truss of thin tubes, with all its feet driven."""
    inner, outer = (0.5 * diameter for diameter in truss_deployment.DIAMETERS["thin"])
    section = fl.Section.tube(inner, outer, truss_deployment.STEEL)
    return truss_scene.Truss(cells, section, elements, 4, fl.schemes.MatrixTerms()).scene


def chain(links: int) -> fl.Scene:
    """Rigid rods on ball joints that fall from the horizontal."""
    scene, before = fl.Scene(gravity=DOWN), fl.ground()
    length, mass, radius = 2.0 / links, 3.0 / links, 0.2 / links
    across = mass * (length**2 / 12 + radius**2 / 4)
    for k in range(links):
        moments = (mass * radius**2 / 2, across, across)
        rod = scene.add(fl.RigidBody(mass, moments, ((k + 0.5) * length, 0, 0)))
        scene.add(fl.joints.Spherical(before, rod.point("centre"), at=(k * length, 0, 0)))
        before = rod.point("centre")
    return scene


def flying_bodies(count: int) -> fl.Scene:
    """Rigid bodies beside each other that spin freely."""
    scene, spins = fl.Scene(), np.random.default_rng(1).normal(size=(count, 3))
    for k, spin in enumerate(spins):
        body = scene.add(fl.RigidBody(1.0, (1, 1, 2), (3.0 * k, 0, 0)))
        body.add_velocity(omega=spin, about=body.point("centre"))
    return scene


def rod(formulation: fl.elements.BeamFormulation) -> fl.Scene:
    """A rod without shear that is clamped and swings under its weight."""
    section = fl.Section.from_stiffness([1e4] * 3 + [1.0] * 3, mass=0.1, polar=2e-5)
    scene = fl.Scene(gravity=(0, -9.81, 0))
    body = scene.add(
        fl.Rod(fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 20), section, formulation=formulation)
    )
    scene.add(fl.Clamp(body.point("start")))
    return scene


def ancf_beam() -> fl.Scene:
    """A beam of position-gradient coordinates on a hinge."""
    section = fl.Section.from_stiffness([1e4, 4e3, 4e3, 1.0, 1.0, 1.0], mass=1.0, polar=1e-3)
    scene = fl.Scene(gravity=DOWN)
    beam = scene.add(fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), section, cells=8))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
    return scene


def sheet(body: type[fl.ThinShell | fl.AncfShell]) -> fl.Scene:
    """A curved sheet on hinges along one edge that falls."""

    def bent(a: float, b: float) -> np.ndarray:
        return np.array([a, b, 0.1 * np.cos(2 * a) + 0.05 * b * b])

    layer = fl.ShellSection.layer(0.02, fl.Material(1e6, 0.3, 100.0))
    scene = fl.Scene(gravity=DOWN)
    scene.add(body(fl.mesh.smooth_patch(bent, (3, 3)), layer)).hinge("a=0")
    return scene


def brick() -> fl.Scene:
    """A soft brick that tumbles and falls."""
    scene = fl.Scene(gravity=DOWN)
    body = scene.add(fl.Solid.brick((1.0, 0.4, 0.2), RUBBER, cells=(4, 3, 2)))
    body.add_velocity(omega=(1.0, 6.0, 0.3), about=(0.5, 0.2, 0.1))
    return scene


def reduced_crank() -> fl.Scene:
    """The slider-crank with a reduced-order rod, its modes included."""
    part, rod_in_full = fl.Scene(), slider_crank.flexible(16, 2e9)
    part.add(rod_in_full)
    points = [rod_in_full.point(8), rod_in_full.point("start"), rod_in_full.point("end")]
    inner = fl.reduction.inertial_modes(part, points, 8, spinning=True)
    return slider_crank.mechanism(fl.reduction.reduced_order_body(part, points, inner))[0]


def slider_on_beam() -> fl.Scene:
    """A body with a collar on a soft cantilever that sags."""
    scene = fl.Scene(gravity=DOWN)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SOFT, cells=8))
    scene.add(fl.Clamp(beam.point("start")))
    body = scene.add(fl.RigidBody(0.05, (1e-5, 2e-5, 2e-5), (0.2, 0, 0)))
    scene.add(fl.joints.Collar(beam, body.point("centre"), at=(0.2, 0, 0)))
    return scene


def dropped_beam() -> fl.Scene:
    """A soft beam that drops aslant on the ground, with impacts and friction."""
    scene = fl.Scene(gravity=DOWN)
    beam = scene.add(fl.Beam.straight((0, 0, 0.03), (1, 0, 0.13), SOFT, cells=8))
    nodes = fl.contact.Vertices([fl.extend.Point(beam, n) for n in range(len(beam.frames))], 0.01)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(fl.contact.Contact(nodes, floor, fl.contact.Impact(friction=0.3)))
    return scene


def beams_at_rest() -> fl.Scene:
    """A light beam on two others, on which it rests by penalties."""
    scene = fl.Scene(gravity=(0, 0, -0.1))
    ends = [((x, -0.5, 0), (x, 0.5, 0)) for x in (-0.3, 0.3)]
    lower = [scene.add(fl.Beam.straight(*both, SOFT, cells=4)) for both in ends]
    upper = scene.add(fl.Beam.straight((-0.5, 0, 0.02), (0.5, 0, 0.02), SOFT, cells=4))
    for beam in lower:
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.Clamp(beam.point("end")))
        scene.add(
            fl.contact.Contact(
                fl.contact.Line(upper, 0.01), fl.contact.Line(beam, 0.01), fl.contact.Penalty(1e4)
            )
        )
    return scene


def thrown_plate() -> fl.Scene:
    """The tumbling plate of shell elements."""
    return tumbling_plate.thrown("hr", 4, 3)[0]


def rope_and_ball() -> fl.Scene:
    """A cable that flies with a ball at its end, held off its centre."""
    cord = fl.Section.from_stiffness([100.0] * 3 + [1e-3] * 3, mass=0.01)
    scene = fl.Scene()
    cable = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), cord, cells=8))
    ball = scene.add(fl.RigidBody(0.02, (1e-5, 2e-5, 2e-5), (1.1, 0, 0)))
    ball.velocities[0, [1, 5]] = 0.2, 2.0
    scene.add(fl.joints.Spherical(cable.point("end"), ball.point("centre"), at=(1, 0, 0)))
    return scene


def hung_cable() -> fl.Scene:
    """A cable from node to node of the catenary."""
    scene = fl.Scene(gravity=(0, -catenary.GRAVITY, 0))
    cable = scene.add(catenary.laid("cable", 512))
    assert isinstance(cable, fl.Cable)
    cable.pin(cable.point("start"), cable.point("end"))
    return scene


def membrane() -> fl.Scene:
    """Cook's membrane of compressible rubber."""
    cells = fl.mesh.parametric_volume(cooks_membrane.position, (24, 24, 1))
    panel = fl.Solid(cells, fl.sections.NeoHooke(240.0, 0.3), name="panel")
    panel.clamp("a=0")
    panel.model.held[:, 2] = True
    scene = fl.Scene()
    scene.add(panel)
    scene.add(fl.loads.FaceLoad(panel, "a=1", (0, 10.0 / 16, 0)))
    return scene


def wave() -> fl.Scene:
    """A net that is hit in its middle."""
    return wave_in_a_net.square_net(20)[0]


def pinched() -> fl.Scene:
    """A quarter of the pinched hemisphere."""
    return hemisphere.pinched(0.04, hemisphere.quarter(10))


# --- cases that differ from these in how they are run ---------------------------------------------


def governed() -> Outcome:
    """The governor with variable steps."""
    scheme, size = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9), 1e-3
    steps = fl.schemes.AdaptiveStep(
        governor.TOLERANCE * size, first=size / governor.FINER, largest=size
    )
    result = scheme.run(governor.governor(1.0), duration=2.0, step=steps, progress=False)
    return Outcome(int(result.iterations[-1]), result.frames[-1, :, 0])


def two_rates() -> Outcome:
    """A beam, one half of which makes steps ten times smaller."""
    scene, lower = multi_rate.swinging(20)
    return moved(fl.schemes.MultiRate({lower: 10}), Motion(lambda: scene, 1e-3, 100))


def pressed_ring() -> Outcome:
    """A shell that is pressed by a plane."""
    result = pressed_cylinder.press(8)[0]
    return Outcome(result.total_iterations, result.frames[-1, :, 0])


def crossed_beams() -> Outcome:
    """A beam that is led across another one."""
    record = crossing_beams.main(pictures=False)
    return Outcome(round(100 * record["iterations_per_step"]), np.array(record["moved"]))


def wound_rope() -> Outcome:
    """A rope that is pulled through rings with friction."""
    record = rings.capstan(90, 4, 8, 0.3)
    return Outcome(round(rings.STEPS * record["iterations"]), np.array([record["ratio"]]))


def explicit(build_scene: Callable[[], fl.Scene], steps: int, part: float) -> Outcome:
    """Steps of a part of the largest stable one."""
    scheme, scene = fl.Explicit(), build_scene()
    step = part * scheme.stable_step(scene)
    return moved(scheme, Motion(lambda: scene, step, steps))


def columns() -> Outcome:
    """Linear buckling of all columns of the demo."""
    loads = [fl.buckling(euler_column.column(ends, 40)[0], 2).factors for ends in euler_column.BETA]
    return Outcome(0, np.concatenate(loads))


def spinning_blade() -> Outcome:
    """Frequencies of a blade at several speeds."""
    scene, found = rotating_beam.blade(32)[0], []
    for spin in (0.0, 2.0, 5.0, 10.0):
        found.append(fl.vibrations(scene, 4, spin=(0, 0, spin)).frequencies)
    return Outcome(0, np.concatenate(found))


def case_of_contact(name: str, stiffness: float) -> fl.Scene:
    """One of the scenes of impacts."""
    return conserving_contact.CASES[name][0](stiffness)[0]


def cable_of(name: str, cells: int, element: str) -> fl.Scene:
    """One of the cables that swing."""
    scene = fl.Scene(gravity=swinging_cable.GRAVITY)
    scene.add(swinging_cable.SCENES[name][0](cells, element))
    return scene


# --- all of them ----------------------------------------------------------------------------------


def tumbling_in_box() -> fl.Scene:
    """A rod that falls within a box, with impacts and friction."""
    return rod_in_box.rod_in_box("square", fl.contact.Impact(0.2))[0]


def net_in_rings() -> fl.Scene:
    """A net that flies to a ball, with a rope in its edge, through rings, whose ends are pulled."""
    rings, cells, radius = 2, 2, 0.3
    thread = fl.Section.circle(1e-3, fl.Material(E=1e8, nu=0.3, density=1000.0))
    flat, cables, edge = net_scene.hexagons(rings, cells)
    positions = np.column_stack([flat, np.full(len(flat), radius + 0.01)])
    along = positions[cables[rings - 1][:-cells]]
    tied = 0.5 * (along[0] + along[-1])
    tied[:2] *= 1.0 + 0.3 / np.linalg.norm(tied[:2])
    parts = (np.arange(cells) / cells)[:, np.newaxis]
    out, back = tied + parts * (along[0] - tied), tied + parts * (along[-1] - tied)
    path = np.vstack([out, along, back[::-1]])
    scene = fl.Scene()
    net = scene.add(fl.Net(positions, cables, thread, formulation=net_scene.LAID, name="net"))
    rope = scene.add(fl.Net(path, [range(len(path))], thread, formulation=net_scene.LAID))
    corners = [edge[k * rings] for k in range(6)]
    masses = [
        scene.add(fl.RigidBody(0.02, np.full(3, 1e-6), position))
        for position in (*positions[corners], tied)
    ]
    held = [*(net.point(node) for node in corners), rope.point(0), rope.point(len(path) - 1)]
    for point, mass in zip(held, [*masses, masses[-1]], strict=True):
        scene.add(fl.joints.Spherical(point, mass.point("centre")))
    for body in scene.bodies:
        body.add_velocity((0.0, 0.0, -10.0))
    stiffness = 2.0 * thread.stiffness[0, 0] * rings * cells
    knots = fl.contact.Rings([net.point(node) for node in edge])
    through = fl.contact.Penalty(stiffness)
    scene.add(fl.contact.Contact(fl.contact.Rope(rope), knots, through))
    nodes = [body.point(n) for body in (net, rope) for n in range(len(body.model.frames))]
    ball = fl.contact.Sphere(fl.ground(), radius)
    scene.add(fl.contact.Contact(fl.contact.Vertices(nodes, 1e-3), ball, fl.contact.Penalty(2e2)))
    pull = fl.loads.PiecewiseLinear((0.0, 0.02, 0.03), (0.0, 0.0, 10.0))
    scene.add(fl.PointLoad(masses[-1].point("centre"), force=(0.0, 0.0, -1.0), history=pull))
    return scene


ALPHA_MOTIONS = {
    "double pendulum": Motion(partial(pendulum, 1), 1e-4, 5000),
    "truss of two cells": Motion(partial(truss, 2, 10), 2e-3, 100),
    "chain of 30 links": Motion(partial(chain, 30), 1e-3, 1000),
    "200 flying bodies": Motion(partial(flying_bodies, 200), 1e-3, 3000),
    "collar on a beam": Motion(slider_on_beam, 1e-3, 500),
    "swinging cable": Motion(partial(cable_of, "swinging", 16, "cable"), 5e-4, 3000),
    "taut discrete cable": Motion(partial(cable_of, "taut", 32, "discrete"), 5e-4, 2000),
    "Kirchhoff rod": Motion(partial(rod, fl.elements.KirchhoffRod()), 1e-3, 1000),
    "discrete rod": Motion(partial(rod, fl.elements.DiscreteRod()), 1e-3, 1000),
    "net with a rope in rings": Motion(net_in_rings, 2e-4, 200),
    "tumbling plate": Motion(thrown_plate, 1e-3, 300),
    "thin shell": Motion(partial(sheet, fl.ThinShell), 1e-3, 500),
    "ANCF beam": Motion(ancf_beam, 1e-3, 500),
    "ANCF shell": Motion(partial(sheet, fl.AncfShell), 1e-3, 600),
    "solid brick": Motion(brick, 1e-3, 400),
    "reduced slider-crank": Motion(reduced_crank, 1e-3, 500),
    "rod in a box, impacts": Motion(tumbling_in_box, 1e-4, 20_000),
    "pile of 64 balls": Motion(lambda: piles.scene_of(piles.in_box(64)), piles.STEP, 400),
    "dropped beam, impacts": Motion(dropped_beam, 1e-3, 150),
}
CONSERVING_MOTIONS = {
    "double pendulum": Motion(partial(pendulum, 1), 1e-4, 3000),
    "pendulum, cable at rest": Motion(partial(pendulum_beside, "cable"), 1e-4, 400),
    "pendulum, ball at rest": Motion(partial(pendulum_beside, "ball"), 1e-4, 1000),
    "tumbling plate": Motion(thrown_plate, 1e-3, 200),
    "beam and cable": Motion(conserving_mixed.beam_and_cable, 1e-3, 300),
    "solid hub, beams, cable": Motion(conserving_mixed.solid_hub, 1e-3, 150),
    "whirling cable": Motion(partial(cable_of, "whirling", 8, "cable"), 1e-3, 400),
    "falling net": Motion(conserving_any.falling_net, 1e-3, 400),
    "flapping thin plate": Motion(conserving_any.flapping_plate, 1e-3, 200),
    "tumbling brick": Motion(conserving_any.tumbling_brick, 1e-3, 300),
    "ball in a box": Motion(partial(case_of_contact, "box", 1e4), 1e-2, 400),
    "beams at rest on beams": Motion(beams_at_rest, 1e-3, 100),
    "ring on a cable": Motion(partial(rings.free, "cable", "body"), 5e-4, 60),
}
DECAYING_MOTIONS = {
    "double pendulum": Motion(partial(pendulum, 1), 1e-4, 2000),
    "crane with a cable": Motion(conserving_mixed.crane, 1e-3, 200),
}
VARIATIONAL_MOTIONS = {
    "double pendulum": Motion(partial(pendulum, 1), 1e-4, 1000),
    "chain of 10 links": Motion(partial(chain, 10), 1e-3, 700),
}


def motions(name: str, scheme: Scheme, scenes: Mapping[str, Motion]) -> tuple[Case, ...]:
    """All scenes of one scheme."""
    return tuple(Case(name, of, partial(moved, scheme, motion)) for of, motion in scenes.items())


CASES: tuple[Case, ...] = (
    *motions("generalised-α", ALPHA, ALPHA_MOTIONS),
    Case("generalised-α", "governor, variable steps", governed),
    Case("generalised-α", "crossing beams", crossed_beams),
    Case(
        "generalised-α", "random mixed scenes", partial(random_motions, ALPHA, MIXED, MIXED_SEEDS)
    ),
    *motions("energy-momentum", CONSERVING, CONSERVING_MOTIONS),
    Case(
        "energy-momentum",
        "random mixed scenes",
        partial(random_motions, CONSERVING, MIXED_CONSERVING, CONSERVING_SEEDS),
    ),
    *motions("energy-decaying", DECAYING, DECAYING_MOTIONS),
    *motions("variational", fl.schemes.Variational(), VARIATIONAL_MOTIONS),
    *motions(
        "Hamel",
        fl.schemes.Hamel(),
        {"rolling disc": Motion(lambda: hamel.rolling()[0], 1e-3, 5000)},
    ),
    Case("explicit", "wave in a net", partial(explicit, wave, 2000, 0.9)),
    Case("explicit", "rope and ball", partial(explicit, rope_and_ball, 400, 0.1)),
    *motions(
        "asynchronous",
        fl.schemes.Asynchronous(),
        {"net with short edges": Motion(lambda: asynchronous.net(10, 2), 0.01, 40)},
    ),
    Case("multi-rate", "beam of two rates", two_rates),
    *motions(
        "composed",
        fl.schemes.Composed(),
        {"soft pendulum": Motion(soft_bars.soft_pendulum, 2e-3, 200)},
    ),
    *motions(
        "composed, variational",
        fl.schemes.Composed(fl.schemes.Variational()),
        {"soft pendulum": Motion(soft_bars.soft_pendulum, 2e-3, 100)},
    ),
    Case("statics", "roll-up", partial(balanced, lambda: rollup.cantilever(600, 1e8)[0], 6)),
    Case("statics", "hung cable", partial(balanced, hung_cable)),
    Case("statics", "membrane of solids", partial(balanced, membrane)),
    Case("statics", "rope in rings", wound_rope),
    Case("statics", "ring pressed by a plane", pressed_ring),
    Case("arc length", "pinched hemisphere", partial(followed, pinched)),
    Case("path", "hinged roof", partial(traced, lambda: hinged_roof.roof(6.35, 5)[0])),
    Case("path", "deep arch", partial(traced, lambda: deep_arch.arch(16, "stretchable")[0])),
    Case("buckling", "four columns", columns),
    Case("vibrations", "turning blade", spinning_blade),
)
"""All of them, by scheme."""

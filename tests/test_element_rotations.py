"""Elements that rotate too far: a warning near the limit, an error beyond it."""

import re

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

BEAMS = {
    "geodesic": fl.elements.GeodesicBeam(),
    "director 1": fl.elements.DirectorBeam(1),
    "director 2": fl.elements.DirectorBeam(2),
    "Kirchhoff": fl.elements.KirchhoffRod(),
}
EI, LENGTH = 100.0, 10.0


def bent(
    cells: int, angle: float, formulation: fl.elements.BeamFormulation
) -> tuple[fl.Scene, fl.Beam]:
    """A cantilever under the moment that rotates each of its elements by an angle."""
    scene, section = fl.Scene(), fl.Section.from_stiffness([1e4] * 3 + [EI] * 3)
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=cells, formulation=formulation)
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, angle * cells * EI / LENGTH)))
    return scene, beam


def moments(formulation: fl.elements.BeamFormulation, turns: np.ndarray) -> np.ndarray:
    """Bending moment over stiffness of one element in arcs of several rotations, by differences."""
    beam = fl.Beam.straight(
        (0, 0, 0),
        (1, 0, 0),
        fl.Section.from_stiffness([0.0, 0.0, 0.0, 1.0, 1.0, 1.0] + 1e-12 * np.ones(6)),
        cells=1,
        formulation=formulation,
    )
    assembly = beam.model.assemble([beam.model])

    def energy(turn: float) -> float:
        H = np.empty_like(beam.frames)
        angles = turn * beam.frames[:, 0, 0]
        for node, angle in enumerate(angles):
            H[assembly.order[node]] = lie.frame(beam.frames[node, 0], lie.so3_exp([0, 0, angle]))
        return assembly.energy(H)

    return np.array([(energy(t + 1e-4) - energy(t - 1e-4)) / 2e-4 for t in turns])


@pytest.mark.parametrize("name", BEAMS)
def test_limit_is_where_the_moment_of_an_arc_stops_growing(name):
    """Up to the limit a larger rotation needs a larger moment; plain directors end there."""
    formulation = BEAMS[name]
    limit = formulation.largest_turn
    below = moments(formulation, np.linspace(0.1, 0.99 * limit, 12))
    assert (np.diff(below) > 0).all()


def test_node_inside_of_three_is_stable_up_to_the_limit_and_no_farther():
    """Second derivative of the energy in the rotation of the middle node, with both ends held."""
    g, limit = 1 / np.sqrt(3), fl.elements.DirectorBeam(2).largest_turn

    def energy(middle: float, turn: float) -> float:
        phi, total = np.array([0.0, middle, turn]), 0.0
        for p in (-g, g):
            N = np.array([p * (p - 1) / 2, 1 - p * p, p * (p + 1) / 2])
            dN = np.array([p - 0.5, -2 * p, p + 0.5])
            square = N @ np.cos(phi - phi[:, np.newaxis]) @ N  # of the interpolated directors
            curvature = 2 * N @ np.sin(phi - phi[:, np.newaxis]) @ dN
            total += ((2 - square) * curvature) ** 2 / 4
        return total

    def lowest(turn: float) -> float:
        h, K = 1e-4, np.empty((2, 2))
        steps = np.eye(2) * h
        at = np.array([turn / 2, turn])
        for i, a in enumerate(steps):
            for j, b in enumerate(steps):
                corners = [(1, at + a + b), (-1, at + a - b), (-1, at - a + b), (1, at - a - b)]
                K[i, j] = sum(sign * energy(*position) for sign, position in corners) / (4 * h * h)
        return float(np.linalg.eigvalsh(K)[0])

    assert lowest(limit - 1e-3) > 0 > lowest(limit + 1e-3)


@pytest.mark.parametrize("name", BEAMS)
def test_elements_far_from_the_limit_are_silent(name):
    scene, beam = bent(8, 0.8, BEAMS[name])
    end = fl.statics(scene).rotation(beam.point("end"))[-1]
    np.testing.assert_allclose(end, lie.so3_exp([0, 0, 6.4]), atol=0.05)


@pytest.mark.parametrize(("name", "angle"), [("geodesic", 2.9), ("director 1", 2.9)])
def test_statics_warns_near_the_limit(name, angle):
    scene, _ = bent(3, angle, BEAMS[name])
    with pytest.warns(
        fl.schemes.CoarseElementsWarning, match=r"element \d of .* rotates by 2\.9 rad"
    ):
        fl.statics(scene, load_steps=3)


def test_elements_that_would_have_to_turn_by_more_than_pi_are_named():
    """At π the rotation has two logarithms: there is no equilibrium, and the message says why."""
    scene, beam = bent(2, 3.3, fl.elements.GeodesicBeam())
    with (
        pytest.warns(fl.schemes.CoarseElementsWarning),
        pytest.raises(fl.ConvergenceError, match=rf"element \d of {beam.label} rotates by 3"),
    ):
        fl.statics(scene, load_steps=4, newton=fl.schemes.Newton(smallest_step=0.05))


@pytest.mark.parametrize("road", [fl.statics, fl.follow_path], ids=["statics", "path"])
def test_directors_of_three_nodes_do_not_fold_in_silence(road):
    """160 was applied, 6620 was in the elements: an error, or a path that ends there."""
    scene, beam = bent(4, 3.6, fl.elements.DirectorBeam(2))
    if road is fl.follow_path:
        with pytest.warns(fl.schemes.CoarseElementsWarning):
            path = road(scene)
        assert not path.complete and 0.5 < path.factors[-1] < 1.0
        assert re.search(rf"element \d of {beam.label} rotates by", path.reason)
        return
    with (
        pytest.warns(fl.schemes.CoarseElementsWarning),
        pytest.raises(fl.ConvergenceError, match="fold at"),
    ):
        road(scene, load_steps=4, newton=fl.schemes.Newton(smallest_step=0.02))


@pytest.mark.parametrize("run", ["generalised alpha", "conserving", "variable steps"])
def test_motion_ends_where_an_element_folds(run):
    """A cantilever swings with more energy than its only element takes before it folds."""
    scene, section = fl.Scene(), fl.Section.rectangle(0.1, 0.1, fl.Material(1.2e5, 0.0, 1e3))
    beam = scene.add(
        fl.Beam.straight(
            (0, 0, 0), (1, 0, 0), section, cells=1, formulation=fl.elements.DirectorBeam(2)
        )
    )
    beam.add_velocity(omega=(0, 0, 2.0), about=beam.point("start"))
    beam.velocities[beam.point("start").node] = 0.0
    scene.add(fl.Clamp(beam.point("start")))
    scheme = fl.EnergyMomentum() if run == "conserving" else fl.GeneralisedAlpha()
    step = fl.schemes.AdaptiveStep(tolerance=1e-2) if run == "variable steps" else 1e-2
    with (
        pytest.warns(fl.schemes.CoarseElementsWarning, match="at time"),
        pytest.raises(fl.ConvergenceError, match=r"an element folds: at time .* element 0 of") as e,
    ):
        scheme.run(scene, duration=4.0, step=step)
    assert len(e.value.result.times) > 3


@pytest.mark.parametrize("degree", [1, 2])
def test_shells_have_a_limit_too(degree):
    """The moment of a strip goes with the sine of the rotation of a linear cell."""
    from demos.cantilever_moment import CIRCLE, THICKNESS, WIDTH, E
    from demos.cantilever_moment import LENGTH as L

    form = fl.elements.DisplacementBased()
    mesh = fl.mesh.parametric_surface(lambda a, b: (L * a, WIDTH * b, 0.0), (2, 1), degree=degree)
    shell = fl.Shell(
        mesh, fl.ShellSection.layer(THICKNESS, fl.Material(E, 0.0, 1.0)), formulation=form
    )
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", moment=(0, -CIRCLE / WIDTH, 0)))
    turning = shell.model.rotation_limit()
    assert turning.limit == (np.pi / 2 if degree == 1 else 3.0)
    assert turning.nodes.shape == (8, degree + 1)
    wanted = [0.8 / np.pi, 0.93 / np.pi] if degree == 1 else [1.5 / np.pi, 1.0]
    result = fl.follow_loads(scene, wanted[:1])
    d = result.rotation(shell.points("a=1")[0])[-1, :, 2]
    turn = np.arctan2(-d[0], d[2]) / 2
    assert turn == pytest.approx(np.arcsin(0.8) if degree == 1 else 1.440, rel=2e-3)
    if degree == 1:  # no equilibrium above one
        with (
            pytest.warns(fl.schemes.CoarseElementsWarning),
            pytest.raises(fl.ConvergenceError, match="fold"),
        ):
            fl.follow_loads(scene, [1.1 / np.pi])

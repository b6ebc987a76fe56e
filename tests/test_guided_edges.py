"""Edges that are guided: their rotations are held, and joints keep them straight."""

from collections.abc import Callable

import numpy as np
import pytest

import fem_lie as fl

LENGTH, WIDTH, THICKNESS, E = 1.0, 0.1, 0.01, 2e11
LAYER = fl.ShellSection.layer(THICKNESS, fl.Material(E, 0.0, 7800.0))


def flat(a: float, b: float) -> np.ndarray:
    return np.array([LENGTH * a, WIDTH * b, 0.0])


def shell() -> fl.Shell:
    return fl.Shell(fl.mesh.parametric_surface(flat, (32, 2)), LAYER)


def thin() -> fl.ThinShell:
    return fl.ThinShell(fl.mesh.smooth_patch(flat, (8, 2)), LAYER)


@pytest.mark.parametrize("make", [shell, thin])
def test_a_strip_with_guided_end_is_a_beam_that_cannot_tilt_there(
    make: Callable[[], fl.Shell | fl.ThinShell],
) -> None:
    """Forces at one corner only: a rigid plate along the edge makes it move as a whole.

    The deflection is F L³ / (12 E I), the elongation F L / (E A).
    """
    strip = make()
    strip.clamp("a=0")
    edge = strip.guided("a=1", (1, 0, 0))
    scene = fl.Scene()
    scene.add(strip)
    plate = scene.add(fl.RigidBody(1.0, (0.1,) * 3, (LENGTH, 0.5 * WIDTH, 0.0))).point("centre")
    scene.add(fl.joints.Prismatic(fl.ground(), plate, axis=(1, 0, 0)))
    for point in edge:
        scene.add(fl.joints.InPlane(plate, point, at=point.position, axis=(1, 0, 0)))
    pull, lift = 1.0, 0.01
    scene.add(fl.PointLoad(strip.point("10"), (pull, 0, 0)))
    scene.add(fl.loads.EdgeLoad(strip, "a=1", (0, 0, lift / WIDTH)))
    result = fl.statics(scene)
    moved = np.array([result.displacement(point)[-1] for point in edge])
    elongation = pull * LENGTH / (E * WIDTH * THICKNESS)
    np.testing.assert_allclose(moved[:, 0], elongation, rtol=1e-3)
    assert np.ptp(moved[:, 0]) < 1e-9 * elongation
    EI = E * WIDTH * THICKNESS**3 / 12.0
    np.testing.assert_allclose(moved[:, 2], lift * LENGTH**3 / (12.0 * EI), rtol=2e-3)


@pytest.mark.parametrize("make", [shell, thin])
def test_an_edge_that_is_not_in_the_plane_is_refused(
    make: Callable[[], fl.Shell | fl.ThinShell],
) -> None:
    with pytest.raises(ValueError, match="not on a plane of symmetry"):
        make().guided("a=1", (0, 1, 0))


@pytest.mark.parametrize("hold", ["hinge", "roller"])
def test_directors_of_a_hinged_edge_rotate_about_its_axis_only(hold: str) -> None:
    """Also by large angles, and not at all where two edges meet that are not parallel.

    A skew plate is twisted by a force at a free corner; without axes, directors tilt along edges.
    """
    along = {"b=0": np.array([1.0, 0, 0]), "a=0": np.array([0.5, np.sqrt(0.75), 0.0])}

    def directors(axes: bool) -> tuple[fl.Shell, np.ndarray]:
        plate = fl.Shell(
            fl.mesh.parametric_surface(lambda a, b: (a + 0.5 * b, np.sqrt(0.75) * b, 0), (6, 6)),
            fl.ShellSection.layer(0.05, fl.Material(2e9, 0.3, 1000.0)),
        )
        for edge, axis in along.items():
            given = axis if axes else None
            if hold == "hinge":
                plate.hinge(edge, axis=given)
            else:
                for normal in np.eye(3):
                    plate.roller(edge, normal, axis=given)
        scene = fl.Scene()
        scene.add(plate)
        scene.add(fl.PointLoad(plate.point("11"), (0, 0, 2e5)))
        result = fl.statics(scene)
        return plate, result.frames[-1, result.info.body(plate.name).nodes, 3]

    plate, d = directors(axes=True)
    for edge, axis in along.items():
        nodes = plate.nodes(edge)
        assert np.abs(d[nodes] @ axis).max() < 1e-12
        assert np.degrees(np.arccos(d[nodes, 2])).max() > 10.0
    np.testing.assert_allclose(d[plate.nodes("00")], [[0, 0, 1]], atol=1e-12)
    _, soft = directors(axes=False)
    assert max(np.abs(soft[plate.nodes(edge)] @ axis).max() for edge, axis in along.items()) > 0.05


def test_an_axis_along_directors_is_refused() -> None:
    with pytest.raises(ValueError, match="expected an axis perpendicular to them"):
        shell().hinge("a=1", axis=(0, 1, 1))

"""Tubes, tori and rings of functions whose ends are one: no seam anywhere."""

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
FORMS = [(cell, degree) for cell in ("quadrilateral", "triangle") for degree in (1, 2)]


def tube(a, b):
    """Tube with a radius and a length of 1."""
    return np.cos(2 * np.pi * a), np.sin(2 * np.pi * a), b


def torus(a, b):
    """Torus of radii 1 and 0.3."""
    r = 1.0 + 0.3 * np.cos(2 * np.pi * b)
    return r * np.cos(2 * np.pi * a), r * np.sin(2 * np.pi * a), 0.3 * np.sin(2 * np.pi * b)


def ring(a, b, c):
    """Thick ring about z."""
    r = 1.0 + 0.2 * b
    return r * np.cos(2 * np.pi * a), r * np.sin(2 * np.pi * a), 0.3 * c


def edges_of(mesh):
    """Number of edges of cells, by their corners."""
    around = (0, 1, 2) if mesh.cell == "triangle" else (0, 1, 3, 2)
    corners = mesh.cells[:, around]
    pairs = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    return len(np.unique(np.sort(pairs, axis=1), axis=0)), len(np.unique(corners))


@pytest.mark.parametrize(("cell", "degree"), FORMS)
@pytest.mark.parametrize(
    ("function", "closed", "curves", "points"),
    [
        (tube, "a", ["b=0", "b=1"], ["00", "01"]),
        (torus, "ab", [], ["00"]),
        (torus, "ba", [], ["00"]),
    ],
)
def test_euler_s_number_is_that_of_a_tube_and_a_torus(
    function, closed, curves, points, cell, degree
):
    mesh = fl.mesh.parametric_surface(function, (6, 5), cell=cell, degree=degree, closed=closed)
    edges, corners = edges_of(mesh)
    assert corners - edges + len(mesh.cells) == 0
    assert sorted(mesh.curves) == curves
    assert sorted(mesh.named_points) == points


@pytest.mark.parametrize(("cell", "degree"), FORMS)
def test_a_free_tube_has_its_frequencies_in_pairs(cell, degree):
    around = 32 // degree
    mesh = fl.mesh.parametric_surface(tube, (around, 4), cell=cell, degree=degree, closed="a")
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.02, STEEL))
    scene = fl.Scene()
    scene.add(shell)
    found = fl.vibrations(scene, 14).frequencies
    assert found[:6] == pytest.approx(0.0, abs=1e-3 * found[6])
    pairs = found[6:].reshape(-1, 2)
    assert pairs[:, 0] == pytest.approx(pairs[:, 1], rel=1e-7)
    # inextensional bending with two waves and no strain along the axis (Rayleigh, 1881)
    plate = STEEL.E / (1.0 - STEEL.nu**2) * 0.02**3 / 12.0
    rayleigh = np.sqrt(36.0 / 5.0 * plate / (STEEL.density * 0.02))
    assert pairs[0, 0] == pytest.approx(rayleigh, rel=0.05)


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_a_free_ring_has_its_frequencies_in_pairs(cell):
    mesh = fl.mesh.parametric_volume(ring, (16, 1, 1), cell=cell, closed="a")
    assert sorted(mesh.faces) == ["b=0", "b=1", "c=0", "c=1"]
    assert sorted(mesh.named_points) == ["000", "001", "010", "011"]
    body = fl.Solid(mesh, fl.sections.NeoHooke(E=1e6, nu=0.3, density=1000.0))
    scene = fl.Scene()
    scene.add(body)
    found = fl.vibrations(scene, 10).frequencies
    pairs = found[6:].reshape(-1, 2)
    assert pairs[:, 0] == pytest.approx(pairs[:, 1], rel=1e-7)


def test_pressure_widens_a_tube():
    mesh = fl.mesh.parametric_surface(tube, (48, 4), closed="a")
    thickness, pressure = 0.01, 1e4
    shell = fl.Shell(mesh, fl.ShellSection.layer(thickness, STEEL))
    scene = fl.Scene()
    scene.add(shell)
    shell.roller("b=0", (0, 0, 1))
    scene.add(fl.joints.InPlane(fl.ground(), shell.point("00"), axis=(0, 1, 0)))
    quarter = shell.point(next(n for n, x in enumerate(mesh.points) if x[1] > 1 - 1e-9))
    scene.add(fl.joints.InPlane(fl.ground(), quarter, axis=(1, 0, 0)))
    opposite = shell.point(next(n for n, x in enumerate(mesh.points) if x[0] < -1 + 1e-9))
    scene.add(fl.joints.InPlane(fl.ground(), opposite, axis=(0, 1, 0)))
    scene.add(fl.loads.SurfacePressure(shell, pressure))
    x = mesh.points + fl.statics(scene).displacements(shell)[-1]
    radius = np.linalg.norm(x[:, :2], axis=1)
    assert radius - 1.0 == pytest.approx(pressure / (STEEL.E * thickness), rel=0.02)


@pytest.mark.parametrize(
    ("closed", "cells", "kind", "message"),
    [
        ("b", (6, 6), ValueError, "points at b=1 to be those at b=0, got points with a distance"),
        ("a", (2, 6), ValueError, "three cells or more along a, got 2"),
        ("c", (6, 6), ValueError, r"of a, b, such as 'a', got 'c'"),
        (True, (6, 6), TypeError, "closed must be a word, got True"),
    ],
)
def test_ends_that_cannot_be_closed(closed, cells, kind, message):
    with pytest.raises(kind, match=message):
        fl.mesh.parametric_surface(tube, cells, closed=closed)


def test_ends_of_a_volume_that_do_not_meet():
    with pytest.raises(ValueError, match="points at c=1 to be those at c=0"):
        fl.mesh.parametric_volume(ring, (6, 3, 3), closed="c")

"""Nodes that are positions alone, by an element of this file: strings, which only resist stretch.

Nothing of the package knows the element: what it is made of stands here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import pytest
import ufl

import fem_lie as fl

EA, MASS, GRAVITY = 50.0, 0.3, 9.81


@fl.extend.frame_function
def _pull(state, y, given, out, nodes):
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 4, 3))
    r = numba.carray(out, (nodes, 6))
    for i in range(nodes):
        fl.extend.node_types.pull_back(fl.extend.node_types.POSITION, H[i], f[i], 1.0, r[i])


@fl.extend.frame_function
def _push(state, y, given, out, nodes):
    H, h = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 6))
    rates = numba.carray(out, (nodes, 4, 3))
    for i in range(nodes):
        fl.extend.node_types.push_forward(fl.extend.node_types.POSITION, H[i], h[i], rates[i])


@fl.extend.frame_function
def _geometric(state, y, given, out, nodes):
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 4, 3))
    A = numba.carray(out, (nodes, 6, nodes, 6))
    for i in range(nodes):
        fl.extend.node_types.pull_back_derivative(
            fl.extend.node_types.POSITION, H[i], f[i], 1.0, A[i, :, i]
        )


PLACES = fl.extend.FrameMap(None, _pull, _push, _geometric, values=12, unknowns=6)


@dataclass(frozen=True)
class String(fl.elements.BeamFormulation):
    """``½ EA (|b − a|/ℓ − 1)² ℓ`` between two positions."""

    node_type = fl.extend.NodeType.POSITION
    viscous = False
    degree: int = 1

    def forms(self, nodal: fl.NodalFrames, cells: fl.extend.CellData) -> fl.extend.LocalFrameForms:
        mesh = nodal.function.function_space.mesh
        length = fl.extend.cellwise(mesh, cells.lengths)
        chord = ufl.dot(ufl.grad(nodal.position), ufl.Jacobian(mesh)[:, 0])
        strain = ufl.sqrt(ufl.dot(chord, chord)) / length - 1
        stretch = 0.5 * fl.extend.cellwise(mesh, cells.stiffness[:, 0, 0]) * strain**2
        dx = ufl.Measure("dx", mesh, metadata={"quadrature_degree": 0})
        energy = stretch * length / ufl.CellVolume(mesh) * dx
        return fl.extend.LocalFrameForms(energy, nodal.function, nodal.increment, PLACES)


def string(direction, cells: int, stretch: float = 1.1, begin=(0.0, 0.0, 0.0)) -> fl.Cable:
    """Of unstretched length 2, stretched at the start."""
    section = fl.Section.from_stiffness([EA, 1, 1, 1, 1, 1], mass=MASS)
    mesh = fl.mesh.straight_line(begin, np.add(begin, 2 * stretch * np.array(direction)), cells)
    return fl.Cable(mesh, section, length=2.0, formulation=String())


def test_two_strings_hang_on_each_other():
    """Linear elements that carry their weight at both ends are exact at the nodes."""
    upper, lower = (string((0, 0, -1), 5, begin=(0, 0, -2.2 * k)) for k in range(2))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    for cable in (upper, lower):
        scene.add(cable)
    upper.pin(upper.point("start"))
    scene.add(fl.joints.Spherical(upper.point("end"), lower.point("start")))
    scene.add(fl.PointLoad(lower.point("end"), (0, 0, -2.0)))
    found = fl.statics(scene)
    weight = MASS * 2.0 * GRAVITY
    middle = 2.0 + (1.5 * weight + 2.0) * 2.0 / EA
    end = middle + 2.0 + (0.5 * weight + 2.0) * 2.0 / EA
    for cable, depth in ((upper, middle), (lower, end)):
        np.testing.assert_allclose(
            found.position(cable.point("end"))[-1], (0, 0, -depth), atol=1e-9
        )
    np.testing.assert_array_equal(found.frames[-1, :6, 1:], upper.frames[:, 1:])


def test_vibrations_of_a_taut_string():
    """Those of linear elements with consistent mass, twice, across; none of what is held."""
    cells, stretch = 8, 1.3
    cable = string((1, 0, 0), cells, stretch)
    scene = fl.Scene()
    scene.add(cable)
    cable.pin(cable.point("start"), cable.point("end"))
    tension, h = EA * (stretch - 1), 2.0 / cells
    cosine = np.cos(np.pi * np.arange(1, 3) / cells)
    squares = 6 * tension / (MASS * stretch * h**2) * (1 - cosine) / (2 + cosine)
    found = fl.vibrations(scene, 4, at=fl.statics(scene)).frequencies
    np.testing.assert_allclose(found, np.repeat(np.sqrt(squares), 2), rtol=1e-8)


@pytest.mark.parametrize("group", fl.lie.Group)
def test_flight_of_a_string(group):
    """The centre of mass falls along a parabola, and the energy stays."""
    cable = string((0.6, 0, 0.8), cells=3).set_group(group)
    cable.add_velocity(omega=(1, 2, 0.5), about=cable.point(1))
    cable.add_velocity((1, 0, 2))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(cable)
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.2, step=1e-3)
    weights = np.array([0.5, 1, 1, 0.5]) / 3
    centre = np.einsum("i,tij->tj", weights, result.frames[:, :, 0])
    start = np.einsum("i,ij->j", weights, cable.frames[:, 0])
    v = np.array([1, 0, 2]) + np.cross((1, 2, 0.5), start - cable.point(1).position)
    t = result.times[:, np.newaxis]
    expected = start + v * t + 0.5 * t**2 * np.array([0, 0, -GRAVITY])
    np.testing.assert_allclose(centre, expected, atol=1e-6)
    assert result.energy_error < 1e-4


def test_blocks_have_nothing_of_what_a_position_lacks():
    cable = string((1, 0, 0), cells=2)
    scene = fl.Scene()
    scene.add(cable)
    equations = fl.extend.Equations(scene, dynamics=True)
    held = equations.unknowns.held
    assert held[:, 3:].all() and not held[:, :3].any()
    _, columns, pointers = equations.matrix.csr
    assert (np.diff(pointers).reshape(-1, 6)[:, 3:] == 1).all()
    assert (columns[columns % 6 >= 3]).size == 3 * 3


def test_what_takes_hold_of_frames_is_refused():
    cable = string((1, 0, 0), cells=2)
    scene = fl.Scene()
    scene.add(cable)
    with pytest.raises(ValueError, match="have positions:"):
        scene.add(fl.joints.RigidLink(cable.point("start"), cable.point("end")))

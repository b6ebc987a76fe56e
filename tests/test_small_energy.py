"""Elements of vectors, strains and a law: derivatives, rigid motions, stress and viscosity."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.small_energy.jets import first_order, second_order, store_parts
from tests.body_alone import BodyAlone
from tests.own_elements import ELEMENTS, random_body, stiffening, unit_normal

DOCS = Path(__file__).parents[1] / "docs"


# --- jets -----------------------------------------------------------------------------------------


@fl.extend.compiled
def composed(x):
    """All operations and functions of jets."""
    a, b, c = x
    root = math.sqrt(a * b + 2) * math.atan(c / a)
    return -root - b / (1.0 + c * c) + 3 * a + math.exp(a - c) * math.log(b) - (2 - c) + a / 4


@fl.extend.compiled
def both_orders(a, b, c):
    out, second, first = np.empty(14), stack(10), stack(4)
    store_parts((composed(second_order((a, b, c))),), second)
    store_parts((composed(first_order((a, b, c))),), first)
    out[:10], out[10:] = vector_at(second, 10), vector_at(first, 4)
    return out


X = np.array([1.3, 0.7, 0.4])


def test_jets_have_the_value_of_plain_numbers():
    assert both_orders(*X)[0] == composed(tuple(X)) == both_orders(*X)[10]


def test_first_derivatives_are_those_of_complex_steps():
    step = 1e-30

    def along(k):
        a, b, c = X + 1j * step * np.eye(3)[k]
        root = np.sqrt(a * b + 2) * np.arctan(c / a)
        rest = 3 * a + np.exp(a - c) * np.log(b) - (2 - c) + a / 4
        return (-root - b / (1 + c * c) + rest).imag / step

    expected = [along(k) for k in range(3)]
    np.testing.assert_allclose(both_orders(*X)[1:4], expected, rtol=1e-14)
    np.testing.assert_allclose(both_orders(*X)[11:], expected, rtol=1e-14)


def test_second_derivatives_are_those_of_first_ones():
    def gradients(step):
        return np.array([both_orders(*(X + step * e))[1:4] for e in np.eye(3)])

    h = 1e-4
    fine, coarse = ((gradients(s) - gradients(-s)) / (2 * s) for s in (h, 2 * h))
    expected = (4 * fine - coarse) / 3
    np.testing.assert_allclose(both_orders(*X)[4:10], expected[np.triu_indices(3)], atol=1e-10)


@fl.extend.compiled
def compared(x):
    """Branches by values."""
    a, b = x
    if a > b and a >= 1 and b < 2.0 and b <= a:
        return a * b
    return 0.0 * a


@fl.extend.compiled
def first_of_compared(a, b):
    out, position = np.empty(3), stack(3)
    store_parts((compared(first_order((a, b))),), position)
    out[:] = vector_at(position, 3)
    return out


def test_jets_are_compared_by_their_values():
    np.testing.assert_array_equal(first_of_compared(1.5, 0.5), [0.75, 0.5, 1.5])
    np.testing.assert_array_equal(first_of_compared(0.5, 1.5), [0.0, 0.0, 0.0])


# --- elements -------------------------------------------------------------------------------------


class Alone(BodyAlone):
    """Such a body by itself."""

    size = 0.05

    def __init__(self, name):
        body = random_body(name)
        super().__init__(body, body.model.assemble([body.model]))

    def viscous(self, H, v):
        out = np.zeros((self.count, 6))
        self.term.add_viscous_forces(H, v, out)
        return out


every_element = pytest.mark.parametrize("name", ELEMENTS)


def close(found, expected, relative):
    np.testing.assert_allclose(found, expected, rtol=0, atol=relative * np.abs(expected).max())


@every_element
def test_forces_are_the_gradient_of_the_energy(name):
    alone, h = Alone(name), 1e-5
    H, d = alone.deformed(), alone.rng.normal(size=(alone.count, 6))
    ahead, behind = (alone.term.energy(alone.follow(H, s * h * d)) for s in (1, -1))
    assert np.vdot(alone.forces(H), d) == pytest.approx((ahead - behind) / (2 * h), rel=1e-7)


@every_element
def test_the_tangent_is_the_derivative_of_the_forces(name):
    alone, h = Alone(name), 1e-5
    H, d = alone.deformed(), alone.rng.normal(size=(alone.count, 6))
    ahead, behind = (alone.forces(alone.follow(H, s * h * d)) for s in (1, -1))
    close(alone.matrix(H) @ d.ravel(), ((ahead - behind) / (2 * h)).ravel(), 1e-7)


@every_element
def test_rigid_motions_change_nothing(name):
    """Energy stays, and forces do no work in the six rigid motions."""
    alone = Alone(name)
    H = alone.deformed()
    forces, motions = (
        alone.forces(H),
        fl.extend.node_types.rigid_motions(alone.kinds, H, np.zeros(3)),
    )
    work = np.einsum("na,nab->nb", forces, motions)
    assert np.abs(work.sum(axis=0)).max() < 1e-12 * np.abs(work).sum()
    turn = lie.so3_exp(np.array([[0.7, -1.2, 0.4]]))[0]
    moved = H.copy()
    turned = alone.kinds != fl.extend.NodeType.MODAL
    moved[turned] = H[turned] @ turn.T
    assert alone.term.energy(moved) == pytest.approx(alone.term.energy(H), rel=1e-13)


@every_element
def test_linearised_stress_is_that_of_the_strains_to_first_order(name):
    """Twice the increment leaves four times the difference."""
    alone = Alone(name)
    H, d = alone.deformed(), alone.rng.normal(size=(alone.count, 6))

    def difference(h):
        alone.term.update_stress(H, h * d)
        values = alone.term.linearised_values.copy()
        alone.term.reset_stress(alone.follow(H, h * d))
        return np.abs(values - alone.term.linearised_values).max()

    assert difference(0.0) < 1e-14 * np.abs(alone.term.linearised_values).max()
    assert difference(2e-4) / difference(1e-4) == pytest.approx(4.0, rel=1e-2)


@every_element
def test_the_tangent_has_the_linearised_stress(name):
    """At another stress the tangent is another one by forces linear in it."""
    alone = Alone(name)
    H = alone.deformed()
    alone.term.reset_stress(H)
    stress, found = alone.term.linearised_values.copy(), []
    for factor in (0.0, 1.0, 2.0):
        alone.term.restore(factor * stress)
        found.append(alone.term.tangent(H, np.empty((0, 6))))
    close(found[2] - found[1], found[1] - found[0], 1e-12)
    assert np.abs(found[1] - found[0]).max() > 1e-3 * np.abs(found[1]).max()


@every_element
def test_viscous_forces_dissipate_and_leave_rigid_motions_free(name):
    alone = Alone(name)
    H, v = alone.deformed(), alone.rng.normal(size=(alone.count, 6))
    forces = alone.viscous(H, v)
    assert np.vdot(forces, v) > 0.0
    D, rest = alone.term.viscous_tangent(H, v)
    assert rest is None
    matrix, (rows, columns) = np.zeros((alone.count, 6, alone.count, 6)), alone.term.pairs
    matrix[rows, :, columns] = D
    close(np.einsum("iajb,jb->ia", matrix, v), forces, 1e-12)
    scale = np.abs(forces).max() / np.abs(v).max()
    for motion in fl.extend.node_types.rigid_motions(alone.kinds, H, np.zeros(3)).transpose(
        2, 0, 1
    ):
        assert np.abs(alone.viscous(H, motion)).max() < 1e-11 * scale * np.abs(motion).max()


@every_element
def test_strains_do_not_touch_the_stress(name):
    alone = Alone(name)
    H = alone.deformed()
    alone.term.reset_stress(H)
    before = alone.term.linearised_values.copy()
    strains = alone.term.strains(alone.body.frames)
    assert strains.shape == (3, before.size // 3)
    np.testing.assert_array_equal(alone.term.linearised_values, before)


# --- the element of the page ----------------------------------------------------------------------


def test_the_element_of_the_page_is_that_of_the_package():
    """The cable on position-gradient nodes has energy and forces of
    :class:`fl.elements.HermiteCable`."""
    page = runpy.run_path(str(DOCS / "how_to" / "gradient_element.py"))
    section = fl.Section.circle(0.01, fl.Material(E=1e9, nu=0.0, density=1000.0))
    EA, EI = section.stiffness[0, 0], section.stiffness[4, 4]
    own = page["cable"](4, EA, EI, 1.0)
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), section, cells=4)
    alone = [BodyAlone(body, body.model.assemble([body.model])) for body in (own, cable)]
    H = alone[0].deformed()
    first, second = (each.forces(H) for each in alone)
    close(first, second, 1e-12)
    energies = [each.term.energy(H) for each in alone]
    assert energies[0] == pytest.approx(energies[1], rel=1e-12)
    close(*(each.matrix(H) for each in alone), 1e-11)


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"products": [(0, 0)]}, r"products must have strain, vectors and factor each"),
        ({"products": [(0, 0, 2, 1.0)]}, r"products must be of vectors 0 to 1 in strains 0 to 0"),
        ({"products": [(1, 0, 0, 1.0)]}, r"products must be of vectors 0 to 1 in strains 0 to 0"),
        ({"products": [(0, 0, 0, 1.0)], "law": stiffening}, "a law that is a function needs"),
        ({"products": [(0, 0, 0, 1.0)], "pairs": [(0, 1)]}, "pairs must be of strains 0 to 0"),
        ({"products": [(0, 0, 0, 1.0)], "inputs": [(0, 1)]}, "linear vectors 0 to 1, got no func"),
        (
            {"products": [(0, 0, 2, 1.0)], "derive": unit_normal, "inputs": [(0, 2)]},
            r"as its inputs, linear vectors 0 to 1, got a function and \[\[0, 2\]\]",
        ),
    ],
)
def test_products_that_do_not_fit_are_refused(arguments, message):
    products = arguments.pop("products")
    with pytest.raises(ValueError, match=message):
        fl.extend.element([fl.extend.NodeType.POSITION], products, vectors=2, **arguments)


def test_data_of_another_shape_are_refused():
    of = fl.extend.element([fl.extend.NodeType.POSITION] * 2, [(0, 0, 0, 0.5)], vectors=1)
    with pytest.raises(ValueError, match=r"tables of cells must be of shape \(2, 1, 1, 2\)"):
        fl.extend.cell_data(of, np.zeros((2, 1, 1, 3)), np.zeros((2, 1, 2)))
    with pytest.raises(ValueError, match="offsets of cells must be none, got shape"):
        fl.extend.cell_data(
            of, np.zeros((2, 1, 1, 2)), np.zeros((2, 1, 2)), offsets=np.zeros((2, 1, 1, 3))
        )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rows": np.zeros((2, 4, 3))}, r"rows must have shape \(9, 4, 3\)"),
        ({"cells": [[0, 1, 9]]}, "cells must have 3 of 9 nodes each"),
        ({"cells": [[1, 0, 2]]}, "cells must have nodes of types"),
        ({"data": np.zeros((1, 4))}, "3 cells need as many data, got 1"),
        ({"inertia": np.zeros((3, 3, 3))}, "inertia must have shape"),
        ({"damping": fl.sections.Damping(stiffness=0.1)}, "damping with mass only"),
    ],
)
def test_bodies_whose_parts_do_not_fit_are_refused(change, message):
    body = random_body("function of products, with a law")
    given = {
        "rows": body.frames,
        "node_types": body.model.node_types,
        "cells": body.model.element_nodes,
        "element": body.model.element,
        "functions": body.model.functions,
        "data": body.model.element_data(),
    }
    with pytest.raises(ValueError, match=message):
        fl.extend.ElementBody(**(given | change))

"""Laws of the elements of solids: patch test, derivatives, rigid motions, with all materials."""

import basix
import numpy as np
import pytest
import ufl

import fem_lie as fl
from tests.assembled import Assembled


def mooney(C, first, second, bulk):
    """Another material, as a user writes it."""
    J = ufl.sqrt(ufl.det(C))
    I1, I2 = ufl.tr(C), 0.5 * (ufl.tr(C) ** 2 - ufl.tr(C * C))
    slope = 2 * first + 4 * second
    return first * (I1 - 3) + second * (I2 - 3) - slope * ufl.ln(J) + bulk * (J - 1) ** 2


MATERIALS = {
    "Saint-Venant": fl.sections.SaintVenantKirchhoff(10.0, 0.3, 2.0),
    "neo-Hooke": fl.sections.NeoHooke(10.0, 0.3, 2.0),
    "Mooney": fl.sections.Hyperelastic(mooney, 2.0, (1.5, 0.5, 10.0)),
}

ELEMENTS = {
    "hexahedron 1, mean dilatation": ("hexahedron", 1, fl.elements.MeanDilatation()),
    "hexahedron 1": ("hexahedron", 1, fl.elements.Isoparametric()),
    "hexahedron 2": ("hexahedron", 2, None),
    "tetrahedron 1": ("tetrahedron", 1, None),
    "tetrahedron 2": ("tetrahedron", 2, None),
}

element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS)
material = pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)


def skewed(a, b, c):
    """A brick whose inner cells are crooked."""
    x = np.array([1.5 * a, 1.0 * b, 0.8 * c])
    inside = 16 * a * (1 - a) * b * (1 - b) * c * (1 - c)
    return x + inside * np.array([0.3, -0.25, 0.2])


def solid(element, material=MATERIALS["neo-Hooke"], cells=(2, 2, 2)):
    cell, degree, formulation = element
    mesh = fl.mesh.parametric_volume(skewed, cells, cell=cell)
    return fl.Solid(mesh, material, degree=degree, formulation=formulation)


def system_of(body, dynamics=True, **options):
    scene = fl.Scene()
    scene.add(body)
    return Assembled(scene, dynamics=dynamics, **options)


def bent(system, size=0.05):
    """Frames of a deformed state, axes as they follow it."""
    H, rng = system.start.copy(), np.random.default_rng(1)
    n = system.count
    x = H[:n, 0]
    H[:n, 0] += size * np.sin(x @ rng.normal(size=(3, 3))) + 0.02 * size * rng.normal(size=(n, 3))
    system.equations.history_variables.rotate_axes(H)
    return H


def forces(system, H):
    return system.residual(H).reshape(-1, 6)


def moved(H, h):
    new = H.copy()
    new[: len(h), 0] += np.einsum("nij,ni->nj", H[: len(h), 1:], h[:, :3])
    return new


def energy(system, H):
    return system.equations.report(H, linearised=False).elastic


def volume(x):
    """Of a trilinear cell with corners ``x``, (8, 3)."""
    kind = basix.CellType.hexahedron
    points, weights = basix.make_quadrature(kind, 6)
    element = basix.create_element(basix.ElementFamily.P, kind, 1)
    F = np.einsum("dgk,kj->gdj", element.tabulate(1, points)[1:, :, :, 0], x)
    return float(weights @ np.linalg.det(F))


@element
@material
def test_patch(element, material):
    """Boundary positions by any linear map: the same map within, in crooked cells."""
    body = solid(element, material)
    F = np.array([[1.1, 0.2, 0.0], [-0.1, 0.95, 0.15], [0.05, -0.1, 1.05]])
    start = body.frames[:, 0].copy()
    for face in ("a=0", "a=1", "b=0", "b=1", "c=0", "c=1"):
        body.clamp(face)
    free = ~body.model.held[:, 0]
    assert free.any()
    body.frames[:, 0] = start @ F.T
    body.frames[free, 0] += 0.02 * np.random.default_rng(0).normal(size=(free.sum(), 3))
    scene = fl.Scene()
    scene.add(body)
    found = fl.statics(scene)
    np.testing.assert_allclose(
        found.frames[-1, found.info.bodies[0].nodes, 0], start @ F.T, atol=1e-10
    )


@element
@material
def test_forces_are_the_gradient_of_the_energy(element, material):
    system = system_of(solid(element, material))
    H, rng, step = bent(system), np.random.default_rng(2), 2e-6
    h = rng.normal(size=(system.count, 3))
    ahead, behind = (energy(system, moved(H, sign * step * h)) for sign in (1, -1))
    rise = (ahead - behind) / (2 * step)
    assert (forces(system, H)[:, :3] * h).sum() == pytest.approx(rise, rel=1e-6)


@element
@material
def test_tangent_is_the_derivative_of_the_forces(element, material):
    system = system_of(solid(element, material))
    H, rng, step = bent(system), np.random.default_rng(3), 1e-6
    h = rng.normal(size=(system.count, 6))
    h[:, 3:] = 0
    wanted = (forces(system, moved(H, step * h)) - forces(system, moved(H, -step * h))) / (2 * step)
    found = (system.matrix(H) @ h.ravel()).reshape(-1, 6)
    wanted[system.held] = found[system.held] = 0.0
    np.testing.assert_allclose(found, wanted, atol=2e-8 * np.abs(wanted).max())


@element
def test_a_rigid_motion_changes_neither_forces_nor_tangent(element):
    """In axes that follow; claim 5."""
    system = system_of(solid(element))
    H = bent(system)
    Q, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    Q *= np.sign(np.linalg.det(Q))
    there = H.copy()
    there[: system.count, 0] = H[: system.count, 0] @ Q.T + [3.0, -2.0, 1.0]
    system.equations.history_variables.rotate_axes(there)
    before, after = forces(system, H), forces(system, there)
    np.testing.assert_allclose(after, before, atol=1e-10 * np.abs(before).max())
    K, again = system.matrix(H), system.matrix(there)
    np.testing.assert_allclose(again, K, atol=1e-10 * np.abs(K).max())
    turned = there[: system.count, 1:]
    np.testing.assert_allclose(turned, H[: system.count, 1:] @ Q.T, atol=1e-13)


@element
def test_the_unloaded_body_is_without_stress_and_stiff_but_for_rigid_motions(element):
    body = solid(element)
    system = system_of(body)
    assert np.abs(forces(system, system.start)).max() < 1e-12
    n = system.count
    whole = system.matrix(system.start).reshape(n, 6, n, 6)[:, :3, :, :3]
    values = np.linalg.eigvalsh(whole.reshape(3 * n, 3 * n))
    assert (np.abs(values[:6]) < 1e-10 * values[-1]).all()
    assert values[6] > 1e-4 * values[-1]


@element
def test_mass_and_moments_of_inertia(element):
    """Of a brick, by its rigid motions."""
    cell, degree, formulation = element
    body = fl.Solid.brick(
        (1.0, 2.0, 3.0),
        MATERIALS["neo-Hooke"],
        cells=(2, 1, 1),
        cell=cell,
        degree=degree,
        formulation=formulation,
    )
    body.add_velocity(omega=(0.3, 0.5, -0.2), about=(0.5, 1.0, 1.5))
    body.add_velocity((1.0, 2.0, 3.0))
    scene = fl.Scene()
    scene.add(body)
    result = fl.GeneralisedAlpha().run(scene, duration=1e-3, step=1e-3)
    found = [result.kinetic[0], *result.momentum[0], *result.angular_momentum[0]]
    mass = 2.0 * 6.0
    inertia = mass / 12 * np.array([4.0 + 9.0, 1.0 + 9.0, 1.0 + 4.0])
    spin, velocity = np.array([0.3, 0.5, -0.2]), np.array([1.0, 2.0, 3.0])
    energy = 0.5 * mass * velocity @ velocity + 0.5 * inertia @ spin**2
    about = np.cross([0.5, 1.0, 1.5], mass * velocity) + inertia * spin
    np.testing.assert_allclose(found, [energy, *(mass * velocity), *about], rtol=1e-12)


def test_volume_of_a_crooked_cell():
    """By the divergence theorem: of a cell with plane faces, from tetrahedra."""
    x = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0], [0, 0, 1], [2, 0, 3], [0, 1, 1]])
    assert volume(np.vstack([x, (2, 1, 3)])) == pytest.approx(2 * 1 * 2.0, rel=1e-14)


def test_the_mean_dilatation_is_the_volume_of_the_cell():
    """An energy of ``J`` alone is that of volumes, in a state that is not homogeneous."""
    law = fl.sections.Hyperelastic(lambda C: 0.25 * ufl.ln(ufl.det(C)) ** 2)
    body = solid(("hexahedron", 1, fl.elements.MeanDilatation()), law)
    system = system_of(body, dynamics=False)
    H = bent(system, 0.2)
    before, after = (
        np.array([volume(rows[:, 0]) for rows in of[body.model.connectivity]])
        for of in (body.frames, H[system.equations.unknowns.bodies[body]])
    )
    assert np.ptp(after / before) > 0.01
    wanted = (before * np.log(after / before) ** 2).sum()
    assert energy(system, H) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("cell", [("hexahedron", 1, None), ("tetrahedron", 2, None)])
def test_a_material_with_stress_at_rest_is_refused(cell):
    """Without -2 ln J a block collapsed, and statics called that solved."""
    law = fl.sections.Hyperelastic(lambda C: 0.5 * (ufl.tr(C) - 3.0))
    body = solid(cell, law)
    with pytest.raises(ValueError, match=r"the material has forces .* zero derivative at C = 1"):
        system_of(body, dynamics=False)


def bulge(X):
    """A smooth deformation of the unit cube."""
    x, y, z = X.T
    moved = [np.sin(2 * y) * z, np.cos(x + 2 * z), x * np.sin(y + z)]
    return X + 0.05 * np.stack(moved, axis=-1)


def stress_of(X, λ, μ, d=1e-4):
    """First Piola-Kirchhoff stress of Saint-Venant's and Kirchhoff's law in :func:`bulge`."""
    F = np.stack([(bulge(X + d * e) - bulge(X - d * e)) / (2 * d) for e in np.eye(3)], axis=-1)
    E = 0.5 * (F.swapaxes(-1, -2) @ F - np.eye(3))
    trace = np.trace(E, axis1=-2, axis2=-1)[..., np.newaxis, np.newaxis]
    return F @ (λ * trace * np.eye(3) + 2 * μ * E)


def bulged_error(element, n):
    """Root mean square of inner positions, under the body force that belongs to the deformation."""
    cell, degree, formulation = element
    law = fl.sections.SaintVenantKirchhoff(1.0, 0.3)
    body = fl.Solid.brick(
        (1, 1, 1), law, cells=(n, n, n), cell=cell, degree=degree, formulation=formulation
    )

    def force(X, d=1e-3):
        steps = d * np.eye(3)
        ahead, behind = (stress_of(X + s * steps, *law.parameters) for s in (1, -1))
        return -np.einsum("jij->i", ahead - behind) / (2 * d)

    for face in ("a=0", "a=1", "b=0", "b=1", "c=0", "c=1"):
        body.clamp(face)
    exact = bulge(body.model.positions)
    body.frames[:, 0] = exact
    scene = fl.Scene()
    scene.add(body)
    scene.add(fl.loads.BulkLoad(body, force))
    found = fl.statics(scene)
    gap = found.frames[-1, found.info.bodies[0].nodes, 0] - exact
    return np.sqrt((gap[~body.model.held[:, 0]] ** 2).sum(axis=1).mean())


@pytest.mark.parametrize(
    ("name", "order"),
    [
        ("hexahedron 1, mean dilatation", 2),
        ("hexahedron 1", 2),
        pytest.param("tetrahedron 1", 2, marks=pytest.mark.slow),
        ("hexahedron 2", 3),
        pytest.param("tetrahedron 2", 3, marks=pytest.mark.slow),
    ],
)
def test_order_of_convergence(name, order):
    """Of a smooth deformation: degree plus one, or more where positions are the better for it."""
    meshes = (5, 10) if name == "tetrahedron 1" else (3, 6)
    coarse, fine = (bulged_error(ELEMENTS[name], n) for n in meshes)
    assert np.log2(coarse / fine) > order - 0.3
    assert fine < 1e-3

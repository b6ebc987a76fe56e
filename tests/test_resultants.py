"""Stress resultants of shells: constant states, axes, equilibrium, functions, files."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
import ufl
from dolfinx import fem
from hypothesis import given, settings
from hypothesis import strategies as st
from models import few
from shell_models import quartic

import fem_lie as fl
from fem_lie import lie
from tests.unit_systems import METRES, OTHER_SYSTEMS, UnitSystem

SOFT = fl.Material(100.0, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, SOFT)
FIBRES = fl.sections.Orthotropic(25.0, 1.0, 0.25, 0.5, 0.5, 0.2, 1.0)
ANGLE_PLY = fl.ShellSection.laminate(
    [fl.sections.Ply(0.05, FIBRES, 30.0), fl.sections.Ply(0.1, FIBRES, -20.0)]
)

COMPONENTS = ("N11", "N22", "N12", "M11", "M22", "M12", "Q1", "Q2")

ELEMENTS = [
    pytest.param("quadrilateral", 1, fl.elements.HellingerReissner(), id="HR"),
    pytest.param(
        "quadrilateral", 1, fl.elements.HellingerReissner(fl.elements.MITC4_PLUS), id="HR, MITC4+"
    ),
    pytest.param("quadrilateral", 1, fl.elements.HuWashizu(), id="HW"),
    pytest.param("quadrilateral", 1, fl.elements.DisplacementBased(), id="MITC4"),
    pytest.param("triangle", 1, fl.elements.HellingerReissner(), id="MITC3+"),
    pytest.param("triangle", 2, fl.elements.DisplacementBased(), id="MITC6"),
    pytest.param("quadrilateral", 2, fl.elements.DisplacementBased(), id="MITC9"),
]


def states(shell: fl.Shell, *frames: np.ndarray) -> SimpleNamespace:
    """A result of the shell alone in given frames."""
    shell.name = shell.name or "shell"
    scene = fl.Scene()
    scene.add(shell)
    info = fl.extend.Equations(scene, dynamics=False).info
    (body,) = info.bodies
    ordered = np.empty((len(frames), *shell.frames.shape))
    ordered[:, body.nodes] = frames
    return SimpleNamespace(frames=ordered, info=info)


def rotated(values, c, s):
    """Components (…, 8) in axes rotated by an angle of cosine ``c`` and sine ``s``, (…)."""
    R = np.moveaxis(np.array([[c, s], [-np.asarray(s), c]]), (0, 1), (-2, -1))
    parts = []
    for k in (0, 3):
        T = R @ values[..., [[k, k + 2], [k + 2, k + 1]]] @ np.swapaxes(R, -1, -2)
        parts += [T[..., 0, 0], T[..., 1, 1], T[..., 0, 1]]
    shear = np.einsum("...ij,...j->...i", R, values[..., 6:])
    return np.stack([*parts, shear[..., 0], shear[..., 1]], axis=-1)


def mises(stress):
    """Equivalent stress of plane ones ``(σ₁₁, σ₂₂, σ₁₂)`` by their deviators."""
    a, b, c = np.moveaxis(np.asarray(stress), -1, 0)
    mean = (a + b) / 3
    return np.sqrt(1.5 * ((a - mean) ** 2 + (b - mean) ** 2 + mean**2 + 2 * c**2))


def directed(positions: np.ndarray, directors: np.ndarray) -> np.ndarray:
    """Frames with these third directors, turned about them at will."""
    t = directors / np.linalg.norm(directors, axis=1, keepdims=True)
    e1 = np.cross([0.3, 1.0, 0.2], t)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return np.stack([positions, e1, np.cross(t, e1), t], axis=1)


def distorted(
    cell: str, degree: int, formulation, section=LAYER, along=(0.8, 0.6, 0.0)
) -> fl.Shell:
    """Distorted cells in the plane; parallelograms for nine nodes, which want them."""
    size = 0.0 if (cell, degree) == ("quadrilateral", 2) else 0.15

    def position(a: float, b: float):
        p, q = abs(2 * a - 1), abs(2 * b - 1)
        # (bi)linear in each cell, so that sides of second degree stay straight
        hat = (1 - p) * (1 - q) if cell == "quadrilateral" else 1 - max(p, q, 2 * abs(a - b))
        bump = size * max(0.0, hat)
        return a + bump + 0.1 * b, b - 0.7 * bump + 0.2 * a, 0.0

    mesh = fl.mesh.parametric_surface(position, (2, 2), cell=cell, degree=degree)
    return fl.Shell(mesh, section, along=along, formulation=formulation)


def rotation(rng: np.random.Generator) -> np.ndarray:
    return lie.so3_exp(rng.normal(size=3))


# --- constant states ---


@pytest.mark.parametrize(("cell", "degree", "formulation"), ELEMENTS)
def test_membrane_patch_is_exact_at_any_size(cell, degree, formulation):
    """A homogeneous deformation of any size: N = D E with Green's strain in the section's axes."""
    shell = distorted(cell, degree, formulation, ANGLE_PLY)
    F = np.array([[1.3, 0.2, 0.0], [-0.1, 0.8, 0.0], [0.0, 0.0, 1.0]])
    Q = rotation(np.random.default_rng(1))
    x = shell.frames[:, 0] @ (Q @ F).T
    found = fl.post.resultants(states(shell, directed(x, np.tile(Q[:, 2], (len(x), 1)))), shell)
    E = 0.5 * (F.T @ F - np.eye(3))
    e = np.array([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0]])
    E = e @ E @ e.T
    exact = ANGLE_PLY.stiffness @ [E[0, 0], E[1, 1], 2 * E[0, 1], 0, 0, 0, 0, 0]
    tolerance = {"rtol": 0, "atol": 1e-11 * np.abs(exact).max()}
    for values in (found.at_points, found.in_cells, found.nodal):
        np.testing.assert_allclose(values, np.broadcast_to(exact, values.shape), **tolerance)
    # what the deformation makes of the axes: the nearest orthonormal ones to Q F e
    images = e @ (Q @ F).T
    U, _, V = np.linalg.svd(images, full_matrices=False)
    expected = np.broadcast_to(U @ V, (*found.areas.shape, 2, 3))
    np.testing.assert_allclose(found.axes[:, :, :2], expected, atol=1e-12)
    np.testing.assert_allclose(found.axes[:, :, 2], np.broadcast_to(Q[:, 2], found.points.shape))


@pytest.mark.parametrize(("cell", "degree", "formulation"), ELEMENTS)
def test_bending_twist_and_shear_patches_are_exact(cell, degree, formulation):
    """Of second order is what 1e-7 times the slopes is, 1e-6 of the whole."""
    shell = distorted(cell, degree, formulation, ANGLE_PLY)
    size = 1e-7
    kappa, shear = size * np.array([[2.0, 0.5], [0.5, -1.0]]), size * np.array([0.7, -0.4])
    if shell.model.formulation.measures_for(cell, degree).bubble:
        shear *= 0.0  # without a change of moments it is no equilibrium, and the bubble says so
    x = shell.frames[:, 0].copy()
    slope = -x[:, :2] @ kappa  # of w = −½ x·κx
    x[:, 2] = 0.5 * np.einsum("ni,ni->n", slope, x[:, :2])
    t = np.column_stack([shear - slope, np.ones(len(x))])
    found = fl.post.resultants(states(shell, directed(x, t)), shell, along=(1, 0, 0))
    strain = np.array([0, 0, 0, kappa[0, 0], kappa[1, 1], 2 * kappa[0, 1], *shear])
    # strain and stress in the axes of the section, and back
    c, s = np.float64(0.8), np.float64(0.6)
    engineering = np.array([1, 1, 2, 1, 1, 2, 1, 1])
    local = engineering * rotated(strain / engineering, c, s)
    exact = rotated(ANGLE_PLY.stiffness @ local, c, -s)
    for values in (found.at_points, found.in_cells, found.nodal):
        error = np.abs(values - exact).max(axis=(0, 1) if values.ndim == 3 else 0)
        for part in (slice(0, 3), slice(3, 6), slice(6, 8)):  # of the plane, bending and shear
            scale = max(np.abs(exact[part]).max(), size * np.abs(ANGLE_PLY.stiffness[part]).max())
            assert error[part].max() <= 1e-6 * scale


@pytest.mark.parametrize(
    "formulation", [fl.elements.DisplacementBased(law=quartic), fl.elements.HuWashizu(law=quartic)]
)
def test_users_law_is_evaluated_at_the_true_strain(formulation):
    """The mixed fields of this law take several rounds to settle."""
    shell = distorted("quadrilateral", 1, formulation, along=(1, 0, 0))
    stretch = 1.4
    x = shell.frames[:, 0] * [stretch, 1, 1]
    found = fl.post.resultants(states(shell, directed(x, np.tile([0, 0, 1.0], (len(x), 1)))), shell)
    E = 0.5 * (stretch**2 - 1)
    exact = np.array([80 * E + 1200 * E**3, 10 * E, 0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(found.at_points - exact, 0.0, atol=1e-8 * exact.max())


def test_one_element_in_pure_bending_to_a_quarter_circle():
    """Decoupled bending: the moment of the load, to round-off."""
    length, EI = 10.0, 100.0
    moment = EI * 0.5 * np.pi / length
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (length * a, b, 0.0), (1, 1)),
        fl.ShellSection.layer(0.1, fl.Material(1.2e6, 0.0, 1.0)),
        formulation=fl.elements.HellingerReissner(fl.elements.DECOUPLED),
    )
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", moment=(0, moment, 0)))
    found = fl.post.resultants(fl.follow_loads(scene), shell)
    exact = np.array([0, 0, 0, moment, 0, 0, 0, 0])
    np.testing.assert_allclose(
        found.at_points[..., 3:6], np.broadcast_to(exact[3:6], (1, 4, 3)), atol=1e-7 * moment
    )


# --- axes ---


@given(st.floats(-7, 7), st.integers(0, 9))
@settings(few, max_examples=20)
def test_components_rotate_as_tensors(angle, seed):
    """From one choice of axes to another; principal values and von Mises stress have no axes."""
    shell = distorted("quadrilateral", 1, fl.elements.HellingerReissner())
    result = states(shell, crumpled(shell, seed))
    base = 0.7 * seed
    one, other = (
        fl.post.resultants(result, shell, along=(np.cos(at), np.sin(at), 0.0))
        for at in (base, base + angle)
    )
    values, found = one.at_points, other.at_points
    # axes are in the tangent plane of each point
    c, s = (np.einsum("cqi,cqi->cq", other.axes[:, :, 0], one.axes[:, :, k]) for k in (0, 1))
    scale = np.abs(values).max()
    np.testing.assert_allclose(found, rotated(values, c, s), atol=1e-11 * scale)
    for k, letter in ((0, "N"), (3, "M")):
        T = values[..., [[k, k + 2], [k + 2, k + 1]]]
        small, large = np.moveaxis(np.linalg.eigvalsh(T), -1, 0)
        np.testing.assert_allclose(one.raw(f"{letter} max"), large, atol=1e-12 * scale)
        np.testing.assert_allclose(one.raw(f"{letter} min"), small, atol=1e-12 * scale)
    for side, name in ((1, "von Mises top"), (-1, "von Mises bottom")):
        stress = values[..., :3] / 0.1 + side * 6 * values[..., 3:6] / 0.1**2
        np.testing.assert_allclose(one.raw(name), mises(stress), rtol=1e-12)
    for name in ("N max", "N min", "M max", "M min", "von Mises top", "von Mises bottom"):
        np.testing.assert_allclose(other.raw(name), one.raw(name), atol=1e-10 * scale / 0.1**2)


def arch(a: float, b: float) -> tuple[float, float, float]:
    angle = 0.5 * np.pi * a
    return (np.cos(angle), 1.0 - b, np.sin(angle))


def outward(x: np.ndarray) -> np.ndarray:
    return x * [1, 0, 1] / np.hypot(x[0], x[2])


def around(x: np.ndarray) -> np.ndarray:
    return np.array([-x[2], 0.0, x[0]])


def arch_shell(cell="quadrilateral", degree=1, formulation=None, cells=(6, 3), **options):
    mesh = fl.mesh.parametric_surface(arch, cells, cell=cell, degree=degree)
    return fl.Shell(mesh, LAYER, director=outward, formulation=formulation, **options)


def crumpled(shell: fl.Shell, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    h = 0.02 * rng.normal(size=(len(shell.frames), 6))
    return lie.se3_retract(shell.frames, h)


@pytest.mark.parametrize(("cell", "degree", "formulation"), ELEMENTS)
def test_rigid_motion_leaves_resultants_alone(cell, degree, formulation):
    shell = arch_shell(cell, degree, formulation, along=around)
    H = crumpled(shell)
    rng = np.random.default_rng(5)
    Q = rotation(rng)
    moved = H @ Q.T
    moved[:, 0] += rng.normal(size=3)
    before, after = fl.post.resultant_series(states(shell, H, moved), shell)
    scale = np.abs(before.at_points).max(axis=(0, 1))
    assert scale.min() > 0
    assert np.abs((after.at_points - before.at_points) / scale).max() <= 1e-9
    assert np.abs((after.nodal - before.nodal) / scale).max() <= 1e-9
    np.testing.assert_allclose(after.axes, before.axes @ Q.T, atol=1e-12)


@cache
def of_fields(u: UnitSystem) -> np.ndarray:
    """Of cells whose fields depend on themselves, far from the start: forces, moments over 1 m."""
    layer = fl.ShellSection.layer(u.length(0.02), fl.Material(u.stress(1e9), 0.3, 0.0))
    mesh = fl.mesh.parametric_surface(
        lambda a, b: u.length([a + 0.1 * a * b, 0.7 * b, 0.1 * a * b]), (3, 2)
    )
    shell = fl.Shell(mesh, layer, formulation=fl.elements.HellingerReissner(fl.elements.MITC4_PLUS))
    moves = np.random.default_rng(3).normal(size=(len(shell.frames), 6))
    moves *= [1e-4] * 3 + [0.1] * 3
    H = lie.se3_retract(shell.frames, u.increment(moves))
    found = fl.post.resultants(states(shell, H), shell).at_points
    forces = u.inverse.of(found[..., :3], mass=1, time=-2)
    return np.array([forces, u.inverse.of(found[..., 3:6], length=1, mass=1, time=-2)])


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_resultants_are_the_same_in_all_units(u):
    """Fields of cells are iterated until forces and moments, by sizes of theirs, change no more."""
    for found, expected in zip(of_fields(u), of_fields(METRES), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_the_order_of_cells_and_nodes_does_not_matter():
    shell = arch_shell(along=around)
    H = crumpled(shell)
    rng = np.random.default_rng(8)
    cells = rng.permutation(len(shell.model.mesh.cells))
    number = rng.permutation(len(H))  # new number of each node
    node = np.argsort(number)
    mesh = fl.mesh.SurfaceMesh.from_cells(
        shell.model.mesh.points[node], number[shell.model.mesh.cells[cells]], "quadrilateral"
    )
    shuffled = fl.Shell(mesh, LAYER, director=outward, along=around)
    one = fl.post.resultants(states(shell, H), shell)
    other = fl.post.resultants(states(shuffled, H[node]), shuffled)
    scale = np.abs(one.at_points).max()
    np.testing.assert_allclose(other.at_points, one.at_points[cells], atol=1e-9 * scale)
    np.testing.assert_allclose(other.nodal, one.nodal[node], atol=1e-9 * scale)


def test_axes_of_the_user():
    """Other axes, the same tensor; and they may depend on the position."""
    shell = arch_shell(along=around)
    H = crumpled(shell)
    own = fl.post.resultants(states(shell, H), shell)
    other = fl.post.resultants(states(shell, H), shell, along=lambda x: [-x[2], 1 + x[0], x[0]])
    assert np.abs(own.at_points - other.at_points).max() > 0.1 * np.abs(own.at_points).max()
    for name in ("N max", "N min", "M max", "M min", "Q", "von Mises top", "von Mises bottom"):
        for kind in ("raw", "mean"):
            a, b = (getattr(r, kind)(name) for r in (own, other))
            # means are taken in turning axes: not the same tensor to the last digit
            bound = 1e-11 if kind == "raw" else 0.1
            assert np.abs(a - b).max() <= bound * np.abs(a).max(), (name, kind)
    # e₁ against e₂
    across = fl.post.resultants(states(shell, H), shell, along=(0, 1, 0))
    swapped = own.at_points[..., [1, 0, 2, 4, 3, 5, 7, 6]] * [1, 1, -1, 1, 1, -1, -1, 1]
    np.testing.assert_allclose(
        np.abs(across.at_points), np.abs(swapped), atol=1e-11 * np.abs(swapped).max()
    )


def test_axes_that_jump_are_refused_at_nodes_only():
    """By default e₁ is the first edge of a cell: of triangles it can be any."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), cell="triangle")
    turned_cells = mesh.cells.copy()
    turned_cells[::2] = turned_cells[::2][:, [1, 2, 0]]
    mesh = fl.mesh.SurfaceMesh.from_cells(mesh.points, turned_cells, "triangle")
    shell = fl.Shell(mesh, LAYER)
    x = shell.frames[:, 0] * [1.01, 1, 1]
    result = states(shell, directed(x, np.tile([0, 0, 1.0], (len(x), 1))))
    found = fl.post.resultants(result, shell)
    with pytest.raises(ValueError, match=r"differ .*by up to \d+°: give .*along.*N max"):
        found.nodal  # noqa: B018
    with pytest.raises(ValueError, match="give resultants"):
        found.smooth("N11")
    E = 0.5 * (1.01**2 - 1)
    N = LAYER.stiffness @ [E, 0, 0, 0, 0, 0, 0, 0]
    np.testing.assert_allclose(found.smooth("N max"), N[0], rtol=1e-9)
    np.testing.assert_allclose(found.smooth("N min"), N[1], rtol=1e-9)
    stress = [N[0] / 0.1, N[1] / 0.1, 0.0]
    np.testing.assert_allclose(found.smooth("von Mises top"), mises(np.array(stress)), rtol=1e-9)
    along = fl.post.resultants(result, shell, along=(1, 0, 0))
    np.testing.assert_allclose(along.nodal, np.broadcast_to(N, along.nodal.shape), atol=1e-9)


def test_edges_are_where_the_mesh_ends():
    for cell in ("triangle", "quadrilateral"):
        mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (4, 3), cell=cell)
        shell = fl.Shell(mesh, LAYER)
        found = fl.post.resultants(states(shell, shell.frames), shell, along=(1, 0, 0))
        groups = found.stress_points.patches
        x, y, _ = mesh.points.T
        outside = (np.minimum(x, y) < 1e-9) | (np.maximum(x, y) > 1 - 1e-9)
        np.testing.assert_array_equal(groups.edge, outside)
        np.testing.assert_array_equal(groups.node, np.arange(len(x)))


def test_nothing_is_averaged_across_a_jump():
    """Half of a strip is twice as thick: under a pull along it N11 is the same, N22 is not."""
    plain = fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0.0), (4, 2))
    centre = plain.points[plain.cells].mean(axis=1)
    mesh = fl.mesh.SurfaceMesh.from_cells(
        plain.points,
        plain.cells,
        "quadrilateral",
        groups={
            "thin": np.flatnonzero(centre[:, 0] < 1),
            "thick": np.flatnonzero(centre[:, 0] > 1),
        },
    )
    thick = fl.ShellSection.layer(0.2, SOFT)
    shell = fl.Shell(mesh, {"thin": LAYER, "thick": thick}, along=(1, 0, 0))
    x = shell.frames[:, 0] * [1, 1.01, 1]
    result = states(shell, directed(x, np.tile([0, 0, 1.0], (len(x), 1))))
    found = fl.post.resultants(result, shell)
    node = found.stress_points.patches.node
    assert len(node) == len(x) + 3
    value = found.smooth("N22")
    middle = np.abs(shell.frames[node, 0, 0] - 1) < 1e-9
    assert sorted(np.round(value[middle] / value[0], 9)) == [1, 1, 1, 2, 2, 2]
    # forces of twice the size on twice the thickness: the stress is everywhere the same
    np.testing.assert_allclose(found.smooth("von Mises top"), found.raw("von Mises top")[0, 0])
    with pytest.raises(ValueError, match=r"jump at 3 nodes.*cell_function"):
        found.function("N22")
    np.testing.assert_allclose(np.unique(np.round(found.cell_function("N22").x.array, 9)).size, 2)


def test_nothing_is_averaged_where_bending_alone_jumps():
    """Plies in another order have the same stiffness in the plane."""
    hard, soft = (fl.sections.Ply(0.025, fl.Material(E, 0.3, 2.0)) for E in (400.0, 100.0))
    outside = fl.ShellSection.laminate([hard, soft, soft, hard])
    inside = fl.ShellSection.laminate([soft, hard, hard, soft])
    np.testing.assert_allclose(outside.stiffness[:3, :3], inside.stiffness[:3, :3])
    mesh = fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0.0), (4, 2))
    shell = fl.Shell(mesh, lambda centre: outside if centre[0] < 1 else inside, along=(1, 0, 0))
    found = fl.post.resultants(states(shell, shell.frames), shell)
    assert len(found.stress_points.patches.node) == len(shell.frames) + 3


def test_means_of_distorted_cells_are_means_over_their_area():
    """∫N₁₂ dA is the work of the load on a unit of shear strain, whatever the cells."""
    length, width, force = 2.0, 1.0, 1e-6

    def position(a: float, b: float):
        bump = 0.15 * np.sin(np.pi * a) * np.sin(2 * np.pi * b)
        return length * (a + bump), width * (b + a * (1 - a) * b * (1 - b)), 0.0

    shell = fl.Shell(fl.mesh.parametric_surface(position, (4, 3)), LAYER, along=(1, 0, 0))
    scene = fl.Scene()
    scene.add(shell)
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", (0, force, 0)))
    found = fl.post.resultants(fl.statics(scene), shell)
    areas = found.areas.sum(axis=1)
    assert np.ptp(found.areas, axis=1).max() > 0.1 * areas.max() / 4
    total = areas @ found.mean("N12")
    np.testing.assert_allclose(total, force * width * length, rtol=1e-4)


def test_nothing_is_averaged_across_a_kink():
    def roof(a: float, b: float):
        return 2 * a, b, min(2 * a, 2 - 2 * a)

    shell = fl.Shell(
        fl.mesh.parametric_surface(roof, (4, 2)), LAYER, kink_angle=np.pi, along=(0, 1, 0)
    )
    result = states(shell, shell.frames)
    found = fl.post.resultants(result, shell)
    assert len(found.stress_points.patches.node) == len(shell.frames) + 3
    assert len(fl.post.resultants(result, shell, kink_angle=np.pi).stress_points.patches.node) == 15


# --- equilibrium ---

LENGTH, WIDTH, FORCE = 10.0, 2.0, 3e-4


def cantilever(cell, degree, formulation, cells=(8, 2), force=(0.0, 0.0, FORCE / WIDTH)):
    shell = fl.Shell(
        fl.mesh.parametric_surface(
            lambda a, b: (LENGTH * a, WIDTH * b, 0.0), cells, cell=cell, degree=degree
        ),
        fl.ShellSection.layer(0.1, fl.Material(1.2e6, 0.0, 1.0)),
        along=(1, 0, 0),
        formulation=formulation,
    )
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=force))
    return shell, fl.follow_loads(scene)


# Bending strain is constant along four- and three-node cells; the means of quadrilaterals are
# exact, and so are the planes through them that give the values at edges. Nine nodes are exact.
@pytest.mark.parametrize(
    ("cell", "degree", "formulation", "at_nodes", "in_cells"),
    [
        pytest.param("quadrilateral", 1, fl.elements.HellingerReissner(), 0.0, 0.0, id="HR"),
        pytest.param("quadrilateral", 1, fl.elements.HuWashizu(), 0.0, 0.0, id="HW"),
        pytest.param("quadrilateral", 1, fl.elements.DisplacementBased(), 0.0, 0.0, id="MITC4"),
        pytest.param("triangle", 1, fl.elements.HellingerReissner(), 0.02, 0.03, id="MITC3+"),
        pytest.param("triangle", 2, fl.elements.DisplacementBased(), 0.02, 0.015, id="MITC6"),
        pytest.param("quadrilateral", 2, fl.elements.DisplacementBased(), 0.0, 0.0, id="MITC9"),
    ],
)
def test_cantilever_under_end_shear(cell, degree, formulation, at_nodes, in_cells):
    """Moment linear, F L at the clamp, and each cut carries the load; ν = 0."""
    shell, result = cantilever(cell, degree, formulation)
    found = fl.post.resultants(result, shell)
    largest = FORCE / WIDTH * LENGTH

    def error(values, x):
        return np.abs(values + FORCE / WIDTH * (LENGTH - x)).max() / largest

    x, area = shell.model.mesh.points[:, 0], found.areas.sum(axis=1)
    centre = (found.areas * found.points[..., 0]).sum(axis=1) / area
    assert error(found.smooth("M11"), x) <= at_nodes + 1e-6
    assert error(found.mean("M11"), centre) <= in_cells + 1e-6
    # means of the strips of cells between cuts
    strip = np.floor(centre / LENGTH * 8)
    total = np.bincount(strip.astype(int), found.mean("Q1") * area) / (LENGTH / 8)
    np.testing.assert_allclose(total, FORCE, rtol=1e-5)


def test_moment_at_the_clamp_in_large_bending():
    """The lever of the load in the deformed state; the cells' means half a cell away."""
    shell, result = cantilever("quadrilateral", 1, None, (32, 1), (0.0, 0.0, 2.0))
    found = fl.post.resultants(result, shell)
    x = result.frames[-1][result.info.body(shell.name).nodes, 0]
    assert x[:, 2].max() > 0.4 * LENGTH
    end = x[shell.model.mesh.nodes("a=1")].mean(axis=0)
    middle = x[shell.model.mesh.cells].mean(axis=1)
    exact = -2.0 * (end[0] - middle[:, 0])
    np.testing.assert_allclose(found.mean("M11"), exact, atol=2e-3 * np.abs(exact).max())
    # each cut carries the load; N alone does not, for the shell is bent much
    np.testing.assert_allclose(
        found.cut_forces[:, :, 0].mean(axis=1), np.tile([0, 0, 2.0], (32, 1)), atol=0.01
    )
    assert np.abs(found.mean("N11")).max() > 2.0
    np.testing.assert_allclose(
        found.cut_moments[:, :, 0].mean(axis=1) @ [0, 1, 0], found.mean("M11"), rtol=1e-3
    )


RADIUS, HEIGHT, THICKNESS = 2.0, 1.0, 0.02


def cylinder(cell, degree, formulation, count=12):
    """A quarter with free ends; symmetric about both planes and at mid-height."""

    def position(a: float, b: float):
        angle = 0.5 * np.pi * a
        return RADIUS * np.cos(angle), RADIUS * np.sin(angle), HEIGHT * b

    plain = fl.mesh.parametric_surface(position, (count, 2), cell=cell, degree=degree)
    centre = plain.points[plain.corners].mean(axis=1)
    column = np.floor(np.arctan2(centre[:, 1], centre[:, 0]) / (0.5 * np.pi) * count).astype(int)
    mesh = fl.mesh.SurfaceMesh.from_cells(
        plain.points,
        plain.cells,
        cell,
        groups={str(k): np.flatnonzero(column == k) for k in range(count)},
        curves=plain.curves,
    )
    shell = fl.Shell(
        mesh,
        fl.ShellSection.layer(THICKNESS, fl.Material(1e6, 0.3, 1.0)),
        director=lambda x: np.array([x[0], x[1], 0.0]) / np.hypot(x[0], x[1]),
        along=(0, 0, 1),
        formulation=formulation,
    )
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.symmetry("b=0", (0, 0, 1))
    return shell


@pytest.mark.parametrize(("cell", "degree", "formulation"), ELEMENTS)
def test_cylinder_under_pressure_and_axial_pull(cell, degree, formulation):
    """Membrane theory: p R around and q along; bending, which is p t²/12 or so, is no matter."""
    count, p, q = 12, 0.01, 0.05
    shell = cylinder(cell, degree, formulation, count)
    scene = fl.Scene()
    scene.add(shell)
    for k in range(count):
        angle = 0.5 * np.pi * (k + 0.5) / count
        push = p * np.array([np.cos(angle), np.sin(angle), 0.0])
        scene.add(fl.AreaLoad(shell, push, cells=str(k)))
    scene.add(fl.loads.EdgeLoad(shell, "b=1", force=(0, 0, q)))
    found = fl.post.resultants(fl.follow_loads(scene), shell)
    # triangles do not bend and stretch independently: from cell to cell the error alternates
    alone, together = (3e-3, 3e-3) if cell == "quadrilateral" else (0.2, 3e-3)
    weight = found.areas / found.areas.sum()
    for value, exact in ((found.nodal[:, 1], p * RADIUS), (found.nodal[:, 0], q)):
        np.testing.assert_allclose(value, exact, rtol=alone)
    mean = np.einsum("mg,mgi->i", weight, found.at_points)
    np.testing.assert_allclose(mean[:2], [q, p * RADIUS], rtol=together)
    np.testing.assert_allclose(found.nodal[:, 3:6], 0.0, atol=0.1 * q * THICKNESS)


# --- functions, files, pictures ---


@pytest.mark.parametrize(("cell", "degree", "formulation"), ELEMENTS)
def test_functions_interpolate_the_values(cell, degree, formulation):
    shell = arch_shell(cell, degree, formulation, along=around)
    H = crumpled(shell)
    found = fl.post.resultants(states(shell, H), shell)
    f = found.function("M11")
    positions = f.function_space.tabulate_dof_coordinates()
    nearest = np.linalg.norm(shell.model.mesh.points - positions[:, np.newaxis], axis=2).argmin(
        axis=1
    )
    np.testing.assert_array_equal(f.x.array, found.smooth("M11")[nearest])
    moved = found.function(deformed=True)
    positions = moved.function_space.tabulate_dof_coordinates()
    nearest = np.linalg.norm(H[:, 0] - positions[:, np.newaxis], axis=2).argmin(axis=1)
    np.testing.assert_array_equal(moved.x.array.reshape(-1, 8), found.nodal[nearest])
    # integrals by DOLFINx and by our own areas
    measures = shell.model.formulation.measures_for(cell, degree)
    dx = ufl.Measure("dx", found.mesh, metadata={"quadrature_degree": measures.quadrature_degree})
    exact = (found.areas[..., np.newaxis] * found.at_points).sum(axis=(0, 1))
    points = found.point_function()
    points.name = "points"
    for g in (points, found.cell_function()):
        for i in range(8):
            total = fem.assemble_scalar(fem.form(g[i] * dx))
            size = (found.areas * np.abs(found.at_points[..., i])).sum()
            # the nearest bilinear field need not have the same mean where stress is of higher order
            exactly = degree == 1 or g.name == "points"
            assert abs(total - exact[i]) <= (1e-12 if exactly else 0.05) * size
    assert found.point_function("N max").x.array.size == found.areas.size


def test_files_hold_cell_and_point_data(tmp_path):
    import pyvista

    shell, result = cantilever("quadrilateral", 1, None)
    found = fl.post.resultants(result, shell)
    found.write_vtk(tmp_path / "plate.vtu")
    grid = pyvista.read(tmp_path / "plate.vtu")
    np.testing.assert_allclose(grid.points, found.frames[:, 0], atol=1e-6)
    for name in (*COMPONENTS, "M max", "von Mises bottom"):
        np.testing.assert_array_equal(grid.point_data[name], found.smooth(name))
        np.testing.assert_array_equal(grid.cell_data[name], found.mean(name))
    np.testing.assert_allclose(grid.cell_data["e1"][:, 0], 1.0, atol=1e-4)
    assert grid.point_data["displacement"][:, 2].max() > 0
    with pytest.raises(ValueError, match=r"'\.vtu'"):
        found.write_vtk(tmp_path / "plate.vtk")
    series = fl.post.resultant_series(result, shell)
    fl.post.write_resultants(tmp_path / "plate.pvd", series, result.factors)
    assert pyvista.get_reader(tmp_path / "plate.pvd").time_values == [1.0]
    with pytest.raises(ValueError, match="one time for each of 1 states"):
        fl.post.write_resultants(tmp_path / "plate.pvd", series, [0.0, 1.0])


@pytest.mark.parametrize(("cell", "degree"), [("triangle", 2), ("quadrilateral", 2)])
def test_cells_of_second_degree_are_drawn_as_they_are(tmp_path, cell, degree):
    """Their area in the file is that of the shell: the nodes are in VTK's order."""
    import pyvista

    shell = arch_shell(cell, degree, fl.elements.DisplacementBased(), along=around)
    fl.post.resultants(states(shell, shell.frames), shell).write_vtk(tmp_path / "arch.vtu")
    cells = pyvista.read(tmp_path / "arch.vtu").tessellate(max_n_subdivide=3)
    area = cells.compute_cell_sizes(length=False, volume=False)["Area"].sum()
    assert area == pytest.approx(shell.model.areas().sum(), rel=2e-3)


def test_hdf5_file_holds_everything(tmp_path):
    import h5py

    shell, result = cantilever("quadrilateral", 1, None)
    found = fl.post.resultants(result, shell)
    found.save(tmp_path / "plate.h5")
    with h5py.File(tmp_path / "plate.h5") as file:
        assert tuple(file.attrs["components"]) == COMPONENTS
        np.testing.assert_array_equal(file["averaged"], found.nodal)
        for name in ("in_cells", "at_points", "points", "areas", "cut_forces", "cut_moments"):
            np.testing.assert_array_equal(file[name], getattr(found, name))
        np.testing.assert_array_equal(file["axes"], found.stress_points.shared)
        positions = file["positions"][()][file["cells"][()]]
        np.testing.assert_array_equal(positions, shell.model.mesh.points[shell.model.mesh.cells])


def test_picture(tmp_path):
    from PIL import Image

    shell, result = cantilever("quadrilateral", 1, None, (8, 1), (0.0, 0.0, 2.0))
    found = fl.post.resultants(result, shell)
    found.picture(tmp_path / "M11.png", "M11", units=fl.post.Units(length="m", force="kN"))
    image = np.asarray(Image.open(tmp_path / "M11.png").convert("RGB")).reshape(-1, 3)
    assert len(np.unique(image, axis=0)) > 200  # a scale of colours, not one
    with pytest.raises(ValueError, match=r"'\.png'"):
        found.picture(tmp_path / "M11.jpg", "M11")


def test_bad_input_is_named():
    shell, result = cantilever("quadrilateral", 1, None)
    other = fl.Shell(shell.model.mesh, ANGLE_PLY, name="other")
    with pytest.raises(ValueError, match=r"no body 'other'"):
        fl.post.resultants(result, other)
    with pytest.raises(ValueError, match="has 1 states, got state 1"):
        fl.post.resultants(result, shell, 1)
    with pytest.raises(ValueError, match="must not be zero or normal"):
        fl.post.resultants(result, shell, along=(0, 0, 1))
    with pytest.raises(ValueError, match=r"along at .* must be 3"):
        fl.post.resultants(result, shell, along=lambda x: x[:2])
    found = fl.post.resultants(result, shell)
    with pytest.raises(ValueError, match="has no quantity 'N13'; it has: N11"):
        found.raw("N13")
    laminate = fl.post.resultants(states(other, other.frames), other)
    with pytest.raises(ValueError, match="'von Mises top' is the stress in a homogeneous layer"):
        laminate.mean("von Mises top")

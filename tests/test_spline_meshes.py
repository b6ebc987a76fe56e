"""Spline meshes: truncated hierarchical functions, and thin shells on cells of several sizes."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import sharp_gradients as sharp
from fem_lie import lie
from tests.assembled import Assembled
from tests.body_alone import BodyAlone
from tests.hermite_functions import bicubic, gauss_points

STEEL = fl.Material(1e3, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, STEEL)
UNSYMMETRIC = fl.ShellSection.laminate(
    [fl.sections.Ply(0.04, fl.Material(3e3, 0.2, 1.0)), fl.sections.Ply(0.06, STEEL)]
)


def flat(a, b):
    return np.array([3.0 * a, 2.0 * b, 0.0])


def wavy(a, b):
    return np.array([a, b * (1 + 0.3 * a), 0.2 * a * b + 0.1 * np.sin(2 * a)])


def cut_anyhow(function=flat, cells=(3, 2), times=4, seed=0):
    """Cells of several levels: a few cut, some times over."""
    rng, patch = np.random.default_rng(seed), fl.mesh.smooth_patch(function, cells)
    if function is flat:
        # exactly, without what differences leave
        patch = fl.mesh.SmoothPatch(
            patch.nodal_vectors.round(6), tuple(s.round(6) for s in patch.sizes)
        )
    mesh = fl.mesh.spline_mesh(patch)
    for _ in range(times):
        mesh = fl.adaptivity.refine(mesh, rng.choice(len(mesh.cells), 3, replace=False))
    return mesh


def random_function(mesh, seed=1):
    """One of the space, by its nodal vectors at all points, those that hang too."""
    surface = mesh.surface()
    body = fl.ThinShell(mesh, LAYER)
    rows = np.random.default_rng(seed).normal(size=surface.nodal_vectors.shape)
    fourth, _ = body.model.fourth_vectors(surface._replace(nodal_vectors=rows))
    frames = body.frames.copy()
    count = body.model.points_count
    frames[:count, :2], frames[count:, 1], frames[count:, 2] = rows[:, :2], fourth, rows[:, 2]
    a, b = mesh.sizes.T
    scales = np.stack([np.ones_like(a), a, b, a * b], axis=1)[:, np.newaxis, :, np.newaxis]
    filled = mesh.nodal_vectors.copy()
    filled[mesh.cells] = body.model.hermite_vectors(frames).reshape(-1, 4, 4, 3) / scales
    return replace(mesh, nodal_vectors=filled)


def values(mesh, cells, at, *order):
    """Of the surface of a mesh at points (c, 2) within cells (c,), of nodal vectors."""
    a, b = mesh.sizes[cells].T
    scales = np.stack([np.ones_like(a), a, b, a * b], axis=1)[:, np.newaxis, :, np.newaxis]
    vectors = (mesh.nodal_vectors[mesh.cells[cells]] * scales).reshape(-1, 16, 3)
    return np.einsum("ca,caj->cj", bicubic(at, *order), vectors)


def basis(mesh):
    """Values of all functions at points of Gauss of all cells, (m g, 4 n), and their weights."""
    body, (x, w) = fl.ThinShell(mesh, LAYER), gauss_points(4)
    parts = bicubic(x) @ body.model.hermite_matrices()
    points = body.model.connectivity[:, :4]
    found = np.zeros((*parts.shape[:2], body.model.points_count, 4))
    for corner in range(4):
        for cell, point in enumerate(points[:, corner]):
            found[cell, :, point] += parts[cell][:, 4 * corner : 4 * corner + 4]
    areas = mesh.sizes.prod(axis=1)[:, np.newaxis] * w
    return found.reshape(areas.size, -1), areas.ravel()


@pytest.mark.parametrize("seed", range(3))
def test_functions_are_independent_and_as_many_as_points_that_do_not_hang_have_vectors(seed):
    mesh = cut_anyhow(seed=seed)
    N, weights = basis(mesh)
    assert mesh.levels.max() >= 2
    assert N.shape[1] == 4 * int((mesh.hanging() < 0).sum())
    products = N.T @ (weights[:, np.newaxis] * N)
    size = np.sqrt(np.diag(products))
    least = np.linalg.eigvalsh(products / np.outer(size, size))[0]
    assert least > 1e-5


def test_values_are_a_partition_of_unity():
    """Those of the functions that are one at a point, with those that hang left out."""
    mesh = cut_anyhow()
    N, _ = basis(mesh)
    np.testing.assert_allclose(N[:, ::4].sum(axis=1), 1.0, rtol=1e-13)


def test_functions_are_truncated():
    """Where all cells around a point are fine, those of coarser points are nothing."""
    mesh = fl.adaptivity.refine(fl.mesh.spline_mesh(fl.mesh.smooth_patch(flat, (2, 2))), [0])
    N, _ = basis(mesh)
    body = fl.ThinShell(mesh, LAYER)
    positions = np.einsum(
        "ga,maj->mgj",
        bicubic(gauss_points(4)[0]),
        body.model.hermite_vectors(),
    ).reshape(-1, 3)
    (corner,) = np.flatnonzero(
        (body.frames[: body.model.points_count, 0] == [1.5, 1.0, 0]).all(axis=1)
    )
    in_corner = (positions[:, 0] < 0.75) & (positions[:, 1] < 0.5)
    assert np.abs(N[in_corner, 4 * corner]).max() == 0.0
    assert np.abs(N[~in_corner, 4 * corner]).max() > 0.9


def test_bicubics_are_in_the_space_exactly():
    mesh = cut_anyhow()
    body, rng = fl.ThinShell(mesh, LAYER), np.random.default_rng(3)
    c, surface = rng.normal(size=(4, 4)), mesh.surface()
    x, y = surface.nodal_vectors[:, 0, :2].T / [[3.0], [2.0]]
    polynomial = np.polynomial.polynomial
    derivative = [
        polynomial.polyval2d(x, y, polynomial.polyder(polynomial.polyder(c, i, axis=0), j, axis=1))
        / (3.0**i * 2.0**j)
        for i, j in ((0, 0), (1, 0), (0, 1), (1, 1))
    ]
    rows = np.repeat(np.stack(derivative, axis=1)[:, :, np.newaxis], 3, axis=2)
    fourth, _ = body.model.fourth_vectors(surface._replace(nodal_vectors=rows))
    frames, n = body.frames.copy(), body.model.points_count
    frames[:n, :2], frames[n:, 1], frames[n:, 2] = rows[:, :2], fourth, rows[:, 2]
    at = rng.random((5, 2))
    table = bicubic(at)
    found = np.einsum("ga,ma->mg", table, body.model.hermite_vectors(frames)[..., 0])
    positions = np.einsum("ga,maj->mgj", table, body.model.hermite_vectors())
    wanted = polynomial.polyval2d(positions[..., 0] / 3.0, positions[..., 1] / 2.0, c)
    np.testing.assert_allclose(found, wanted, atol=1e-12 * np.abs(wanted).max())


def test_spaces_are_nested():
    """Any function of a mesh is one of the mesh that is cut further."""
    mesh = random_function(cut_anyhow())
    finer = fl.adaptivity.refine(mesh, np.arange(0, len(mesh.cells), 3))
    again = random_function(finer)  # the space of the finer one
    assert len(finer.surface().nodal_vectors) > len(mesh.surface().nodal_vectors)
    # what hangs there is what the points that do not hang say
    surface = finer.surface()
    body = fl.ThinShell(finer, LAYER)
    a, b = finer.sizes.T
    scales = np.stack([np.ones_like(a), a, b, a * b], axis=1)[:, np.newaxis, :, np.newaxis]
    whole = (finer.nodal_vectors[finer.cells] * scales).reshape(-1, 16, 3)
    np.testing.assert_allclose(
        body.model.hermite_vectors(), whole, atol=1e-13 * np.abs(whole).max()
    )
    assert again.nodal_vectors.shape == finer.nodal_vectors.shape and len(surface.hanging) == len(
        finer.cells
    )


def test_values_and_slopes_are_continuous_where_corners_hang():
    mesh = random_function(cut_anyhow())
    hanging = mesh.hanging()
    assert (hanging >= 0).sum() > 5
    for point in np.flatnonzero(hanging >= 0):
        large = hanging[point]
        small, corner = np.argwhere(mesh.cells == point)[0]
        end = mesh.parents[small, corner]
        k = np.flatnonzero(mesh.cells[large] == end)[0]
        other = np.flatnonzero(mesh.cells[large] == mesh.cells[small, mesh.quarters[small]])[0]
        ends = np.array([[k & 1, k >> 1], [other & 1, other >> 1]], dtype=float)
        inner = np.array([[corner & 1, corner >> 1]], dtype=float)
        stays = np.array([[mesh.quarters[small] & 1, mesh.quarters[small] >> 1]], dtype=float)
        for share in (0.3, 0.8):
            here = values(mesh, [small], stays + share * (inner - stays))
            there = values(mesh, [large], ends[1:] + 0.5 * share * (ends[:1] - ends[1:]))
            np.testing.assert_allclose(here, there, atol=1e-12 * np.abs(mesh.nodal_vectors).max())
            for order, axis in (((1, 0), 0), ((0, 1), 1)):
                here = values(mesh, [small], stays + share * (inner - stays), *order)
                there = values(
                    mesh, [large], ends[1:] + 0.5 * share * (ends[:1] - ends[1:]), *order
                )
                here, there = here / mesh.sizes[small, axis], there / mesh.sizes[large, axis]
                np.testing.assert_allclose(
                    here, there, atol=1e-11 * np.abs(mesh.nodal_vectors).max()
                )


def test_cells_that_meet_differ_by_one_level():
    mesh = fl.mesh.spline_mesh(fl.mesh.smooth_patch(flat, (4, 4)))
    for _ in range(4):
        corner = np.argmin(np.linalg.norm(mesh.nodal_vectors[mesh.cells, 0].mean(axis=1), axis=1))
        mesh = fl.adaptivity.refine(mesh, [corner])
    assert mesh.levels.max() == 4
    for point in range(len(mesh.nodal_vectors)):
        levels = mesh.levels[(mesh.cells == point).any(axis=1)]
        hung = mesh.hanging()[point]
        levels = np.append(levels, mesh.levels[hung] if hung >= 0 else [])
        assert np.ptp(levels) <= 1
    np.testing.assert_allclose(mesh.sizes.prod(axis=1).sum(), 6.0, rtol=1e-10)


# --- shells on such meshes ---


class Shell(BodyAlone):
    """A thin shell by itself, with corners that hang."""

    size = 0.003

    def __init__(self, function=wavy, section=UNSYMMETRIC):
        body = fl.ThinShell(cut_anyhow(function, (2, 2), 3), section)
        assert (body.model.sizes[:, 3] > 0).sum() > 5
        super().__init__(body, body.model.assemble([body.model]))


def test_forces_are_the_gradient_of_the_energy():
    shell, step = Shell(), 1e-6
    H, d = shell.deformed(), np.random.default_rng(2).normal(size=(shell.count, 6))
    ahead, behind = (shell.term.energy(shell.follow(H, s * step * d)) for s in (1, -1))
    assert np.vdot(shell.forces(H), d) == pytest.approx((ahead - behind) / (2 * step), rel=1e-6)


def test_tangent_is_the_derivative_of_the_forces():
    shell, step = Shell(), 1e-6
    H, d = shell.deformed(), np.random.default_rng(2).normal(size=(shell.count, 6))
    ahead, behind = (shell.forces(shell.follow(H, s * step * d)) for s in (1, -1))
    numeric = ((ahead - behind) / (2 * step)).ravel()
    K = shell.matrix(H)
    np.testing.assert_allclose(K @ d.ravel(), numeric, atol=1e-6 * np.abs(numeric).max())
    np.testing.assert_allclose(K, K.T, atol=1e-13 * np.abs(K).max())


def test_rigid_motion_strains_nothing_and_forces_turn_along():
    shell = Shell()
    motion = lie.se3_exp(np.array([3.0, -2.0, 1.0, 2.0, 0.5, -1.5]))
    rest = shell.turned(shell.body.frames, motion)
    strains = shell.term.strains(rest)
    assert np.abs(strains).max() < 1e-11
    H = shell.turned(shell.deformed(), np.eye(4, 3, -1))
    force = shell.forces(H)
    moved = shell.forces(shell.turned(H, motion))
    np.testing.assert_allclose(moved, force, atol=1e-11 * np.abs(shell.matrix(H)).max())


@pytest.mark.parametrize("exact", ["stretch", "curvature"])
def test_patch_test_across_levels(exact):
    """Constant strain or curvature has no forces but at the edges: of the matrix, exactly."""
    shell = Shell(flat, LAYER)
    body, n = shell.body, shell.body.model.points_count
    x, y = body.frames[:n, 0, :2].T
    zero, one = np.zeros(n), np.ones(n)
    if exact == "stretch":
        field = [0.2 * x + 0.1 * y, 0.3 * y, zero], [0.2 * one, zero, zero]
        field += [0.1 * one, 0.3 * one, zero], [zero, zero, zero]
    else:
        field = [zero, zero, x * x + 0.4 * x * y], [zero, zero, 2 * x + 0.4 * y]
        field += [zero, zero, 0.4 * x], [zero, zero, 0.4 * one]
    rows = np.array(field).transpose(2, 0, 1)
    fourth, _ = body.model.fourth_vectors(body_surface(body)._replace(nodal_vectors=rows))
    d = np.zeros((2 * n, 2, 3))
    # axes are those of space: the plate is flat, along x and y
    d[:n, 0], d[:n, 1], d[n:, 1], d[n:, 0] = rows[:, 0], rows[:, 1], rows[:, 2], fourth
    f = (shell.matrix(body.frames) @ d.ravel()).reshape(2 * n, 6)
    outer = np.unique(np.concatenate([edge.points for edge in body.model._edges.values()]))
    inner = np.setdiff1d(np.arange(n), outer)
    assert len(inner) > 10
    assert np.abs(f[inner]).max() < 1e-10 * np.abs(f).max()
    assert np.abs(f[n + inner]).max() < 1e-10 * np.abs(f).max()


def body_surface(body):
    """What :meth:`ThinShell.fourth` reads."""
    return cut_anyhow(flat, (2, 2), 3).surface()


def cantilever(mesh, force=4.0):
    """A strip that a force at its end bends by about a right angle."""
    scene = fl.Scene()
    section = fl.ShellSection.layer(0.1, fl.Material(1.2e6, 0.0, 1.0))
    shell = scene.add(fl.ThinShell(mesh, section, name="strip"))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0, 0, force)))
    return shell, scene


def strip(cells):
    return fl.mesh.smooth_patch(lambda a, b: (10.0 * a, b, 0.0), cells)


def test_all_cells_cut_are_the_grid_that_is_twice_as_fine():
    bodies, positions = [], []
    for mesh in (
        fl.adaptivity.refine(fl.mesh.spline_mesh(strip((4, 1))), np.arange(4)),
        strip((8, 2)),
    ):
        shell, scene = cantilever(mesh)
        lying = shell.frames[: shell.model.points_count, 0].round(6)
        order = np.lexsort(lying.T)
        bodies.append(lying[order])
        positions.append(fl.statics(scene).frames[-1][order, 0])
    np.testing.assert_array_equal(*bodies)
    assert np.ptp(positions[0][:, 2]) > 5.0
    np.testing.assert_allclose(*positions, atol=1e-7)


def test_a_strip_of_cells_of_three_sizes_bends_as_one_of_equal_ones():
    """By a large rotation: the end of an elastica, by both meshes."""
    mesh = fl.mesh.spline_mesh(strip((6, 2)))
    for _ in range(2):
        near = np.flatnonzero(mesh.nodal_vectors[mesh.cells, 0, 0].mean(axis=1) < 3.0)
        mesh = fl.adaptivity.refine(mesh, near[::2])
    tips = []
    for given in (mesh, strip((24, 4))):
        shell, scene = cantilever(given)
        result = fl.statics(scene)
        tips.append(result.frames[-1][shell.points("11")[0].node, 0])
    assert (mesh.surface().hanging > 0).any() and tips[0][2] > 5.0
    np.testing.assert_allclose(tips[0], tips[1], atol=2e-3)


def test_loads_on_areas_have_their_resultant_where_corners_hang():
    """Forces, and moments with those on slopes."""
    body = Shell(flat, LAYER).body
    load = fl.AreaLoad(body, (0.0, 0.0, 2.0))
    assert load.nodal()[:, 2].sum() == pytest.approx(2.0 * 6.0, rel=1e-13)
    moment = (body.frames[:, 0, 0] * load.nodal()[:, 2]).sum()
    slopes = load.on_directors()
    moment += (slopes[:, 0, 2] * body.frames[:, 1, 0])[: body.model.points_count].sum()
    assert moment == pytest.approx(2.0 * 6.0 * 1.5, rel=1e-12)


def test_derivative_of_pressure():
    scenes, step = (fl.Scene(), fl.Scene()), 1e-6
    for scene in scenes:
        body = scene.add(fl.ThinShell(cut_anyhow(wavy, (2, 2), 3), UNSYMMETRIC))
    scene.add(fl.loads.SurfacePressure(body, 2.0, gradient=(0.3, -0.2, 0.5)))
    without, pressed = (Assembled(scene, dynamics=False) for scene in scenes)
    pressed.equations.prescribed(1.0).act(1.0)
    rng, free = np.random.default_rng(2), ~pressed.held
    H = pressed.moved(pressed.start, np.where(free, 0.003 * rng.normal(size=free.shape), 0.0))
    d = np.where(free, rng.normal(size=free.shape), 0.0)

    def forces(at):
        return pressed.residual(at) - without.residual(at)

    ahead, behind = (forces(pressed.moved(H, s * step * d)) for s in (1, -1))
    found, wanted = (
        (pressed.matrix(H) - without.matrix(H)) @ d.ravel(),
        (ahead - behind) / (2 * step),
    )
    assert np.abs(wanted).max() > 0.1
    np.testing.assert_allclose(found, wanted, atol=1e-6 * np.abs(wanted).max())


def test_first_frequency_of_a_hinged_plate_across_levels():
    """Kirchhoff's ``2 π² √(B/ρt)``, from above, as masses are consistent."""
    mesh = fl.mesh.spline_mesh(fl.mesh.smooth_patch(lambda a, b: (a, b, 0.0), (4, 4)))
    scene = fl.Scene()
    section = fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7800.0))
    shell = scene.add(
        fl.ThinShell(fl.adaptivity.refine(fl.adaptivity.refine(mesh, [5, 6]), [5, 10]), section)
    )
    for name in ("a=0", "a=1", "b=0", "b=1"):
        shell.hinge(name)
    wanted = 2 * np.pi**2 * np.sqrt(section.stiffness[3, 3] / 78.0)
    error = fl.vibrations(scene, count=1).frequencies[0] / wanted - 1
    assert shell.model.sizes[:, 3].any()
    assert 0 < error < 2e-4


# --- names, several patches, what is refused ---


def test_names_stay_and_patches_are_cut_across_their_edge():
    left = fl.mesh.smooth_patch(lambda a, b: (a, b, 0.0), (2, 2))
    right = fl.mesh.smooth_patch(lambda a, b: (1.0 + a, b, 0.0), (2, 2))
    mesh = fl.mesh.spline_mesh({"left": left, "right": right})
    finer = fl.adaptivity.refine(fl.adaptivity.refine(mesh, mesh.groups["left"]), [2, 3])
    shell = fl.ThinShell(finer, {"left": LAYER, "right": UNSYMMETRIC})
    np.testing.assert_allclose(finer.sizes[finer.groups["left"]].prod(axis=1).sum(), 1.0)
    for name, at in (("left.a=0", 0.0), ("left.a=1", 1.0), ("right.a=0", 1.0), ("right.a=1", 2.0)):
        positions = np.array([p.body.frames[p.node, 0] for p in shell.points(name)])
        np.testing.assert_allclose(positions[:, 0], at)
        assert (np.diff(positions[:, 1]) > 0).all()
        edge = shell.model.edge_quadrature(name)
        assert edge.weights.sum() == pytest.approx(1.0, rel=1e-13)
        np.testing.assert_allclose(edge.positions[..., 0], at, atol=1e-13)
        assert (edge.weights * edge.positions[..., 1] ** 2).sum() == pytest.approx(1 / 3, rel=1e-12)
    one, other = ([p.node for p in shell.points(name)] for name in ("left.a=1", "right.a=0"))
    assert one == other
    assert (finer.surface().hanging > 0).any()
    assert shell.point("right.11").position == pytest.approx([2.0, 1.0, 0.0])


def test_what_cannot_be_is_refused():
    patch = fl.mesh.smooth_patch(flat, (2, 2))
    mesh = fl.mesh.spline_mesh(patch)
    with pytest.raises(ValueError, match="cells"):
        fl.adaptivity.refine(mesh, [4])
    with pytest.raises(ValueError, match="onto"):
        fl.adaptivity.refine(mesh, [0], onto=lambda x: x)
    with pytest.raises(ValueError, match="omit joined"):
        fl.ThinShell(mesh, LAYER, joined=True)
    with pytest.raises(TypeError, match="SplineMesh"):
        fl.mesh.spline_mesh(mesh)
    with pytest.raises(ValueError, match="AncfShell"):
        fl.AncfShell(fl.adaptivity.refine(mesh, [0]), LAYER)

    def ring(a, b):
        return np.array([np.cos(2 * np.pi * a), np.sin(2 * np.pi * a), b])

    with pytest.raises(ValueError, match="three cells around"):
        fl.mesh.spline_mesh(fl.mesh.smooth_patch(ring, (2, 1)), joined=True)


# --- by the error ---


def test_error_falls_with_the_order_of_the_element_and_is_known():
    """A plate with a layer, see the benchmark: from the estimate alone."""
    found = list(sharp.run(sharp.Layer(10.0), sharp.square(8), 0.5, 0.02, 12_000))
    errors, unknowns = (np.array([row[k] for row in found]) for k in (3, 2))
    assert errors[-1] < 0.02 < errors[0]
    assert 0.8 < found[-1][0].relative / errors[-1] < 1.25
    order = np.log(errors[-1] / errors[0]) / np.log(unknowns[-1] / unknowns[0])
    assert order < -0.95, order


def test_cells_in_one_row_have_the_estimate_of_two_rows():
    """One row does not determine polynomials across it: errors once were 1e8 of the solution."""
    estimates = []
    for across in (1, 2):
        shell, scene = cantilever(fl.mesh.spline_mesh(strip((4, across))), 1.0)
        estimates.append(fl.adaptivity.space_error(fl.statics(scene), shell, scene).relative)
    assert 0.8 < estimates[0] / estimates[1] < 1.25


def test_adapt_takes_spline_meshes():
    def build(mesh):
        return cantilever(mesh, 1.0)[1]

    found = fl.adaptivity.adapt(build, fl.mesh.spline_mesh(strip((2, 1))), tolerance=0.01)
    assert found.relative[-1] < 0.01 < found.relative[0] < 0.02
    force = sharp.Force()
    anew = fl.adaptivity.adapt(force.scene, sharp.square(8), tolerance=0.01, fall=0.5)
    assert force.error(anew.scene, anew.result) < 0.012 and anew.unknowns[-1] < 2200
    with pytest.raises(ValueError, match="for Beams and Shells, strip is a ThinShell"):
        goal = fl.adaptivity.PointDisplacementGoal("strip.11", (0, 0, 1))
        fl.adaptivity.adapt(build, fl.mesh.spline_mesh(strip((2, 1))), tolerance=0.05, goal=goal)

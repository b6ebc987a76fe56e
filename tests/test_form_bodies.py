"""Users' forms as bodies of scenes: the general path of all schemes, and what is refused."""

import json
from math import comb

from mpi4py import MPI

import basix.ufl
import dolfinx
import models
import numpy as np
import parallel_form_bodies
import pytest
import ufl
from dolfinx import fem
from own_meshes import own_mesh
from ranks import on_ranks

import fem_lie as fl

SECTION = fl.Section.circle(0.02, fl.Material(E=1e8, nu=0.3, density=1000.0))
GRAVITY = (0.0, 0.0, -9.81)
DAMPING = fl.sections.Damping(mass=0.8, stiffness=2e-3)
ALPHA = fl.GeneralisedAlpha(radius=0.8)
SCHEMES = [ALPHA, fl.EnergyMomentum(), fl.EnergyDecaying(), fl.schemes.Variational()]


def frames(cells: int = 6) -> fl.NodalFrames:
    points = np.zeros((cells + 1, 3))
    points[:, 0] = np.linspace(0, 1, cells + 1)
    nodes = np.column_stack([np.arange(cells), np.arange(1, cells + 1)])
    return fl.NodalFrames(own_mesh(points, nodes, "interval"))


def mesh_of(q: fl.NodalFrames) -> dolfinx.mesh.Mesh:
    return q.function.function_space.mesh


def strains(q: fl.NodalFrames) -> ufl.core.expr.Expr:
    stretch, curvature = fl.elements.director_strains(q)
    return ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])


def midpoint_strains(q: fl.NodalFrames) -> ufl.core.expr.Expr:
    """Those of ``fl.elements.DirectorBeam``, see demos/forms/transient_element.py."""
    h = ufl.CellVolume(mesh_of(q))
    stretch, curvature = fl.elements.director_strains(q)
    w, c = curvature * h, ufl.sqrt((sum(ufl.inner(d, d) for d in q.directors) - 1) / 2)
    shift = ufl.dot(w, stretch) / (4 * c**3 * (1 + c))
    growth = sum(comb(2 * n, n) / 4**n / (2 * n + 1) * (1 - c**2) ** n for n in range(7))
    stretch, curvature = stretch / c - w * shift, curvature / c * growth
    return ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])


def law(q: fl.NodalFrames):
    C = fem.Constant(mesh_of(q), SECTION.stiffness)
    return lambda e: ufl.inner(e, C * e) / 2


def measure(q: fl.NodalFrames, **given) -> ufl.Measure:
    return ufl.Measure("dx", domain=mesh_of(q), metadata={"quadrature_degree": 1}, **given)


def with_stress(q, strain=strains, **given):
    energy = fl.extend.StrainEnergy(strain(q), law(q), measure(q), **given)
    return [fl.local_frame_forms(energy, q)]


def plain(q):
    return [fl.local_frame_forms(law(q)(strains(q)) * measure(q), q)]


def local_field(q, size: int) -> fem.Function:
    element = basix.ufl.element("DG", "interval", 0, shape=(size,))
    return fem.Function(fem.functionspace(mesh_of(q), element))


def hellinger_reissner(q):
    s, F = local_field(q, 6), fem.Constant(mesh_of(q), np.linalg.inv(SECTION.stiffness))
    energy = ufl.inner(s, strains(q)) - ufl.inner(s, F * s) / 2
    return [fl.local_frame_forms(energy * measure(q), q, local=s)]


def stiffening(q):
    return lambda e: law(q)(e) + 0.2 * e[4] ** 4


def hu_washizu(q):
    f = local_field(q, 12)
    e, s = (ufl.as_vector([f[k + i] for i in range(6)]) for k in (0, 6))
    energy = stiffening(q)(e) + ufl.inner(s, strains(q) - e)
    return [fl.local_frame_forms(energy * measure(q), q, local=f)]


def stiffening_with_stress(q):
    return [fl.local_frame_forms(fl.extend.StrainEnergy(strains(q), stiffening(q), measure(q)), q)]


def of_parts(q):
    mesh, numbers = mesh_of(q), np.arange(len(mesh_of(q).geometry.x) - 1, dtype=np.int32)
    far = dolfinx.mesh.compute_midpoints(mesh, 1, numbers)[:, 0] > 0.4
    tags = dolfinx.mesh.meshtags(mesh, 1, numbers, np.where(far, 2, 1).astype(np.int32))
    dx = measure(q, subdomain_data=tags)
    energies = [fl.extend.StrainEnergy(strains(q), law(q), dx(tag)) for tag in (2, 1)]
    return [fl.local_frame_forms(energy, q) for energy in energies]


def body_of(q, forms, *, held: bool = True, damping=None, name="") -> fl.extend.FormBody:
    V = q.increment.function_space
    nodes = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[0], 0.0))
    bcs = [fem.dirichletbc(np.zeros(6), nodes, V)] if held else []
    inertia = fl.extend.kinetic_energy(SECTION.inertia, ufl.dx(mesh_of(q), degree=2), q)
    problem = fl.FrameProblem(forms, q, bcs)
    return fl.extend.FormBody(problem, inertia=inertia, damping=damping, name=name)


def beam(cells: int = 6, damping=None) -> fl.Beam:
    element = fl.elements.DirectorBeam(bending_flexibility=False)
    return fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), SECTION, cells=cells, formulation=element, damping=damping
    )


def swing(scheme, body, *items, gravity=GRAVITY, duration=0.2, step=0.005) -> fl.Result:
    scene = fl.Scene(gravity=gravity)
    for item in (body, *items):
        scene.add(item)
    return scheme.run(scene, duration=duration, step=step)


def end(result: fl.Result, body) -> np.ndarray:
    return result.position(body.point((1.0, 0.0, 0.0)))


# --- equal to the library's beam ------------------------------------------------------------------


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda s: type(s).__name__)
def test_motion_of_the_library_beam(scheme):
    q, other = frames(), beam()
    own = body_of(q, with_stress(q, midpoint_strains))
    found = swing(scheme, own)
    expected = swing(scheme, other, fl.Clamp(other.point("start")))
    assert np.abs(expected.position(other.point("end"))[-1] - (1, 0, 0)).max() > 0.1
    np.testing.assert_allclose(
        end(found, own), expected.position(other.point("end")), rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(found.elastic, expected.elastic, rtol=0, atol=1e-10)


def test_rayleigh_damping_of_the_library_beam():
    q, other = frames(), beam(damping=DAMPING)
    viscosity = fem.Constant(mesh_of(q), DAMPING.stiffness * SECTION.stiffness)
    forms = with_stress(q, midpoint_strains, viscosity=viscosity)
    own = body_of(q, forms, damping=fl.sections.Damping(mass=DAMPING.mass))
    found = swing(ALPHA, own)
    expected = swing(ALPHA, other, fl.Clamp(other.point("start")))
    free = end(swing(ALPHA, undamped := body_of(q, with_stress(q, midpoint_strains))), undamped)
    tip = end(found, own)
    assert np.abs(free - tip).max() > 1e-3
    np.testing.assert_allclose(tip, expected.position(other.point("end")), rtol=0, atol=1e-12)


def test_gravity_as_a_load_of_forms():
    """Virtual work of the weight, with the beam's supports, is gravity of the scene."""
    q, other = frames(), frames()
    weight = fem.Constant(mesh_of(q), SECTION.inertia[0, 0] * np.array(GRAVITY))
    load = fl.extend.dead_force(weight, measure(q), q)
    own, reference = body_of(q, [*with_stress(q), load]), body_of(other, with_stress(other))
    for scheme in SCHEMES[:2]:
        found, expected = swing(scheme, own, gravity=(0, 0, 0)), swing(scheme, reference)
        np.testing.assert_allclose(end(found, own), end(expected, reference), rtol=0, atol=1e-8)
        # a conserving scheme does exactly the work of the weight
        assert found.balance_error < (1e-10 if scheme is SCHEMES[1] else 1e-3)


def at_the_end(q) -> ufl.Measure:
    nodes = dolfinx.mesh.locate_entities_boundary(mesh_of(q), 0, lambda x: np.isclose(x[0], 1.0))
    tags = dolfinx.mesh.meshtags(mesh_of(q), 0, nodes, np.ones(1, dtype=np.int32))
    return ufl.Measure("ds", domain=mesh_of(q), subdomain_data=tags)(1)


def kick(t: float) -> float:
    return np.sin(30 * t)


@pytest.mark.parametrize(
    "scheme",
    [fl.GeneralisedAlpha(radius=0.8, tolerance=1e-12), *SCHEMES[1:]],
    ids=lambda s: type(s).__name__,
)
def test_loads_of_forms_with_a_history_are_point_loads(scheme):
    """A dead force and a follower moment on the end, beside another body."""
    q, other = frames(), frames()
    force, moment = np.array([0.0, 1.0, -3.0]), np.array([0.0, 0.4, 0.1])
    works = [
        fl.extend.dead_force(fem.Constant(mesh_of(q), force), at_the_end(q), q),
        fl.extend.follower_moment(fem.Constant(mesh_of(q), moment), at_the_end(q), q),
    ]
    own, reference = body_of(q, with_stress(q)), body_of(other, with_stress(other))
    loads = [fl.loads.FormLoad(own, work, history=kick) for work in works]
    tip = reference.point((1.0, 0.0, 0.0))
    points = [
        fl.PointLoad(tip, force=force, history=kick),
        fl.PointLoad(tip, moment=moment, following=True, history=kick),
    ]
    found = swing(scheme, fl.RigidBody(1.0, np.eye(3)), own, *loads, gravity=(0, 0, 0))
    expected = swing(scheme, reference, *points, gravity=(0, 0, 0))
    assert np.abs(end(expected, reference)[-1] - (1, 0, 0)).max() > 0.01
    np.testing.assert_allclose(end(found, own), end(expected, reference), rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.balance, expected.balance, rtol=0, atol=1e-8)


def test_loads_of_forms_grow_with_the_load_factor_in_statics():
    q, other = frames(), frames()
    force = np.array([0.0, 0.0, -3.0])
    work = fl.extend.dead_force(fem.Constant(mesh_of(q), force), at_the_end(q), q)
    own, reference = body_of(q, with_stress(q)), body_of(other, with_stress(other))
    tip, found = reference.point((1.0, 0.0, 0.0)), []
    for body, load in (
        (own, fl.loads.FormLoad(own, work)),
        (reference, fl.PointLoad(tip, force=force)),
    ):
        scene = fl.Scene()
        scene.add(body)
        scene.add(load)
        found.append(end(fl.statics(scene, load_steps=4), body))
    assert np.abs(found[0][-1] - (1, 0, 0)).max() > 0.05
    np.testing.assert_allclose(*found, rtol=0, atol=1e-9)


# --- laws -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("forms", [with_stress, plain, hellinger_reissner, of_parts])
def test_the_same_element_in_other_forms(forms):
    """Energy, strain and law, independent resultants, parts: one element with one point."""
    q, other = frames(), frames()
    for scheme in SCHEMES[:2]:
        own, reference = body_of(q, forms(q)), body_of(other, plain(other))
        found, expected = swing(scheme, own), swing(scheme, reference)
        np.testing.assert_allclose(end(found, own), end(expected, reference), rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.elastic, expected.elastic, rtol=0, atol=1e-11)


def test_independent_strains_with_a_nonlinear_law():
    q, other = frames(), frames()
    linear = body_of(other, plain(other))
    without = end(swing(ALPHA, linear), linear)
    for scheme in SCHEMES[:2]:
        own, reference = body_of(q, hu_washizu(q)), body_of(other, stiffening_with_stress(other))
        found, expected = swing(scheme, own), swing(scheme, reference)
        assert np.abs(end(found, own) - without).max() > 1e-4
        np.testing.assert_allclose(end(found, own), end(expected, reference), rtol=0, atol=1e-9)


@pytest.mark.parametrize("forms", [plain, with_stress, hellinger_reissner, hu_washizu, of_parts])
def test_energy_and_momenta_are_conserved(forms):
    q = frames()
    own = body_of(q, forms(q), held=False)
    own.model.add_rigid_motion(
        np.array([0.1, 0.2, 0.3]), np.array([3.0, 4.0, 5.0]), np.array([0.5, 0.0, 0.0])
    )
    own.velocities[-1, 2] += 2.0
    result = swing(fl.EnergyMomentum(), own, gravity=(0, 0, 0), duration=0.5, step=0.01)
    assert result.elastic.max() > 0.01 * result.kinetic[0]
    assert result.balance_error < 1e-10
    for moment in (result.momentum, result.angular_momentum):
        assert np.abs(moment - moment[0]).max() < 1e-10 * np.abs(moment[0]).max()


def test_order_in_time(monkeypatch):
    """Of a rod so soft that steps resolve all its modes."""
    soft = fl.Section.circle(0.05, fl.Material(E=1e5, nu=0.3, density=1000.0))
    monkeypatch.setattr(f"{__name__}.SECTION", soft)
    tips = []
    for step in (0.02, 0.01, 0.005, 0.0025, 0.000625):
        q = frames(3)
        own = body_of(q, hellinger_reissner(q))
        tips.append(end(swing(ALPHA, own, duration=0.2, step=step), own)[-1])
    errors = [np.linalg.norm(tip - tips[-1]) for tip in tips[:-1]]
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(slopes, 2.0, atol=0.2)


def test_statics_finds_the_equilibrium_of_snes():
    q = frames()
    force = fem.Constant(mesh_of(q), (0.0, 1.0, -3.0))
    ds = at_the_end(q)
    loads = [
        fl.extend.dead_force(force, ds, q),
        fl.extend.follower_moment(fem.Constant(mesh_of(q), (0.0, 0.4, 0.0)), ds, q),
    ]
    own = body_of(q, [*with_stress(q), *loads])
    scene = fl.Scene()
    scene.add(own)
    found = fl.statics(scene).position(own.point((1.0, 0.0, 0.0)))[-1]
    np.testing.assert_array_equal(q.frames, own.frames)  # left where they were
    problem = own.model.problem
    snes = problem.snes()
    snes.setTolerances(rtol=0.0, atol=1e-10, stol=1e-12)
    snes.solve(None, problem.x.x.petsc_vec)
    assert snes.getConvergedReason() > 0
    at = own.point((1.0, 0.0, 0.0)).node
    assert np.abs(found - own.frames[at, 0]).max() > 0.05
    np.testing.assert_allclose(found, q.frames[at, 0], rtol=0, atol=1e-8)


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_sums_over_facets_are_those_of_dolfinx(cell):
    """Kernels get the local numbers of their facets."""
    mesh = models.surface(MPI.COMM_SELF, cell)
    q = fl.NodalFrames(mesh)
    t = ufl.cross(ufl.CellNormal(mesh), ufl.FacetNormal(mesh))
    along = ufl.grad(q.position) * t
    scale = fem.Function(fem.functionspace(mesh, ("DG", 0)))
    scale.x.array[:] = 1 + np.arange(len(scale.x.array))
    ds = ufl.Measure("ds", domain=mesh, metadata={"quadrature_degree": 2})
    edge = fl.local_frame_forms(scale * (ufl.inner(along, along) - 1) ** 2 * ds, q)
    inside = fl.local_frame_forms(ufl.inner(q.directors[0], q.directors[1]) ** 2 * ufl.dx, q)
    problem = fl.FrameProblem([inside, edge], q)
    model = fl.extend.FormBody(problem).model
    (term,) = model.assemble([model]).further_terms
    h = np.random.default_rng(0).uniform(-0.3, 0.3, 6 * len(q.frames))
    q.update(h)
    H, count = q.frames.copy(), len(q.frames)
    forces = np.zeros((count, 6))
    term.add_forces(H, forces)
    K = np.zeros((count, 6, count, 6))
    rows, columns = term.pairs
    np.add.at(K.transpose(0, 2, 1, 3), (rows, columns), term.tangent(H, term.workspace()))
    expected = fem.assemble_vector(edge.residual).array.reshape(-1, 6)
    assert np.abs(expected).max() > 1.0
    np.testing.assert_allclose(forces, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    dense = fem.assemble_matrix(edge.tangent).to_dense()
    np.testing.assert_allclose(
        K.reshape(dense.shape), dense, rtol=0, atol=1e-12 * np.abs(dense).max()
    )
    assert term.energy(H) == pytest.approx(fem.assemble_scalar(edge.energy), rel=1e-13)


# --- inertia and results --------------------------------------------------------------------------


def test_mass_at_a_vertex_and_kinetic_energy_of_ones_own():
    q = frames()
    dx, ds = ufl.dx(mesh_of(q), degree=2), ufl.ds(mesh_of(q))
    tip = fl.sections.director_mass_matrix(3.0, np.diag([0.02, 0.03, 0.04]))
    μ, ρI = SECTION.inertia[0, 0], SECTION.inertia[2, 2]
    own = μ / 2 * ufl.inner(q.velocity, q.velocity) * dx
    own += ρI / 2 * sum(ufl.inner(d, d) for d in q.director_rates[1:]) * dx
    own += fl.extend.kinetic_energy(tip, ds, q)  # at both ends
    body = fl.extend.FormBody(fl.FrameProblem(with_stress(q), q), inertia=own)
    spin = np.array([0.3, -0.2, 0.5])
    body.model.add_rigid_motion(np.zeros(3), spin, np.array([0.5, 0.0, 0.0]))
    result = swing(ALPHA, body, gravity=(0, 0, 0), duration=0.005)
    J = np.diag([2 * ρI, ρI, ρI]) + np.diag([0, 1, 1]) * μ / 12
    J += 2 * np.diag([0.02, 0.03, 0.04]) + 2 * 3.0 * 0.25 * np.diag([0, 1, 1])
    np.testing.assert_allclose(result.kinetic[0], spin @ J @ spin / 2, rtol=1e-12)
    np.testing.assert_allclose(result.info.mass, μ + 6.0, rtol=1e-12)


def test_results_are_functions_on_the_mesh_of_the_forms():
    q = frames()
    own = body_of(q, with_stress(q))
    result = swing(ALPHA, own)
    u = result.functions(own)["displacement"]
    assert u.function_space.mesh is mesh_of(q)
    at = own.point((1.0, 0.0, 0.0))
    np.testing.assert_array_equal(u.x.array.reshape(-1, 3)[at.node], result.displacement(at)[-1])


def test_runs_repeat_and_see_changed_constants():
    q = frames()
    stiffness = fem.Constant(mesh_of(q), SECTION.stiffness)
    e = strains(q)
    forms = [fl.local_frame_forms(ufl.inner(e, stiffness * e) / 2 * measure(q), q)]
    own = body_of(q, forms)
    scene = fl.Scene(gravity=GRAVITY)
    scene.add(own)
    first, second = (end(ALPHA.run(scene, duration=0.1, step=0.005), own) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    stiffness.value *= 0.5
    third = end(ALPHA.run(scene, duration=0.1, step=0.005), own)
    assert np.abs(third - first).max() > 1e-3


# --- what is refused ------------------------------------------------------------------------------


def test_what_bodies_of_forms_refuse():
    q = frames()
    mesh, V = mesh_of(q), q.increment.function_space
    dx, forms = ufl.dx(mesh, degree=2), with_stress(q)
    problem = fl.FrameProblem(forms, q)
    load = fl.extend.dead_force(fem.Constant(mesh, (0.0, 0.0, 1.0)), dx, q)
    weight = fl.local_frame_forms(-q.position[2] * dx, q)
    foundation = fl.local_frame_forms(ufl.inner(q.position, q.position) * dx, q)
    lifted = fem.dirichletbc(np.ones(6), np.array([0], np.int32), V)
    v, d = q.velocity, q.director_rates
    for problem_of, match in (
        (lambda: fl.FrameProblem([load], q), "at least one energy, got virtual work only"),
        (lambda: fl.FrameProblem([*forms, weight], q), "rigid motions do not change"),
        (lambda: fl.FrameProblem([*forms, foundation], q), "rigid motions do not change"),
        (lambda: fl.FrameProblem(forms, q, [lifted]), r"supports with zeros.*PrescribedMotion"),
    ):
        with pytest.raises(ValueError, match=match):
            fl.extend.FormBody(problem_of())
    for inertia, match in (
        (v[0] * dx, "quadratic in q.velocity"),
        (ufl.inner(v, v) ** 2 * dx, "depends on the rates"),
        (ufl.inner(v, v) * q.position[0] * dx, "depends on the frames"),
        ((ufl.inner(v, v) + v[0]) * dx, "linear in the rates"),
        ((v[0] ** 2 + 2 * v[1] ** 2) * dx, "same mass in all directions"),
        (v[0] * d[1][1] * dx, "same mass in all directions"),
        (-q.position[2] * dx, "quadratic in q.velocity"),
    ):
        with pytest.raises(ValueError, match=match):
            fl.extend.FormBody(problem, inertia=inertia)
    with pytest.raises(ValueError, match="expected inertia with mass-proportional damping"):
        fl.extend.FormBody(problem, damping=fl.sections.Damping(mass=1.0))
    with pytest.raises(ValueError, match="damping with mass only"):
        body_of(q, forms, damping=DAMPING)
    own = fl.extend.FormBody(problem)
    with pytest.raises(ValueError, match="expected a virtual work, got an energy"):
        fl.loads.FormLoad(own, forms[0])
    strange = fl.extend.dead_force(fem.Constant(mesh_of(r := frames()), np.ones(3)), ufl.dx, r)
    with pytest.raises(ValueError, match="got one of other NodalFrames"):
        fl.loads.FormLoad(own, strange)
    with pytest.raises(TypeError, match=r"FormLoad: work must be a virtual work"):
        fl.loads.FormLoad(own, ufl.inner(q.position, q.position) * dx)
    with pytest.raises(TypeError, match="FormLoad: loaded must be a FormBody"):
        fl.loads.FormLoad(beam(), load)
    with pytest.raises(TypeError, match="problem must be a FrameProblem"):
        fl.extend.FormBody(forms)
    with pytest.raises(ValueError, match=r"shape \(4, 4\), got shape \(6, 6\)"):
        fl.extend.kinetic_energy(SECTION.stiffness, dx, q)


def test_dynamics_need_inertia():
    q = frames()
    own = fl.extend.FormBody(fl.FrameProblem(with_stress(q), q))
    with pytest.raises(ValueError, match="inertia"):
        swing(ALPHA, own)


def test_distributed_meshes_are_refused(tmp_path):
    assert parallel_form_bodies.refusal(MPI.COMM_SELF) == ""
    on_ranks(parallel_form_bodies, 2, tmp_path / "out.json")
    message = json.loads((tmp_path / "out.json").read_text())
    assert "expected a mesh of one process, created with MPI.COMM_SELF" in message
    assert "got a mesh on 2 processes" in message


@pytest.mark.parametrize(("rest", "warnings"), [(1.0, 0), (0.999, 1)])
def test_forces_before_any_load_are_a_warning(caplog, rest, warnings):
    """They may be meant, as of a membrane under tension."""
    q = frames()
    stretch, curvature = fl.elements.director_strains(q)
    strain = ufl.as_vector([stretch[0] - rest, stretch[1], stretch[2], *curvature])
    form = fl.local_frame_forms(fl.extend.StrainEnergy(strain, law(q), measure(q)), q)
    scene = fl.Scene()
    scene.add(body_of(q, [form], name="bar"))
    with caplog.at_level("WARNING", logger="fem_lie"):
        fl.statics(scene)
    found = [record for record in caplog.records if "unloaded configuration" in record.message]
    assert len(found) == warnings
    assert all(record.message.startswith("bar: the energy has forces") for record in found)

"""Assembly in local frames: packing, condensation, linearised stress, ranks, refusals."""

import itertools
import json
from dataclasses import replace

from mpi4py import MPI

import basix
import basix.ufl
import dolfinx
import dolfinx.fem.petsc
import models
import numpy as np
import parallel_forms
import pytest
import ufl
from dolfinx import fem
from hypothesis import given
from hypothesis import strategies as st
from models import CARRIED, STRAIN_0, D, Model, built, few
from ranks import on_ranks

import fem_lie as fl
from fem_lie import lie

seeds = st.integers(0, 2**32 - 1)


def name(make) -> str:
    return make.__name__


def close(a, b, tolerance) -> bool:
    return np.abs(a - b).max() <= tolerance * np.abs(b).max()


# --- against plain DOLFINx and the nodal map in NumPy ---------------------------------------------


def nodal_map(H: np.ndarray) -> np.ndarray:
    """L of all nodes, (12 n, 6 n): ``δx = R u``, ``δd_k = R (η × e_k)``."""
    n = len(H)
    L = np.zeros((n, 12, n, 6))
    for i, R in enumerate(lie.rotation(H)):
        L[i, :3, i, :3] = R
        for k in range(3):
            L[i, 3 + 3 * k : 6 + 3 * k, i, 3:] = -R @ lie.hat(np.eye(3)[k])
    return L.reshape(12 * n, 6 * n)


def map_derivative(H: np.ndarray, f: np.ndarray, step: float = 1e-5) -> np.ndarray:
    """``∂(Lᵀ f)/∂h`` by central differences."""
    columns = []
    for h in step * np.eye(6 * len(H)):
        ahead, back = (lie.se3_retract(H, sign * h.reshape(-1, 6)) for sign in (1, -1))
        columns.append((nodal_map(ahead) - nodal_map(back)).T @ f / (2 * step))
    return np.array(columns).T


def twin(q: fl.NodalFrames, energy: ufl.Form) -> tuple[float, np.ndarray, np.ndarray]:
    """Energy, residual and tangent by DOLFINx in flat coordinates and NumPy on nodes."""
    y, space = q.function, q.function.function_space
    gradient = ufl.derivative(energy, y, ufl.TestFunction(space))
    hessian = ufl.derivative(gradient, y, ufl.TrialFunction(space))
    f = fem.assemble_vector(fem.form(gradient)).array
    # DOLFINx's own matrix has no blocks of 12
    matrix = fem.petsc.assemble_matrix(fem.form(hessian))
    matrix.assemble()
    H, L = q.frames.copy(), nodal_map(q.frames)
    K = L.T @ matrix[:, :] @ L + map_derivative(H, f)
    matrix.destroy()
    return fem.assemble_scalar(fem.form(energy)), L.T @ f, K


def data(mesh, rng: np.random.Generator) -> dict:
    """Coefficients and constants of different spaces and shapes, by name, as makers."""

    def function(*element, **options):
        space = fem.functionspace(mesh, basix.ufl.element(*element, **options))
        f = fem.Function(space)
        f.x.array[:] = rng.normal(size=f.x.array.size)
        return f

    cell = mesh.basix_cell()
    return {
        "shift": lambda: function("DG", cell, 0),
        "stiffness": lambda: function("DG", cell, 0, shape=(3, 3)),
        "offset": lambda: function("Lagrange", cell, 1, shape=(3,)),
        "density": lambda: function("Lagrange", cell, 2),
        "bulk": lambda: fem.Constant(mesh, 1.7),
        "load": lambda: fem.Constant(mesh, rng.normal(size=3)),
        "coupling": lambda: fem.Constant(mesh, rng.normal(size=(3, 2))),
    }


def packed_energy(q: fl.NodalFrames, g: dict) -> tuple:
    """A strain and a law that use all of them; ``shift`` drops out of the derivatives."""
    x, (d1, d2, d3) = q.position, q.directors
    J = ufl.Jacobian(q.function.function_space.mesh)
    stretch = ufl.dot(ufl.grad(x), ufl.as_vector([J[i, 0] for i in range(3)]))
    a = g["stiffness"] * (stretch - g["offset"]) + g["density"] * d3
    b = ufl.as_vector([ufl.dot(d1, a), ufl.dot(d2, g["load"]) * g["bulk"], ufl.dot(d3, d3)])
    strain = ufl.as_vector([*b, *(ufl.transpose(g["coupling"]) * b)])

    def law(e):
        return 0.5 * ufl.inner(e, e) + g["density"] * e[0] + g["bulk"] * e[4] ** 3 + g["shift"]

    return strain, law


NAMES = ["shift", "stiffness", "offset", "density", "bulk", "load", "coupling"]


@pytest.mark.parametrize("carried", [False, True], ids=["plain", "carried"])
@pytest.mark.parametrize("state_at", [0, 2, 6])
@pytest.mark.parametrize("order", [NAMES, NAMES[::-1], NAMES[1::2] + NAMES[0::2]], ids=str)
def test_packing_does_not_depend_on_the_order_of_creation(order, state_at, carried):
    """UFL numbers functions and constants as they are created; FFCx packs them in that order."""
    mesh = models.line(MPI.COMM_SELF, 1, 3)
    makers, given_data, q = data(mesh, np.random.default_rng(1)), {}, None
    for position, key in enumerate([*order, None]):
        if position == state_at:
            q = fl.NodalFrames(mesh)
        if key is not None:
            given_data[key] = makers[key]()
    strain, law = packed_energy(q, given_data)
    energy = fl.extend.StrainEnergy(strain, law, models.measure(mesh, 3))
    model = Model(q, fl.local_frame_forms(energy if carried else energy.form(), q), energy)
    model.at(model.random(2)).settle()
    value, residual, tangent = twin(q, energy.form())
    assert model.energy_value() == pytest.approx(value, rel=1e-13)
    assert close(model.residual(), residual, 1e-13)
    # the derivative of the map is by differences here: 1e-5²
    assert close(model.tangent(), tangent, 1e-8)


def test_changed_data_are_seen():
    """Constants and coefficients are read at each assembly, the linearised stress, too."""
    mesh = models.line(MPI.COMM_SELF, 1, 2)
    q, factor = fl.NodalFrames(mesh), fem.Constant(mesh, 1.0)
    weight = fl.extend.cellwise(mesh, np.ones(2))
    energy = models.director_energy(q)
    energy = fl.extend.StrainEnergy(
        energy.strain, lambda e: factor * models.linear_law(e), energy.dx, weight
    )
    model = Model(q, fl.local_frame_forms(energy, q), energy)
    model.at(model.random(1)).settle()
    before = model.residual(), model.tangent()
    factor.value, weight.x.array[:] = 3.0, 0.5
    model.settle()
    assert close(model.residual(), 1.5 * before[0], 1e-13)
    assert close(model.tangent(), 1.5 * before[1], 1e-13)


def test_energy_linear_in_the_coordinates():
    """The second derivative is zero, FFCx makes no function: the map's derivative is left."""
    mesh = models.line(MPI.COMM_SELF, 1)
    q = fl.NodalFrames(mesh)
    x, d = q.position, q.directors
    energy = (2 * x[0] - x[2] + 3 * d[0][1] + d[2][0]) * ufl.dx(mesh)
    model = Model(q, fl.local_frame_forms(energy, q), energy)
    model.at(model.random(4))
    _, residual, tangent = twin(q, energy)
    assert close(model.residual(), residual, 1e-13)
    assert close(model.tangent(), tangent, 1e-8)


@pytest.mark.parametrize("carried", [False, True], ids=["plain", "carried"])
def test_energy_on_a_part_of_the_mesh(carried):
    mesh = models.line(MPI.COMM_SELF, 1, 5)
    tags = dolfinx.mesh.meshtags(mesh, 1, np.arange(5, dtype=np.int32), np.array([7, 3, 7, 7, 3]))
    dx = ufl.Measure(
        "dx", domain=mesh, subdomain_data=tags, metadata={"quadrature_degree": 1}
    )(7)  # fmt: skip
    q = fl.NodalFrames(mesh)
    whole = models.director_energy(q)
    energy = fl.extend.StrainEnergy(whole.strain, whole.law, dx)
    model = Model(q, fl.local_frame_forms(energy if carried else energy.form(), q), energy)
    model.at(model.random(8)).settle()
    _, residual, tangent = twin(q, energy.form())
    assert close(model.residual(), residual, 1e-13)
    assert close(model.tangent(), tangent, 1e-8)


# --- linearised stress ----------------------------------------------------------------------------


def true_stress(model: Model, H: np.ndarray) -> np.ndarray:
    """σ(ε) at frames H at the points of the linearised stress, evaluated by DOLFINx."""
    model.at(H)
    space = model.frames.function.function_space
    if model.coordinates is not None:
        ends = H[space.dofmap.list]
        model.coordinates.x.array[:] = lie.se3_relative(ends[:, 0], ends[:, 1]).ravel()
    cells = np.arange(space.mesh.topology.index_map(1).size_local, dtype=np.int32)
    values = model.stress.eval(space.mesh, cells)
    return values.reshape(len(cells), len(model.stress.X()), -1)


def linearised_stress(model: Model) -> np.ndarray:
    stress = model.forms.stress
    values = stress.x.array.reshape(-1, 6)
    return values[stress.function_space.dofmap.list]


@pytest.mark.parametrize("make", CARRIED, ids=name)
@given(seed=seeds)
@few
def test_linearised_stress_is_true_stress_without_increment(make, seed):
    model = built(make)
    H = model.random(seed)
    model.at(H).settle()
    assert close(linearised_stress(model), true_stress(model, H), 1e-13)


@pytest.mark.parametrize("make", CARRIED, ids=name)
@given(seed=seeds)
@few
def test_linearised_stress_is_linear_forecast(make, seed):
    """``σ(ε) + C ε' L h``: value and slope of the true stress along H exp(t h) at t = 0."""
    model = built(make)
    H = model.random(seed)
    h = np.random.default_rng(seed).normal(size=(len(H), 6))
    model.at(H).forms.increment.x.array[:] = h.ravel()
    model.forms.update_stress()
    step = 3e-5
    ahead, back, far_ahead, far_back = (
        true_stress(model, lie.se3_retract(H, t * step * h)) for t in (1, -1, 2, -2)
    )
    slope = (8 * (ahead - back) - (far_ahead - far_back)) / (12 * step)
    forecast = true_stress(model, H) + slope
    model.at(H)
    # step⁴ of fifth derivatives, which are 1e11 where a rod turns by nearly π
    assert close(linearised_stress(model), forecast, 1e-7)


def test_linearised_stress_of_a_degree_2_line_has_two_different_points():
    """What the tests above would not see if all points were one."""
    model = built(models.director_beam_2_carried)
    model.at(model.random(1)).settle()
    N = linearised_stress(model)
    assert N.shape == (4, 2, 6)
    assert np.abs(N[:, 0] - N[:, 1]).min() > 1e-6


@pytest.mark.parametrize("make", CARRIED[:2], ids=name)
def test_geometric_stiffness_is_of_the_linearised_stress(make):
    """``K(N) − K(0)`` is the tangent of the energy ``N·ε`` with dead N, whatever N is."""
    model = built(make)
    energy, stress = model.energy, model.forms.stress
    model.at(model.random(3))
    linear = fl.local_frame_forms(ufl.inner(stress, energy.strain) * energy.dx, model.frames)
    stress.x.array[:] = 0.0
    material = model.tangent()
    stress.x.array[:] = np.random.default_rng(3).normal(size=stress.x.array.size) * 30
    geometric = fem.assemble_matrix(linear.tangent).to_dense()
    assert close(model.tangent() - material, geometric, 1e-12)
    # the residual does not know of N
    before = model.residual()
    stress.x.array[:] = 0.0
    assert (model.residual() == before).all()


@pytest.mark.parametrize("rule", ["default", "GLL"])
def test_quadrature_rule_of_the_measure_is_that_of_the_stress(rule):
    mesh = models.line(MPI.COMM_SELF, 1, 2)
    q = fl.NodalFrames(mesh)
    whole = models.director_energy(q)
    # one point in the middle or one at each end: neither is exact, so they differ
    metadata = {"quadrature_degree": 1, "quadrature_rule": rule}
    energy = fl.extend.StrainEnergy(
        whole.strain, whole.law, ufl.Measure("dx", domain=mesh, metadata=metadata)
    )
    model = Model(q, fl.local_frame_forms(energy, q), energy)
    model.at(model.random(1)).settle()
    _, residual, tangent = twin(q, energy.form())
    assert close(model.residual(), residual, 1e-13)
    assert close(model.tangent(), tangent, 1e-8)


# --- condensation ---------------------------------------------------------------------------------


def linear_director_beam() -> Model:
    q = fl.NodalFrames(models.line(MPI.COMM_SELF, 1))
    energy = models.director_energy(q, models.linear_law)
    return Model(q, fl.local_frame_forms(energy, q), energy)


@pytest.mark.parametrize(
    ("mixed", "pure"),
    [
        (models.hellinger_reissner, linear_director_beam),
        (models.hu_washizu, models.director_beam_1),
    ],
    ids=["Hellinger-Reissner", "Hu-Washizu"],
)
@given(seed=seeds)
@few
def test_condensed_element_is_the_displacement_element(mixed, pure, seed):
    a, b = built(mixed), built(pure)
    H = a.random(seed)
    for model in (a, b):
        model.at(H).settle()
    # 12 unknowns eliminated in matrices of condition 100
    assert close(a.residual(), b.residual(), 1e-12)
    assert close(a.tangent(), b.tangent(), 1e-12)


@given(seed=seeds)
@few
def test_hellinger_reissner_is_linearised_stress(seed):
    """With a quadratic law: same residual, tangent and linearised stress, off the solution, too."""
    a, b = built(models.hellinger_reissner), built(linear_director_beam)
    rng = np.random.default_rng(seed)
    H = a.random(seed)
    h = 0.3 * rng.normal(size=(len(H), 6))
    for model in (a, b):
        model.at(H).forms.increment.x.array[:] = h.ravel()
        model.forms.update_stress()
        model.at(lie.se3_retract(H, h))
    assert close(a.forms.local.x.array.reshape(-1, 1, 6), linearised_stress(b), 1e-12)
    assert close(a.residual(), b.residual(), 1e-12)
    assert close(a.tangent(), b.tangent(), 1e-12)


def test_local_fields_are_stationary_after_settling():
    model = built(models.hu_washizu)
    model.at(model.random(6)).settle()
    local = model.forms.local
    gradient = ufl.derivative(model.energy, local, ufl.TestFunction(local.function_space))
    unbalance = fem.assemble_vector(fem.form(gradient)).array
    assert np.abs(unbalance).max() < 1e-12 * np.abs(local.x.array).max()


@pytest.mark.parametrize(
    "make",
    [
        models.director_beam_1,
        models.director_beam_2_carried,
        models.geodesic_beam_nonlinear,
        models.hellinger_reissner,
        models.hu_washizu,
    ],
    ids=name,
)
def test_newton_converges_quadratically(make):
    """Clamped at one end, a follower force and moment at the other, carried along."""
    model = built(make)
    model.at(model.unloaded).settle()
    x = model.unloaded[:, 0, 0]
    free = np.repeat(x > x.min() + 1e-9, 6)
    load = np.zeros((len(x), 6))
    load[x.argmax()] = [0.2, 0.4, -0.3, 0.3, 1.0, -0.8]
    start = model.residual()  # the initial strains of some models do not fit their meshes
    for part in np.linspace(0, 1, 11)[1:]:
        norms = newton(model, (1 - part) * start + part * load.ravel(), free)
    # the last steps that do not end in round-off nearly square the residual: twice its logarithm
    steps = [(a, b) for a, b in itertools.pairwise(norms) if 1e-11 < b < a < 1e-1]
    assert steps, norms
    assert max(np.log(b) / np.log(a) for a, b in steps) > 1.6, norms


def newton(model: Model, load: np.ndarray, free: np.ndarray) -> list[float]:
    """Norms of the residual; the model is left in equilibrium."""
    h, norms = np.zeros(len(load)), []
    for _ in range(12):
        r = model.residual() - load
        norms.append(np.linalg.norm(r[free]))
        if norms[-1] < 1e-11:
            return norms
        K = model.tangent()
        h[free] = -np.linalg.solve(K[np.ix_(free, free)], r[free])
        model.forms.increment.x.array[:] = h
        model.forms.update_stress()
        model.frames.update(h)
    raise AssertionError(norms)


# --- ranks ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def alone() -> dict:
    return parallel_forms.results(MPI.COMM_SELF)


@pytest.mark.parametrize("ranks", [2, 3])
def test_ranks_give_the_same_vectors(ranks, alone, tmp_path):
    """Residual, tangent with linearised stress times a vector, and energy by nodal coordinates."""
    out = tmp_path / "ranks.json"
    on_ranks(parallel_forms, ranks, out)
    together = json.loads(out.read_text())
    assert together.keys() == alone.keys()
    for key, expected in alone.items():
        assert together[key]["ghost_cells"] > 0
        assert together[key]["energy"] == pytest.approx(expected["energy"], rel=1e-12)
        for field in ("position", "residual", "action"):
            # sums in another order
            np.testing.assert_allclose(
                together[key][field],
                expected[field],
                rtol=0,
                atol=1e-12 * np.abs(expected[field]).max(),
                err_msg=f"{key} {field}",
            )


# --- refusals -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def frames() -> fl.NodalFrames:
    return fl.NodalFrames(models.line(MPI.COMM_SELF, 1, 2))


def test_strain_energy_needs_a_quadrature_degree(frames):
    energy = models.director_energy(frames)
    energy = fl.extend.StrainEnergy(
        energy.strain, energy.law, ufl.dx(frames.function.function_space.mesh)
    )
    with pytest.raises(ValueError, match="needs a quadrature degree"):
        fl.local_frame_forms(energy, frames)


def test_strain_must_be_a_vector(frames):
    dx = models.measure(frames.function.function_space.mesh, 1)
    energy = fl.extend.StrainEnergy(frames.position[0], lambda e: e**2, dx)
    with pytest.raises(ValueError, match=r"shape \(n,\), got \(\)"):
        fl.local_frame_forms(energy, frames)


@pytest.mark.parametrize("measure", [ufl.ds, ufl.dS])
def test_one_kind_of_integral(frames, measure):
    mesh = frames.function.function_space.mesh
    x = frames.position
    density = ufl.inner(x, x) if measure is ufl.ds else ufl.avg(ufl.inner(x, x))
    with pytest.raises(ValueError, match=r"over cells \(dx\) or over exterior facets \(ds\), got"):
        fl.local_frame_forms(density * measure(mesh) + x[0] ** 2 * ufl.dx(mesh), frames)
    if measure is ufl.dS:
        with pytest.raises(ValueError, match="got interior_facet in"):
            fl.local_frame_forms(density * measure(mesh), frames)


def test_one_density_on_any_number_of_subdomains(frames):
    mesh = frames.function.function_space.mesh
    tags = dolfinx.mesh.meshtags(mesh, 1, np.arange(2, dtype=np.int32), np.array([1, 2]))
    dx = ufl.Measure("dx", domain=mesh, subdomain_data=tags)
    x = frames.position
    with pytest.raises(ValueError, match=r"one integral, got 2.*which fl.FrameProblem adds"):
        fl.local_frame_forms(x[0] ** 2 * dx(1) + x[1] ** 2 * dx(2), frames)
    both = fl.local_frame_forms(x[0] ** 2 * dx((1, 2)), frames)
    whole = fl.local_frame_forms(x[0] ** 2 * ufl.dx(mesh), frames)
    assert np.array_equal(
        fem.assemble_matrix(both.tangent).to_dense(), fem.assemble_matrix(whole.tangent).to_dense()
    )
    assert fem.assemble_scalar(both.energy) == fem.assemble_scalar(whole.energy) > 0


def test_energy_that_does_not_depend_on_the_frames(frames):
    mesh = frames.function.function_space.mesh
    with pytest.raises(ValueError, match="does not depend on the coordinates"):
        fl.local_frame_forms(fem.Constant(mesh, 2.0) * ufl.dx(mesh), frames)


def test_local_fields_with_strain_energy(frames):
    mesh = frames.function.function_space.mesh
    with pytest.raises(ValueError, match="local fields as a UFL form"):
        fl.local_frame_forms(
            models.director_energy(frames), frames, fl.extend.cellwise(mesh, D[:2])
        )


@pytest.mark.parametrize(
    ("family", "degree"), [("Lagrange", 1), ("Lagrange", 2), ("Bubble", 2), ("DG", 0), ("DG", 1)]
)
def test_local_fields_are_refused_if_cells_share_them(frames, family, degree):
    """What is eliminated cell by cell must have no values at the ends of the cells."""
    mesh = frames.function.function_space.mesh
    element = basix.ufl.element(family, "interval", degree, shape=(6,))
    local = fem.Function(fem.functionspace(mesh, element))
    strain = models.director_energy(frames).strain
    energy = (ufl.inner(local, strain) - 0.5 * ufl.inner(local, local)) * models.measure(mesh, 3)
    if family == "Lagrange":
        with pytest.raises(ValueError, match="must be discontinuous between cells"):
            fl.local_frame_forms(energy, frames, local)
    else:
        assert fl.local_frame_forms(energy, frames, local).local is local


def test_frames_need_a_mesh_in_space():
    mesh = dolfinx.mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
    with pytest.raises(ValueError, match="gdim 3, got gdim 2"):
        fl.NodalFrames(mesh)


@fl.extend.frame_function
def nothing(state, y, given, out, nodes):
    """A part of a map that is not called."""


def test_functions_must_fit_the_map(frames):
    plain = fl.extend.FrameMap(None, nothing, nothing, None, 12, 6)
    relative = replace(plain, coordinates=nothing)
    energy = frames.position[0] ** 2 * ufl.dx(frames.function.function_space.mesh)
    state, increment = frames.function, frames.increment
    with pytest.raises(ValueError, match="increment must have 6 values per node"):
        fl.extend.LocalFrameForms(energy, state, state, plain)
    with pytest.raises(ValueError, match="state must have 12 values per node"):
        fl.extend.LocalFrameForms(energy, increment, increment, plain)
    finer = fem.functionspace(state.function_space.mesh, ("Lagrange", 2, (6,)))
    with pytest.raises(ValueError, match="same nodes"):
        fl.extend.LocalFrameForms(energy, state, fem.Function(finer), plain)
    with pytest.raises(ValueError, match=r"this map does$"):
        fl.extend.LocalFrameForms(energy, state, increment, relative)
    with pytest.raises(ValueError, match=r"this map does not$"):
        fl.extend.LocalFrameForms(energy, state, increment, plain, coordinates=state)


def test_update_needs_six_values_per_node(frames):
    with pytest.raises(ValueError, match="6 values for each of 3 nodes, got 12"):
        frames.update(np.zeros(12))


def test_unloaded_strain_of_the_models_is_not_zero():
    """Otherwise no test above would see initial curvature."""
    assert np.abs(STRAIN_0[3:]).min() > 0

"""Damping of shells and solids: ratios of modes, rigid motions, all schemes."""

from __future__ import annotations

from mpi4py import MPI

import dolfinx.jit
import numpy as np
import pytest
import ufl

import fem_lie as fl
from fem_lie import lie
from tests import models
from tests.assembled import Assembled

_JIT = dolfinx.jit.DOLFINX_DEFAULT_JIT_OPTIONS


@pytest.fixture(scope="module", autouse=True)
def _without_optimisation():
    """Forms with damping take the C compiler minutes, and these tests microseconds."""
    kept = _JIT["cffi_extra_compile_args"]
    _JIT["cffi_extra_compile_args"] = ["-O0", "-g0"], kept[1]
    yield
    _JIT["cffi_extra_compile_args"] = kept


STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
SOFT = fl.Material(E=2.1e9, nu=0.3, density=7800.0)
WIDTH = 0.3


def flat(a: float, b: float) -> np.ndarray:
    return np.array([a, WIDTH * b, 0.0])


def shell(formulation, cell="quadrilateral", degree=1, material=STEEL, **options):
    """A plate of an element."""
    mesh = fl.mesh.parametric_surface(flat, (3, 2), cell=cell, degree=degree)
    layer = fl.ShellSection.layer(0.01, material)
    return fl.Shell(mesh, layer, formulation=formulation, name="body", **options)


def solid(degree, material=None, **options):
    """A block of an element."""
    law = material or fl.sections.NeoHooke(2.1e11, 0.3, 7800.0)
    size = 1.0, WIDTH, 0.05
    return fl.Solid.brick(size, law, cells=(3, 2, 1), degree=degree, name="body", **options)


def quartic(strain):
    """A law of a user: that of a plate, and a fourth power."""
    D = fl.ShellSection.layer(0.01, STEEL).stiffness
    linear = 0.5 * sum(D[i, j] * strain[i] * strain[j] for i in range(8) for j in range(8))
    return linear + 1e9 * strain[0] ** 4


BODIES = {
    "independent stress": lambda **o: shell(fl.elements.HellingerReissner(), **o),
    "triangles with a bubble": lambda **o: shell(fl.elements.HellingerReissner(), "triangle", **o),
    "independent strain": lambda **o: shell(fl.elements.HuWashizu(), **o),
    "law of a user": lambda **o: shell(fl.elements.HuWashizu(law=quartic), **o),
    "MITC4": lambda **o: shell(fl.elements.DisplacementBased(), **o),
    "MITC6": lambda **o: shell(fl.elements.DisplacementBased(), "triangle", degree=2, **o),
    "geodesic": lambda **o: shell(fl.elements.GeodesicShell(), **o),
    "mean dilatation": lambda **o: solid(1, **o),
    "quadratic": lambda **o: solid(2, **o),
}
every_body = pytest.mark.parametrize("make", BODIES.values(), ids=BODIES)


@every_body
def test_ratios_of_modes_are_those_of_rayleigh(make):
    """``ζ = (α/ω + τω)/2`` for every mode, as the matrix is a sum of mass and stiffness."""
    damping = fl.sections.Damping(mass=3.0, stiffness=2e-6)
    ratios, omega = [], None
    for given in (None, damping):
        body = make(damping=given)
        body.clamp("a=0")
        scene = fl.Scene()
        scene.add(body)
        modes = fl.vibrations(scene, 4)
        if given is None:
            omega = 2 * np.pi * modes.hertz
        else:
            ratios = modes.damping_ratios
    expected = 0.5 * (damping.mass / omega + damping.stiffness * omega)
    np.testing.assert_allclose(ratios, expected, rtol=1e-8)


@every_body
def test_viscous_forces_have_no_work_in_rigid_motions_and_take_energy_from_others(make):
    damped, free = (
        Assembled(scene_of(make(damping=given)), dynamics=True)
        for given in (fl.sections.Damping(stiffness=0.1), None)
    )
    rng = np.random.default_rng(3)
    n = damped.count
    H = damped.moved(damped.start, 0.02 * rng.normal(size=(n, 6)))
    v = rng.normal(size=(n, 6))

    def forces(twists):
        return damped.residual(H, twists) - free.residual(H, twists)

    rigid = lie.se3_adjoint(lie.se3_inverse(H[:n])) @ v[0]
    assert np.abs(forces(rigid)).max() < 1e-10 * np.abs(forces(v)).max()
    assert forces(v) @ v.ravel() > 0
    # linear in the twists, and the matrix is the derivative
    step = damped.matrix(H, v, 0 * v, damping=2.0) - damped.matrix(H, v, 0 * v, damping=1.0)
    step -= free.matrix(H, v, 0 * v, damping=2.0) - free.matrix(H, v, 0 * v, damping=1.0)
    expected = forces(v)
    np.testing.assert_allclose(step @ v.ravel(), expected, atol=1e-9 * np.abs(expected).max())


def scene_of(body: fl.Body) -> fl.Scene:
    scene = fl.Scene()
    scene.add(body)
    return scene


SCHEMES = {
    "generalised-α": fl.GeneralisedAlpha(radius=0.9),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(),
    "variational": fl.schemes.Variational(),
}
TUMBLING = {
    "shell": lambda: shell(
        fl.elements.HellingerReissner(),
        material=SOFT,
        damping=fl.sections.Damping(stiffness=1e-2),
    ),
    "triangles": lambda: shell(
        fl.elements.HellingerReissner(),
        "triangle",
        material=SOFT,
        damping=fl.sections.Damping(stiffness=1e-2),
    ),
    "solid": lambda: solid(
        1, fl.sections.NeoHooke(2.1e9, 0.3, 7800.0), damping=fl.sections.Damping(stiffness=1e-2)
    ),
}


def tumbled(make, scheme) -> fl.Result:
    """A body that spins about an axis that is none of its own, with a bent tip."""
    scene = scene_of(make())
    (body,) = scene.bodies
    body.add_velocity(omega=(0.3, 4.0, 0.2), about=(0.5, 0.15, 0.0))
    body.velocities[:, 2] += 4.0 * body.frames[:, 0, 0] ** 2
    return scheme.run(scene, duration=0.05, step=1e-3, progress=False)


@pytest.mark.parametrize("make", TUMBLING.values(), ids=TUMBLING)
def test_schemes_agree_on_what_is_lost(make):
    """Momenta are conserved, energy is not, and the balance has what is lost."""
    found = {name: tumbled(make, scheme) for name, scheme in SCHEMES.items()}
    first = found["generalised-α"]
    energy = first.total_energy
    assert energy[-1] < 0.995 * energy[0]
    for result in found.values():
        size = np.abs(first.frames[-1, :, 0]).max()
        np.testing.assert_allclose(
            result.frames[-1, :, 0], first.frames[-1, :, 0], atol=2e-4 * size
        )
        assert result.total_energy[-1] == pytest.approx(energy[-1], rel=2e-3)
        np.testing.assert_allclose(
            result.angular_momentum[-1],
            result.angular_momentum[0],
            atol=1e-4 * np.abs(result.angular_momentum[0]).max(),
        )
    for scheme in ("energy-momentum", "energy-decaying"):
        assert found[scheme].balance_error < 1e-10
        assert found[scheme].angular_momentum_error < 1e-10


def test_six_relaxation_times_belong_to_beams():
    six = fl.sections.Damping(stiffness=(1, 2, 3, 4, 5, 6))
    for make, what in ((BODIES["MITC4"], "Shell"), (BODIES["quadratic"], "Solid")):
        with pytest.raises(ValueError, match=f"{what} has one relaxation time for all strains"):
            make(damping=six)
    with pytest.raises(TypeError, match="Shell: damping must be a Damping or None"):
        BODIES["MITC4"](damping=0.1)


def test_thin_shells_have_damping_of_mass_alone():
    patch = fl.mesh.smooth_patch(flat, (1, 1))
    layer = fl.ShellSection.layer(0.01, STEEL)
    given = fl.ThinShell(patch, layer, damping=fl.sections.Damping(mass=1.0))
    assert given.model.damping.mass == 1.0
    with pytest.raises(ValueError, match="ThinShell has damping with mass only"):
        fl.ThinShell(patch, layer, damping=fl.sections.Damping(stiffness=1e-3))


def test_an_energy_without_strains_has_no_viscosity():
    mesh = models.straight(MPI.COMM_SELF, 1.0, 1)
    q = fl.NodalFrames(mesh)
    energy = ufl.inner(q.position, q.position) * ufl.dx(mesh)
    no_map = fl.extend.FrameMap(None, None, None, None, values=12, unknowns=6)
    given = q.function, q.increment, no_map
    with pytest.raises(ValueError, match="viscous forces need strains"):
        fl.extend.LocalFrameForms(energy, *given, relaxation=0.1)

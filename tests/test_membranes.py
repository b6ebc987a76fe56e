"""Membranes against closed forms: drums, inflated tubes, wrinkled strips; in all schemes."""

import numpy as np
import pytest

import fem_lie as fl
from studies import variational_sheets
from tests.unit_systems import OTHER_SYSTEMS

E, NU, T = 1e6, 0.3, 1e-3
RUBBER = fl.Material(E=E, nu=NU, density=1000.0)
FILM = fl.ShellSection.layer(T, RUBBER)
C = E * T / (1.0 - NU**2)
FLAT = ("a=0", "a=1", "b=0", "b=1")

each_cell = pytest.mark.parametrize(
    ("cell", "degree"),
    [("triangle", 1), ("quadrilateral", 1), ("triangle", 2), ("quadrilateral", 2)],
)


def square(cells=4, *, cell="quadrilateral", degree=1, size=1.0):
    def position(a, b):
        return np.array([size * a, size * b, 0.0])

    return fl.mesh.parametric_surface(position, (cells, cells), cell=cell, degree=degree)


def on_edges(body):
    for edge in FLAT:
        body.clamp(edge)
    scene = fl.Scene()
    scene.add(body)
    return scene


@each_cell
def test_frequencies_of_a_drum(cell, degree):
    """ω² = (N/ρt) π² (m² + n²), second or fourth order in the size of cells."""
    tension, exact = 100.0, np.pi * np.sqrt(100.0 * 2.0)
    errors = []
    for cells in (8, 16):
        drum = fl.Membrane(
            square(cells // degree, cell=cell, degree=degree),
            FILM,
            prestress=(tension, tension, 0.0),
        )
        errors.append(fl.vibrations(on_edges(drum), 1).frequencies[0] / exact - 1.0)
    assert 0.0 < errors[1] < 0.01
    assert errors[0] / errors[1] > 0.9 * 4.0**degree


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_a_drum_does_not_depend_on_units(u):
    section = fl.ShellSection.layer(u.length(T), fl.Material(u.stress(E), NU, u.density(1000.0)))
    tension = u.force(100.0) / u.length(1.0)
    drum = fl.Membrane(square(size=u.length(1.0)), section, prestress=(tension, tension, 0.0))
    found = fl.vibrations(on_edges(drum), 1).frequencies[0]
    here = fl.Membrane(square(), FILM, prestress=(100.0, 100.0, 0.0))
    wanted = fl.vibrations(on_edges(here), 1).frequencies[0]
    assert found * u.time(1.0) == pytest.approx(wanted, rel=1e-9)


@each_cell
def test_an_inflated_tube(cell, degree):
    """A tube that keeps its length: p R λ = λ C (λ² − 1)/2."""

    def quarter(a, b):
        return np.array([np.cos(a * np.pi / 2), np.sin(a * np.pi / 2), b])

    pressure = 200.0
    stretch = np.sqrt(1.0 + 2.0 * pressure / C)
    errors = []
    for cells in (8, 16):
        mesh = fl.mesh.parametric_surface(quarter, (cells // degree, 2), cell=cell, degree=degree)
        tube = fl.Membrane(mesh, FILM)
        for edge, normal in zip(FLAT, ((0, 1, 0), (1, 0, 0), (0, 0, 1), (0, 0, 1)), strict=True):
            tube.roller(edge, normal)
        scene = fl.Scene()
        scene.add(tube)
        scene.add(fl.loads.SurfacePressure(tube, pressure))
        result = fl.statics(scene)
        assert result.stable.all()
        radii = np.linalg.norm(result.frames[-1, :, 0, :2], axis=1)
        errors.append(abs(radii.mean() / stretch - 1.0))
    assert errors[1] < (1e-2 if (cell, degree) == ("triangle", 1) else 5e-4)
    assert errors[0] / errors[1] > 3.0


@pytest.mark.parametrize(
    ("tension", "wanted"),
    [
        ((50.0, 20.0, 0.0), (50.0, 20.0)),
        ((50.0, -20.0, 0.0), (50.0 + NU * 20.0, 0.0)),
        ((-50.0, -20.0, 0.0), (0.0, 0.0)),
    ],
    ids=["taut", "wrinkled", "slack"],
)
@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_a_tension_field_has_no_compression(tension, wanted, angle):
    """A wrinkled strip has the force of free lateral contraction, whatever contraction it has."""
    axis = (np.cos(angle), np.sin(angle), 0.0)
    c, s = axis[0], -axis[1]  # of the tension in the axes of the section
    N1, N2, _ = tension
    turned = (c * c * N1 + s * s * N2, s * s * N1 + c * c * N2, c * s * (N1 - N2))
    law = fl.elements.TensionField(residual=0.0)
    sheet = fl.Membrane(square(), FILM, along=axis, prestress=turned, formulation=law)
    scene = on_edges(sheet)
    result = fl.GeneralisedAlpha().run(scene, duration=1e-4, step=1e-4, progress=False)
    found = [result.reaction(*sheet.clamp(edge))[0, k] for k, edge in enumerate(("a=1", "b=1"))]
    np.testing.assert_allclose(found, wanted, atol=1e-9)


SCHEMES = {
    "alpha": (fl.GeneralisedAlpha(radius=0.8), 1e-3, 0.1),
    "energy-momentum": (fl.EnergyMomentum(), 1e-3, 1e-11),
    "energy-decaying": (fl.EnergyDecaying(), 1e-3, 0.1),
    "variational": (fl.schemes.Variational(), 1e-3, 1e-2),
    "explicit": (fl.Explicit(), 2e-4, 1e-2),
}
LAWS = [fl.elements.LinearMembrane(), fl.elements.TensionField(1e-3)]


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("name", SCHEMES)
def test_a_flag_in_all_schemes(name, law):
    """Held at two corners it falls and wrinkles; work of the weight is in its energy."""
    scheme, step, bound = SCHEMES[name]
    flag = fl.Membrane(square(3), FILM, formulation=law)
    for corner in ("00", "01"):
        flag.clamp(corner)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(flag)
    result = scheme.run(scene, duration=0.1, step=step, progress=False)
    energy = result.total_energy
    assert np.abs(energy - energy[0]).max() < bound * result.kinetic.max()
    assert result.position(flag.point("11"))[-1, 2] < -0.03


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("name", ["energy-momentum", "variational"])
def test_a_thrown_membrane_keeps_its_momenta(name, law):
    sheet = fl.Membrane(square(2), FILM, formulation=law)
    scene = fl.Scene()
    scene.add(sheet)
    sheet.add_velocity((1.0, 0.0, 0.5), omega=(3.0, 10.0, 2.0), about=(0.2, 0.5, 0.0))
    result = SCHEMES[name][0].run(scene, duration=0.1, step=1e-3, progress=False)
    for momentum in (result.momentum, result.angular_momentum):
        np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=1e-13)


def test_a_ball_on_a_trampoline_keeps_its_energy():
    """Contact by penalty on the facets of a membrane in conserving steps."""
    bed = fl.Membrane(square(3), FILM, prestress=(100.0, 100.0, 0.0), name="bed")
    scene = on_edges(bed)
    scene.gravity = (0, 0, -9.81)
    ball = scene.add(fl.RigidBody.ball(0.1, 0.1, (0.5, 0.5, 0.105), name="ball"))
    surface = fl.contact.Facets(bed, thickness=2 * T)
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.1), surface, fl.contact.Penalty(1e5)
        )
    )
    result = fl.EnergyMomentum().run(scene, duration=0.2, step=1e-3, progress=False)
    energy = result.total_energy
    assert np.abs(energy - energy[0]).max() < 2e-9 * result.kinetic.max()
    height = result.position(ball.point("centre"))[:, 2]
    assert height.min() < 0.095 and height[-1] > height.min() + 0.01


def test_wrong_membranes():
    ply = fl.sections.Ply(1e-4, fl.sections.Orthotropic(1e9, 1e8, 0.3, 1e8, 1e8, 1e8, 1e3), 0.0)
    for call, message in (
        (lambda: fl.Membrane(square(), FILM, prestress=(1.0, 2.0)), "3 numbers"),
        (lambda: fl.elements.TensionField(2.0), "from 0 to 1"),
        (
            lambda: fl.Membrane(
                square(),
                fl.ShellSection.laminate([ply]),
                formulation=fl.elements.TensionField(),
            ),
            "isotropic",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(ValueError, match="moment, or a follower load"):
        scene = fl.Scene()
        body = scene.add(fl.Membrane(square(), FILM))
        scene.add(fl.loads.EdgeLoad(body, "a=1", force=(1, 0, 0), following=True))


def test_sheets_that_tumble_keep_momenta_and_energy():
    """The first steps of the study, for the bodies that take the least time."""
    record = variational_sheets.main(300, ("cable", "membrane", "membrane that wrinkles"))
    for found in record.values():
        assert found["momentum"] < 1e-13 and found["angular_momentum"] < 1e-13
        assert found["swing"] < 1e-5 and found["drift"] < 1e-6

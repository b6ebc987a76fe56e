"""Linear buckling: loads of any size, with and without a potential; springs, shells on bodies."""

from dataclasses import dataclass

import basix.ufl
import numpy as np
import pytest
import ufl
from dolfinx import fem

import fem_lie as fl
from tests.random_scenes import PROPORTIONAL, random_scene
from tests.scene_builder import build

STEEL = fl.Material(2.1e11, 0.3, 7800.0)


def rectangle() -> fl.Section:
    return fl.Section.rectangle(0.01, 0.02, STEEL)


def stiff(weak: float = 1.0, strong: float = 1.0, torsion: float = 0.8, axial: float = 1e5):
    """Strong bending about e₂, weak bending about e₃."""
    return fl.Section.from_stiffness([axial, axial, axial, torsion, strong, weak])


def cantilever(
    section: fl.Section, cells: int = 16, formulation: fl.elements.BeamFormulation | None = None
):
    """A beam of length 1 along x, clamped at its start."""
    beam = fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), section, cells=cells, up=(0, 0, 1), formulation=formulation
    )
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    return scene, beam


# --- bodies under a load of any size, compressed by a positive one ---


def of_beam(
    load: float, formulation: fl.elements.BeamFormulation | None = None, cells: int = 6
) -> fl.Scene:
    scene, beam = cantilever(rectangle(), cells, formulation)
    scene.add(fl.PointLoad(beam.point("end"), force=(-load, 0, 0)))
    return scene


def of_rod(load: float) -> fl.Scene:
    rod = fl.Rod(fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 6), rectangle(), up=(0, 0, 1))
    scene = fl.Scene()
    scene.add(rod)
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.PointLoad(rod.point("end"), force=(-load, 0, 0)))
    return scene


def of_ancf_beam(load: float) -> fl.Scene:
    beam = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), rectangle(), cells=6, up=(0, 0, 1))
    beam.clamp(beam.point("start"))
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.PointLoad(beam.point("end"), force=(-load, 0, 0)))
    return scene


def of_solid(load: float, degree: int = 2) -> fl.Scene:
    material = fl.sections.SaintVenantKirchhoff(2.1e11, 0.3, 7800.0)
    solid = fl.Solid.brick((0.1, 0.1, 1.0), material, cells=(1, 1, 4), degree=degree)
    solid.clamp("c=0")
    scene = fl.Scene()
    scene.add(solid)
    scene.add(fl.loads.FaceLoad(solid, "c=1", force=(0, 0, -load)))
    return scene


def flat(a: float, b: float) -> tuple[float, float, float]:
    return a, 0.3 * b, 0.0


SHEET = fl.ShellSection.layer(0.01, STEEL)


def of_surface(load: float, kind: type = fl.Shell) -> fl.Scene:
    if kind is fl.Shell:
        shell = fl.Shell(fl.mesh.parametric_surface(flat, (6, 2)), SHEET)
    else:
        shell = kind(fl.mesh.smooth_patch(flat, (6, 2)), SHEET)
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(-load, 0, 0)))
    return scene


def of_strut(load: float) -> fl.Scene:
    """A post on a spring along it, held at its top by a weaker spring across: ``P = k a``."""
    scene = fl.Scene()
    top = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), (0, 0, 1.5)))
    plane = scene.add(
        fl.joints.Planar(fl.ground(), top.point("centre"), axis=(0, 1, 0), second=(1, 0, 0))
    )
    scene.add(fl.joints.Spring(plane.angle, 1e9))
    post = scene.add(fl.joints.Distance(fl.ground(), top.point("centre"), at=(0, 0, 0)))
    scene.add(fl.joints.Spring(post.length, 1e6))
    across = scene.add(fl.joints.Distance(fl.ground(), top.point("centre"), at=(1, 0, 1.5)))
    scene.add(fl.joints.Spring(across.length, 30.0))
    scene.add(fl.PointLoad(top.point("centre"), force=(0, 0, -load)))
    return scene


EULER = np.pi**2 / 4 * 2.1e11 * 0.02 * 0.01**3 / 12
SQUARE = np.pi**2 / 4 * 2.1e11 * 0.1**4 / 12 / 0.1**2
PLATE = np.pi**2 / 4 * 2.1e11 * 0.01**3 / 12

BODIES = {
    "geodesic beam": (of_beam, EULER),
    "director beam": (lambda load: of_beam(load, fl.elements.DirectorBeam(2)), EULER),
    "rod": (of_rod, EULER),
    "ANCF beam": (of_ancf_beam, EULER),
    "solid of degree 2": (of_solid, SQUARE),
    "shell": (of_surface, PLATE),
    "thin shell": (lambda load: of_surface(load, fl.ThinShell), PLATE),
    "ANCF shell": (lambda load: of_surface(load, fl.AncfShell), PLATE),
    "springs": (of_strut, 45.0),
}


@pytest.mark.parametrize("body", BODIES)
def test_factor_times_load_does_not_depend_on_the_load(body):
    """Loads of a millionth of the critical one, and less, were lost in round-off."""
    make, critical = BODIES[body]
    loads = critical * 10.0 ** np.arange(-12, 4, 3)
    found = [p * fl.buckling(make(p), 1).factors[0] for p in loads]
    np.testing.assert_allclose(found, found[-2], rtol=1e-8)
    # 4 % of a solid's are shear, 3 to 10 % of a plate's its width
    assert found[0] == pytest.approx(critical, rel=0.06)


@dataclass(frozen=True)
class Yielding(fl.elements.DirectorBeam):
    """A beam whose bending compliance grows with its axial force: ``(1 + γ N)/EI``.

    Its stresses are unknowns of the cells, and its tangent is no linear function of them.
    """

    gamma: float = 0.0

    def forms(self, nodal, cells):
        mesh = nodal.function.function_space.mesh
        element = basix.ufl.element("DG", "interval", 0, shape=(6,))
        s = fem.Function(fem.functionspace(mesh, element))
        stretch, curvature = fl.elements.director_strains(nodal)
        strain = ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])
        C = fl.extend.cellwise(mesh, np.linalg.inv(cells.stiffness))
        bending = C[4, 4] * s[4] ** 2 + C[5, 5] * s[5] ** 2
        stored = 0.5 * ufl.inner(s, C * s) + 0.5 * self.gamma * s[0] * bending
        dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 1})
        return fl.local_frame_forms((ufl.inner(s, strain) - stored) * dx, nodal, local=s)


@pytest.mark.parametrize("load", [1e-9, 1.0, 10.0])
def test_a_tangent_that_is_not_linear_in_the_stress_is_differentiated(load):
    """``EI (1 + γ P) (π/2)² = P`` to first order in P: 10 % more than without γ."""
    euler = np.pi**2 / 4
    scene, beam = cantilever(stiff(strong=100.0, axial=1e6), 16, Yielding(1, gamma=0.1 / euler))
    scene.add(fl.PointLoad(beam.point("end"), force=(-load, 0, 0)))
    assert load * fl.buckling(scene, 1).factors[0] == pytest.approx(euler / 0.9, rel=5e-3)


def test_springs_bear_on_stability_by_their_forces():
    """A post on a spring, held at its top by another: ``P = k a``, 30 times the height of 1.5."""
    assert fl.buckling(of_strut(1.0), 1).factors[0] == pytest.approx(45.0, rel=1e-3)
    (point,) = fl.follow_path(of_strut(45.0), 1.2).critical
    assert point.factor == pytest.approx(1.0, rel=1e-3)


def test_shells_under_rigid_bodies_buckle_as_beams_do():
    """A body on a strip of shells and on a beam, loaded 0.3 above their ends."""
    material, found = fl.Material(2.1e11, 0.0, 7800.0), []
    strip = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (0.3 * (b - 0.5), 0.0, a), (12, 2)),
        fl.ShellSection.layer(0.01, material),
    )
    strip.clamp("a=0")
    section = fl.Section.rectangle(0.3, 0.01, material)
    beam = fl.Beam.straight(
        (0, 0, 0),
        (0, 0, 1),
        section,
        cells=12,
        up=(0, 1, 0),
        formulation=fl.elements.DirectorBeam(2),
    )
    for body, ends in ((strip, strip.points("a=1")), (beam, [beam.point("end")])):
        scene = fl.Scene()
        scene.add(body)
        if body is beam:
            scene.add(fl.Clamp(beam.point("start")))
        top = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (0, 0, 1.3)))
        for end in ends:
            scene.add(fl.joints.RigidLink(top.point("centre"), end))
        scene.add(fl.PointLoad(top.point("centre"), force=(0, 0, -1.0)))
        found.append(fl.buckling(scene, 1).factors[0])
    assert found[0] == pytest.approx(found[1], rel=3e-3)


@pytest.mark.parametrize("seed", [7, 47, 99])
def test_forces_fixed_in_space_have_a_potential_whatever_they_act_on(seed):
    """Shells on beams and bodies: their tangent took forces of the unloaded state for present."""
    scene = build(random_scene(seed, PROPORTIONAL), static=True).scene
    assert fl.buckling(scene, 1).factors[0] > 0


# --- loads that follow, and moments about fixed axes ---


def on_forks() -> tuple[fl.Scene, float]:
    """End moments about the strong axis, ends that do not twist: ``π √(EI GJ)/L``."""
    section = stiff(strong=1e4, torsion=0.5, axial=1e8)
    beam = fl.Beam.straight(
        (0, 0, 0),
        (1, 0, 0),
        section,
        cells=16,
        up=(0, 0, 1),
        formulation=fl.elements.DirectorBeam(2),
    )
    scene = fl.Scene()
    scene.add(beam)
    scene.add(
        fl.joints.Universal(fl.ground(), beam.point("start"), axis=(0, 1, 0), second=(0, 0, 1))
    )
    beam.model.held[beam.point("end").node, 1:4] = True
    scene.add(fl.PointLoad(beam.point("start"), moment=(0, 1, 0)))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, -1, 0)))
    return scene, np.pi * np.sqrt(0.5)


def with_guided_end() -> tuple[fl.Scene, float]:
    """A force that follows an end that does not turn: ``π² EI/L²``."""
    scene, beam = cantilever(stiff(strong=100.0, axial=1e8))
    scene.add(fl.PointLoad(beam.point("end"), force=(-1, 0, 0), following=True))
    beam.model.held[beam.point("end").node, 3:] = True
    return scene, np.pi**2


def ring(*, plane: bool) -> tuple[fl.Scene, float]:
    """Pressure on a circular ring of radius 1: ``3 EI/R³`` in its plane."""
    mesh = fl.mesh.Spline.circle((0, 0, 0), 1.0, (0, 0, 1), 48).mesh()
    beam, scene = fl.Beam(mesh, stiff(), up=(0, 0, 1)), fl.Scene()
    scene.add(beam)
    held = [int(np.argmax(beam.frames[:, 0] @ axis)) for axis in ((1, 0, 0), (-1, 0, 0), (0, 1, 0))]
    beam.model.held[held, 0] = True
    beam.model.held[:, 2:5] |= plane
    beam.model.held[held, 2] = True
    inward = beam.frames[0, 1:] @ -beam.frames[0, 0]
    scene.add(fl.loads.PressureLoad(beam, 1.0, direction=(0, *np.round(inward[1:], 12))))
    return scene, 3.0


WITH_POTENTIAL = {
    "end moments on forks": on_forks,
    "a following force on a guided end": with_guided_end,
    "pressure on a ring in its plane": lambda: ring(plane=True),
}


@pytest.mark.parametrize("name", WITH_POTENTIAL)
def test_loads_have_a_potential_where_supports_give_them_one(name):
    scene, factor = WITH_POTENTIAL[name]()
    assert fl.buckling(scene, 1).factors[0] == pytest.approx(factor, rel=1e-3)


def becks_column() -> fl.Scene:
    scene, beam = cantilever(stiff())
    scene.add(fl.PointLoad(beam.point("end"), force=(-1, 0, 0), following=True))
    return scene


def leipholz_column() -> fl.Scene:
    scene, beam = cantilever(stiff())
    scene.add(fl.LineLoad(beam, force=(-1, 0, 0), following=True))
    return scene


def twisted_cantilever() -> fl.Scene:
    scene, beam = cantilever(stiff())
    scene.add(fl.PointLoad(beam.point("end"), moment=(1, 0, 0)))
    return scene


def cardan_shaft() -> fl.Scene:
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), stiff(), cells=16, up=(0, 0, 1))
    scene = fl.Scene()
    scene.add(beam)
    scene.add(
        fl.joints.Universal(fl.ground(), beam.point("start"), axis=(0, 1, 0), second=(0, 0, 1))
    )
    for axis in ((0, 1, 0), (0, 0, 1)):
        scene.add(fl.joints.InPlane(fl.ground(), beam.point("end"), axis=axis))
    scene.add(fl.PointLoad(beam.point("end"), moment=(1, 0, 0)))
    return scene


def pressed_end() -> fl.Scene:
    """Pressure on the free end of a clamped block: Beck's column, too."""
    solid = fl.Solid.brick(
        (0.1, 0.1, 1.0),
        fl.sections.SaintVenantKirchhoff(2.1e11, 0.3, 7800.0),
        cells=(1, 1, 4),
        degree=2,
    )
    solid.clamp("c=0")
    scene = fl.Scene()
    scene.add(solid)
    scene.add(fl.loads.FacePressure(solid, "c=1", 1e6))
    return scene


WITHOUT = {
    "Beck's column": becks_column,
    "Leipholz's column": leipholz_column,
    "torsion of a cantilever": twisted_cantilever,
    "a cardan shaft": cardan_shaft,
    "pressure on a ring that may leave its plane": lambda: ring(plane=False)[0],
    "pressure on the end of a block": pressed_end,
}


@pytest.mark.parametrize("name", WITHOUT)
def test_loads_without_a_potential_are_refused(name):
    """The symmetric part of their stiffness is critical where nothing happens."""
    what = r"potential.*follow_path.*fl\.stability\.flutter"
    with pytest.raises(ValueError, match=what) as caught:
        fl.buckling(WITHOUT[name](), 1)
    assert "unsymmetric load stiffness" in str(caught.value)


def partly_following() -> fl.Scene:
    """Half a per cent of the load, by which the factor would be wrong by as much."""
    scene, beam = cantilever(stiff())
    scene.add(fl.PointLoad(beam.point("end"), force=(-0.995, 0, 0)))
    scene.add(fl.PointLoad(beam.point("end"), force=(-0.005, 0, 0), following=True))
    return scene


def beside_another_column() -> fl.Scene:
    """Of two columns the first one to buckle has a potential, and the other one has none."""
    scene, beam = cantilever(stiff())
    scene.add(fl.PointLoad(beam.point("end"), force=(-1, 0, 0)))
    other = scene.add(fl.Beam.straight((0, 5, 0), (1, 5, 0), stiff(), cells=16, up=(0, 0, 1)))
    scene.add(fl.Clamp(other.point("start")))
    scene.add(fl.PointLoad(other.point("end"), force=(-0.5, 0, 0), following=True))
    return scene


@pytest.mark.parametrize("make", [partly_following, beside_another_column])
def test_little_of_a_load_and_modes_that_come_later_count(make):
    with pytest.raises(ValueError, match="unsymmetric load stiffness"):
        fl.buckling(make(), 1)


# --- loads that pull ---

PULLED = [name for name in BODIES if name != "springs"]


@pytest.mark.parametrize("body", PULLED)
def test_what_is_pulled_does_not_buckle(body):
    """Solids and plates had modes of single cells at strains far beyond linear theory."""
    make, critical = BODIES[body]
    what = r"do not make the scene unstable.*tensile"
    with pytest.raises(fl.ConvergenceError, match=what) as caught:
        fl.buckling(make(-critical), 2)
    assert caught.value.result is None
    reversed_at = float(str(caught.value).partition("loads do at ")[2].split()[0])
    assert reversed_at == pytest.approx(1.0, rel=0.1)


def test_loads_that_change_no_stiffness_are_named():
    """A mass on a slide and a spring."""
    scene = fl.Scene()
    mass = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    slide = scene.add(fl.joints.Prismatic(fl.ground(), mass.point("centre"), axis=(1, 0, 0)))
    scene.add(fl.joints.Spring(slide.displacement, 10.0))
    scene.add(fl.PointLoad(mass.point("centre"), force=(1, 0, 0)))
    with pytest.raises(fl.ConvergenceError, match="do not change its stiffness"):
        fl.buckling(scene, 1)


# --- prestress ---

_HEIGHT, _SPAN, _GUY = 10.0, 8.0, 2e5
_SLOPED = float(np.hypot(_HEIGHT, _SPAN))


def guyed_mast(tension: float, kind: str, axial: float) -> fl.Scene:
    """A mast on a hinge under a load of 1, and two guys from its top that are tightened.

    Args:
        tension: Force in the guys before the mast gets shorter.
        kind: What the guys are made of, ``"cable"`` or ``"spring"``.
        axial: EA of the mast.
    """
    column = fl.Section.from_stiffness([axial, 1e9, 1e9, 1e6, 2e5, 2e5])
    scene = fl.Scene()
    mast = scene.add(fl.Rod.straight((0, 0, 0), (0, 0, _HEIGHT), column, cells=12))
    top = mast.point("end")
    scene.add(fl.joints.Revolute(fl.ground(), mast.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.InPlane(fl.ground(), top, axis=(0, 1, 0)))
    scene.add(fl.PointLoad(top, force=(0, 0, -1.0)))
    for x in (-_SPAN, _SPAN):
        rest = _SLOPED / (1 + tension / _GUY)
        if kind == "cable":
            guy = fl.Section.from_stiffness([_GUY, _GUY, _GUY, 1e-3, 1e-3, 1e-3])
            rope = fl.Cable.straight((x, 0, 0), (0, 0, _HEIGHT), guy, cells=1, length=rest)
            rope.pin(rope.point("start"))
            scene.add(rope)
            scene.add(fl.joints.Spherical(top, rope.point("end")))
        else:
            line = fl.joints.Distance(fl.ground((x, 0, 0)), top)
            scene.add(fl.joints.Spring(line.length, stiffness=_GUY / rest, rest=rest))
    return scene


@pytest.mark.parametrize("axial", [1e9, 1e12])
@pytest.mark.parametrize("kind", ["cable", "spring"])
def test_guys_compress_their_mast_before_it_is_loaded(kind, axial):
    tension = 2000.0
    loaded = fl.buckling(guyed_mast(tension, kind, axial), 1).factors[0]
    euler = np.pi**2 * 2e5 / _HEIGHT**2
    by_guys = 2 * tension * _HEIGHT / _SLOPED
    assert loaded == pytest.approx(euler - by_guys, rel=5e-4)


def test_a_mast_that_its_guys_buckle_is_refused():
    with pytest.raises(fl.ConvergenceError, match="buckles without loads"):
        fl.buckling(guyed_mast(13000.0, "cable", 1e9), 1)

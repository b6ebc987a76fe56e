"""Paths of equilibrium: through limit points, restart, controls, ends, bad input."""

import numpy as np
import pytest

import fem_lie as fl
from tests.assembled import Assembled

LIMIT = 0.8968413923  # of the deep arch below, by shooting (EA = 3e6, no shear)
LOWER = -0.07292283728


def arch(elements: int, *, hinged: bool = True, force: float = 1000.0):
    """Clamped-hinged deep arch of Da Deppo & Schmidt, and its crown."""
    half = np.radians(107.5)
    section = fl.Section.from_stiffness([3e6, 3e10, 3e10, 1e8, 1e8, 1e6])

    def position(s):
        angle = half * (2 * s - 1)
        return 100 * np.sin(angle), 100 * np.cos(angle), 0.0

    scene = fl.Scene()
    beam = scene.add(fl.Beam.curve(position, section, cells=elements, up=(0, 0, 1), name="arch"))
    scene.add(fl.Clamp(beam.point("end")))
    if hinged:
        scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    else:
        scene.add(fl.Clamp(beam.point("start")))
    crown = beam.point(elements // 2)
    scene.add(fl.PointLoad(crown, force=(0, -force, 0)))
    return scene, crown


def column(ends: str, elements: int, factor: float = 1.0):
    """A column of length and bending stiffness 1 under Euler's load."""
    euler = {"fixed-free": (np.pi / 2) ** 2, "pinned-pinned": np.pi**2}[ends]
    section = fl.Section.from_stiffness([1e6, 1e6, 1e6, 100, 1, 100])
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (0, 0, 1), section, cells=elements, up=(1, 0, 0), name="column")
    )
    if ends == "fixed-free":
        scene.add(fl.Clamp(beam.point("start")))
    else:
        scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
        scene.add(fl.joints.InPlane(fl.ground(), beam.point("end"), axis=(1, 0, 0)))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -factor * euler)))
    return scene, beam, euler


@pytest.fixture(scope="module")
def deep():
    scene, crown = arch(24)
    path = fl.follow_path(
        scene, observe={"down": lambda s: -s.displacement(crown)[1], "load": lambda s: s.factor}
    )
    return scene, crown, path


def test_deep_arch_passes_both_limit_points(deep):
    _, _, path = deep
    upper, lower = path.critical
    assert [point.kind for point in path.critical] == [fl.stability.CriticalPointType.LIMIT] * 2
    assert upper.factor == pytest.approx(LIMIT, rel=3e-3)
    assert lower.factor == pytest.approx(LOWER, rel=3e-3)
    assert upper.negative_pivots == (0, 1)
    assert lower.negative_pivots == (1, 0)
    assert path.complete and path.factors[-1] == 1.0
    assert "load factor 1 is reached" in path.reason


def test_located_limit_loads_do_not_depend_on_the_steps(deep):
    scene, _, path = deep
    other = fl.follow_path(scene, resolution=0.13)
    assert len(other) < len(path)
    for a, b in zip(path.limits, other.limits, strict=True):
        assert b.factor == pytest.approx(a.factor, rel=1e-6)
        assert abs(a.bracket[1] - a.bracket[0]) <= 1e-6 * abs(a.factor)


def test_every_state_is_in_equilibrium(deep):
    scene, _, path = deep
    system = Assembled(scene, dynamics=False)
    masters, n = system.equations.unknowns.masters, system.count
    for frames, factor in zip(path.frames, path.factors, strict=True):
        H = system.start.copy()
        H[:n] = frames[masters]
        system.equations.prescribed(float(factor)).act(factor=float(factor))
        left = system.residual(H)[: 6 * n]
        B = system.equations.constraints(H).jacobian.toarray()
        reactions = np.linalg.lstsq(B.T, -left, rcond=None)[0]
        # of 1000, EA is 3e6
        assert np.abs(left + B.T @ reactions).max() <= 2e-5


def test_steps_are_those_of_the_wanted_resolution(deep):
    """Loads change by no more than a part of the range."""
    _, _, path = deep
    assert np.abs(np.diff(path.factors)).max() <= 0.05 * (1 + 1e-6)
    np.testing.assert_array_equal(path.observed["load"], path.factors)


def test_path_begins_again_anywhere_and_goes_both_ways(deep):
    scene, crown, path = deep
    k = len(path) // 2
    on = fl.follow_path(scene, start=path.stations[k])
    assert on.factors[0] == path.factors[k]
    np.testing.assert_allclose(on.position(crown)[-1], path.position(crown)[-1], atol=1e-6)
    back = fl.follow_path(scene, 0.5, start=path.stations[path.limits[0].index - 2], backwards=True)
    assert back.factors[-1] == 0.5 and back.stable.all()
    first = np.interp(0.5, path.factors[:30], -path.displacement(crown)[:30, 1])
    assert -back.displacement(crown)[-1, 1] == pytest.approx(first, rel=1e-2)


def test_displacement_control_passes_limit_points_of_the_load(deep):
    """Down to where the crown stops going down: there is the second turn, of the displacement."""
    scene, crown, path = deep
    control = fl.stability.DisplacementControl(crown, (0, -1, 0), to=116.0)
    found = fl.follow_path(scene, control=control)
    assert found.complete
    assert -found.displacement(crown)[-1, 1] == pytest.approx(116.0, abs=1e-5)
    assert [point.kind for point in found.critical] == [fl.stability.CriticalPointType.LIMIT]
    assert found.critical[0].factor == pytest.approx(path.limits[0].factor, rel=1e-6)


def test_load_control_stops_at_a_limit_point_and_keeps_what_it_has(deep):
    scene, _, path = deep
    found = fl.follow_path(scene, control=fl.stability.LoadControl())
    assert not found.complete
    assert "still fail beyond load factor" in found.reason
    assert found.factors[-1] == pytest.approx(path.limits[0].factor, rel=1e-2)
    assert found.stable.all()


def test_path_ends_where_it_should(deep):
    scene, crown, _ = deep
    stopped = fl.follow_path(
        scene, fl.stability.PathEnds(stop=lambda s: -s.displacement(crown)[1] - 50.0)
    )
    assert stopped.complete
    assert -stopped.displacement(crown)[-1, 1] == pytest.approx(50.0, abs=1e-6)
    few = fl.follow_path(scene, fl.stability.PathEnds(steps=3))
    assert not few.complete and "number of steps" in few.reason and len(few) == 4
    ranged = fl.follow_path(scene, fl.stability.PathEnds(load_range=(-1.0, 0.6)))
    assert not ranged.complete and "leaves the range" in ranged.reason
    assert ranged.factors[-1] == 0.6
    first = fl.follow_path(scene, fl.stability.PathEnds(critical_points=1))
    assert first.reason == "1 critical point is found"
    assert first.complete and len(first.critical) == 1


def test_thin_roof_snaps_back_with_one_negative_pivot():
    """Displacement element of degree 4: 0.19486 and −0.12838; here 6×6 cells."""
    R = 2540.0

    def position(a, b):
        return R * np.sin(0.1 * a), 254.0 * b, R * (np.cos(0.1 * a) - 1)

    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (6, 6)),
        fl.ShellSection.layer(6.35, fl.Material(3102.75, 0.3, 1.0)),
        director=lambda x: np.array([x[0], 0, x[2] + R]) / R,
        name="roof",
    )
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    shell.hinge("a=1")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("00"), force=(0, 0, -750.0)))
    path = fl.follow_path(scene)
    down = -path.displacement(shell.point("00"))[:, 2]
    assert (np.diff(down) < 0).any() and (np.diff(path.factors) < 0).any()
    upper, lower = path.limits
    assert upper.factor == pytest.approx(0.19486, rel=0.05)
    assert lower.factor == pytest.approx(-0.12838, rel=0.05)
    assert (upper.negative_pivots, lower.negative_pivots) == ((0, 1), (1, 0))


def test_plain_newton_and_linearised_stress_find_the_same_path(deep):
    scene, _, path = deep
    plain = fl.follow_path(
        scene,
        fl.stability.PathEnds(critical_points=1),
        options=fl.stability.PathOptions(linearised_stress=False),
    )
    assert plain.limits[0].factor == pytest.approx(path.limits[0].factor, rel=1e-6)


def test_diagram_and_animation_of_a_path(deep, tmp_path):
    _, _, path = deep
    path.plot_path("down", tmp_path / "path.png", label="deflection")
    path.animate(tmp_path / "path.gif", images=3)
    path.critical[0].picture(tmp_path / "mode.png")
    for name in ("path.png", "path.gif", "mode.png"):
        assert (tmp_path / name).stat().st_size > 1000
    with pytest.raises(ValueError, match="was not observed"):
        path.plot_path("up")
    with pytest.raises(ValueError, match="must have shape"):
        path.plot_path(np.zeros(3))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": 0.0}, "resolution"),
        (
            {"until": fl.stability.PathEnds(load_range=(0.5, 1.0))},
            "leaves the range of load factors where",
        ),
        ({"until": 0.0}, "not where it begins"),
        (
            {
                "until": fl.stability.PathEnds(critical_points=1),
                "options": fl.stability.PathOptions(locate=None),
            },
            "must be located",
        ),
    ],
)
def test_bad_options_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        fl.follow_path(arch(4)[0], **options)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fl.stability.PathEnds(steps=0), "steps"),
        (lambda: fl.stability.PathEnds(critical_points=0), "critical_points"),
        (lambda: fl.stability.PathEnds(load_range=(1.0, 1.0)), "load_range"),
        (lambda: fl.stability.PathOptions(locate=2.0), "locate"),
        (lambda: fl.schemes.Newton(tolerance=0.0), "tolerance"),
        (lambda: fl.schemes.Newton(smallest_step=2.0), "smallest_step"),
    ],
)
def test_options_that_are_none_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_bad_scenes_are_refused(deep):
    scene, _ = arch(4)
    scene.loads.clear()
    with pytest.raises(ValueError, match="a load that is not zero"):
        fl.follow_path(scene)
    free = fl.Scene()
    beam = free.add(
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.from_stiffness(np.ones(6)), cells=3)
    )
    free.add(fl.PointLoad(beam.point("end"), force=(1, 0, 0)))
    with pytest.raises(ValueError, match="singular"):
        fl.follow_path(free)
    with pytest.raises(ValueError, match="singular"):
        fl.buckling(free)
    with pytest.raises(ValueError, match="must be a state of this scene"):
        fl.follow_path(arch(4)[0], start=deep[2].stations[0])
    linked, crown = arch(4)
    body = linked.add(fl.RigidBody(1.0, (1, 1, 1), (0, 110, 0)))
    linked.add(fl.joints.RigidLink(crown, body.point("centre")))
    with pytest.raises(ValueError, match="attached to another node"):
        control = fl.stability.DisplacementControl(body.point("centre"), (0, 0, 1), to=1.0)
        fl.follow_path(linked, control=control)
    with pytest.raises(ValueError, match="needs a point"):
        control = fl.stability.DisplacementControl(fl.ground(), (0, 0, 1), to=1.0)
        fl.follow_path(arch(4)[0], control=control)

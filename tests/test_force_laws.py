"""Force laws of users: closed forms, equality with springs, schemes, checkpoints, messages."""

import numpy as np
import pytest

import fem_lie as fl

NOTHING_BUT_FRAMES = fl.schemes.Record.FRAMES
STIFF, DAMP, REST = 50.0, 0.4, 0.3


def slider(add, mass=2.0, speed=0.0):
    """A body on a line without gravity; ``add(scene, displacement)``."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(mass, (0.1, 0.1, 0.1), position=(1.0, 0.0, 0.0)))
    joint = scene.add(fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0)))
    if speed:
        body.add_velocity((speed, 0.0, 0.0))
    add(scene, joint.displacement)
    return scene


def law_of(law, **how):
    return lambda scene, q: scene.add(fl.loads.ForceLaw(q, law, **how))


@fl.loads.compiled_law
def linear(t, q, rate):
    return 50.0 * (q - 0.3) + 0.4 * rate


LINEAR = {
    "Python": lambda t, q, rate: STIFF * (q - REST) + DAMP * rate,
    "compiled": linear,
}


@pytest.mark.parametrize("law", LINEAR.values(), ids=LINEAR)
@pytest.mark.parametrize("step", [0.01, fl.schemes.AdaptiveStep(1e-3, first=0.01)])
def test_linear_law_is_a_spring(law, step):
    spring = slider(lambda scene, q: scene.add(fl.joints.Spring(q, STIFF, DAMP, rest=REST)))
    scheme = fl.GeneralisedAlpha(radius=0.8)
    a, b = (
        scheme.run(scene, duration=0.5, step=step, save_every=1)
        for scene in (spring, slider(law_of(law)))
    )
    np.testing.assert_array_equal(a.frames, b.frames)
    # a spring stores energy; a law without a potential takes it out of the balance
    assert a.energy_error < 1e-3 and b.energy_error < 2e-3


@pytest.mark.parametrize(
    "law",
    [
        lambda t, q, rate: -3.0 * np.cos(2.0 * t),
        fl.loads.compiled_law(lambda t, q, rate: -3.0 * np.cos(2.0 * t)),
    ],
)
def test_time_is_that_of_the_end_of_a_step(law):
    """Force 3 cos 2t on 2 kg: x = (3/8)(1 − cos 2t)."""
    errors = []
    for steps in (50, 100):
        scene = slider(law_of(law, name="motor"))
        result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=1.0, step=1.0 / steps)
        moved = result.frames[-1, 0, 0, 0] - 1.0
        errors.append(abs(moved - 0.375 * (1.0 - np.cos(2.0))))
    assert errors[1] < 5e-5 and errors[1] < 0.26 * errors[0]


def test_points_attract_each_other_by_a_law_of_their_distance():
    """Two masses 1 and 3 at distance 2 with a linear attraction: reduced mass 3/4."""
    scene = fl.Scene()
    a, b = (
        scene.add(fl.RigidBody(m, (0.1, 0.1, 0.1), position=(x, 0.0, 0.0)))
        for m, x in ((1.0, 0.0), (3.0, 2.0))
    )
    points = a.point("centre"), b.point("centre")
    scene.add(fl.loads.ForceLaw(points, lambda t, q, rate: 27.0 * (q - 1.0)))
    period = 2.0 * np.pi / 6.0
    scheme = fl.GeneralisedAlpha(radius=1.0)
    result = scheme.run(scene, duration=0.5 * period, step=0.5 * period / 400)
    distance = result.frames[-1, 1, 0, 0] - result.frames[-1, 0, 0, 0]
    assert abs(distance - 0.0) < 1.0  # swings to 0: stays on the line
    quarter = result.frames[200, 1, 0, 0] - result.frames[200, 0, 0, 0]
    assert abs(quarter - 1.0) < 1e-4
    centre = (result.frames[:, 0, 0] + 3.0 * result.frames[:, 1, 0]) / 4.0
    np.testing.assert_allclose(centre - centre[0], 0.0, atol=1e-13)


def duffing():
    def force(t, q, rate):
        return 20.0 * q + 900.0 * q**3

    return {
        "Python": law_of(force, potential=lambda q: 10.0 * q**2 + 225.0 * q**4),
        "compiled": law_of(
            fl.loads.compiled_law(potential=lambda q: 10.0 * q**2 + 225.0 * q**4)(force)
        ),
    }


@pytest.mark.parametrize("add", duffing().values(), ids=duffing())
def test_conserving_scheme_keeps_the_energy_of_a_potential(add):
    scene = slider(add, speed=2.0)
    result = fl.EnergyMomentum(tolerance=0.0).run(scene, duration=2.0, step=0.02)
    energy = result.kinetic + result.elastic
    assert result.elastic.max() > 0.9 * energy[0]
    np.testing.assert_allclose(energy, energy[0], rtol=2e-13)


def test_conserving_scheme_keeps_the_energy_of_a_table():
    q = np.linspace(-1.0, 1.0, 9)
    table = fl.loads.SpringTable(q, 20.0 * q + 90.0 * q**3)
    result = fl.EnergyMomentum(tolerance=0.0).run(
        slider(law_of(table), speed=2.0), duration=2.0, step=0.02
    )
    energy = result.kinetic + result.elastic
    np.testing.assert_allclose(energy, energy[0], rtol=2e-13)


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.schemes.Variational(), fl.Explicit()])
def test_schemes_refuse_a_law_without_a_potential(scheme):
    with pytest.raises(ValueError, match=r"force laws without a potential \(ForceLaw\)"):
        scheme.run(slider(law_of(LINEAR["Python"])), duration=0.1, step=0.01)


@pytest.mark.parametrize("scheme", [fl.schemes.Variational(), fl.GeneralisedAlpha(radius=1.0)])
def test_schemes_of_second_order_with_a_potential(scheme):
    """Stiffening spring x³: x″ = −x³ from rest at 1 has the period 7.4162987…"""
    force = law_of(
        lambda t, q, rate: 2.0 * (q + 1.0) ** 3, potential=lambda q: 0.5 * (q + 1.0) ** 4
    )
    errors = []
    for steps in (200, 400):
        result = scheme.run(
            slider(force), duration=7.416298709205487, step=7.416298709205487 / steps
        )
        errors.append(abs(result.frames[-1, 0, 0, 0] - 1.0))
    speeds = result.velocities[-1, 0, 0]
    assert errors[1] < 1e-5 and abs(speeds) < 2e-3


def test_table_is_exact_at_its_points_and_on_straight_lines():
    q, f = np.array([-1.0, 0.0, 0.5, 2.0]), np.array([-3.0, 0.0, 4.0, 4.5])
    table = fl.loads.SpringTable(q, f)
    np.testing.assert_allclose([table(0.0, x, 0.0) for x in q], f, rtol=1e-15)
    straight = fl.loads.SpringTable(q, 7.0 * q + 1.0)
    for x in (-4.0, -0.3, 0.1, 1.7, 5.0):
        assert abs(straight(0.0, x, 0.0) - (7.0 * x + 1.0)) < 1e-14 * 40
        assert abs(straight.derivatives(0.0, x, 0.0)[0] - 7.0) < 1e-13
    # monotone, and its potential is the integral
    x = np.linspace(-2.0, 3.0, 2001)
    values = np.array([table(0.0, each, 0.0) for each in x])
    assert (np.diff(values) >= 0.0).all()
    work = np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(x))
    assert abs(table.potential(3.0) - table.potential(-2.0) - work) < 1e-5


@pytest.mark.parametrize(
    ("law", "rest"),
    [(fl.loads.TensionOnly(80.0, 0.4), 0.4), (fl.loads.CompressionOnly(80.0, 0.4), 0.4)],
)
def test_one_sided_springs_in_statics(law, rest):
    """A force of 20 N on two springs, one of which acts on one side only."""
    for force in (20.0, -20.0):
        scene = slider(law_of(law))
        joint = scene.joints[0]
        scene.add(fl.joints.Spring(joint.displacement, 40.0, rest=0.0))
        scene.add(fl.PointLoad(scene.bodies[0].point("centre"), force=(force, 0.0, 0.0)))
        found = fl.statics(scene).frames[-1, 0, 0, 0] - 1.0
        alone = force / 40.0
        both = (force + 80.0 * rest) / 120.0
        acts = both > rest if type(law) is fl.loads.TensionOnly else both < rest
        assert abs(found - (both if acts else alone)) < 1e-10


@pytest.mark.parametrize(
    ("scheme", "damping"), [(fl.GeneralisedAlpha(radius=0.8), 0.4), (fl.EnergyMomentum(), 0.0)]
)
def test_laws_on_points_within_bodies_are_springs(scheme, damping):
    """Between a body, the end of a cable and a face of a solid: two sets of joints."""
    frames = []
    for own in (False, True):
        scene = fl.Scene(gravity=(0.0, 0.0, -9.81))
        material = fl.Material(E=1e9, nu=0.3, density=1e3)
        section = fl.Section.circle(0.01, material)
        stuff = fl.sections.SaintVenantKirchhoff(E=1e9, nu=0.3, density=1e3)
        rope = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), section, cells=3))
        scene.add(fl.joints.Spherical(fl.ground(), rope.point("start")))
        block = scene.add(fl.Solid.brick((0.1, 0.1, 0.1), stuff, cells=(1, 1, 1)))
        block.clamp("a=0")
        body = scene.add(fl.RigidBody(0.2, (0.1, 0.1, 0.1), position=(0.6, 0.0, -0.5)))
        for k, point in enumerate((rope.point("end"), block.point("a=1"))):
            length = fl.joints.Distance(point, body.point("centre")).length
            stiffness, rest = 90.0 + k, 0.4 - 0.1 * k
            if own and damping:

                def law(t, q, rate, k=stiffness, q0=rest):
                    return k * (q - q0) + damping * rate

                scene.add(fl.loads.ForceLaw(length, law))
            elif own:
                ends = np.array([-1.0, 1.0])
                table = fl.loads.SpringTable(rest + ends, stiffness * ends)
                scene.add(fl.loads.ForceLaw(length, table))
            else:
                scene.add(fl.joints.Spring(length, stiffness, damping, rest=rest))
        frames.append(scheme.run(scene, duration=0.02, step=0.002).frames)
    np.testing.assert_allclose(*frames, rtol=0.0, atol=1e-9)


def test_slack_cable_stay():
    """A mass thrown up falls back on its stay: the time of free flight is 2 v/g."""
    scene = fl.Scene(gravity=(0.0, 0.0, -9.81))
    body = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0.0, 0.0, -1.0)))
    body.add_velocity((0.0, 0.0, 1.0))
    stay = fl.loads.TensionOnly(1e4, rest=1.0)
    length = fl.joints.Distance(fl.ground(), body.point("centre"), at=(0.0, 0.0, 0.0)).length
    scene.add(fl.loads.ForceLaw(length, stay))
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=0.2, step=1e-3)
    z = -1.0 + result.times - 0.5 * 9.81 * result.times**2
    np.testing.assert_allclose(result.frames[:, 0, 0, 2], z, atol=1e-5)
    assert result.elastic.max() == 0.0


def guyed_mast(rest):
    """A rigid mast of 3 m on a hinge, with two stays of 10 kN/m to 2 m from its foot."""
    scene = fl.Scene()
    mast = scene.add(fl.RigidBody(5.0, (4.0, 4.0, 0.1), position=(0, 0, 1.5), name="mast"))
    foot = {"at": (0, 0, 0), "axis": (0, 1, 0), "name": "foot"}
    scene.add(fl.joints.Revolute(fl.ground(), mast.point("centre"), **foot))
    top = mast.point((0, 0, 3))
    for name, x in (("stay", -2), ("lee", 2)):
        ends = fl.ground((x, 0, 0)), top
        scene.add(fl.loads.ForceLaw(ends, fl.loads.TensionOnly(1e4, rest), name=name))
    return scene, top


@pytest.mark.parametrize("force", [500.0, 3000.0, -3000.0])
def test_a_mast_leans_on_one_stay(force):
    """The moment about the foot at any angle: P = k (l − l₀) a/l, hence l = l₀/(1 − P/(k a))."""
    rest = 0.999 * np.hypot(3.0, 2.0)
    scene, top = guyed_mast(rest)
    scene.add(fl.PointLoad(top, force=(force, 0, 0)))
    result = fl.statics(scene, newton=fl.schemes.Newton(tolerance=1e-13))
    length = rest / (1.0 - abs(force) / 2e4)
    leaning = np.sign(force) * (length**2 - 13.0) / 4.0
    assert abs(result.position(top)[-1, 0] - leaning) < 1e-11
    tensions = [np.linalg.norm(result.joint_force(name)[-1, :3]) for name in ("stay", "lee")]
    expected = [1e4 * (length - rest), 0.0][:: int(np.sign(force))]
    np.testing.assert_allclose(tensions, expected, atol=1e-6)


@pytest.mark.parametrize("scheme", [fl.GeneralisedAlpha(radius=1.0), fl.EnergyMomentum()])
def test_a_mass_between_pretensioned_stays_swings_beyond_their_pretension(scheme):
    """Both stays pull up to the elongation e of the pretension, one beyond it: closed period."""
    k, m, e, v = 450.0, 2.0, 0.02, 1.0
    ω, alone = np.sqrt(2.0 * k / m), np.sqrt(k / m)
    left = np.sqrt(v**2 - (ω * e) ** 2)
    period = 4.0 * (np.arcsin(ω * e / v) / ω + np.arctan(left / (alone * 2.0 * e)) / alone)
    laws = fl.loads.TensionOnly(k, -e), fl.loads.CompressionOnly(k, e)
    errors = []
    for steps in (200, 400):

        def add(scene, q):
            for law in laws:
                scene.add(fl.loads.ForceLaw(q, law))

        result = scheme.run(slider(add, m, v), duration=period, step=period / steps)
        errors.append(abs(result.frames[-1, 0, 0, 0] - 1.0) / (v * period))
    assert errors[1] < 2e-5 and errors[1] < 0.3 * errors[0]


def test_vibrations_take_the_derivative_of_a_law():
    scene = slider(law_of(lambda t, q, rate: 32.0 * np.sin(q)))
    frequency = fl.vibrations(scene, 1).frequencies[0]
    assert abs(frequency - 4.0) < 1e-12


def test_run_resumes_to_the_last_bit(tmp_path):
    def scene(factor=1.0):
        return slider(law_of(lambda t, q, rate: factor * 50.0 * q + np.tanh(rate - np.sin(t))))

    scheme, path = fl.GeneralisedAlpha(radius=0.9), tmp_path / "run.h5"
    plan = {"duration": 1.0, "step": 0.01, "checkpoint_every": 10}
    whole = scheme.run(scene(), file=tmp_path / "whole.h5", **plan)
    calls = []

    def interrupted(t, q, rate):
        calls.append(t)
        if len(calls) > 200 and t > 0.555:
            raise KeyError("enough")
        return 50.0 * q + np.tanh(rate - np.sin(t))

    with pytest.raises(fl.ConvergenceError, match="KeyError: 'enough'") as error:
        scheme.run(slider(law_of(interrupted)), file=path, **plan)
    assert len(error.value.result.times) == 56  # with results
    resumed = scheme.resume(scene(), path)
    np.testing.assert_array_equal(resumed.frames, whole.frames)
    with pytest.raises(ValueError, match="force law of ForceLaw"):
        scheme.resume(scene(1.1), path)


WRONG = {
    "a vector": (lambda t, q, rate: np.array([q, 0.0, 0.0]), {}, RuntimeError, "value of the law"),
    "nothing": (lambda t, q, rate: None, {}, RuntimeError, "value of the law"),
    "two arguments": (lambda q, rate: q, {}, RuntimeError, "positional argument"),
    "not finite": (lambda t, q, rate: np.nan, {}, RuntimeError, "finite value"),
    "a comparison": (lambda t, q, rate: max(q, 0.0), {}, RuntimeError, "give derivatives="),
    "wrong derivatives": (
        lambda t, q, rate: 2.0 * q,
        {"derivatives": lambda t, q, rate: (3.0, 0.0)},
        ValueError,
        "expected ∂F/∂q = 2",
    ),
    "one derivative": (
        lambda t, q, rate: 2.0 * q,
        {"derivatives": lambda t, q, rate: 2.0},
        RuntimeError,
        "two numbers",
    ),
    "abs": (lambda t, q, rate: abs(q + 1.0), {}, ValueError, "expected ∂F/∂q = 1"),
    "another potential": (
        lambda t, q, rate: 2.0 * q + 1.0,
        {"potential": lambda q: q**2},
        ValueError,
        "whose derivative is the force 1",
    ),
    "a potential and a rate": (
        lambda t, q, rate: 2.0 * q + rate,
        {"potential": lambda q: q**2},
        ValueError,
        "coordinate only",
    ),
}


@pytest.mark.parametrize(("law", "how", "kind", "match"), WRONG.values(), ids=WRONG)
def test_wrong_laws_are_refused_when_added(law, how, kind, match):
    with pytest.raises(kind, match=match):
        slider(law_of(law, **how))


def test_wrong_arguments():
    joint = slider(lambda scene, q: None).joints[0]
    with pytest.raises(TypeError, match="law must be a function, got 3"):
        fl.loads.ForceLaw(joint.displacement, 3.0)
    with pytest.raises(TypeError, match="coordinate of a joint"):
        fl.loads.ForceLaw(joint, linear)
    with pytest.raises(ValueError, match="its own potential"):
        fl.loads.ForceLaw(joint.displacement, linear, potential=abs)
    with pytest.raises(TypeError, match=r"compiled_law\(vector\): the law must return a number"):

        @fl.loads.compiled_law
        def vector(t, q, rate):
            return np.zeros(3)

    with pytest.raises(TypeError, match="give derivatives="):

        @fl.loads.compiled_law
        def compared(t, q, rate):
            return max(q, 0.0)

    with pytest.raises(ValueError, match="increasing coordinates"):
        fl.loads.SpringTable([0.0, 0.0, 1.0], [0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match="stiffness > 0"):
        fl.loads.TensionOnly(-1.0, 2.0)


def test_error_in_a_law_ends_the_run_with_its_results():
    def raises(t, q, rate):
        if 0.0455 < t < 0.5:
            raise ZeroDivisionError("out of range")
        return 5.0 * q

    scene = slider(law_of(raises, name="motor"))
    with pytest.raises(fl.ConvergenceError, match="motor: ZeroDivisionError") as error:
        fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.001)
    assert len(error.value.result.times) == 46

"""Forces and stresses of all bodies are asked for in the same way, and have the same names."""

import numpy as np
import pytest

import fem_lie as fl

LENGTH, WIDTH, THICKNESS, FORCE = 1.0, 0.2, 0.01, 3.0e3
STEEL = fl.Material(E=2.1e11, nu=0.0, density=7800.0)
STRESS = FORCE / (WIDTH * THICKNESS)


def flat(a, b):
    """A rectangle with the corners "00" to "11"."""
    return np.array([LENGTH * a, WIDTH * b, 0.0])


def beam():
    """The strip as a beam, and its resultant as a quantity."""
    section = fl.Section.rectangle(WIDTH, THICKNESS, STEEL)
    body = fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=4, name="strip")
    load = fl.PointLoad(body.point("end"), force=(FORCE, 0, 0))
    return body, [fl.Clamp(body.point("start")), load], {"N": FORCE, "stress max": STRESS}


def shell():
    """The strip as a shell."""
    mesh = fl.mesh.parametric_surface(flat, (4, 2))
    body = fl.Shell(mesh, fl.ShellSection.layer(THICKNESS, STEEL), name="strip")
    body.clamp("a=0")
    load = fl.loads.EdgeLoad(body, "a=1", force=(FORCE / WIDTH, 0, 0))
    return body, [load], OF_SHELLS


def thin_shell():
    """The strip as a thin shell."""
    patch = fl.mesh.smooth_patch(flat, (4, 2))
    body = fl.ThinShell(patch, fl.ShellSection.layer(THICKNESS, STEEL), name="strip")
    body.clamp("a=0")
    load = fl.loads.EdgeLoad(body, "a=1", force=(FORCE / WIDTH, 0, 0))
    return body, [load], OF_SHELLS


def solid():
    """The strip as a solid."""
    material = fl.sections.SaintVenantKirchhoff(2.1e11, 0.0, 7800.0)
    body = fl.Solid.brick((LENGTH, WIDTH, THICKNESS), material, cells=(4, 2, 1), name="strip")
    body.clamp("a=0")
    load = fl.loads.FaceLoad(body, "a=1", force=(STRESS, 0, 0))
    return body, [load], {"xx": STRESS, "von Mises": STRESS, "pressure": -STRESS / 3, "yy": 0.0}


OF_SHELLS = {
    "N11": FORCE / WIDTH,
    "N max": FORCE / WIDTH,
    "N22": 0.0,
    "M11": 0.0,
    "von Mises top": STRESS,
    "von Mises bottom": STRESS,
}
BODIES = {each.__name__: each for each in (beam, shell, thin_shell, solid)}


@pytest.fixture(scope="module", params=BODIES)
def found(request):
    """Fields of a pulled strip, the values that they have, and the state of which they are."""
    body, items, wanted = BODIES[request.param]()
    scene = fl.Scene()
    scene.add(body)
    for item in items:
        scene.add(item)
    result = fl.statics(scene)
    ask = {
        "beam": lambda **states: fl.post.section_forces(result, body, scene, **states),
        "shell": lambda **states: fl.post.resultants(result, body, **states),
        "thin_shell": lambda **states: fl.post.thin_resultants(result, body, **states),
        "solid": lambda **states: fl.post.solid_stresses(result, body, **states),
    }[request.param]
    return ask, wanted, {"beam": "states"}.get(request.param, "state")


@pytest.mark.parametrize("way", ["raw", "mean", "smooth"])
def test_a_pulled_strip_has_one_stress_everywhere(found, way):
    ask, wanted, _ = found
    fields = ask()
    largest = max(map(abs, wanted.values()))
    for name, value in wanted.items():
        values = getattr(fields, way)(name)
        np.testing.assert_allclose(values, value, rtol=1e-5, atol=1e-9 * largest)


def test_quantities_are_listed_and_others_refused(found):
    ask, wanted, _ = found
    fields = ask()
    assert set(wanted) < set(fields.names)
    for name in fields.names:
        for way in (fields.raw, fields.mean, fields.smooth):
            assert np.isfinite(way(name)).all()
    for way in (fields.raw, fields.mean, fields.smooth):
        with pytest.raises(ValueError, match=r"strip has no quantity 'mises'; it has: \w+"):
            way("mises")


def test_shapes_are_those_of_points_cells_and_nodes(found):
    ask, wanted, _ = found
    fields, name = ask(), next(iter(wanted))
    raw, mean, smooth = (way(name) for way in (fields.raw, fields.mean, fields.smooth))
    assert mean.shape == raw.shape[:-1]  # cells, after the states of a beam
    assert smooth.ndim == (1 if raw.ndim == 2 else 3)


def test_values_at_a_point_are_those_of_its_node(found):
    ask, wanted, _ = found
    fields = ask()
    name = next(each for each in ("beam", "shell", "solid") if hasattr(fields, each))
    end = getattr(fields, name).point((LENGTH, 0, 0))
    for name, value in wanted.items():
        np.testing.assert_allclose(
            fields.at(end, name), value, rtol=1e-5, atol=1e-9 * max(map(abs, wanted.values()))
        )
    with pytest.raises(ValueError, match="has no quantity 'mises'"):
        fields.at(end, "mises")
    with pytest.raises(ValueError, match="is not a point of strip"):
        fields.at(fl.RigidBody(1.0, (1, 1, 1)).point("centre"), next(iter(wanted)))


def test_values_at_a_kink_have_several_sides_and_none_between_nodes():
    points = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (1, 0, 1), (1, 1, 1)]
    mesh = fl.mesh.SurfaceMesh.from_cells(points, [(0, 1, 2, 3), (2, 3, 4, 5)], "quadrilateral")
    angle = fl.Shell(mesh, fl.ShellSection.layer(THICKNESS, STEEL), name="angle")
    scene = fl.Scene()
    scene.add(angle)
    scene.add(fl.Clamp(angle.point(0)))
    scene.add(fl.PointLoad(angle.point(5), force=(1.0, 0, 0)))
    fields = fl.post.resultants(fl.statics(scene), angle, along=(0, 1, 0))
    assert np.isfinite(fields.at(angle.point((0, 0, 0)), "N11"))
    with pytest.raises(ValueError, match="'N11' has 2 values at angle"):
        fields.at(angle.point((1, 0, 0)), "N11")
    strip, items, _ = beam()
    scene = fl.Scene()
    for item in (strip, *items):
        scene.add(item)
    forces = fl.post.section_forces(fl.statics(scene), strip, scene)
    with pytest.raises(ValueError, match="is no node of strip, and 'N' is known at nodes"):
        forces.at(strip.point((0.1, 0, 0)), "N")


def test_a_state_is_chosen_by_its_index(found):
    ask, wanted, argument = found
    first = [0] if argument == "states" else 0
    name = next(iter(wanted))
    np.testing.assert_array_equal(ask(**{argument: first}).raw(name), ask().raw(name))
    with pytest.raises(ValueError, match="the result has 1 states, got state 3"):
        ask(**{argument: [3] if argument == "states" else 3})


def test_moments_of_a_thin_shell_are_linear_under_an_end_force():
    """``M₁₁`` is the force times its arm: at integration points, in cells and at points."""
    strip, _, _ = thin_shell()
    scene = fl.Scene()
    scene.add(strip)
    scene.add(fl.loads.EdgeLoad(strip, "a=1", force=(0, 0, 0.4)))
    fields = fl.post.thin_resultants(fl.statics(scene), strip)
    at_points = LENGTH - fields.positions[..., 0]
    points = LENGTH - strip.frames[: strip.model.points_count, 0, 0]
    for values, arms in (
        (fields.mean("M11"), at_points.mean(axis=1)),
        (fields.smooth("M11"), points),
    ):
        np.testing.assert_allclose(np.abs(values), 0.4 * arms, atol=2e-3 * 0.4)
    assert fields.smooth("M11").shape == (strip.model.points_count,)
    outside = 6 * 0.4 * points / THICKNESS**2
    np.testing.assert_allclose(fields.smooth("von Mises top"), outside, atol=2e-3 * outside.max())
    with pytest.raises(ValueError, match="has no quantity 'Q1'"):
        fields.raw("Q1")

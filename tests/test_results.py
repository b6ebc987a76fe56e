"""Results: look-up, invariants, files and pictures, on a rod whose motion is known."""

import os
from dataclasses import replace
from itertools import pairwise, product

import h5py
import numpy as np
import pytest
import pyvista
from PIL import Image

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import COLOURS

SPIN = np.array([0.3, -0.8, 1.5])
NODES = 5
SQUARE = 0.02 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def _scene():
    """The rod and the body, of which results have the names and points."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.04, 0.04, fl.Material(1.0, 0.3, 1.0))
    rod = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=NODES - 1, name="rod"))
    tip = scene.add(fl.RigidBody(1.0, (1, 1, 1), (1.25, 0, 0), name="tip"))
    tip.model.corners = np.array(list(product((-0.25, 0.25), (-0.1, 0.1), (-0.05, 0.05))))
    scene.add(fl.joints.Cylindrical(rod.point("start"), fl.ground(), name="hinge"))
    scene.add(fl.joints.Fixed(tip.point("centre"), rod.point("end"), at=(1, 0, 0), name="weld"))
    return scene


def rod_with_tip():
    """A rod of length 1 that turns about its end with a rigid body at its tip."""
    times, s = np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, NODES)
    along = np.pad(s[:, np.newaxis], [(0, 0), (0, 5)])
    along = np.vstack([along, [1.25, 0, 0, 0, 0, 0]])
    frames = np.array(
        [lie.se3_retract(lie.frame(np.zeros(3), lie.so3_exp(SPIN * t)), along) for t in times]
    )
    velocity = np.hstack([np.cross(SPIN, along[:, :3]), np.tile(SPIN, (NODES + 1, 1))])
    count = len(times)
    info = replace(fl.extend.Equations(_scene(), dynamics=True).info, mass=2.5)
    np.testing.assert_array_equal(
        np.concatenate([body.nodes for body in info.bodies]), np.arange(NODES + 1)
    )
    return fl.Result(
        times=times,
        frames=frames,
        velocities=np.tile(velocity, (count, 1, 1)),
        joint_forces=np.random.default_rng(0).normal(size=(count, 2, 6)),
        reactions=np.zeros((count, 0, 6)),
        joint_coordinates=np.column_stack([times, 2 * times]),
        joint_violations=np.zeros((count, 2)),
        kinetic=2.0 + 0.5 * np.sin(times),
        elastic=1.0 - 0.5 * np.sin(times) + 3e-9 * times,
        potential=np.zeros(count),
        momentum=np.outer(1 + times, [0, 3.0, 4.0]),
        angular_momentum=np.array([3.0, 0, 4.0]) + np.outer(times, [0, 5e-9, 0]),
        balance=np.zeros((count, 3)),
        impulses=np.zeros((count, 2, 6)),
        iterations=3 * np.arange(count),
        factorisations=7,
        k_updates=3,
        phi_updates=7,
        seconds=0.25,
        info=info,
    )


@pytest.fixture(scope="module")
def rod():
    return rod_with_tip()


# --- looking things up ---------------------------------------------------------------------------


def test_points_are_found_by_name_number_and_object(rod):
    exact = np.array([lie.so3_exp(SPIN * t)[:, 0] for t in rod.times])
    for point in ("rod.end", "rod.node 4", 4, np.int64(4)):
        np.testing.assert_allclose(rod.position(point), exact, atol=1e-15)
    body = fl.RigidBody(1.0, [1, 1, 1], name="tip")
    np.testing.assert_allclose(rod.position(body.point("centre")), 1.25 * exact, atol=1e-15)


def test_displacements_of_a_body_are_those_of_its_nodes(rod):
    u = rod.displacements("rod")
    each = np.stack([rod.displacement(f"rod.node {i}") for i in range(NODES)], axis=1)
    np.testing.assert_array_equal(u, each)
    body = fl.RigidBody(1.0, [1, 1, 1], name="tip")
    np.testing.assert_array_equal(rod.displacements(body)[:, 0], rod.displacement("tip.centre"))


def test_displacements_leave_out_nodes_without_a_position():
    """Each point of a thin shell has a second node, for the mixed derivative."""
    patch = fl.mesh.smooth_patch(lambda a, b: (a, b, 0 * a), (2, 2))
    layer = fl.ShellSection.layer(0.01, fl.Material(2.1e11, 0.3, 7800.0))
    shell = fl.ThinShell(patch, layer, name="sheet")
    shell.clamp("a=0")
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(shell)
    result = fl.statics(scene)
    u = result.displacements(shell)
    assert u.shape == (1, 9, 3)
    assert len(result.frames[0]) == 18
    assert (u[0] == result.displacement("sheet.11")[0]).all(axis=1).sum() == 1


def test_rotation_and_velocity_belong_together(rod):
    """``Rᵀẋ`` from positions by central differences is the translation of the local velocity."""
    h = rod.times[1] - rod.times[0]
    slope = (rod.position("rod.end")[2:] - rod.position("rod.end")[:-2]) / (2 * h)
    local = np.einsum("tji,tj->ti", rod.rotation("rod.end")[1:-1], slope)
    error = h**2 / 6 * np.linalg.norm(SPIN) ** 3
    np.testing.assert_allclose(local, rod.velocity("rod.end")[1:-1, :3], atol=1.01 * error)
    np.testing.assert_array_equal(rod.velocity("rod.end")[:, 3:], np.tile(SPIN, (21, 1)))


def test_joint_forces_are_the_joints_own(rod):
    np.testing.assert_array_equal(rod.joint_force("weld"), rod.joint_forces[:, 1])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: r.position("rod.tip"), "no point 'rod.tip'; there are: rod.end, rod.start, tip"),
        (lambda r: r.position(6), r"nodes are 0 … 5, got 6"),
        (lambda r: r.position(fl.ground()), "ground does not move"),
        (
            lambda r: r.position(fl.RigidBody(1, [1, 1, 1], name="top").point("centre")),
            "no body 'top'.*'rod'",
        ),
        (lambda r: r.displacements("top"), "no body 'top'; there are: 'rod', 'tip'"),
        (lambda r: r.joint_force("motor"), "no joint 'motor'; there are: 'hinge', 'weld'"),
        (lambda r: replace(r, elastic=r.elastic[1:]), r"elastic must have shape \(21,\), got"),
        (lambda r: replace(r, velocities=r.velocities[:, 1:]), r"velocities must .*\(21, 6, 6\)"),
        (lambda r: r.plot(), "at least one point"),
        (lambda r: r.picture("rod.jpg"), r"must end in '\.png', got 'rod\.jpg'"),
        (lambda r: r.animate("rod.mp4"), r"must end in '\.gif'"),
        (lambda r: r.animate("rod.gif", seconds=0), "seconds must be positive, got 0"),
        (lambda r: r.write_vtk("rod.vtk"), r"must end in '\.pvd'"),
    ],
)
def test_bad_requests_are_named(rod, call, message):
    with pytest.raises(ValueError, match=message):
        call(rod)


# --- invariants ----------------------------------------------------------------------------------


def test_energy_error_without_loads_is_relative_to_the_initial_energy(rod):
    # 3e-9 of 3; energies are sums of numbers of order 1
    assert rod.energy_error == pytest.approx(1e-9, abs=1e-15)


def test_energy_error_does_not_depend_on_the_zero_of_the_potential(rod):
    loaded = replace(
        rod, kinetic=rod.times**2, elastic=0 * rod.times, potential=-1.01 * rod.times**2
    )
    assert loaded.energy_error == pytest.approx(0.01 / 1.01)
    shifted = replace(loaded, potential=loaded.potential + 1e6)
    assert shifted.energy_error == pytest.approx(loaded.energy_error, rel=1e-7)


def test_work_and_loss_are_no_error(rod):
    balance = np.column_stack([rod.times, 0.5 * rod.times, 0.25 * rod.times])
    driven = replace(rod, kinetic=rod.kinetic + 0.25 * rod.times, balance=balance)
    # of 3.25 in the end
    assert driven.energy_error == pytest.approx((0.25 - 3e-9) / 3.25)
    assert driven.balance_error == pytest.approx(3e-9 / 3.25, rel=1e-6)


def test_momentum_errors_are_of_the_vector_over_the_momentum_in_play(rod):
    assert rod.momentum_error == pytest.approx(5.0 / 10.0)
    # of what parts of the mass 2.5 may exchange, √(2 m T) times the reach, if that is more than 5
    middle = rod.frames[:, :, 0] - rod.frames[:, :, 0].mean(axis=1, keepdims=True)
    exchanged = np.sqrt(5.0 * rod.kinetic.max()) * np.linalg.norm(middle, axis=2).max()
    error = 5e-9 / max(5.0, exchanged)
    assert rod.angular_momentum_error == pytest.approx(error, rel=1e-6)
    still = replace(rod, momentum=1e-12 * rod.momentum)
    assert still.momentum_error == pytest.approx(5e-12 / np.sqrt(5.0 * rod.kinetic.max()))
    at_rest = replace(rod, kinetic=0 * rod.times, elastic=0 * rod.times)
    assert at_rest.energy_error == 0.0


def test_impulses_are_no_error(rod):
    impulses = np.zeros((len(rod.times), 2, 6))
    impulses[:, 0, :3] = np.outer(3 * rod.times, [0, 3.0, 4.0])
    impulses[:, 1, :3] = np.outer(-2 * rod.times, [0, 3.0, 4.0])
    pushed = replace(rod, impulses=impulses)
    assert pushed.momentum_error <= 1e-15
    held = replace(rod, impulses=impulses[:, :, ::-1])
    # the largest that is turned over is now the momentum itself
    assert held.momentum_error == pytest.approx(0.5)


# --- files ---------------------------------------------------------------------------------------


def _same(a, b):
    for name, value in vars(a).items():
        other = getattr(b, name)
        if isinstance(value, np.ndarray):
            np.testing.assert_array_equal(value, other)
            assert value.dtype == other.dtype
        elif name not in ("info", "bodies", "joints"):
            assert value == other and type(value) is type(other), name


def test_a_saved_result_comes_back_bit_by_bit(rod, tmp_path):
    rod.save(tmp_path / "rod.h5")
    back = fl.Result.load(tmp_path / "rod.h5")
    _same(rod, back)
    for mine, theirs in zip(
        (*rod.info.bodies, *rod.info.joints), (*back.info.bodies, *back.info.joints), strict=True
    ):
        _same(mine, theirs)
    np.testing.assert_array_equal(back.position("rod.end"), rod.position("rod.end"))
    assert [p.name for p in tmp_path.iterdir()] == ["rod.h5"]


def test_a_result_without_joints_and_points_comes_back(rod, tmp_path):
    bodies = tuple(replace(body, points={}) for body in rod.info.bodies)
    bare = replace(rod.info, bodies=bodies, joints=())
    none = {
        "joint_forces": np.empty((21, 0, 6)),
        "joint_coordinates": np.empty((21, 0)),
        "joint_violations": np.empty((21, 0)),
    }
    replace(rod, info=bare, **none).save(tmp_path / "rod.h5")
    back = fl.Result.load(tmp_path / "rod.h5")
    assert back.info.joints == () and back.info.bodies[0].points == {}
    assert back.joint_forces.shape == (21, 0, 6)


def test_a_failed_save_leaves_the_old_file(rod, tmp_path):
    rod.save(tmp_path / "rod.h5")
    broken = replace(rod.info, bodies=(replace(rod.info.bodies[0], outline=object()),))
    with pytest.raises(TypeError):
        replace(rod, info=broken, seconds=9.0).save(tmp_path / "rod.h5")
    assert fl.Result.load(tmp_path / "rod.h5").seconds == 0.25
    assert [p.name for p in tmp_path.iterdir()] == ["rod.h5"]


def test_other_files_are_refused(rod, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no file of results .*none\.h5"):
        fl.Result.load(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("energy 1.0")
    with pytest.raises(ValueError, match=r"text\.h5' is not a file of results \(not HDF5\)"):
        fl.Result.load(tmp_path / "text.h5")
    rod.save(tmp_path / "old.h5")
    with h5py.File(tmp_path / "old.h5", "a") as file:
        file.attrs["version"] = 0
    with pytest.raises(
        ValueError, match=r"of versions 10 to 12: format 'fem_lie results', version 0"
    ):
        fl.Result.load(tmp_path / "old.h5")
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["x"] = 1.0
    with pytest.raises(ValueError, match="format None"):
        fl.Result.load(tmp_path / "foreign.h5")
    rod.save(tmp_path / "cut.h5")
    with open(tmp_path / "cut.h5", "r+b") as file:
        file.truncate(3000)
    with pytest.raises(ValueError, match=r"cut\.h5' is damaged"):
        fl.Result.load(tmp_path / "cut.h5")


def test_the_series_for_paraview_has_times_cells_and_global_vectors(rod, tmp_path):
    rod.write_vtk(tmp_path / "out" / "rod.pvd")
    series = pyvista.get_reader(str(tmp_path / "out" / "rod.pvd"))
    np.testing.assert_allclose(series.time_values, rod.times)
    series.set_active_time_value(rod.times[7])
    data = series.read()[0]
    np.testing.assert_allclose(data.points, rod.frames[7, :, 0], atol=1e-7)  # VTK keeps floats
    assert list(data.celltypes) == [1, *[3] * (NODES - 1)]  # a vertex, then lines
    np.testing.assert_array_equal(data.cell_data["body"], [1, 0, 0, 0, 0])
    np.testing.assert_allclose(data.point_data["e1"], rod.frames[7, :, 1])
    moved = rod.frames[7, :, 0] - rod.frames[0, :, 0]
    np.testing.assert_allclose(data.point_data["displacement"], moved)
    np.testing.assert_allclose(
        data.point_data["velocity"],
        np.cross(data.point_data["angular velocity"], rod.frames[7, :, 0]),
        atol=1e-14,
    )


# --- diagrams ------------------------------------------------------------------------------------


def test_diagrams_show_the_data_with_units(rod, tmp_path):
    figure = rod.plot_energies(tmp_path / "energies.png")
    above, below = figure.axes
    lines = {line.get_label(): line.get_ydata() for line in above.lines}
    assert set(lines) == {"kinetic", "elastic", "total"}, "no potential: no line"
    np.testing.assert_array_equal(lines["total"], rod.total_energy)
    assert below.get_xlabel() == "time [s]" and above.get_ylabel() == "energy [J]"
    assert (tmp_path / "energies.png").stat().st_size > 10_000

    figure = rod.plot("rod.end", 0, units=fl.post.Units(length="mm", time="ms"))
    assert [ax.get_ylabel() for ax in figure.axes] == ["rod.end [mm]", "node 0 [mm]"]
    np.testing.assert_array_equal(
        np.array([line.get_ydata() for line in figure.axes[0].lines]).T, rod.position("rod.end")
    )
    assert len(rod.plot_momentum().axes) == 2


def test_forces_and_displacements_are_drawn_along_global_axes(tmp_path):
    """A rod that hangs on a hinge: known forces, in motion and in statics."""
    scene = fl.Scene(gravity=(0, 0, -10.0))
    rod = scene.add(fl.RigidBody.cylinder(2.5, 0.01, (0, 0, 0), (0, 0, -1), name="rod"))
    hinge = fl.joints.Revolute(fl.ground(), rod.point((0, 0, 0)), axis=(0, 1, 0), name="hinge")
    scene.add(hinge)
    end = rod.point((0, 0, -1))
    clamp = scene.add(fl.Clamp(scene.add(fl.RigidBody.ball(1.0, 0.1)).point("centre")))
    for result in (
        fl.statics(scene),
        fl.GeneralisedAlpha().run(scene, duration=0.01, step=0.005, progress=False),
    ):
        figure = result.plot(hinge, "hinge", quantity="joint_force")
        assert len(figure.axes) == 4, "force and moment of each"
        up = figure.axes[0].lines[2].get_ydata()
        np.testing.assert_allclose(np.abs(up), 25.0, rtol=1e-9)
        assert figure.axes[1].get_ylabel() == "hinge [N m]"
        # moments of round-off look like zero, relative to the force times the size of the scene
        assert figure.axes[1].get_ylim()[1] == pytest.approx(1e-6 * 25.0 * 0.5, rel=1e-6)
        figure = result.plot(clamp, quantity="reaction", path=tmp_path / "reaction.png")
        np.testing.assert_allclose(figure.axes[0].lines[2].get_ydata(), 10.0, rtol=1e-9)
        figure = result.plot(end, quantity="displacement")
        drawn = np.array([line.get_ydata() for line in figure.axes[0].lines]).T
        np.testing.assert_array_equal(drawn[-1], result.displacement(end)[-1])
        with pytest.raises(ValueError, match="quantity: expected one of 'position', 'displacem"):
            result.plot(end, quantity="stress")


# --- pictures ------------------------------------------------------------------------------------


@pytest.fixture
def no_display(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)


def _share(image, colour):
    """Part of an image that is darker or lighter ``colour``, by the ratios of its channels."""
    pixels = np.asarray(image.convert("RGB"), dtype=float).reshape(-1, 3)
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], dtype=float)
    strong = np.ptp(pixels, axis=1) > 60
    cosine = pixels[strong] @ rgb / np.linalg.norm(rgb) / np.linalg.norm(pixels[strong], axis=1)
    return (cosine > 0.99).sum() / len(pixels)


def test_a_picture_without_a_display_shows_all_bodies(rod, tmp_path, no_display):
    rod.picture(tmp_path / "rod.png", times=[0.0, 1.0], trace=["rod.end"], title="Rod")
    image = Image.open(tmp_path / "rod.png")
    assert image.size == (1600, 1200)
    assert image.getpixel((5, 5))[:3] == (255, 255, 255)
    # a rod of 4 % of its length, and a box: between a thousandth and a tenth of the picture each
    assert all(1e-3 < _share(image, colour) < 0.1 for colour in COLOURS[:2])
    assert _share(image, COLOURS[2]) < 1e-4, "there is no third body"
    assert "DISPLAY" not in os.environ


def test_nodal_frames_are_drawn_before_anything_moves(tmp_path, no_display):
    scene = fl.Scene()
    section = fl.Section.rectangle(0.05, 0.1, fl.Material(1.0, 0.3, 1.0))
    scene.add(fl.Beam.straight((0, 0, 0), (1, 0.5, 0.2), section, cells=4))
    for frames in (False, True):
        scene.picture(tmp_path / "scene.png", frames=frames)
        image = Image.open(tmp_path / "scene.png")
        shares = [_share(image, colour) for colour in ("#CC0000", "#008800", "#0000CC")]
        # five arrows of a 25th of the picture's length each, or nothing in these colours
        assert all(share > 1e-4 for share in shares) if frames else max(shares) < 1e-5, shares
    with pytest.raises(ValueError, match="no body"):
        fl.Scene().picture(tmp_path / "scene.png")


def test_an_animation_moves(rod, tmp_path, no_display):
    rod.animate(tmp_path / "rod.gif", images=4, seconds=2.0)
    images = []
    with Image.open(tmp_path / "rod.gif") as movie:
        assert (movie.n_frames, movie.info["duration"], movie.info["loop"]) == (4, 500, 0)
        for k in range(4):
            movie.seek(k)
            images.append(np.asarray(movie.convert("RGB")))
    for before, after in pairwise(images):
        assert (before != after).any(axis=-1).mean() > 1e-3


def test_a_missing_x_server_is_named(rod, tmp_path, no_display, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RuntimeError, match=r"DISPLAY is not set, and Xvfb.* not installed"):
        rod.picture(tmp_path / "rod.png")
    (tmp_path / "Xvfb").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "Xvfb").chmod(0o755)
    with pytest.raises(RuntimeError, match="Xvfb does not start"):
        rod.picture(tmp_path / "rod.png")

"""Small inputs that once gave a wrong answer in silence, and the tests that have the right one.

Each entry of ``HELD`` names a fault and the tests that hold what is right; those that no other file
has are here.
"""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl

TESTS = Path(__file__).parent
STEEL = fl.Material(2.1e11, 0.3, 7800.0)

HELD = {
    "no warning is shown of a column at twice Euler's load": [
        "test_visible_warnings.py::test_a_plain_script_shows_the_warning",
    ],
    "buckling factor times load depends on the load": [
        "test_linear_buckling.py::test_factor_times_load_does_not_depend_on_the_load",
    ],
    "a beam end rotated by 80° or more is taken for one rotated the other way": [
        "test_large_rotations.py::test_a_shaft_is_twisted_by_the_prescribed_angle",
        "test_large_rotations.py::test_free_bodies_rotate_as_prescribed",
    ],
    "the whirl of a shaft depends on its mesh and grows": [
        "test_rotors.py::test_whirl_is_that_of_the_continuous_shaft",
        "test_mended_faults.py::test_whirl_of_an_overhung_disc_is_the_same_on_all_meshes",
    ],
    "a torsion spring with a rest angle beyond π loses whole turns": [
        "test_large_rotations.py::test_a_preload_of_whole_turns_on_an_elastic_shaft",
    ],
    "a lever on a torsion spring that turns by 4 rad ends in a division by zero": [
        "test_large_rotations.py::test_a_lever_on_a_torsion_spring",
    ],
    "Beck's column buckles, and its path has critical points": [
        "test_linear_buckling.py::test_loads_without_a_potential_are_refused",
        "test_vibrations.py::test_becks_column",
        "test_mended_faults.py::test_the_path_of_becks_column_has_no_critical_point",
    ],
    "a tensioned wire is unstable, too soft and too slow": [
        "test_coarse_beams.py::test_tensioned_wire_deflects_and_vibrates_as_its_closed_form",
        "test_coarse_beams.py::test_no_tension_makes_elements_unstable",
    ],
    "bodies pass through each other within a step": [
        "test_unresolved_contact.py::test_balls_that_jump_over_each_other_fail_the_step",
        "test_mended_faults.py::test_balls_with_impacts_do_not_pass_through_each_other",
    ],
    "a resting cable makes the steps of a pendulum ten times dearer": [
        "test_conserving_mixed.py::test_frames_move_beside_positions_as_among_themselves",
        "test_conserving_mixed.py::test_a_resting_cable_costs_no_iterations",
    ],
    "a torn joint is refused in one unit of length and taken in another": [
        "test_transfer.py::test_a_torn_joint_is_refused_in_all_units",
    ],
    "a continuous field is condensed cell by cell": [
        "test_kernel.py::test_local_fields_are_refused_if_cells_share_them",
    ],
    "chords of a heavy bar are stretched by 42 % in silence": [
        "test_coarse_beams.py::test_heavy_bar_keeps_its_length",
        "test_coarse_beams.py::test_heavy_bar_of_four_elements_is_named_as_coarse",
        "test_mended_faults.py::test_a_hanging_bar_is_right_or_named_as_coarse",
    ],
    "fibres pinned where they cross take minutes, by a solver for chains": [
        "test_choice.py::test_structure_decides_and_not_who_asks",
        "test_choice.py::test_width_separates_chains_from_meshes",
    ],
    "a chain of a hundred links does not arrive": [
        "test_hard_cases.py::test_a_long_chain_arrives",
    ],
    "residual bending flexibility softens beams in tension": [
        "test_coarse_beams.py::test_no_tension_makes_elements_unstable",
        "test_coarse_beams.py::test_pulled_column_does_not_buckle_by_its_mesh",
    ],
    "a stiff solid of Neo-Hooke's law ends in the first conserving step": [
        "test_stiff_solids.py::test_stiff_solids_move_as_saint_venants",
    ],
    "an ANCF shell of a millimetre takes two hundred times the iterations of one of a metre": [
        "test_bodies_in_units.py::test_all_bodies_move_alike_by_all_schemes",
        "test_mended_faults.py::test_a_hanging_ancf_shell_takes_the_same_iterations_in_all_sizes",
    ],
    "a file named .msh runs a shell command when it is read": [
        "test_gmsh_files.py::test_no_reader_runs_a_script",
        "test_gmsh_files.py::test_a_script_after_the_beginning_of_a_mesh_does_not_run",
    ],
    "schemes fail with bodies, joints and loads in combinations that nobody tried": [
        "test_what_works.py::test_bodies",
        "test_what_works.py::test_joints",
        "test_what_works.py::test_loads",
        "test_random_scenes.py::",
    ],
}


@pytest.mark.parametrize("fault", HELD)
def test_what_is_right_is_held_by_a_test(fault):
    for name in HELD[fault]:
        file, _, function = name.partition("::")
        text = (TESTS / file).read_text("utf-8")
        assert re.search(rf"^def test_{function.removeprefix('test_')}", text, re.MULTILINE), name


@pytest.mark.parametrize("cells", [4, 16, 64])
def test_whirl_of_an_overhung_disc_is_the_same_on_all_meshes(cells):
    """A steel shaft of 20 mm and 0.4 m at 100 rad/s: 23.51 rad/s in the rotating frame."""
    shaft = fl.Beam.straight((0, 0, 0), (0.4, 0, 0), fl.Section.circle(0.01, STEEL), cells=cells)
    disc = fl.RigidBody(5.0, (0.04, 0.02, 0.02), position=(0.4, 0, 0))
    scene = fl.Scene()
    for item in (shaft, disc, fl.Clamp(shaft.point("start"))):
        scene.add(item)
    scene.add(fl.joints.RigidLink(shaft.point("end"), disc.point("centre")))
    modes = fl.vibrations(scene, 4, spin=(100.0, 0, 0))
    np.testing.assert_allclose(modes.frequencies[:3], [23.51, 213.07, 281.54], atol=0.02)
    assert np.abs(modes.eigenvalues.real).max() < 1e-6 and modes.residuals.max() < 1e-9


def test_the_path_of_becks_column_has_no_critical_point():
    """A following force of 30 EI/L²: no divergence at any load."""
    section = fl.Section.rectangle(0.01, 0.02, STEEL)
    bending = min(section.stiffness[4, 4], section.stiffness[5, 5])
    column = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=16, up=(0, 0, 1))
    scene = fl.Scene()
    scene.add(column)
    scene.add(fl.Clamp(column.point("start")))
    scene.add(fl.PointLoad(column.point("end"), (-bending, 0, 0), following=True))
    path = fl.follow_path(scene, 30.0)
    assert path.complete and path.critical == ()


def test_balls_with_impacts_do_not_pass_through_each_other():
    """A ball of 1 cm meets another at 100 m/s; a step is ten times their size."""
    one = fl.RigidBody(1.0, (1e-4,) * 3, position=(-0.25, 0, 0))
    two = fl.RigidBody(1.0, (1e-4,) * 3)
    one.add_velocity((100.0, 0, 0))
    scene = fl.Scene()
    spheres = [fl.contact.Sphere(scene.add(body).point("centre"), 0.01) for body in (one, two)]
    scene.add(fl.contact.Contact(*spheres, fl.contact.Impact(restitution=1.0)))
    with pytest.raises(fl.ConvergenceError, match="one side passed through the other"):
        fl.GeneralisedAlpha().run(scene, duration=5e-3, step=1e-3)
    slow = fl.GeneralisedAlpha().run(scene, duration=5e-3, step=1e-5)
    np.testing.assert_allclose(slow.velocities[-1, :, 0], [0.0, 100.0], atol=1e-9)


@pytest.mark.parametrize(
    ("length", "tip"),
    [(10.0, (6.284, -7.216)), (20.0, (3.449, -18.655)), (30.0, (2.611, -28.941))],
)
@pytest.mark.parametrize("cells", [2, 4])
def test_a_hanging_bar_is_right_or_named_as_coarse(length, tip, cells):
    """A clamped bar of 2 cm sags by its weight: 2 % of its length, or a warning."""
    section = fl.Section.rectangle(0.02, 0.02, STEEL)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    bar = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=cells))
    scene.add(fl.Clamp(bar.point("start")))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = fl.statics(scene).position(bar.point("end"))[-1, [0, 2]]
    named = any(issubclass(each.category, fl.schemes.CoarseElementsWarning) for each in caught)
    assert named or np.linalg.norm(found - tip) <= 0.02 * length


@pytest.mark.parametrize("size", [1e-1, 1e-3])
def test_a_hanging_ancf_shell_takes_the_same_iterations_in_all_sizes(size):
    """All numbers scaled, so that strains are the same."""

    def iterations(length: float) -> int:
        Q = fl.lie.so3_exp(np.array([0.3, -0.5, 0.4]))
        patch = fl.mesh.smooth_patch(
            lambda a, b: length * Q @ [a, 0.4 * (b - 0.5), 0.05 * a * np.sin(1.5 * a)], (2, 2)
        )
        section = fl.ShellSection.layer(0.03 * length, fl.Material(4e7, 0.3, 1e3))
        scene = fl.Scene(gravity=(0, 0, -3.0 / length))
        shell = scene.add(fl.AncfShell(patch, section))
        corner = shell.points("a=0")[1]
        scene.add(fl.joints.Spherical(fl.ground(), corner, at=corner.position))
        step = 4e-3 * length
        result = fl.EnergyMomentum().run(scene, duration=8 * step, step=step)
        assert result.divided == 0
        return result.total_iterations

    assert abs(iterations(size) - iterations(1.0)) <= 6

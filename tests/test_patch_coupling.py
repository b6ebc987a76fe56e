"""Thin shells of patches that are sewn together."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import patch_coupling
from demos import hemisphere

LAYER = fl.ShellSection.layer(0.1, fl.Material(1e3, 0.3, 2.0))


def test_hemisphere_of_four_patches():
    """As good as one; without its couplings it would not stand."""
    errors, solutions = patch_coupling.pinched(patch_coupling.quarters(hemisphere.position, 8))
    assert np.abs(errors).max() < 0.01 and solutions <= 14


def test_roof_of_two_patches_with_other_numbers_of_cells():
    errors, _ = patch_coupling.roof(patch_coupling.halves(patch_coupling.vault, (4, 8), (4, 6)))
    assert np.abs(errors).max() < 0.01


def patch(function) -> fl.mesh.SmoothPatch:
    return fl.mesh.smooth_patch(function, (2, 2))


LEFT = patch(lambda a, b: (a, b, 0))


def sewn(right, **options) -> fl.ThinShell:
    coupling = fl.mesh.PatchCoupling("left.a=1", options.pop("edge", "right.a=0"), **options)
    return fl.ThinShell({"left": LEFT, "right": right}, LAYER, couplings=[coupling])


def uneven(a, b):
    return 1 + a, 0.5 * (b + b**2), 0


def test_a_sewn_plate_is_unstressed_as_it_lies_and_moves_rigidly():
    """Six motions without stiffness, as of one piece."""
    scene = fl.Scene()
    scene.add(sewn(patch(uneven)))
    frequencies = fl.vibrations(scene, 8).frequencies
    assert (frequencies[:6] < 1e-4 * frequencies[6]).all()


def test_parameters_that_agree_need_no_coupling_and_get_none():
    """Points with the same slopes are one."""
    shell = sewn(patch(lambda a, b: (1 + a, b, 0)))
    assert shell.model.points_count == 15


def test_without_a_coupling_it_is_refused():
    with pytest.raises(ValueError, match="Seam"):
        fl.ThinShell({"left": LEFT, "right": patch(uneven)}, LAYER)


REFUSED = {
    "box": (lambda: sewn(patch(lambda a, b: (1, b * (1 + b) / 2, a))), "kink of 90"),
    "apart": (lambda: sewn(patch(lambda a, b: (1.5 + a, b * (1 + b) / 2, 0))), "from each other"),
    "other side": (
        lambda: sewn(patch(lambda a, b: (1 + a, 1 - b * (1 + b) / 2, 0))),
        "kink of 180",
    ),
    "no edge": (lambda: sewn(patch(uneven), edge="right.c=0"), "no edge 'right.c=0'"),
    "stiffness": (lambda: fl.mesh.PatchCoupling("a=0", "a=1", 0.0), "positive"),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED.keys())
def test_refused(case):
    make, message = case
    with pytest.raises(ValueError, match=message):
        make()

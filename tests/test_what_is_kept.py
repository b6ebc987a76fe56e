"""What is recorded, and where it goes, changes no bit of a motion."""

from functools import cache

import numpy as np
import pytest

import fem_lie as fl
from tests.test_bodies_in_units import BODIES, STEPS, TAKES
from tests.unit_systems import METRES

KEPT = {
    "few states": {"save_every": 7},
    "frames alone": {"record": fl.schemes.Record.FRAMES},
    "few frames": {"save_every": 10, "record": fl.schemes.Record.FRAMES},
    "progress": {"progress": True},
}


def scene_of(scheme: str, name: str, held: bool) -> tuple[fl.Scene, float]:
    scene, step = fl.Scene(gravity=(0, 0, -9.81)), STEPS.get(scheme, 2e-3)
    body = scene.add(BODIES[name](METRES))
    if held:
        body.clamp("a=0")
    else:
        body.add_velocity(omega=(1.0, 2.0, 3.0), about=(0.5, 0.1, 0))
    return scene, step


def end(scheme: str, name: str, held: bool, **kept: object) -> np.ndarray:
    scene, step = scene_of(scheme, name, held)
    options = {"progress": False} | kept
    result = TAKES[scheme][0].run(scene, duration=10 * step, step=step, **options)
    return result.frames[-1]


whole = cache(end)
SCENES = [(s, name, False) for s, (_, names) in TAKES.items() for name in sorted(names)]
SCENES += [
    (s, name, True)
    for s in ("generalised-α", "conserving", "decaying", "variational")
    for name in ("shell", "triangles")
]


@pytest.mark.parametrize(("scheme", "name", "held"), SCENES)
def test_what_is_kept_changes_no_bit(scheme, name, held, tmp_path):
    expected = whole(scheme, name, held)
    for kept in KEPT.values():
        np.testing.assert_array_equal(end(scheme, name, held, **kept), expected)
    file = {"file": tmp_path / "run.h5", "checkpoint_every": 3}
    np.testing.assert_array_equal(end(scheme, name, held, **file), expected)


# --- steps that change ---

CHANGING = {
    # that are also divided by an event, and by a load that jumps within a step
    "adaptive": lambda h: fl.schemes.AdaptiveStep(1e-2, first=h, events=(3.3 * h,)),
    "jumps": lambda h: h,
}
CHANGED = [
    *(("generalised-α", name) for name in ("shell", "triangles", "beam of gradients", "hexahedra")),
    *((scheme, name) for scheme in ("conserving", "decaying") for name in ("rod", "shell")),
]


def changed(scheme: str, name: str, choice: str, **kept: object) -> fl.Result:
    """Over ten steps, with a load that jumps twice, once within a step."""
    scene, h = scene_of(scheme, name, False)
    (body,) = scene.bodies
    history = fl.loads.PiecewiseLinear((0, 2.4 * h, 2.4 * h, 6 * h, 6 * h), (1, 1, -2, -2, 3))
    scene.add(fl.PointLoad(body.point(1), force=(3.0, 5.0, 20.0), history=history))
    options = {"progress": False} | kept
    return TAKES[scheme][0].run(scene, duration=10 * h, step=CHANGING[choice](h), **options)


@pytest.mark.parametrize("choice", CHANGING)
@pytest.mark.parametrize(("scheme", "name"), CHANGED)
def test_nor_where_steps_change_or_loads_jump(scheme, name, choice, tmp_path):
    """Nor the steps: as many, of the same size."""
    expected = changed(scheme, name, choice)
    ways = [*KEPT.values(), {"save_at": 3e-3}]
    if expected.steps is None:
        # steps that adapt go to no file as they are made
        ways.append({"file": tmp_path / "run.h5", "checkpoint_every": 3})
    for kept in ways:
        found = changed(scheme, name, choice, **kept)
        assert found.times[-1] == expected.times[-1]
        np.testing.assert_array_equal(found.frames[-1], expected.frames[-1])
        if expected.steps is not None:
            np.testing.assert_array_equal(found.steps.times, expected.steps.times)

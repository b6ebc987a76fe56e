"""What is recorded, and where it goes, changes no bit of a motion."""

from functools import cache

import numpy as np
import pytest

import fem_lie as fl
from tests.test_bodies_in_units import BODIES, STEPS, TAKES
from tests.unit_systems import METRES

KEPT = {
    "few states": {"save_every": 7},
    "frames alone": {"record": fl.Record.FRAMES},
    "few frames": {"save_every": 10, "record": fl.Record.FRAMES},
    "progress": {"progress": True},
}


def scene_of(scheme: str, name: str, held: bool) -> tuple[fl.Scene, float]:
    scene, step = fl.Scene(gravity=(0, 0, -9.81)), STEPS.get(scheme, 2e-3)
    body = scene.add(BODIES[name](METRES))
    if held:
        body.clamp("a=0")
    else:
        body.turn((1.0, 2.0, 3.0), about=(0.5, 0.1, 0))
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

"""Warnings of this package are seen by a plain script, whatever it imports first."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

UNSTABLE = """
material = fl.Material(2e11, 0.3, 7850.0)
beam = fl.Beam.straight((0, 0, 0), (0, 0, 1), fl.Section.circle(0.01, material), cells=4)
scene = fl.Scene()
scene.add(beam)
scene.add(fl.Clamp(beam.point("start")))
scene.add(fl.PointLoad(beam.point("end"), (0, 0, -2e4)))  # twice Euler's load
fl.statics(scene)
"""
COARSE = """
material = fl.Material(2e11, 0.3, 7850.0)
section = fl.Section.circle(0.01, material)
beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=3)
scene = fl.Scene()
scene.add(beam)
scene.add(fl.Clamp(beam.point("start")))
angle = 3 * 2.9  # 2.9 rad in each element
scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, angle * section.stiffness[5, 5])))
fl.statics(scene, load_steps=6)
"""
SCENES = {"UnstableEquilibriumWarning": UNSTABLE, "CoarseElementsWarning": COARSE}

CAPTURED = "import logging\nlogging.captureWarnings(True)\n"
TO_A_HANDLER = 'logging.basicConfig(format="log of the user: %(message)s")\n'


def stderr_of(script):
    """What a script writes to stderr."""
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stderr


@pytest.mark.parametrize("first", ["", "import dolfinx\n"], ids=["fem_lie first", "dolfinx first"])
@pytest.mark.parametrize("name", SCENES)
def test_a_plain_script_shows_the_warning(name, first):
    assert f"{name}: " in stderr_of(f"{first}import fem_lie as fl\n{SCENES[name]}")


@pytest.mark.parametrize(
    "start",
    [
        f"{CAPTURED}import fem_lie as fl\n{TO_A_HANDLER}",
        f"import dolfinx\n{CAPTURED}{TO_A_HANDLER}import fem_lie as fl\n",
        f"import fem_lie as fl\n{CAPTURED}{TO_A_HANDLER}",
    ],
    ids=["before all imports", "after dolfinx", "after fem_lie"],
)
def test_a_capture_of_the_user_is_kept(start):
    logged = stderr_of(f"{start}{UNSTABLE}")
    assert "log of the user: " in logged
    assert "UnstableEquilibriumWarning: " in logged.partition("log of the user: ")[2]

"""Every demo against its reference, by its record of numbers; times are nobody's business here."""

import importlib
import json
import re
import subprocess
import sys
from math import isfinite
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]


def main(demo: str, **parameters):
    return importlib.import_module(f"demos.{demo}").main(pictures=False, **parameters)


def tip(record) -> np.ndarray:
    return np.array([record[f"tip_{axis}"] for axis in "xyz"])


@pytest.mark.parametrize(("elements", "bound"), [(4, 1e-3), (8, 2e-4), (16, 5e-5)])
def test_bend45(elements, bound):
    record = main("bend45", elements=elements, load_steps=3)
    reference = np.array([47.1504, 15.6848, 53.4749])
    assert np.linalg.norm(tip(record) - reference) <= bound * np.linalg.norm(reference)
    assert record["tip_error"] <= bound
    assert record["iterations"] <= 20


@pytest.mark.parametrize("stiffness_ratio", [1e4, 1e8])
def test_rollup(stiffness_ratio):
    record = main("rollup", stiffness_ratio=stiffness_ratio, plain_newton=True)
    assert record["tip_error"] <= 1e-9
    assert np.linalg.norm(tip(record)) / 10.0 <= 1e-9
    assert record["iterations_per_step"] <= 4.5
    # plain Newton fails with these steps, and needs smaller ones if it arrives at all
    assert not record["plain_converged"] or record["plain_failed_iterations"] > 0


def test_own_energy():
    record = main("own_energy")
    assert record["gradient_error"] <= 1e-7
    assert record["tangent_error"] <= 1e-6
    assert record["invariance_error"] <= 1e-10
    assert record["tip_error"] <= 1e-4
    assert record["order"] > 3.8, record["order"]
    assert record["iterations_per_step"] <= 6
    assert not record["plain_converged"]


def test_double_pendulum():
    record = main("double_pendulum", case=1)
    # consistent mass; the reference is not refined in space
    assert np.linalg.norm(tip(record) - [-0.25256, -0.71726, 0.22333]) <= 1e-4
    assert record["steps"] == 10000
    assert record["iterations_per_step"] <= 3.0
    assert record["factorisations"] <= 100
    assert record["energy_error"] <= 1e-6
    assert record["angular_momentum_error"] <= 1e-6
    assert record["joint_gap"] <= 1e-9


@pytest.mark.parametrize(("case", "duration"), [(2, 0.05), (3, 0.2)])
def test_double_pendulum_of_other_cases(case, duration):
    record = main("double_pendulum", case=case, duration=duration)
    assert record["energy_error"] <= 1e-6
    assert record["angular_momentum_error"] <= 1e-6
    assert record["joint_gap"] <= 1e-9


def test_double_pendulum_in_two_policies():
    """Where the matrix is made does not matter for what is computed."""
    kept, full = (
        main("double_pendulum", case=1, duration=0.02, policy=policy)
        for policy in ("automatic", "every")
    )
    assert kept["factorisations"] < 5 < full["factorisations"]
    np.testing.assert_allclose(tip(kept), tip(full), rtol=0, atol=1e-8)


def test_bad_options():
    with pytest.raises(ValueError, match="case must be 1, 2 or 3, got 4"):
        main("double_pendulum", case=4)
    with pytest.raises(ValueError, match=r"policy must be one of automatic, .*, got 'often'"):
        main("double_pendulum", policy="often")


def test_command_line(tmp_path):
    """Options are the parameters of ``main``; the record is a flat file of numbers."""
    file = tmp_path / "record.json"
    command = [sys.executable, "demos/rollup.py", "--elements", "4", "--load-steps", "7"]
    command += ["--stiffness-ratio", "1e5", "--no-pictures", "--json", str(file)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert "4 elements" in done.stdout
    record = json.loads(file.read_text())
    assert (record["elements"], record["load_steps"]) == (4, 7)
    assert all(isfinite(value) for value in record.values())


def test_command_line_says_what_is_wrong():
    command = [sys.executable, "demos/double_pendulum.py", "--case", "4", "--no-pictures"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "double_pendulum.py: case must be 1, 2 or 3, got 4\n"


def test_pictures(tmp_path, monkeypatch):
    bend45 = importlib.import_module("demos.bend45")
    monkeypatch.setattr(bend45, "RESULTS", tmp_path)
    bend45.main(elements=4)
    sizes = {path.name: path.stat().st_size for path in tmp_path.iterdir()}
    assert set(sizes) == {"bend45.png", "bend45_convergence.png"}
    assert min(sizes.values()) > 10_000


def test_readme_example(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    readme = (ROOT / "README.md").read_text()
    code = re.search(r"```python\n(.*?)```", readme, re.DOTALL).group(1)
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    assert np.linalg.norm(names["tip"]) <= 1e-9 * 10.0
    assert "iterations [3 3 3 3 3 3]" in capsys.readouterr().out
    assert (tmp_path / "rollup.png").stat().st_size > 10_000


def test_section_properties():
    record = main("section_properties")
    assert record["largest_error"] <= 1e-3
    assert record["channel_shear_centre"] == pytest.approx(
        record["channel_shear_centre_of_thin_walls"], rel=0.02
    )
    assert record["coupling_at_shear_centre"] <= 1e-12

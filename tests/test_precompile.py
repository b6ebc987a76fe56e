"""What is compiled beforehand is all that first results need."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.everyday_rows.first_use import SCENES, SCRIPT
from fem_lie import _precompile
from fem_lie._jit import machine_code


def python(*arguments):
    """What a process writes on stderr."""
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stderr


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_first_results_compile_nothing_afterwards(scene):
    """Neither machine code nor forms, in the caches that all tests have."""
    python("-m", "fem_lie", "--compile")
    forms = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fenics"
    before = set(forms.glob("*.so"))
    assert "compiles machine code" not in python(SCRIPT, scene)
    assert set(forms.glob("*.so")) == before


def test_that_a_scene_fails_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(machine_code, "FOLDER", tmp_path)
    monkeypatch.setattr(_precompile, "SCENES", {"unknown": lambda: None})
    with pytest.raises(RuntimeError, match=r"unknown could not be compiled:\n(.|\n)*KeyError"):
        _precompile.precompile()
    assert not list(tmp_path.iterdir())


def test_without_a_cache_there_is_nothing_to_compile_for(monkeypatch):
    monkeypatch.setattr(machine_code, "FOLDER", None)
    with pytest.raises(OSError, match="the cache folder cannot be written"):
        _precompile.precompile()


def test_it_is_done_once(tmp_path, monkeypatch):
    """Until caches are cleared or a source is changed."""
    monkeypatch.setattr(machine_code, "FOLDER", tmp_path)
    monkeypatch.setattr(_precompile, "SCENES", {})
    _precompile.precompile()
    (mark,) = tmp_path.iterdir()
    monkeypatch.setattr(_precompile, "SCENES", {"unknown": lambda: None})
    _precompile.precompile()
    _precompile.forget()
    assert not mark.exists()

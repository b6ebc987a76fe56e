"""What is compiled beforehand is all that first results need."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.everyday_rows.first_use import SCENES, SCRIPT
from fem_lie import _precompile
from fem_lie._jit import machine_code


def python(*arguments, **environment):
    """What a process writes on stderr."""
    command, env = [sys.executable, *map(str, arguments)], os.environ | environment
    return subprocess.run(command, capture_output=True, text=True, check=True, env=env).stderr


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_first_results_compile_nothing_afterwards(tmp_path, scene):
    """Neither machine code nor forms, in the caches that all tests have.

    Forms that other processes compile meanwhile go to those caches, and not to links to them.
    """
    python("-m", "fem_lie", "--compile")
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    forms = tmp_path / "fenics"
    forms.mkdir()
    for file in (cache / "fenics").iterdir():
        (forms / file.name).symlink_to(file)
    (tmp_path / "fem_lie").symlink_to(cache / "fem_lie")
    before = set(forms.glob("*.so"))
    assert "compiles machine code" not in python(SCRIPT, scene, XDG_CACHE_HOME=str(tmp_path))
    assert before
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

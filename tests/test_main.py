"""``python -m fem_lie``."""

import os
import subprocess
import sys

import dolfinx
import pytest

from fem_lie import __main__ as program
from fem_lie import _blas


def test_versions_solvers_and_caches():
    done = subprocess.run(
        [sys.executable, "-m", "fem_lie"], capture_output=True, text=True, check=True
    )
    assert f"DOLFINx       {dolfinx.__version__}" in done.stdout
    assert "mumps" in done.stdout
    assert f"BLAS          {_blas.find()}" in done.stdout
    for folder in program.caches().values():
        assert str(folder) in done.stdout


def test_caches_are_cleared_when_asked_for(tmp_path, monkeypatch, capsys):
    """One cache only, whose size is reported."""
    kept = tmp_path / "kept"
    gone = tmp_path / "gone"
    for folder in (kept, gone):
        (folder / "deeper").mkdir(parents=True)
        (folder / "deeper" / "file").write_bytes(bytes(2_000_000))
    monkeypatch.setattr(program, "caches", lambda: {"forms": kept, "machine-code": gone})
    program.main(["--clear", "machine-code"])
    assert not gone.exists() and (kept / "deeper" / "file").exists()
    assert capsys.readouterr().out == f"removed {gone}: 1 files, 2.0 MB\n"
    program.main(["--clear", "all"])
    assert not kept.exists()


def test_an_unknown_cache(capsys):
    with pytest.raises(SystemExit):
        program.main(["--clear", "everything"])
    assert "machine-code" in capsys.readouterr().err


def test_code_is_made_anew_after_clearing(tmp_path):
    """In a cache folder of its own: a start, a clearing, a start."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    script = "import numpy as np; from fem_lie import lie; print(lie.so3_exp(np.zeros(3))[0, 0])"

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *arguments],
            capture_output=True,
            text=True,
            check=True,
            env=environment,
        ).stdout

    assert run("-c", script).strip() == "1.0"
    assert "removed" in run("-m", "fem_lie", "--clear", "all")
    assert run("-c", script).strip() == "1.0"

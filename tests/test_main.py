"""``python -m fem_lie``: versions, BLAS, caches, and what is compiled beforehand."""

import os
import subprocess
import sys
from pathlib import Path

import dolfinx
import pytest

from benchmarks.everyday_rows.first_use import SCENES, SCRIPT
from fem_lie import __main__ as program
from fem_lie import _blas, _precompile
from fem_lie._jit import machine_code


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


DGEMM = "void dgemm_(void) {}\n"
USER = "void dgemm_(void);\nvoid factorise(void) { dgemm_(); }\n"
LIBRARIES = {
    "reference": ("libblas.so.3.12", "", ("reference BLAS", True)),
    "OpenBLAS": (
        "libblas.so.3",
        'const char *openblas_get_config(void) { return "OpenBLAS 0.3.29 Zen "; }\n',
        ("OpenBLAS 0.3.29 Zen", False),
    ),
    "BLIS": (
        "libblas.so.4",
        'const char *bli_info_get_version_str(void) { return "1.1"; }\n',
        ("BLIS 1.1", False),
    ),
    "MKL": ("libmkl_rt.so.2", "void MKL_Get_Version(void) {}\n", ("Intel MKL", False)),
    "other": ("libfast.so", "", ("unknown BLAS", False)),
}


def build(path, source, *libraries):
    """A shared library of a line of C."""
    code = path.with_suffix(".c")
    code.write_text(source)
    command = ["gcc", "-shared", "-fPIC", "-o", path, code, *libraries]
    subprocess.run(command, check=True)
    return path


@pytest.mark.parametrize("kind", LIBRARIES)
def test_a_library_is_recognised_by_what_it_exports(kind, tmp_path):
    """Of what links to it, through a symbolic link as distributions' alternatives are."""
    name, extra, expected = LIBRARIES[kind]
    library = build(tmp_path / name, DGEMM + extra)
    link = tmp_path / "alternative.so"
    link.symlink_to(library)
    user = build(tmp_path / "libuser.so", USER, link, f"-Wl,-rpath,{tmp_path}")
    found = _blas.find(user)
    assert (found.name, found.is_reference) == expected
    assert found.path == library


def test_the_script_warns_of_the_reference_implementation():
    """As the dynamic linker finds it, here by LD_LIBRARY_PATH."""
    folders = list(Path("/usr/lib").glob("*/blas"))
    if not folders:
        pytest.skip("this system keeps no reference BLAS beside the optimised one")
    script = [sys.executable, _blas.__file__]

    def run(**environment):
        environment = os.environ | environment
        done = subprocess.run(script, env=environment, capture_output=True, text=True, check=True)
        return done.stdout

    slow = run(LD_LIBRARY_PATH=str(folders[0]))
    assert slow.startswith(f"warning: reference BLAS, {folders[0]}") and _blas.ADVICE in slow
    found = _blas.find()
    assert run() == (
        f"warning: {found}; {_blas.ADVICE}\n" if found.is_reference else f"BLAS: {found}\n"
    )


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

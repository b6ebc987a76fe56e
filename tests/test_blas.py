"""Which BLAS runs is reported, and whether it is the slow reference implementation."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fem_lie import _blas

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

"""Several processes that compile the same forms, and what a process leaves that was killed."""

import fcntl
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

FORM = """
import sys
from mpi4py import MPI
import numpy as np
import ufl
from dolfinx import fem, mesh
from fem_lie._form_cache import compile_form

domain = mesh.create_interval(MPI.COMM_SELF, 3, [0.0, 1.0])
v = ufl.TestFunction(fem.functionspace(domain, ("P", 1)))
print(fem.assemble_vector(compile_form(2.0 * v * ufl.dx)).array.sum())
"""


def start(caches, **environment):
    """A process that compiles a form into a cache folder, and prints its sum, 2."""
    return subprocess.Popen(
        [sys.executable, "-c", FORM],
        env=os.environ | {"XDG_CACHE_HOME": str(caches)} | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def answer(process):
    """What a process printed."""
    out, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    return float(out)


def slow_compiler(folder, seconds):
    """A C compiler that takes a while before it begins."""
    compiler = folder / "slow-cc"
    compiler.write_text(f'#!/bin/sh\nsleep {seconds}\nexec gcc "$@"\n')
    compiler.chmod(0o755)
    return str(compiler)


def test_processes_wait_for_one_that_compiles_longer_than_ffcx_waits(tmp_path):
    """FFCx gives up after ten seconds; the compiler is called twice, to compile and to link."""
    compiler = slow_compiler(tmp_path, 7)
    both = [start(tmp_path, CC=compiler) for _ in range(2)]
    assert [answer(process) for process in both] == pytest.approx([2.0, 2.0], rel=1e-14)


def test_what_a_killed_process_left_is_compiled_anew(tmp_path):
    """And as soon as it is noticed: not after others have waited in vain."""
    killed = start(tmp_path, CC=slow_compiler(tmp_path, 600))
    forms = tmp_path / "fenics"
    while not list(forms.glob("libffcx_forms_*.c")):
        assert killed.poll() is None
        time.sleep(0.1)
    os.killpg(killed.pid, signal.SIGKILL)  # its compiler, too
    killed.communicate()
    (source,) = forms.glob("libffcx_forms_*.c")
    assert not source.with_suffix(".c.cached").exists()
    assert answer(start(tmp_path)) == pytest.approx(2.0, rel=1e-14)


def test_what_is_left_is_kept_while_somebody_compiles(tmp_path):
    """Whose file it is cannot be known: it is removed when the last of them is through."""
    assert answer(start(tmp_path)) == pytest.approx(2.0, rel=1e-14)
    forms = tmp_path / "fenics"
    (ready,) = forms.glob("*.c.cached")
    ready.unlink()
    with open(forms / "fem_lie.lock", "ab") as other:
        fcntl.flock(other, fcntl.LOCK_SH)
        waiting = start(tmp_path)
        finished = threading.Event()
        thread = threading.Thread(target=lambda: (waiting.wait(), finished.set()))
        thread.start()
        assert not finished.wait(15.0)
        assert ready.with_suffix("").exists()
    assert answer(waiting) == pytest.approx(2.0, rel=1e-14)
    thread.join()


STRETCH = """
from mpi4py import MPI
import ffcx.compiler
import ufl
from dolfinx import fem, mesh
from fem_lie import _compat

domain = mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
space = fem.functionspace(domain, ("P", 2, (3,)))
x = fem.Function(space)
a = ufl.grad(x)
strain = 0.5 * (ufl.dot(a.T, a) - ufl.Identity(2))
energy = ufl.inner(strain, strain) + ufl.tr(strain) ** 2 / (1 + ufl.inner(x, x))
force = ufl.derivative(energy * ufl.dx, x, ufl.TestFunction(space))
form = ufl.derivative(force, x, ufl.TrialFunction(space))

def written():
    return str(ffcx.compiler.compile_ufl_objects([form], ffcx.get_options()))

plain = written()
with _compat.indexed_expressions():
    print(len(plain) > 1e4, written() == plain)
"""


def test_ffcx_writes_the_same_code_with_an_index_of_expressions():
    """Stretch energy of a curved surface: tensors of tensors of derivatives."""
    found = subprocess.run([sys.executable, "-c", STRETCH], capture_output=True, text=True)
    assert found.stdout.split() == ["True", "True"], found.stderr

"""Compiled code: found again on the disk by the next process, and in this one, never stale."""

import errno
import gc
import os
import pickle
import shutil
import subprocess
import sys
import time
from pathlib import Path

from mpi4py import MPI

import dolfinx
import numba
import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

import fem_lie._jit
from fem_lie._form_cache import compile_expression, compile_form
from fem_lie._jit import shipped
from fem_lie._jit.checked_files import CheckedFiles, read_checked, unpickled, write_checked
from fem_lie._jit.garbage import seldom_collected
from fem_lie.solve.progress_bars import Stopwatch

HELPER = """
from {package}._jit import {decorator}
@{decorator}
def helper(x):
    return {value} * x
"""

CALLER = """
import numba
numba.config.CACHE_DIR = "/users/own"
from {package}._jit import callback, compiled
from {package}.helper import helper

@compiled
def caller(x):
    return helper(x) + 1.0

@callback("float64(float64)")
def called_back(x):
    return helper(x) + 2.0

assert numba.config.CACHE_DIR == "/users/own"
print(caller(1.0), called_back.made.ctypes(1.0))
print(sum(caller.stats.cache_hits.values()) + called_back.made.cache_hits)
"""


@pytest.fixture
def run(tmp_path):
    """Write a small package with a helper that multiplies by ``value``, and run its caller."""
    package = tmp_path / "small"
    for path in Path(fem_lie._jit.__file__).parent.glob("*.py"):
        copy = package / "_jit" / path.name
        copy.parent.mkdir(parents=True, exist_ok=True)
        source = path.read_text().replace("from fem_lie.", f"from {package.name}.")
        copy.write_text(source)
    (package / "__init__.py").touch()
    (package / "caller.py").write_text(CALLER.format(package="small"))

    def call(value, decorator="compiled", cache=tmp_path / "cache", package=package, **variables):
        source = HELPER.format(package="small", decorator=decorator, value=value)
        (package / "helper.py").write_text(source)
        # Python takes a .pyc of the same second and size for that of the rewritten helper
        environment = os.environ | {
            "XDG_CACHE_HOME": str(cache),
            "PYTHONPATH": str(package.parent),
            "PYTHONDONTWRITEBYTECODE": "1",
            **variables,
        }
        done = subprocess.run(
            [sys.executable, "-m", "small.caller"], env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        *values, hits = done.stdout.split()
        return [float(v) for v in values], int(hits), done.stderr

    return call


@pytest.mark.parametrize("decorator", ["compiled", "inlined", "inlined_series"])
def test_cache_is_found_again_and_notices_changes(run, decorator):
    assert run(3.0, decorator)[:2] == ([4.0, 5.0], 0)
    assert run(3.0, decorator)[:2] == ([4.0, 5.0], 2)
    assert run(7.0, decorator)[:2] == ([8.0, 9.0], 0)


ON_DEMAND = """
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from small.helper import helper as helper
else:
    __getattr__ = lambda name: __import__("small.helper").helper.helper
"""


@pytest.mark.parametrize(
    ("names", "imports"),
    [
        ("names.py", "from small.names import helper"),
        ("names.py", "from small import _jit, names\nhelper = names.helper"),
        ("__init__.py", "import small as s\nhelper = s.multiply"),
        ("__init__.py", "from small import caller_of, multiply\nhelper = multiply"),
    ],
)
def test_changes_are_noticed_of_names_that_are_imported_on_demand(run, tmp_path, names, imports):
    (tmp_path / "small" / names).write_text(ON_DEMAND)
    (tmp_path / "small" / "caller_of.py").touch()
    caller = tmp_path / "small" / "caller.py"
    caller.write_text(caller.read_text().replace("from small.helper import helper", imports))
    assert run(3.0)[:2] == ([4.0, 5.0], 0)
    assert run(3.0)[:2] == ([4.0, 5.0], 2)
    assert run(7.0)[:2] == ([8.0, 9.0], 0)


def test_that_machine_code_is_made_is_said_once_and_only_then(run):
    assert run(3.0)[2].count("small compiles machine code") == 1
    assert run(3.0)[2] == ""


def test_what_compiled_functions_call_takes_nothing_from_python(run, tmp_path):
    """But it can still be called from there, and then has the same values."""
    run(3.0)
    code = "from small.helper import helper; print(helper(2.0), helper.for_callers is not helper)"
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": tmp_path}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == "6.0 True\n"


def test_nothing_is_made_before_it_is_called(run, tmp_path):
    run(3.0)
    code = (
        "from small.helper import helper\n"
        "from small._jit import callback\n"
        "print('overloads' in vars(helper), helper(x=2.0), 'overloads' in vars(helper))\n"
        "back = callback('float64(float64)')(helper.function)\n"
        "print('made' in vars(back), back.address > 0, 'made' in vars(back))"
    )
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": tmp_path}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "6.0", "True", "False", "True", "True"]


def test_compiling_is_not_in_the_seconds_of_a_run():
    begin, before, watch = time.perf_counter(), fem_lie._jit.compiling.seconds, Stopwatch(2.0)

    @numba.njit
    def new(x):
        return 2.0 * x

    assert new(1.0) == 2.0
    run_for = watch.seconds - 2.0
    made = fem_lie._jit.compiling.seconds - before
    assert made > 0.0
    assert 0.0 <= run_for <= time.perf_counter() - begin - made


def test_files_that_are_not_imported_do_not_matter(run, tmp_path):
    run(3.0)
    other = HELPER.format(package="small", decorator="compiled", value=1.0)
    (tmp_path / "small" / "bystander.py").write_text(other)
    assert run(3.0)[1] == 2


def test_comments_and_docstrings_do_not_matter(run, tmp_path):
    run(3.0)
    caller = tmp_path / "small" / "caller.py"
    text = caller.read_text()
    text = text.replace("def caller(x):", 'def caller(x):\n    """Of x."""\n    # why')
    caller.write_text('"""A module."""\n\n# a comment\n' + text)
    assert run(3.0)[:2] == ([4.0, 5.0], 2)


def test_a_copy_elsewhere_of_another_date_finds_the_same_code(run, tmp_path):
    run(3.0)
    copy = tmp_path / "elsewhere" / "small"
    shutil.copytree(tmp_path / "small", copy)
    os.utime(copy / "caller.py", (0, 0))
    assert run(3.0, package=copy)[:2] == ([4.0, 5.0], 2)


def test_unwritable_cache_folder_is_a_warning(run, tmp_path):
    (tmp_path / "file").touch()
    values, hits, log = run(3.0, cache=tmp_path / "file")
    assert (values, hits) == ([4.0, 5.0], 0)
    assert log.count("XDG_CACHE_HOME") == 1


def test_oldest_folders_of_a_file_are_removed(run, tmp_path):
    base = tmp_path / "cache" / "fem_lie" / "compiled"
    others = [f"caller_of-{0:016x}", "caller-of-old-times"]
    names = [f"caller-{k:016x}" for k in range(25)]
    for age, name in enumerate(reversed([*others, *names]), start=1):
        (base / name).mkdir(parents=True)
        then = time.time() - 3600 * age
        os.utime(base / name, (then, then))
    run(3.0)
    left = {path.name for path in base.iterdir()}
    assert left & {*names, *others} == {*others, *names[-11:]}
    assert len(left) == 11 + 2 + 2 + 1  # with the run's two files and `sources`


EXTENDED = """
import ctypes
from llvmlite import binding
from numba import float64, types
from numba.core.cpu import CPUContext
from numba.core.registry import cpu_target
from small._jit import compiled
from small.helper import helper

answer = ctypes.CFUNCTYPE(ctypes.c_double)(lambda: 42.0)
external = types.ExternalFunction("small_answer", float64())
plain = CPUContext.load_additional_registries

def extended(self):
    binding.add_symbol("small_answer", ctypes.cast(answer, ctypes.c_void_p).value)
    plain(self)

CPUContext.load_additional_registries = extended

@compiled
def outside(x):
    return helper(x) + external()

@compiled
def inside(x):
    return helper(x)

print({name}(2.0), len(cpu_target.target_context._registries) > 0)
"""


@pytest.mark.parametrize(("name", "said"), [("inside", "6.0 False"), ("outside", "48.0 True")])
def test_a_second_start_sets_up_only_what_machine_code_calls(run, tmp_path, name, said):
    """An extension of numba makes a function known when numba gets ready to compile."""
    run(3.0)
    (tmp_path / "small" / "extended.py").write_text(EXTENDED.format(name=name))
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": tmp_path}
    command = [sys.executable, "-m", "small.extended"]
    first, second = (
        subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    assert first.split() == [said.split()[0], "True"]
    assert second.split() == said.split()


def test_machine_code_is_made_of_entrances_alone(run, tmp_path):
    """Of what compiled functions call intermediate code is kept: it begins with its own mark."""
    run(3.0)
    kept = {path.name: path.read_bytes() for path in (tmp_path / "cache").rglob("*.nbc")}
    for name, data in kept.items():
        assert (b"\x7fELF" in data) == ("-inner" not in name), name
    assert any("-inner" in name for name in kept)


def files_of(cache, ending):
    """Files of the cache with this ending; those of sources have none."""
    found = [path for path in cache.rglob(f"*{ending}") if path.is_file()]
    assert found
    return [path for path in found if path.suffix == ending]


DAMAGES = {
    "cut": lambda data: data[: len(data) // 2],
    "empty": lambda data: b"",
    "flipped": lambda data: data[:-1] + bytes([data[-1] ^ 1]),
}


@pytest.mark.parametrize("ending", [".nbi", ".nbc", ""], ids=["index", "code", "source"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_files_of_the_cache_are_replaced(run, tmp_path, damage, ending):
    run(3.0)
    files = files_of(tmp_path / "cache", ending)
    for path in files:
        path.write_bytes(DAMAGES[damage](path.read_bytes()))
    values, _, log = run(3.0)
    assert values == [4.0, 5.0]
    assert "is damaged; it is replaced" in log
    assert run(3.0) == ([4.0, 5.0], 2, "")


def test_records_of_another_version_are_no_error():
    """Versions share a cache: of records that one does not have it takes no code."""
    for missing in (b"cfem_lie.no_such_module\nRecord\n.", b"cfem_lie.lie\nno_such_record\n."):
        assert unpickled(missing) is None
    assert unpickled(None) is None
    assert unpickled(pickle.dumps({"a": 1})) == {"a": 1}


def test_code_of_another_signature_is_not_taken(run, tmp_path):
    """As two processes can leave it that write at the same time."""
    run(3.0)
    files = files_of(tmp_path / "cache", ".nbc")
    of_caller, of_callback = (
        next(path for path in files if path.name.startswith(f"caller.{name}-only"))
        for name in ("caller", "called_back")
    )
    of_caller.write_bytes(of_callback.read_bytes())
    assert run(3.0)[:2] == ([4.0, 5.0], 1)
    assert run(3.0) == ([4.0, 5.0], 2, "")


@pytest.mark.parametrize("largest", [0, 3000])
def test_a_full_disk_is_the_end_of_the_cache_alone(run, tmp_path, largest):
    """As seen by a process that cannot write longer files than this, in bytes."""
    before = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({largest}, {largest}))"
    caller = tmp_path / "small" / "caller.py"
    text = caller.read_text()
    caller.write_text(f"{before}\n{text}")
    values, hits, log = run(3.0)
    assert (values, hits) == ([4.0, 5.0], 0)
    assert log.count("compiled code cannot be cached") == 1 and "File too large" in log
    caller.write_text(text)
    assert run(3.0)[:2] == ([4.0, 5.0], 0)
    assert run(3.0)[:2] == ([4.0, 5.0], 2)


@pytest.mark.parametrize(
    ("inside", "mode"),
    [("fem_lie", 0o770), ("fem_lie/compiled", 0o707), ("fem_lie/compiled", 0o1777)],
)
def test_a_folder_that_others_can_write_is_not_used(run, tmp_path, inside, mode):
    run(3.0)
    folder = tmp_path / "cache" / inside
    folder.chmod(mode)
    values, hits, log = run(3.0)
    assert (values, hits) == ([4.0, 5.0], 0)
    assert log.count(f"mode {mode:o}; remove it") == 1


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")
@pytest.mark.parametrize("inside", ["fem_lie", "fem_lie/compiled"])
def test_a_folder_of_somebody_else_is_not_used(run, tmp_path, inside):
    run(3.0)
    os.chown(tmp_path / "cache" / inside, 12345, -1)
    values, hits, log = run(3.0)
    assert (values, hits) == ([4.0, 5.0], 0)
    assert log.count("belongs to user 12345") == 1


def test_new_folders_are_for_their_owner_alone(run, tmp_path):
    umask = os.umask(0)
    try:
        run(3.0)
    finally:
        os.umask(umask)
    assert run(3.0)[:2] == ([4.0, 5.0], 2)


GENERIC = shipped.generic_processor()[0]


@pytest.fixture
def ship(run, tmp_path):
    """Put what the small package compiles for a generic processor beside its sources."""

    def call(value=3.0, **others):
        processor = {"NUMBA_CPU_NAME": GENERIC, "NUMBA_CPU_FEATURES": ""}
        assert run(value, cache=tmp_path / "built", **processor, **others)[1] == 0
        compiled = tmp_path / "built" / "fem_lie" / "compiled"
        shutil.copytree(compiled, tmp_path / "small" / "_machine_code", dirs_exist_ok=True)

    return call


@pytest.mark.skipif(not shipped.has_all(), reason="this processor has less than the generic one")
def test_code_that_came_with_the_package_is_taken_by_an_empty_cache(run, ship):
    ship()
    assert run(3.0) == ([4.0, 5.0], 2, "")


def test_code_of_other_sources_is_not_taken(run, ship):
    ship()
    values, hits, log = run(7.0)
    assert (values, hits) == ([8.0, 9.0], 0) and "compiles machine code" in log


def test_code_of_another_processor_is_not_taken(run, tmp_path):
    """Of one that has more than the generic one, as if its cache had been put into a wheel."""
    run(3.0, NUMBA_CPU_NAME=GENERIC, NUMBA_CPU_FEATURES="+avx512f", cache=tmp_path / "built")
    compiled = tmp_path / "built" / "fem_lie" / "compiled"
    shutil.copytree(compiled, tmp_path / "small" / "_machine_code")
    assert run(3.0)[:2] == ([4.0, 5.0], 0)


@pytest.mark.skipif(not shipped.has_all(), reason="this processor has less than the generic one")
@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_code_that_came_with_the_package_is_compiled(run, ship, tmp_path, damage):
    ship()
    for path in files_of(tmp_path / "small" / "_machine_code", ".nbc"):
        path.write_bytes(DAMAGES[damage](path.read_bytes()))
    values, hits, log = run(3.0)
    assert (values, hits) == ([4.0, 5.0], 0) and "is damaged" in log
    assert run(3.0) == ([4.0, 5.0], 2, "")


def test_a_file_of_the_cache_that_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    """What is there under its name stays as it was."""
    path = tmp_path / "index"
    write_checked(path, b"before")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "no space left")

    monkeypatch.setattr("fem_lie._jit.checked_files.os.replace", full)
    with pytest.raises(OSError, match="no space left"):
        write_checked(path, b"after")
    assert list(tmp_path.iterdir()) == [path]
    assert read_checked(path) == b"before"


def test_constants_are_compiled_for_once_and_not_for_each_value(run, tmp_path):
    """A call with 1 and one with 2 call the same code."""
    run(3.0)
    (tmp_path / "small" / "constants.py").write_text(
        "from small._jit import compiled\n"
        "from small.helper import helper\n"
        "@compiled\n"
        "def of_constants():\n"
        "    return helper(1) + helper(2)\n"
        "print(of_constants(), len(helper.for_callers.overloads))\n"
    )
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": tmp_path}
    done = subprocess.run(
        [sys.executable, "-m", "small.constants"],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "9.0 1\n"


def test_a_scene_compiles_nothing_for_bodies_that_it_does_not_have():
    code = (
        "import fem_lie as fl\n"
        "from fem_lie.lie.node_types import floating\n"
        "scene = fl.Scene(gravity=(0, 0, -9.81))\n"
        "steel = fl.Material(E=2e11, nu=0.3, density=7800.0)\n"
        "section = fl.Section.rectangle(0.01, 0.01, steel)\n"
        "beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2))\n"
        "scene.add(fl.Clamp(beam.point('start')))\n"
        "fl.statics(scene)\n"
        "from fem_lie._jit.decorators import Callback\n"
        "callbacks = [c for c in vars(floating).values() if isinstance(c, Callback)]\n"
        "print(len(callbacks), sum('made' in vars(c) for c in callbacks))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "3 0\n"


def test_the_compiler_leaves_garbage_collection_as_it_was():
    before = gc.get_threshold()
    with seldom_collected():
        assert gc.get_threshold() > before
    assert gc.get_threshold() == before


def integral(cells, value, factor, over):
    """The sum of ``factor f² v`` over an interval of length two, or over its ends."""
    mesh = dolfinx.mesh.create_interval(MPI.COMM_SELF, cells, [0.0, 2.0])
    V = fem.functionspace(mesh, ("P", 1))
    f, g, c = fem.Function(V), fem.Function(V), fem.Constant(mesh, factor)
    f.x.array[:], g.x.array[:] = value, 1.0
    form = compile_form(c * f**2 * g * ufl.TestFunction(V) * over(mesh))
    return fem.assemble_vector(form).array.sum()


@pytest.mark.parametrize(
    ("over", "size"), [(lambda mesh: ufl.dx(mesh), 2.0), (lambda mesh: ufl.ds(mesh), 2.0)]
)
def test_a_loaded_form_is_that_of_each_mesh_with_its_functions(monkeypatch, over, size):
    """FFCx is asked once; meshes, functions and constants are those of each form."""
    assert integral(3, 2.0, 5.0, over) == pytest.approx(20.0 * size, rel=1e-14)
    monkeypatch.setattr(dolfinx.jit, "ffcx_jit", None)
    assert integral(3, 2.0, 5.0, over) == pytest.approx(20.0 * size, rel=1e-14)
    assert integral(7, 3.0, 2.0, over) == pytest.approx(18.0 * size, rel=1e-14)


def test_forms_over_parts_are_made_for_their_parts():
    """Which cells belong to a part is in no library."""
    mesh = dolfinx.mesh.create_interval(MPI.COMM_SELF, 4, [0.0, 1.0])
    v = ufl.TestFunction(fem.functionspace(mesh, ("P", 1)))
    for count in (1, 3):
        cells = np.arange(count, dtype=np.int32)
        tags = dolfinx.mesh.meshtags(mesh, 1, cells, np.ones(count, dtype=np.int32))
        part = compile_form(v * ufl.dx(1, domain=mesh, subdomain_data=tags))
        assert fem.assemble_vector(part).array.sum() == pytest.approx(0.25 * count, rel=1e-14)


class _Vanished:
    """Like the type of a function that does not exist any more."""

    def __reduce__(self):
        raise ReferenceError("underlying object has vanished")


@pytest.mark.parametrize("others", [{}, {"other": "a"}])
def test_signatures_of_functions_that_are_gone_leave_the_index(tmp_path, others):
    """A cache that many scripts share has signatures of functions that only they have."""
    files = CheckedFiles(str(tmp_path), "function", 1)
    files._save_index({_Vanished(): "gone", **others, "new": "b"})
    assert files._load_index() == {**others, "new": "b"}


# --- forms that take code which was compiled for others ---


def two_functions(domain, rng, swapped, degrees=(1, 2)):
    """Two functions with random values, the second of which may have been made first."""
    found = {}
    for degree in degrees[::-1] if swapped else degrees:
        f = found[degree] = fem.Function(fem.functionspace(domain, ("P", degree)))
        f.x.array[:] = rng.standard_normal(len(f.x.array))
    return [found[degree] for degree in degrees]


def constants(domain, swapped):
    values = (0.3, 1.7)
    found = {v: fem.Constant(domain, v) for v in (values[::-1] if swapped else values)}
    return [found[v] for v in values]


def formula(domain, f, g, a, b):
    """With free indices, a literal, a variable and a position."""
    x, (i, j) = ufl.SpatialCoordinate(domain), ufl.indices(2)
    u = ufl.variable(f)
    change = ufl.diff(u**3 + ufl.sin(u) * g, u)
    H = ufl.outer(ufl.grad(f), ufl.grad(g))
    return a * change + b * 0.25 * H[i, j] * H[j, i] + f * x[0] / (2.0 + g * g)


MESHES = {
    "interval": lambda n: mesh.create_interval(MPI.COMM_SELF, n, [0.0, 1.0]),
    "triangle": lambda n: mesh.create_unit_square(MPI.COMM_SELF, n, n),
    "quadrilateral": lambda n: mesh.create_unit_square(
        MPI.COMM_SELF, n, n, mesh.CellType.quadrilateral
    ),
}


@pytest.mark.parametrize("cell", MESHES)
def test_equal_formulas_have_the_values_of_their_own_functions(cell, rng):
    """However many meshes there are, and in whatever order functions and constants were made."""
    for n in (2, 3):
        for swapped in (False, True):
            for swapped_constants in (False, True):
                domain = MESHES[cell](n)
                f, g = two_functions(domain, rng, swapped)
                value = formula(domain, f, g, *constants(domain, swapped_constants))
                energy = value * ufl.dx(degree=4)
                for form in (energy, ufl.derivative(energy, f), ufl.derivative(energy, g)):
                    found, wanted = compile_form(form), fem.form(form)
                    if form is energy:
                        pair = [fem.assemble_scalar(each) for each in (found, wanted)]
                    else:
                        pair = [fem.assemble_vector(each).array for each in (found, wanted)]
                    np.testing.assert_array_equal(*pair)


@pytest.mark.parametrize("cell", MESHES)
def test_equal_expressions_have_the_values_of_their_own_functions(cell, rng):
    for n in (2, 3):
        for swapped in (False, True):
            domain = MESHES[cell](n)
            f, g = two_functions(domain, rng, swapped)
            value = formula(domain, f, g, *constants(domain, swapped))
            dim = domain.topology.dim
            points = np.full((2, dim), 0.2) + np.array([[0.0], [0.3]])
            cells = np.arange(domain.topology.index_map(dim).size_local, dtype=np.int32)
            found = compile_expression(value, points).eval(domain, cells)
            # FFCx has no derivatives with respect to variables in expressions
            plain = formula(domain, f, g, *constants(domain, swapped))
            plain = ufl.algorithms.apply_derivatives.apply_derivatives(
                ufl.algorithms.apply_algebra_lowering.apply_algebra_lowering(plain)
            )
            wanted = fem.Expression(plain, points).eval(domain, cells)
            np.testing.assert_allclose(found, wanted, rtol=1e-13, atol=1e-13)


def other_forms(domain, V):
    """Forms that differ from each other in one respect."""
    f, v = fem.Function(V, name="f"), ufl.TestFunction(V)
    f.x.array[:] = np.linspace(0.1, 0.9, len(f.x.array))
    x = ufl.SpatialCoordinate(domain)
    yield f * f * v * ufl.dx(degree=2)
    yield f * f * v * ufl.dx(degree=4)
    yield 2 * f * f * v * ufl.dx(degree=2)
    yield 3 * f * f * v * ufl.dx(degree=2)
    yield 2.5 * f * f * v * ufl.dx(degree=2)
    yield 3.5 * f * f * v * ufl.dx(degree=2)
    yield f * v * ufl.dx(degree=2)
    yield x[0] * v * ufl.dx(degree=3)
    yield f * f * v * ufl.ds(degree=2)
    yield f * x[0] * v * ufl.dx(degree=2)
    yield f * x[1] * v * ufl.dx(degree=2)
    yield f.dx(0) * v * ufl.dx(degree=2)
    yield f.dx(1) * v * ufl.dx(degree=2)
    yield ufl.sin(f) * v * ufl.dx(degree=2)
    yield ufl.cos(f) * v * ufl.dx(degree=2)
    yield f * ufl.CellVolume(domain) * v * ufl.dx(degree=2)
    yield f * ufl.Circumradius(domain) * v * ufl.dx(degree=2)


def test_other_formulas_have_values_of_their_own():
    """Also on other elements, and with constants of another shape."""
    seen = []
    for degree in (1, 2):
        domain = MESHES["triangle"](2)
        V = fem.functionspace(domain, ("P", degree))
        for form in other_forms(domain, V):
            found = fem.assemble_vector(compile_form(form)).array
            np.testing.assert_array_equal(found, fem.assemble_vector(fem.form(form)).array)
            seen.append(tuple(found))
    assert len(set(seen)) == len(seen)
    for shape in ((2,), (3,)):
        c = fem.Constant(domain, np.arange(1.0, 1.0 + shape[0]))
        form = ufl.inner(c, c) * ufl.dx(domain)
        assert fem.assemble_scalar(compile_form(form)) == pytest.approx(c.value @ c.value)


def test_code_is_asked_of_ffcx_once(monkeypatch):
    """The second of two equal forms, on another mesh, does not call FFCx."""
    made = []
    original = dolfinx.jit.ffcx_jit

    def counted(*args, **kwargs):
        made.append(args)
        return original(*args, **kwargs)

    monkeypatch.setattr(dolfinx.jit, "ffcx_jit", counted)
    counts = []
    for n in (2, 3):
        f = fem.Function(fem.functionspace(MESHES["interval"](n), ("P", 2)))
        compile_form(ufl.exp(f) * 1.2345 * ufl.dx(degree=3))
        compile_expression(ufl.exp(f) * 2.3456, np.array([[0.1]]))
        counts.append(len(made))
    assert counts == [2, 2]

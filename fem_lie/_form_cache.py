"""Forms and expressions that FFCx compiles, also where other processes compile the same ones.

FFCx writes an empty C file to say that a process compiles, and others wait ten seconds for its
library. They end with an error where that takes longer, as on a busy machine, or where the process
was killed. Here every process that compiles holds a shared lock on one file of FFCx's cache. Others
wait as long as somebody holds it; when nobody does, the C file is left over from a process that was
killed, and is removed.
"""

from __future__ import annotations

import fcntl
import logging
import re
import shutil
import sys
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager, nullcontext
from functools import cache
from pathlib import Path
from typing import IO, Any, TypeVar

from mpi4py import MPI

import dolfinx
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem
from ufl.algorithms.analysis import extract_coefficients, extract_constants, has_type
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
from ufl.algorithms.apply_derivatives import apply_derivatives
from ufl.classes import Variable
from ufl.core.expr import Expr
from ufl.corealg.map_dag import map_expr_dag
from ufl.corealg.multifunction import MultiFunction
from ufl.domain import extract_unique_domain

from fem_lie import _compat
from fem_lie._form_structure import Structure, structure_of_expression, structure_of_form
from fem_lie._jit import shipped

_log = logging.getLogger(__name__)
_PATIENCE = 5  # seconds that FFCx waits for a library before the check for compiling processes
_GAVE_UP = re.compile(r"JIT compilation timed out.*remove (\S+\.c)\)", re.DOTALL)

_DEPTH = 20_000  # calls: UFL 2025 and later call themselves five times for each level of a formula

Compiled = TypeVar("Compiled")


_loaded: dict[Hashable, tuple[Any, Any, Any]] = {}
"""FFCx's form, library and source of forms by their structures, loaded by this process alone."""

_expressions: dict[Hashable, tuple[fem.Expression, list[int], list[int]]] = {}
"""Likewise expressions without functions, and which functions and constants they have."""


def compile_form(form: ufl.Form) -> fem.Form:
    """A form that FFCx has compiled, for assembly over its mesh; see :func:`compiled`."""
    return compiled(form)[0]


def compiled(form: ufl.Form) -> tuple[fem.Form, Structure]:
    """A form that FFCx has compiled, for assembly over its mesh, and its functions.

    FFCx looks through its whole cache folder for each form; one whose library this process has
    loaded takes it from there. Several processes ask FFCx together each time, as not all of them
    need have loaded the same.

    Raises:
        RuntimeError: FFCx or the C compiler cannot compile it.
    """
    structure = structure_of_form(form)
    comm = form.integrals()[0].ufl_domain().ufl_cargo().comm
    whole = all(integral.subdomain_data() is None for integral in form.integrals())
    if comm.size == 1 and whole and (known := _loaded.get(structure.key)) is not None:
        return _compat.form_with_library(form, structure, *known), structure
    made = wait_for_others(comm, lambda options: fem.form(form, jit_options=options))
    if comm.size == 1 and whole:
        _loaded[structure.key] = made.ufcx_form, made.module, made.code
    return made, structure


class _WithoutVariables(MultiFunction):
    """Replaces variables by their operands."""

    expr = MultiFunction.reuse_if_untouched

    def variable(self, o: Expr, value: Expr, label: Expr) -> Expr:
        return value


def compile_expression(value: Expr, points: npt.ArrayLike) -> fem.Expression:
    """An expression at points of its cells, compiled once for all equal expressions.

    FFCx names compiled expressions by the count of each ``ufl.variable``, so derivatives with
    respect to one are expanded first.
    """
    at = np.asarray(points, dtype=np.float64)
    structure = structure_of_expression(value, (at.shape, at.tobytes()))
    comm = extract_unique_domain(value).ufl_cargo().comm
    if comm.size == 1 and (known := _expressions.get(structure.key)) is not None:
        made, functions, constants = known
        given = [structure.coefficients[i] for i in functions]
        fixed = [structure.constants[i] for i in constants]
        return _compat.expression_from(made, value, given, fixed)
    if has_type(value, Variable):
        lowered = apply_derivatives(apply_algebra_lowering(value))
        value = map_expr_dag(_WithoutVariables(), lowered)
    made = wait_for_others(comm, lambda options: fem.Expression(value, at, jit_options=options))
    if comm.size == 1 and not structure.arguments:
        used = _compat.coefficients_of(made.ufcx_expression, extract_coefficients(value))
        functions = [structure.coefficients.index(each) for each in used]
        constants = [structure.constants.index(each) for each in extract_constants(value)]
        _expressions[structure.key] = _compat.expression_template(made), functions, constants
    return made


def wait_for_others(comm: MPI.Comm, compile_with: Callable[[dict[str, Any]], Compiled]) -> Compiled:
    """What ``compile_with`` returns, called until no other process compiles the same.

    Args:
        comm: The processes that call this together.
        compile_with: Compiles with FFCx; takes DOLFINx's ``jit_options``.
    """
    folder = Path(dolfinx.jit.get_options()["cache_dir"])
    folder.mkdir(parents=True, exist_ok=True)
    if comm.rank == 0:
        _copy_shipped(folder)
    while True:
        try:
            # DOLFINx compiles on the first of several processes alone
            announced = _announced(folder) if comm.rank == 0 else nullcontext()
            with announced, _deep_recursion(), _compat.indexed_expressions():
                return compile_with({"timeout": _PATIENCE})
        except (TimeoutError, RuntimeError) as error:
            waited_for = _GAVE_UP.search(str(error))
            if not comm.bcast(waited_for is not None):
                raise
            if waited_for is not None:
                _remove_if_abandoned(Path(waited_for[1]))


@contextmanager
def _deep_recursion() -> Iterator[None]:
    """Context in which formulas may be nested deeply, also where the caller is deep already."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, _DEPTH))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


@cache
def _copy_shipped(folder: Path) -> None:
    """Copy what a wheel brings to FFCx's cache, where nobody has compiled it.

    FFCx names a library after the form, its own version, Python's and the C compiler's options, so
    what is of other versions is never loaded.
    """
    for library in shipped.FOLDER.glob("forms/*.so"):
        source = folder / library.name.split(".")[0]
        try:
            # as FFCx does: the process that makes this file is the one that makes the library
            source.with_suffix(".c").open("x").close()
        except FileExistsError:
            continue
        with _announced(folder):
            shutil.copyfile(library, folder / library.name)
            source.with_suffix(".c.cached").touch()


@contextmanager
def _announced(folder: Path) -> Iterator[None]:
    """Hold the shared lock, which a process loses when it ends, however it ends."""
    with _lock_file(folder) as file:
        fcntl.flock(file, fcntl.LOCK_SH)
        yield


def _remove_if_abandoned(source: Path) -> None:
    """Remove a C file for which others wait, if no process is compiling."""
    with _lock_file(source.parent) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return
        if not source.with_suffix(".c.cached").exists():
            _log.info("%s was left by a process that has ended; it is compiled anew", source)
            source.unlink(missing_ok=True)


def _lock_file(folder: Path) -> IO[bytes]:
    return open(folder / "fem_lie.lock", "ab")

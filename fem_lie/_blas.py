"""The BLAS that the factorisations of this environment call.

As a script it prints that in one line, with a warning if it is the reference implementation. It
imports nothing of the package, so that ``tools/setup --status`` is fast.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path

from petsc4py import PETSc

_TEXTS = {"openblas_get_config": "", "bli_info_get_version_str": "BLIS "}
"""Functions without arguments that return a text, and its prefix."""
_OTHERS = {"MKL_Get_Version": "Intel MKL", "ATL_buildinfo": "ATLAS", "flexiblas_chain": "FlexiBLAS"}
"""Functions by which other optimised libraries are recognised."""


class _SymbolInfo(ctypes.Structure):
    """``Dl_info`` of ``dladdr``."""

    _fields_ = (
        ("file", ctypes.c_char_p),
        ("base", ctypes.c_void_p),
        ("symbol", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
    )


@dataclass(frozen=True)
class Blas:
    """A BLAS library.

    Attributes:
        name: Implementation, version and processor type, as far as the library reports them.
        path: The file with ``dgemm``, without symbolic links.
        is_reference: Whether it is the reference implementation, whose matrix products take four
            to ten times as long as those of an optimised one.
    """

    name: str
    path: Path
    is_reference: bool

    def __str__(self) -> str:
        return f"{self.name}, {self.path}"


def describe(path: Path) -> Blas:
    """Describe the library at ``path`` by the functions that it, or what it links to, exports.

    Raises:
        OSError: The dynamic linker cannot load it.
    """
    library, path = ctypes.CDLL(str(path)), path.resolve()
    for function, before in _TEXTS.items():
        if hasattr(library, function):
            read = getattr(library, function)
            read.argtypes, read.restype = (), ctypes.c_char_p
            return Blas(before + read().decode().strip(), path, False)
    for function, name in _OTHERS.items():
        if hasattr(library, function):
            return Blas(name, path, False)
    if path.name.startswith("libblas."):
        return Blas("reference BLAS", path, True)
    return Blas("unknown BLAS", path, False)


def find(library: Path | None = None) -> Blas:
    """The BLAS that ``library`` calls, by default that of PETSc and its solvers.

    The dynamic linker resolves ``dgemm`` of that library, so alternatives, ``LD_LIBRARY_PATH`` and
    run paths count as they do in a run.

    Raises:
        AttributeError: ``library`` is not linked to a BLAS.
    """
    user = ctypes.CDLL(str(PETSc.__file__ if library is None else library))
    found = _SymbolInfo()
    if not ctypes.CDLL(None).dladdr(ctypes.cast(user.dgemm_, ctypes.c_void_p), ctypes.byref(found)):
        raise AttributeError(f"the dynamic linker does not know the file of dgemm of {user._name}")
    return describe(Path(found.file.decode()))


ADVICE = (
    "factorisations of shells and solids take twice as long with it: install an optimised BLAS "
    "(Debian: libopenblas0-serial, conda: libblas=*=*openblas)"
)


def main() -> None:
    """Print the line."""
    blas = find()
    print(f"warning: {blas}; {ADVICE}" if blas.is_reference else f"BLAS: {blas}")


if __name__ == "__main__":
    main()

"""``python -m fem_lie``: report versions, solvers, BLAS and caches; compile or clear caches."""

from __future__ import annotations

import argparse
import platform
import shutil
from contextlib import suppress
from importlib import metadata
from pathlib import Path

from petsc4py import PETSc

import dolfinx
import slepc4py

from fem_lie import _blas
from fem_lie._jit.machine_code import FOLDER
from fem_lie._precompile import forget, precompile

_PACKAGES = ("fenics-ufl", "fenics-basix", "fenics-ffcx", "numba", "numpy", "scipy", "h5py")
_SHOWN = ("gmsh", "pyvista", "matplotlib", "imageio", "tqdm")
_SOLVERS = ("mumps", "umfpack", "klu", "superlu", "suitesparse", "ptscotch", "hypre")


def caches() -> dict[str, Path]:
    """Cache folders by name; some may not exist yet."""
    found = {"forms": Path(dolfinx.jit.get_options()["cache_dir"])}
    if FOLDER is not None:
        found["machine-code"] = FOLDER
    return found


def size(folder: Path) -> tuple[int, int]:
    """Number of files in a folder and its subfolders, and their bytes."""
    sizes = []
    for path in folder.rglob("*") if folder.is_dir() else ():
        with suppress(FileNotFoundError):  # another process may remove old files
            if path.is_file():
                sizes.append(path.stat().st_size)
    return len(sizes), sum(sizes)


def versions() -> list[tuple[str, str]]:
    """Installed packages and their versions."""
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    scalars = "complex" if PETSc.ScalarType().dtype.kind == "c" else "real"
    found = [
        ("fem_lie", f"{_version('fem_lie')}, {Path(__file__).parent}"),
        ("Python", platform.python_version()),
        ("DOLFINx", dolfinx.__version__),
        ("PETSc", f"{petsc}, {scalars} numbers"),
        ("slepc4py", slepc4py.__version__),
    ]
    return found + [(name, _version(name)) for name in (*_PACKAGES, *_SHOWN)]


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed as a package"


def report() -> str:
    """Report as text."""
    lines = [f"{name:13} {version}" for name, version in versions()]
    solvers = [name for name in _SOLVERS if PETSc.Sys.hasExternalPackage(name)]
    blas = _blas.find()
    lines += ["", f"{'solvers':13} {', '.join(solvers)}", f"{'BLAS':13} {blas}"]
    lines += [f"{'':13} {_blas.ADVICE}", ""] if blas.is_reference else [""]
    for name, folder in caches().items():
        count, total = size(folder)
        lines.append(f"{name:13} {folder}: {count} files, {total / 1e6:.1f} MB")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> None:
    """Print the report, compile, or clear caches."""
    parser = argparse.ArgumentParser(prog="python -m fem_lie", description=__doc__)
    task = parser.add_mutually_exclusive_group()
    task.add_argument(
        "--compile",
        action="store_true",
        help="compile what most runs need, on all cores; they then start at once",
    )
    task.add_argument(
        "--clear",
        choices=[*caches(), "all"],
        help="remove what was compiled, which is made again when it is needed: 'forms' are those "
        "of DOLFINx, of other projects, too",
    )
    given = parser.parse_args(arguments)
    asked = given.clear
    if given.compile:
        precompile()
        return
    if asked is None:
        print(report())
        return
    forget()
    for name, folder in caches().items():
        if asked in (name, "all"):
            count, total = size(folder)
            shutil.rmtree(folder, ignore_errors=True)
            print(f"removed {folder}: {count} files, {total / 1e6:.1f} MB")


if __name__ == "__main__":
    main()

"""Whether this Python has what fem_lie needs: says so in one line, exit status 0 if it does.

With ``--quick`` nothing is imported, only looked up.
"""

import importlib.util
import platform
import sys

MINIMUM = (0, 9)
# Names on PyPI and conda-forge by the module that shows their presence.
NEEDED = {
    "petsc4py": "petsc4py",
    "slepc4py": "slepc4py",
    "mpi4py": "mpi4py",
    "numba": "numba",
    "scipy": "scipy",
    "matplotlib": "matplotlib",
    "h5py": "h5py",
    "pandas": "pandas",
    "tqdm": "tqdm",
    "gmsh": "gmsh",
    "pyvista": "pyvista",
    "imageio": "imageio",
    "PIL": "pillow",
    "pytest": "pytest",
    "xdist": "pytest-xdist",
    "hypothesis": "hypothesis",
    "mpmath": "mpmath",
}


def missing():
    """Return the names of the packages that this Python does not find."""
    return [name for module, name in NEEDED.items() if importlib.util.find_spec(module) is None]


def main():
    """Print the verdict."""
    if importlib.util.find_spec("dolfinx") is None:
        sys.exit("has no DOLFINx")
    if missing():
        names = " ".join(missing())
        sys.exit(
            f"has DOLFINx but lacks {names} (get them with: conda install -c conda-forge {names},"
            f" or {sys.executable} -m pip install {names})"
        )
    if "--quick" in sys.argv[1:]:
        return
    import dolfinx
    import numpy

    if tuple(int(part) for part in dolfinx.__version__.split(".")[:2]) < MINIMUM:
        sys.exit(f"has DOLFINx {dolfinx.__version__}, wanted is 0.9 or newer")
    if not numpy.issubdtype(dolfinx.default_scalar_type, numpy.floating):
        sys.exit("has a DOLFINx for complex numbers, wanted is one for real numbers")
    import dolfinx.fem.petsc  # fails where DOLFINx was built without petsc4py

    print(f"DOLFINx {dolfinx.__version__}, Python {platform.python_version()}")


if __name__ == "__main__":
    try:
        main()
    except Exception as problem:
        sys.exit(f"has a DOLFINx that cannot be imported ({problem})")

"""Write a .msh file beside each .geo file of this folder (python3 meshes/make.py)."""

from pathlib import Path

import gmsh


def main() -> None:
    """Mesh the curves and surfaces of every model."""
    gmsh.initialize(readConfigFiles=False)
    for geo in sorted(Path(__file__).parent.glob("*.geo")):
        gmsh.open(str(geo))
        gmsh.model.mesh.generate(2)
        gmsh.write(str(geo.with_suffix(".msh")))
        gmsh.clear()
    gmsh.finalize()


if __name__ == "__main__":
    main()

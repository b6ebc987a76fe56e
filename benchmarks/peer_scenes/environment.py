"""The virtual environment of the peers, in the cache folder of the project.

pip installs with the user's own settings, as for ruff (``tools/lint``). What cannot be installed is
reported in one line, and left out. Pythons are tried in turn until one can have all: this one, then
others on the path.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

PACKAGES = {
    "exudyn": ["exudyn==1.13.6"],
    "kratos": ["KratosMultiphysics==10.4.4", "KratosStructuralMechanicsApplication==10.4.4"],
    "mujoco": ["mujoco==3.3.7"],
    # its package does not say which versions of these it was built with
    "pinocchio": ["pin==3.8.0", "cmeel-urdfdom==4.0.1", "cmeel-tinyxml2==10.0.0"],
}
IMPORTS = {
    "exudyn": "exudyn",
    "kratos": "KratosMultiphysics.StructuralMechanicsApplication",
    "mujoco": "mujoco",
    "pinocchio": "pinocchio",
}
OWN = "python{}.{}".format(*sys.version_info)
PYTHONS = ("python3.13", "python3.12", "python3.11", "python3.10")


def interpreters(*peers: str) -> dict[str, Path]:
    """The Python that has each peer, of those that can be had."""
    found: dict[str, Path] = {}
    missing = set(peers)
    for python in candidates():
        for peer in sorted(missing):
            inside = folder(python, peer) / "bin" / "python"
            if has(inside, peer) or install(python, peer):
                found[peer] = inside
                missing.discard(peer)
        if not missing:
            break
    for peer in sorted(missing):
        print(f"{peer} is skipped: no Python here can have {' '.join(PACKAGES[peer])} by pip")
    return found


def candidates() -> list[Path]:
    """Pythons of different versions, this one first."""
    others = (shutil.which(name) for name in PYTHONS if name != OWN)
    return [Path(sys.executable), *(Path(path) for path in others if path)]


def folder(python: Path, peer: str) -> Path:
    """Where the environment of a peer is; named by the versions that it has."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    version = PACKAGES[peer][0].partition("==")[2]
    tag = OWN if python == Path(sys.executable) else python.name
    return cache / "fem_lie" / "environment" / "peers" / f"{peer}-{version}-{tag}"


def has(python: Path, peer: str) -> bool:
    """Whether a Python is there and imports the peer."""
    return python.exists() and silent([python, "-c", f"import {IMPORTS[peer]}"])


def install(python: Path, peer: str) -> bool:
    """Make the environment; False, and nothing left of it, where that fails."""
    position = folder(python, peer)
    inside = position / "bin" / "python"
    print(f"installing {' '.join(PACKAGES[peer])} into {position}")
    pip = [inside, "-m", "pip", "install", "--quiet", *PACKAGES[peer]]
    if silent([python, "-m", "venv", position]) and silent(pip) and has(inside, peer):
        return True
    shutil.rmtree(position, ignore_errors=True)
    return False


def silent(command: list[str | Path]) -> bool:
    """Run a command for its success alone."""
    quiet = {**os.environ, "PIP_ROOT_USER_ACTION": "ignore"}
    try:
        done = subprocess.run(command, env=quiet, capture_output=True, check=False)
    except OSError:
        return False
    return done.returncode == 0

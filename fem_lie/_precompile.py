"""Compile beforehand what most runs need: ``python -m fem_lie --compile``.

Small scenes are run, each in a process of its own, as many at once as there are cores. The compiled
code stays in the caches of FFCx and of this package for all later runs.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from typing import Any

from llvmlite import binding as llvm
from numba.core import event
from tqdm import tqdm

import fem_lie as fl
from fem_lie._jit import machine_code, shipped

_STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
_SECTION = fl.Section.rectangle(0.01, 0.01, _STEEL)


def _mechanism() -> fl.Scene:
    """A beam on a ball joint, with a beam on a hinge at its end that carries a rigid body."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), _SECTION, cells=4))
    two = scene.add(fl.Beam.straight((0.5, 0, 0), (0.5, 0.5, 0), _SECTION, cells=4))
    body = scene.add(fl.RigidBody(1.0, (0.01, 0.02, 0.02), (0.5, 0.5, 0)))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(1, 0, 0)))
    scene.add(fl.joints.Fixed(two.point("end"), body.point("centre")))
    return scene


def _generalised_alpha() -> None:
    fl.GeneralisedAlpha().run(_mechanism(), duration=0.01, step=1e-3)


def _energy_momentum() -> None:
    fl.EnergyMomentum().run(_mechanism(), duration=0.01, step=1e-3)


def _shells() -> None:
    scene = fl.Scene(gravity=(0, 0, -9.81))
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0), (2, 2))
    plate = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, _STEEL)))
    plate.clamp("a=0")
    fl.statics(scene)


def _beams() -> None:
    scene = fl.Scene()
    rod = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), _SECTION, cells=4))
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.PointLoad(rod.point("end"), force=(0, 0, 100.0)))
    fl.statics(scene)
    fl.vibrations(scene, 2)


SCENES: dict[str, Callable[[], None]] = {
    "generalised-α": _generalised_alpha,
    "energy-momentum": _energy_momentum,
    "shells": _shells,
    "beams": _beams,
}
"""Scenes by name; those that take longest to compile come first."""


def precompile(jobs: int | None = None) -> None:
    """Run all scenes, unless that was done with these sources, this numba and this processor.

    Args:
        jobs: Number of simultaneous processes; ``None``: number of available cores.

    Raises:
        RuntimeError: A scene fails; with its output.
        OSError: No cache folder is writable.
    """
    if machine_code.FOLDER is None:
        raise OSError("compiled code cannot be kept: the cache folder cannot be written")
    mark = machine_code.FOLDER / f"precompiled-{_fingerprint()}"
    if mark.exists():
        return
    _run_all(jobs, os.environ)
    forget()
    mark.touch()


def forget() -> None:
    """Make the next :func:`precompile` run all scenes, as after a cache was cleared."""
    for mark in _marks():
        mark.unlink(missing_ok=True)


def _marks() -> Iterator[Path]:
    return iter(()) if machine_code.FOLDER is None else machine_code.FOLDER.glob("precompiled-*")


def _fingerprint() -> str:
    """Fingerprint of all sources, of Python and numba, and of the processor."""
    digest = hashlib.sha256(f"{sys.version} {fl.__file__} {llvm.get_host_cpu_name()}".encode())
    digest.update(machine_code.numba.__version__.encode())
    for source in sorted(machine_code.PACKAGE.rglob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def write_generic(folder: Path, jobs: int | None = None) -> None:
    """Write machine code for a generic processor of this architecture, for wheels.

    Args:
        folder: Target folder, which is created.
        jobs: As for :func:`precompile`.

    Raises:
        RuntimeError: A scene fails.
        ValueError: There is no generic processor for this architecture.
    """
    with tempfile.TemporaryDirectory() as caches:
        processor = {"NUMBA_CPU_NAME": shipped.generic_processor()[0], "NUMBA_CPU_FEATURES": ""}
        _run_all(jobs, os.environ | processor | {"XDG_CACHE_HOME": caches})
        shutil.copytree(Path(caches) / "fem_lie" / "compiled", folder)
        forms = folder / "forms"
        forms.mkdir()
        for library in Path(caches, "fenics").glob("*.so"):
            shutil.copy(library, forms)


class _Bar:
    """Progress of scenes and compiled functions."""

    def __init__(self) -> None:
        self._bar = tqdm(total=len(SCENES), desc="compiling", unit="scene", disable=None)
        self._lock, self._functions = Lock(), 0

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *_: Any) -> None:
        self._bar.close()

    def function(self, name: str) -> None:
        """Count a compiled function."""
        with self._lock:
            self._functions += 1
            self._bar.set_postfix_str(f"{self._functions} functions, {name}", refresh=False)
            self._bar.update(0)

    def scene(self) -> None:
        """Count a finished scene."""
        with self._lock:
            self._bar.update()


def _run_all(jobs: int | None, environment: os._Environ[str] | dict[str, str]) -> None:
    count = jobs or len(os.sched_getaffinity(0))
    with _Bar() as bar, ThreadPoolExecutor(count) as pool:
        runs = [pool.submit(_run_one, name, dict(environment), bar) for name in SCENES]
        for run in runs:
            run.result()


_COMPILED = "compiled: "


def _run_one(name: str, environment: dict[str, str], bar: _Bar) -> None:
    command = [sys.executable, "-m", "fem_lie._precompile", name]
    written = []
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith(_COMPILED):
                bar.function(line.removeprefix(_COMPILED).strip())
            else:
                written.append(line)
    if process.returncode:
        raise RuntimeError(f"{name} could not be compiled:\n{''.join(written)}")
    bar.scene()


class _Reports(event.Listener):
    """Writes a line for each compiled function."""

    def on_start(self, event: Any) -> None:
        """Note the start of a compilation."""

    def on_end(self, event: Any) -> None:
        """Write the line."""
        function = event.data["dispatcher"].py_func
        print(f"{_COMPILED}{function.__module__}.{function.__qualname__}", flush=True)


def main(name: str) -> None:
    """Run one scene."""
    logging.disable(logging.WARNING)
    event.register("numba:compile", _Reports())
    SCENES[name]()


if __name__ == "__main__":
    main(sys.argv[1])

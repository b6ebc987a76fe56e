"""Machine code for a generic processor that comes with a wheel.

Its folders have the names of those of the user's cache: fingerprints of the sources, numba and
Python. Other code is not found, and compiled.
"""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path
from typing import Any

from llvmlite import binding as llvm

from fem_lie._jit.checked_files import CheckedFiles

FOLDER = Path(__file__).parents[1] / "_machine_code"
"""Folder of the shipped machine code; a checkout has none."""

_GENERIC = {
    "x86_64": ("x86-64-v3", "avx avx2 bmi bmi2 cx16 f16c fma lzcnt movbe popcnt sse4.2 xsave"),
    "aarch64": ("generic", "neon"),
}
"""For each architecture: LLVM's name of the generic processor, and required features."""


def generic_processor() -> tuple[str, str]:
    """LLVM's name of the generic processor of this architecture, and its features.

    Raises:
        ValueError: No machine code is shipped for this architecture.
    """
    machine = platform.machine()
    if machine not in _GENERIC:
        known = ", ".join(_GENERIC)
        raise ValueError(f"machine code is shipped for {known}, this is a {machine}")
    return _GENERIC[machine]


@cache
def has_all() -> bool:
    """Whether this processor has all features of the generic one."""
    if platform.machine() not in _GENERIC:
        return False
    features = llvm.get_host_cpu_features()
    return all(features.get(name, False) for name in generic_processor()[1].split())


class WithShipped(CheckedFiles):
    """Files of the user's cache, and of the shipped one where these have nothing."""

    def __init__(self, folder: str, base: str, stamp: str) -> None:
        """Find the files of one function in a cache folder, whose name is the stamp."""
        super().__init__(folder, base, stamp)
        self._shipped: CheckedFiles | None = None
        if FOLDER.is_dir() and has_all():
            self._shipped = CheckedFiles(str(FOLDER / stamp), base, stamp)

    def load(self, key: Any) -> Any:
        """Compiled code of a signature, or ``None``."""
        found = super().load(key)
        if found is not None or self._shipped is None:
            return found
        signature, (triple, *_), code = key
        return self._shipped.load((signature, (triple, generic_processor()[0], ""), code))

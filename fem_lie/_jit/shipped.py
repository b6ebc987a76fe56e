"""Machine code for a generic processor that a wheel brings beside the sources.

Its folders carry the same names as those of the user's cache: they say which sources, which numba
and which Python the code was made of and with. Code of anything else is not found, and compiled.
"""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path
from typing import Any

from llvmlite import binding as llvm

from fem_lie._jit.checked_files import CheckedFiles

FOLDER = Path(__file__).parents[1] / "_machine_code"
"""Where it lies; a checkout has none."""

_GENERIC = {
    "x86_64": ("x86-64-v3", "avx avx2 bmi bmi2 cx16 f16c fma lzcnt movbe popcnt sse4.2 xsave"),
    "aarch64": ("generic", "neon"),
}
"""Of an architecture: LLVM's name of the generic processor, and what a processor must have."""


def generic_processor() -> tuple[str, str]:
    """LLVM's name of the generic processor of this architecture, and the features that it has.

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
    """Whether this processor has all that the generic one has."""
    if platform.machine() not in _GENERIC:
        return False
    features = llvm.get_host_cpu_features()
    return all(features.get(name, False) for name in generic_processor()[1].split())


class WithShipped(CheckedFiles):
    """Files of the user's cache, and where these have nothing, those that came with the package."""

    def __init__(self, folder: str, base: str, stamp: str) -> None:
        """Find the files of one function in a folder of the cache, whose name is the stamp."""
        super().__init__(folder, base, stamp)
        self._shipped: CheckedFiles | None = None
        if FOLDER.is_dir() and has_all():
            self._shipped = CheckedFiles(str(FOLDER / stamp), base, stamp)

    def load(self, key: Any) -> Any:
        """What is compiled for a signature, or ``None``."""
        found = super().load(key)
        if found is not None or self._shipped is None:
            return found
        signature, (triple, *_), code = key
        return self._shipped.load((signature, (triple, generic_processor()[0], ""), code))

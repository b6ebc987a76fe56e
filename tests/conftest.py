"""Order of the tests, their random numbers, and patience with each other's compilers."""

import gc
import os
import time
from pathlib import Path

import dolfinx.jit
import numpy as np
import pytest
from hypothesis import settings

# the same examples in each run; HYPOTHESIS_PROFILE=default looks for others
settings.register_profile("same", derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))

_PATIENCE = 600
# forms take FFCx and the C compiler up to minutes, and another process may be at them
dolfinx.jit.DOLFINX_DEFAULT_JIT_OPTIONS["timeout"] = (
    _PATIENCE,
    "seconds to wait for another process",
)


def pytest_sessionstart(session):
    """Remove what compilers that were killed have left: FFCx waits for its end."""
    if hasattr(session.config, "workerinput"):
        return
    for source in Path(dolfinx.jit.get_options()["cache_dir"]).glob("libffcx_*.c"):
        if not source.with_suffix(".c.cached").exists():
            if time.time() - source.stat().st_mtime > _PATIENCE:
                source.unlink(missing_ok=True)


@pytest.hookimpl(wrapper=True)
def pytest_collection(session):
    """Collect no garbage while tests are collected: they stay, and all would be looked at often."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_modifyitems(items):
    """Laws first, demos after them."""
    items.sort(key=lambda item: item.path.name.startswith("test_demos"))


@pytest.fixture
def rng():
    """Random numbers that are the same for each test, whichever tests ran before it."""
    return np.random.default_rng(7)

"""Order of the tests, and patience with each other's compilers."""

import dolfinx.jit

# forms take FFCx and the C compiler up to minutes, and another process may be at them
dolfinx.jit.DOLFINX_DEFAULT_JIT_OPTIONS["timeout"] = (600, "seconds to wait for another process")


def pytest_collection_modifyitems(items):
    """Laws first, demos after them."""
    items.sort(key=lambda item: item.path.name.startswith("test_demos"))

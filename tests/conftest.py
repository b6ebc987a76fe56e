"""Order of the tests."""


def pytest_collection_modifyitems(items):
    """Laws first, demos after them."""
    items.sort(key=lambda item: item.path.name.startswith("test_demos"))

"""All public names are in the reference, and all their parameters are documented."""

import enum
import inspect

import pytest

from tools.site import parameters, reference

SPACES = reference.namespaces()
NAMES = [
    pytest.param(space, name, id=f"{space.short}.{name}")
    for space in SPACES
    for name in [*space.names, *space.modules]
]


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The pages of the reference by their names."""
    folder = tmp_path_factory.mktemp("docs")
    reference.write(folder)
    files = (folder / "reference").rglob("*.md")
    return {
        file.relative_to(folder / "reference").as_posix(): file.read_text(encoding="utf-8")
        for file in files
    }


@pytest.mark.parametrize(("space", "name"), NAMES)
def test_a_public_name_is_in_the_reference(space, name, pages):
    own = f"{space.page}/{name}.md" if inspect.isclass(space.get(name)) else f"{space.page}.md"
    assert f":: {space.qualified(name)}\n" in pages[own]


@pytest.mark.parametrize("space", [pytest.param(space, id=space.short) for space in SPACES])
def test_a_namespace_has_a_docstring_and_links_to_its_classes(space, pages):
    assert inspect.getdoc(space.module)
    for name in space.names:
        assert f"~{space.qualified(name)}`" in pages[f"{space.page}.md"]


def own_docstrings(thing):
    """Docstrings that may document the parameters of a callable."""
    if not inspect.isclass(thing):
        return [thing.__doc__]
    constructors = [vars(base)["__init__"] for base in thing.__mro__ if "__init__" in vars(base)]
    return [base.__doc__ for base in thing.__mro__] + [one.__doc__ for one in constructors]


def undocumented(thing):
    """Parameters of a callable that no docstring describes."""
    known = set().union(*map(parameters.documented, own_docstrings(thing)))
    return [name for name in inspect.signature(thing).parameters if name not in known]


def callables():
    """Public functions and classes with a constructor of their own."""
    for space in SPACES:
        for name in space.names:
            thing = getattr(space.get(name), "py_func", space.get(name))
            if not callable(thing) or not thing.__module__.startswith("fem_lie"):
                continue
            foreign = inspect.isclass(thing) and issubclass(thing, (enum.Enum, Exception))
            protocol = getattr(thing, "_is_protocol", False)
            decorator = "<locals>" in getattr(thing, "__qualname__", "")
            if not (foreign or protocol or decorator):
                yield pytest.param(thing, id=f"{space.short}.{name}")


@pytest.mark.parametrize("thing", list(callables()))
def test_all_parameters_are_documented(thing):
    assert undocumented(thing) == []


def methods():
    """Public methods of public classes."""
    found = {}
    for space in SPACES:
        for name in filter(lambda name: inspect.isclass(space.get(name)), space.names):
            cls = space.get(name)
            for method in filter(lambda method: not method.startswith("_"), dir(cls)):
                static = inspect.getattr_static(cls, method)
                function = getattr(static, "__func__", static)
                if inspect.isfunction(function) and function.__module__.startswith("fem_lie"):
                    found[function] = cls, method
    return [
        pytest.param(cls, method, function, id=function.__qualname__)
        for function, (cls, method) in found.items()
    ]


@pytest.mark.parametrize(("cls", "method", "function"), list(methods()))
def test_all_parameters_of_methods_are_documented(cls, method, function):
    """A base class may document them."""
    definitions = [vars(base)[method] for base in cls.__mro__ if method in vars(base)]
    docstrings = [getattr(one, "__func__", one).__doc__ for one in definitions]
    known = set().union(*map(parameters.documented, docstrings), {"self", "cls"})
    assert [name for name in inspect.signature(function).parameters if name not in known] == []

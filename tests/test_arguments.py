"""Calls with arguments that do not exist: every public callable names itself and what it takes."""

import enum
import inspect
import pickle
import types

import pytest

from tools.site import reference

SPACES = reference.namespaces()
PUBLIC = {f"{space.short}.{name}": space.get(name) for space in SPACES for name in space.names}
NEVER_CALLED = (enum.Enum, BaseException)
"""Public classes that users do not construct: choices, errors and warnings."""

CLASSES = {
    name: thing
    for name, thing in PUBLIC.items()
    if inspect.isclass(thing)
    and not isinstance(thing, types.GenericAlias)
    and not issubclass(thing, NEVER_CALLED)
    and not getattr(thing, "_is_protocol", False)
}
CONSTRUCTORS = {
    name: cls
    for name, cls in CLASSES.items()
    if not inspect.isabstract(cls) and inspect.signature(cls).parameters
}
FUNCTIONS = {
    name: thing
    for name, thing in PUBLIC.items()
    if inspect.isfunction(thing) or hasattr(thing, "py_func")
}
METHODS = {
    f"{name}.{method}": (cls, method)
    for name, cls in CLASSES.items()
    for method in dir(cls)
    if not method.startswith("_")
    and method not in getattr(cls, "__dataclass_fields__", {})
    and (inspect.isfunction(found := getattr(cls, method)) or inspect.ismethod(found))
    and found.__module__.startswith("fem_lie")
}


def message(function, *args):
    """The message for a call with an unknown argument."""
    with pytest.raises(TypeError) as caught:
        function(*args, nonsense=1)
    return str(caught.value)


def expected(name, function):
    """The message that is expected for a function or constructor."""
    parameters = inspect.signature(function).parameters.values()
    names = [str(p).partition(":")[0].partition("=")[0] for p in parameters if p.name != "self"]
    return f"{name} has no argument 'nonsense' (it has {', '.join(names) or 'none'})"


def test_there_are_many():
    assert len(CONSTRUCTORS) > 170
    assert len(FUNCTIONS) > 140
    assert len(METHODS) > 500


@pytest.mark.parametrize("name", CONSTRUCTORS | FUNCTIONS)
def test_a_function_or_class_names_itself_and_its_arguments(name):
    function = PUBLIC[name]
    if any(p.kind is p.VAR_KEYWORD for p in inspect.signature(function).parameters.values()):
        pytest.skip("takes any argument")
    assert message(function) == expected(function.__name__, function)


def test_all_methods_name_themselves_and_their_arguments():
    for name, (cls, method) in METHODS.items():
        function = inspect.getattr_static(cls, method)
        bound = inspect.isfunction(function)
        called = getattr(cls, method)
        kinds = inspect.signature(called).parameters.values()
        if not any(p.kind is p.VAR_KEYWORD for p in kinds):
            said = message(called, *[cls] * bound)
            assert said.split(".")[-1] == expected(method, called), name


@pytest.mark.parametrize("name", CONSTRUCTORS | FUNCTIONS)
def test_a_misspelt_argument_is_recognised(name):
    for argument, parameter in inspect.signature(PUBLIC[name]).parameters.items():
        if len(argument) > 3 and parameter.kind is not parameter.VAR_POSITIONAL:
            with pytest.raises(TypeError, match=f"; expected {argument}="):
                PUBLIC[name](**{argument + argument[-1]: 1})


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if "frame_function" not in name])
def test_a_function_can_be_pickled(name):
    assert pickle.loads(pickle.dumps(FUNCTIONS[name])) is FUNCTIONS[name]


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if inspect.isfunction(PUBLIC[name])])
def test_the_inner_function_has_the_same_signature_and_can_be_pickled(name):
    inner = PUBLIC[name].__wrapped__
    assert inspect.signature(inner) == inspect.signature(PUBLIC[name])
    assert "<locals>" in inner.__qualname__ or pickle.loads(pickle.dumps(inner)) is inner

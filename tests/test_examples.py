"""Examples in docstrings: all that goes into a scene has one, every integrator has, and all run."""

import doctest
import inspect

import numpy as np

import fem_lie as fl
from tools.site import reference

CONNECTION = next(base for base in fl.joints.Joint.__mro__ if base.__name__ == "Connection")
PUT_IN = (
    fl.extend.Body,
    CONNECTION,
    fl.joints.RigidLink,
    fl.extend.Load,
    fl.Clamp,
    fl.PrescribedMotion,
    fl.contact.Contact,
    fl.extend.Integrator,
)
SPACES = [space for space in reference.namespaces() if space.short not in ("fl.extend", "fl.lie")]
CLASSES = [
    thing for space in SPACES for name in space.names if inspect.isclass(thing := space.get(name))
]
BASES = CONNECTION, fl.extend.Body, fl.joints.Joint
EXPECTED = [
    thing for thing in CLASSES if issubclass(thing, (*PUT_IN, fl.Scene)) and thing not in BASES
]


def example(thing: type) -> doctest.DocTest:
    text = inspect.cleandoc(thing.__doc__ or "")
    return doctest.DocTestParser().get_doctest(
        text, {"fl": fl, "np": np}, thing.__name__, inspect.getsourcefile(thing), 0
    )


def test_all_that_goes_into_a_scene_has_an_example():
    without = sorted({thing.__name__ for thing in EXPECTED if not example(thing).examples})
    assert len(EXPECTED) > 50
    assert without == []


def test_examples_run():
    """All in one process: no start of a scheme is made twice."""
    output: list[str] = []
    runner = doctest.DocTestRunner(verbose=False)
    for thing in CLASSES:
        runner.run(example(thing), out=output.append)
    assert runner.tries > 150
    assert "".join(output) == ""

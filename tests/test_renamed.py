"""Names that have moved, or are in another namespace: the errors say where."""

import re
from pathlib import Path

import pytest

import fem_lie as fl
from fem_lie._renamed import ATTRIBUTES, MEANT, RENAMED

CHANGELOG = Path(__file__).parents[1] / "CHANGELOG.md"


def resolve(path: str) -> object:
    """The object of a dotted path that begins with ``fl``."""
    found: object = fl
    for name in path.split("(")[0].split(".")[1:]:
        found = getattr(found, name)
    return found


@pytest.mark.parametrize("old", sorted(RENAMED))
def test_an_old_name_says_the_new_one(old):
    with pytest.raises(AttributeError, match=re.escape(f"'{old}'; it is {RENAMED[old]} now")):
        getattr(fl, old)
    assert resolve(RENAMED[old]) is not None
    assert re.search(rf"`(fl\.)?(extend\.)?{old}\b", CHANGELOG.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "namespace, name, expected",
    [
        (fl, "Revolute", "fl.joints.Revolute"),
        (fl, "EdgeLoad", "fl.loads.EdgeLoad"),
        (fl.loads, "PointLoad", "fl.PointLoad"),
        (fl.joints, "Penalty", "fl.contact.Penalty"),
        (fl.mesh, "surface", "fl.mesh.parametric_surface"),
    ],
)
def test_a_name_of_another_namespace_says_where_it_is(namespace, name, expected):
    with pytest.raises(AttributeError, match=re.escape(expected)):
        getattr(namespace, name)


@pytest.mark.parametrize("name", sorted(MEANT))
def test_a_name_of_another_code_says_what_is_meant(name):
    with pytest.raises(AttributeError, match=re.escape(f"'{name}'; expected {MEANT[name]}")):
        getattr(fl, name)
    for path in re.findall(r"fl[.\w]+", MEANT[name]):
        assert resolve(path.rstrip(".")) is not None


def small_scene() -> dict[str, object]:
    """A cantilever under its weight and what belongs to it, by the names in hints."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    section = fl.Section.circle(0.1, fl.Material(2e11, 0.3, 7800.0))
    body = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=1))
    scene.add(fl.Clamp(body.point("start")))
    result = fl.EnergyMomentum().run(scene, duration=1e-4, step=1e-4, progress=False)
    return {"result": result, "scene": scene, "body": body}


def test_attributes_of_other_codes_say_what_is_meant():
    things = small_scene()
    for name, meant in ATTRIBUTES.items():
        for thing in things.values():
            if not hasattr(thing, name):
                with pytest.raises(AttributeError, match=re.escape(meant)):
                    getattr(thing, name)
        for owner, attribute in re.findall(r"\b(result|scene|body)\.(\w+)", meant):
            known = hasattr(things[owner], attribute) or hasattr(fl.StaticResult, attribute)
            assert known or attribute in ("factors", "html"), meant
        for path in re.findall(r"\bfl(?:\.\w+)+", meant):
            assert resolve(path) is not None


def test_a_misspelt_attribute_names_the_near_ones():
    result = small_scene()["result"]
    with pytest.raises(AttributeError, match=r"'positon'; expected position"):
        result.positon  # noqa: B018


def test_what_was_not_recorded_keeps_its_own_error():
    scene = fl.Scene()
    scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0)))
    options = {"duration": 1.0, "step": 1.0, "progress": False}
    result = fl.EnergyMomentum().run(scene, **options, record=fl.schemes.Record.FRAMES)
    with pytest.raises(AttributeError, match="kinetic was not recorded"):
        result.kinetic  # noqa: B018


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("beam", "fl.Beam"),
        ("Beem", "fl.Beam"),
        ("rigid_body", "fl.RigidBody"),
        ("revolute", "fl.joints.Revolute"),
        ("pointload", "fl.PointLoad"),
    ],
)
def test_a_name_in_other_letters_is_understood(name, meant):
    with pytest.raises(AttributeError, match=rf"; expected {meant} \(fl is"):
        getattr(fl, name)


def test_a_name_that_is_nowhere_has_no_hint():
    with pytest.raises(AttributeError, match=r"^fem_lie has no 'quantum'$"):
        fl.quantum  # noqa: B018


def test_few_names_stand_at_the_top():
    assert len(fl.__all__) <= 50
    assert {name for name in dir(fl) if not name.startswith("_")} >= set(fl.__all__)

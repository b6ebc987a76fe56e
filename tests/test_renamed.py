"""Names that have moved, or are in another namespace: the errors say where."""

import re
from pathlib import Path

import pytest

import fem_lie as fl
from fem_lie._renamed import RENAMED

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


def test_a_name_that_is_nowhere_has_no_hint():
    with pytest.raises(AttributeError, match=r"^fem_lie has no 'Beem'$"):
        fl.Beem  # noqa: B018


def test_few_names_stand_at_the_top():
    assert len(fl.__all__) <= 50
    assert {name for name in dir(fl) if not name.startswith("_")} >= set(fl.__all__)

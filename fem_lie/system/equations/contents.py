"""All that equations depend on: what fingerprints are made of."""

from __future__ import annotations

from typing import Any

from fem_lie.system.system import System


def contents(system: System) -> list[tuple[str, Any, str]]:
    """All that they depend on but functions of time: name, value, what errors call it."""
    numbering = system.numbering
    found: list[tuple[str, Any, str]] = []
    pairs = zip(numbering.members, numbering.assemblies, strict=True)
    for k, (members, (_, assembly)) in enumerate(pairs, start=1):
        others = f" and {len(members) - 1} others" if len(members) > 1 else ""
        shown = f"energy of the elements of {members[0].label}{others}"
        found.append((f"energy of assembly {k}", assembly.contents, shown))
    contacts = system.scene.contacts
    groups = system.kinds, system.held, numbering.supports
    sums = {
        "inertia": tuple(system.inertia),
        "damping of mass": system.terms.rates,
        "loads": system.load_cases.contents,
        "groups and supports": groups,
        "contacts": [each.contents(numbering.nodes.__getitem__) for each in contacts],
    }
    if system.floating.integers[0]:
        sums["inertia within frames"] = system.floating.contents
    return found + [(name, value, name) for name, value in sums.items()]

"""Fingerprint of a scene and a scheme: everything on which the equations depend, part by part.

Numbers are compared as they enter the equations. Functions of time are compared by their values at
the ends and midpoints of all steps made so far. Names and labels do not matter.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array
from fem_lie.bodies.canonical import CanonicalBytes, attributes, data_of_body
from fem_lie.events.actions import Action
from fem_lie.parts.part_scene import undivided, whole_scene
from fem_lie.scene import Scene
from fem_lie.system.equations import Equations

_DIGEST = "digest "
_SHORT = 60
"""Longest text that is stored as it is; longer ones are stored as a digest."""


class Fingerprint:
    """Fingerprint that a checkpoint must match.

    Attributes:
        scene: The whole scene.
        parts: Text or digest of each part of scene and scheme, by name.
    """

    def __init__(self, equations: Equations, scheme: Any) -> None:
        """Take the fingerprint of the equations at the start.

        That of a divided scene is of the whole scene, without the sums in equations.

        Args:
            equations: Equations with which nothing was computed yet.
            scheme: Scheme; its options are attributes.
        """
        part = equations.part
        self.scene = scene = whole_scene(equations.scene, part)
        self.parts: dict[str, str] = {}
        self._shown: dict[str, str] = {}
        self._bytes = CanonicalBytes(scene.bodies)
        self._add("scheme", type(scheme))
        for name, value in vars(scheme).items():
            self._add(f"option {name}", value)
        self._add_scene(scene)
        # the same on any number of ranks
        nodes = undivided(scene).nodes.__getitem__
        for k, contact in enumerate([*scene.contacts, *scene.impacts], start=1):
            self._add(f"contact {k}", contact.contents(nodes), contact.label)
        self._sums = len(self.parts)
        for name, value, shown in equations.contents() if part is None else ():
            self._add(name, value, shown)
        self._functions: dict[str, Callable[[float], Any]] = {}
        for name, shown, function in _functions(scene):
            self._functions[name], self._shown[name] = function, shown
        self._values = {name: hashlib.sha256() for name in self._functions}
        self._made = -1

    def _add(self, name: str, value: Any, shown: str = "") -> None:
        self.parts[name] = _brief(self._bytes.of(value))
        self._shown[name] = shown or name

    def _add_scene(self, scene: Scene) -> None:
        for name in ("gravity", "redundant", "matrix_terms"):
            self._add(name, getattr(scene, name))
        for k, body in enumerate(scene.bodies, start=1):
            for name, value in data_of_body(body):
                self._add(f"{name} of body {k}", value, f"{name} of {body.label}")
            self._add(
                f"drilling of body {k}", scene.has_drilling(body), f"drilling of {body.label}"
            )
        if scene.began.state is not None:
            for name, value in zip(
                ("frames", "velocities"), scene.began.state.arrays(scene.bodies), strict=True
            ):
                self._add(f"{name} at the start", value)
        for k, item in enumerate((*scene.joints, *scene.connections), start=1):
            for name, value in (
                ("constraint definitions", (type(item), item.size, item.definitions())),
                ("stiffness, damping and rest", item.spring),
                ("force law", item.fingerprint),
                ("activity", item.active),
                ("sliding", item.sliding_definition()),
                ("rolling", item.velocity_definitions()),
                ("bushing", item.bushing_definition()),
                ("tie", item.tie_definition()),
            ):
                self._add(f"{name} of connection {k}", value, f"{name} of {item.label}")
        for k, event in enumerate(scene.events, start=1):
            own = [type(action) for action in event.actions if isinstance(action, Action)]
            scaled = [factor for _, factor in event.scaled]
            labels = [c.label for c in event.switched]
            given = event.direction, event.repeated, own, labels, scaled
            self._add(f"event {k}", given, f"event {k} ({event.label})")
        for k, each in enumerate(scene.controllers, start=1):
            data = type(each), each.numbers, [type(actuator) for actuator in each.actuators]
            self._add(f"controller {k}", data, f"controller {k} ({each.label})")
        self._add("sensors", [each.name for each in scene.sensors])
        for kind in ("links", "loads", "clamps", "motions"):
            for k, item in enumerate(getattr(scene, kind), start=1):
                for name, value in attributes(item):
                    what = f"{name} of {kind[:-1]} {k}"
                    self._add(what, value, f"{what} ({type(item).__name__})")

    def values(self, ends: Array) -> dict[str, str]:
        """Digests of the values of all functions of time on steps with these ends."""
        made = len(ends) - 1
        both = np.empty(2 * made + 1)
        both[::2], both[1::2] = ends, 0.5 * (ends[:-1] + ends[1:])
        times = [float(time) for time in both[max(2 * self._made + 1, 0) :]]
        for name, function in self._functions.items():
            values = np.array([np.asarray(function(time), dtype=np.float64) for time in times])
            self._values[name].update(values.tobytes())
        self._made = made
        return {name: _DIGEST + digest.hexdigest() for name, digest in self._values.items()}

    def packed(self, ends: Array) -> npt.NDArray[np.uint8]:
        """The complete fingerprint after steps with these ends, for a checkpoint."""
        contents = {"parts": self.parts, "functions": self.values(ends)}
        return np.frombuffer(json.dumps(contents).encode(), dtype=np.uint8)

    def differences(self, packed: npt.NDArray[np.uint8], ends: Array) -> list[str]:
        """Names of the parts that differ from a fingerprint packed after the same steps."""
        stored = json.loads(packed.tobytes().decode())
        sums = list(self.parts)[self._sums :]
        given = self.parts
        if not any(name in stored["parts"] for name in sums):  # it was divided then
            given = {name: text for name, text in given.items() if name not in sums}
        found = self._compared(stored["parts"], given)
        named = {name: text for name, text in found.items() if name not in sums}
        made = self.values(ends)
        for name, text in self._compared(stored["functions"], made).items():
            named[name] = f"{text}, up to time {ends[-1]:g}"
        return list((named or found).values())

    def _compared(self, stored: Mapping[str, str], given: Mapping[str, str]) -> dict[str, str]:
        """The differing parts, with both texts if these are short."""
        found = {}
        for name in dict.fromkeys([*stored, *given]):
            was, now = stored.get(name, "nothing"), given.get(name, "nothing")
            if was != now:
                shown = self._shown.get(name, name)
                brief = not (was.startswith(_DIGEST) or now.startswith(_DIGEST))
                found[name] = f"{shown} ({now}, was {was})" if brief else shown
        return found


def _functions(scene: Scene) -> Iterator[tuple[str, str, Callable[[float], Any]]]:
    """Name, label in errors, and value of each function of time."""
    for k, load in enumerate(scene.loads, start=1):
        if load.history is not None:
            name = f"history of load {k}"
            yield name, f"{name} ({type(load).__name__})", load.history
    for k, item in enumerate((*scene.joints, *scene.connections), start=1):
        if item.history is not None:
            yield f"function of connection {k}", f"function of {item.label}", item.history
    for k, motion in enumerate(scene.motions, start=1):
        yield f"motion {k}", f"motion {k}, of {motion.point.label}", motion.motion


def _brief(text: bytes) -> str:
    if len(text) <= _SHORT:
        return text.decode()
    return _DIGEST + hashlib.sha256(text).hexdigest()[:32]

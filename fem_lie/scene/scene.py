"""A scene: bodies, joints, loads and supports in the order in which they were added, with names."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, choice, instance, shown, vector
from fem_lie._summary import Summarised
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.bodies.initial_state import InitialState
from fem_lie.bodies.model import Holds
from fem_lie.contact.contact import Contact
from fem_lie.events.controller import ContinuousController, Controller
from fem_lie.events.event import Event
from fem_lie.events.sensor import Sensor
from fem_lie.joints.connection import Connection
from fem_lie.joints.joint import Joint, RedundantConstraints
from fem_lie.joints.rigid_link import RigidLink
from fem_lie.joints.springs import Drive
from fem_lie.pictures.bodies import draw
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.ranks.together import end_together
from fem_lie.scene.held_rotations import Holding, held_by, held_in
from fem_lie.scene.load import Load
from fem_lie.scene.matrix_terms import MatrixTerms
from fem_lie.scene.supports import Clamp, PrescribedMotion

Item = TypeVar(
    "Item",
    bound=Body
    | Connection
    | RigidLink
    | Contact
    | Load
    | Clamp
    | PrescribedMotion
    | Event
    | Sensor
    | Controller
    | ContinuousController,
)


class Family:
    """Scenes that share bodies, joints and supports, and so their setup.

    Attributes:
        setup: Node numbering and assembled forms shared by the family; ``None`` until a solver
            makes them.
    """

    def __init__(self) -> None:
        """Start without a shared setup."""
        self.setup: Any = None


class Began(NamedTuple):
    """Time and state from which runs of the scene start, not zero if it continues a result.

    Attributes:
        time: Scene time at which runs start; histories are evaluated from this time on.
        factor: Load factor of the equilibrium in which the bodies are.
        turned: Joint history variables that frames do not determine, such as full turns; default:
            those of the initial configuration.
        state: State of the bodies, instead of their own; default: theirs.
    """

    time: float = 0.0
    factor: float = 0.0
    turned: Array | None = None
    state: InitialState | None = None


def require_scene(value: object) -> None:
    """Raise ``TypeError`` if ``value`` is not a :class:`Scene`."""
    instance(value, Scene, "what is solved", "a Scene")


class Scene(Summarised):
    """A multibody system: bodies, joints, contacts, loads and supports.

    Attributes:
        matrix_terms: Terms of the iteration matrix that the user forces in or out.
        redundant: Treatment of redundant constraints.
        bodies: All bodies. This list and the following ones are in the order of addition.
        joints: Joints, without rigid links.
        connections: Springs, drives and gears.
        links: Rigid links.
        contacts: Contacts.
        impacts: Those contacts that :meth:`without_impacts` took out of ``contacts``.
        loads: Loads, without gravity.
        clamps: Clamped points.
        motions: Points with a prescribed motion.
        events: Events of runs.
        sensors: Sensors of runs.
        controllers: Controllers of runs.
        initial_factors: Factors at the start of loads, springs and force laws that events scale;
            ``None`` where no event says it.
        switched_by_events: Connections that events switch.
        began: Time and state from which runs start; :func:`~fem_lie.adaptivity.transfer` sets it.
        family: Family of scenes made by :meth:`with_loads` and :meth:`with_drives`, or ``None``.

    Example:
        >>> wheel = fl.Scene(gravity=(0, 0, -9.81)).add(fl.RigidBody(2.0, (0.1, 0.1, 0.2)))
    """

    def __init__(
        self,
        gravity: npt.ArrayLike = (0.0, 0.0, 0.0),
        *,
        matrix_terms: MatrixTerms | None = None,
        redundant: RedundantConstraints = RedundantConstraints.REFUSE,
    ) -> None:
        """Start empty.

        Args:
            gravity: Acceleration of free fall, global components.
            matrix_terms: Terms of the iteration matrix that are forced in or out; default: none.
            redundant: Treatment of redundant constraints.
        """
        end_together()
        self._gravity = vector(gravity, 3, "gravity")
        instance(matrix_terms, MatrixTerms | None, "Scene: matrix_terms", "MatrixTerms or None")
        self.matrix_terms = MatrixTerms() if matrix_terms is None else matrix_terms
        self.redundant = choice(redundant, RedundantConstraints, "Scene: redundant")
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self.connections: list[Connection] = []
        self.links: list[RigidLink] = []
        self.contacts: list[Contact] = []
        self.impacts: list[Contact] = []
        self.loads: list[Load] = []
        self.clamps: list[Clamp] = []
        self.motions: list[PrescribedMotion] = []
        self.events: list[Event] = []
        self.sensors: list[Sensor] = []
        self.controllers: list[Controller | ContinuousController] = []
        self.initial_factors: dict[Any, float | None] = {}
        self.switched_by_events: list[Connection] = []
        self._known: set[Body] = set()
        self._names: set[str] = set()
        self._kinds: Counter[type[Body]] = Counter()
        self.began = Began()
        self.family: Family | None = None

    def _summary(self) -> Iterator[tuple[str, object]]:
        """What the scene holds, by numbers."""
        yield "gravity", self._gravity
        yield "bodies", [body.label for body in self.bodies]
        between = "joints", "connections", "links", "contacts"
        counted = (*between, "loads", "clamps", "motions", "events", "sensors", "controllers")
        yield from ((name, len(getattr(self, name))) for name in counted if getattr(self, name))

    @property
    def gravity(self) -> Array:
        """Acceleration of free fall, global components, shape (3,)."""
        return self._gravity

    @gravity.setter
    def gravity(self, value: npt.ArrayLike) -> None:
        self._gravity = vector(value, 3, "gravity")

    def add(self, item: Item) -> Item:
        """Add a body, joint, spring, link, contact, load, support, event and so on; return it.

        Args:
            item: A body, joint, spring, drive, gear, link, contact, load, support, event, sensor or
                controller.

        Raises:
            ValueError: The item is invalid, refers to a body that is not in the scene, or its name
                is taken.
            TypeError: The item is of no such type.
        """
        if isinstance(item, Body):
            self._add_body(item)
        elif isinstance(item, Connection):
            item.check()
            self._check_points(item.label, *item.bodies)
            self._check_coordinates(item)
            self._check_friction(item)
            self._check_rotations(item)
            if isinstance(item, Joint):
                self.joints.append(item)
            else:
                self.connections.append(item)
        elif isinstance(item, RigidLink):
            item.check()
            self._check_points(item.label, item.a.body, item.b.body)
            self._check_frames(item.label, item.a.body, item.b.body)
            self._check_rotations(item)
            self.links.append(item)
        elif isinstance(item, Contact):
            self._check_points(item.label, *item.bodies)
            item.check()
            self._check_rotations(item)
            self.contacts.append(item)
        elif isinstance(item, Load):
            item.check()
            self._check_points(type(item).__name__, item.body)
            self._check_rotations(item)
            self.loads.append(item)
        elif isinstance(item, Clamp | PrescribedMotion):
            item.check()
            self._check_points(type(item).__name__, item.point.body)
            if isinstance(item, PrescribedMotion) and item.point.attachment is None:
                self._check_frames(f"a prescribed motion of {item.point.label}", item.point.body)
            self._check_rotations(item)
            supports: list = self.clamps if isinstance(item, Clamp) else self.motions
            supports.append(item)
        elif isinstance(item, Event):
            for connection in item.switched:
                if connection not in (*self.joints, *self.connections):
                    raise ValueError(
                        f"{item.label} switches {connection.label}, which is not in the scene; add "
                        "it first"
                    )
            self._check_scaled(item.label, *(each for each, _ in item.scaled))
            for each, start in item.scaled:
                known = self.initial_factors.setdefault(each, start)
                if known is None:
                    self.initial_factors[each] = start
                elif start is not None and start != known:
                    raise ValueError(
                        f"{item.label}: expected the initial factor {known:g}, as another event "
                        f"says, got {start:g}"
                    )
            self.switched_by_events += item.switched
            self.events.append(item)
        elif isinstance(item, Controller | ContinuousController):
            self._check_scaled(item.label, *item.actuators)
            for other in self.controllers:
                if twice := [each for each in item.actuators if each in other.actuators]:
                    what = getattr(twice[0], "label", type(twice[0]).__name__)
                    raise ValueError(f"{item.label}: {other.label} controls {what} already")
            self.controllers.append(item)
        elif isinstance(item, Sensor):
            if item.name in (each.name for each in self.sensors):
                raise ValueError(f"the scene has a sensor named {item.name!r} already")
            self.sensors.append(item)
        else:
            raise TypeError(
                "a scene takes bodies, joints, links, contacts, loads, supports, events, sensors, "
                "controllers, got "
                f"{shown(item)}"
            )
        return item

    def items(self) -> Iterator[tuple[Any, Sequence[Body | None]]]:
        """All items but bodies, with the bodies on which they act; ``None`` is ground.

        Links come first, for joints on what they join.
        """
        yield from ((link, [link.a.body, link.b.body]) for link in self.links)
        yield from ((item, item.bodies) for item in (*self.joints, *self.connections))
        yield from ((contact, contact.bodies) for contact in self.contacts)
        yield from ((load, (load.body,)) for load in self.loads)
        yield from ((clamp, (clamp.point.body,)) for clamp in self.clamps)
        yield from ((motion, (motion.point.body,)) for motion in self.motions)

    def held_rotations(self) -> Holds:
        """Items that act on the rotations of nodes, for each body."""
        between: list[Holding] = [*self.joints, *self.connections, *self.links]
        touching = [*self.contacts, *self.impacts]
        return held_in([*between, *touching, *self.loads, *self.motions])

    def has_drilling(self, body: Body) -> bool:
        """Whether the nodes of a body have a drilling rotation in this scene.

        For a shell: whether its nodes have drilling rotations here.

        Args:
            body: A body of the scene.

        Raises:
            ValueError: The body is not in the scene.
        """
        self._check_points("has_drilling", body)
        return body.model.has_drilling(self.held_rotations().get(body.model, ()))

    def with_loads(self, *loads: Load, gravity: npt.ArrayLike | None = None) -> Scene:
        """Copy of the scene with other loads, for parameter sweeps; it reuses the setup.

        Bodies, joints, springs, supports and motions are those of this scene. All scenes of the
        family share the node numbering, the assembled forms of the elements and their inertia;
        results are bitwise equal to those of a scene built from the start. Do not change the bodies
        between the runs: the setup would be made again.

        Args:
            loads: All loads of the new scene; those of this one are left out.
            gravity: Acceleration of free fall, global components; default: that of this scene.

        Raises:
            ValueError: A load is invalid, or acts on a body that is not in the scene.
        """
        scene = self._copy(self.connections)
        if gravity is not None:
            scene.gravity = vector(gravity, 3, "gravity")
        for load in loads:
            instance(load, Load, "Scene.with_loads", "a load")
            scene.add(load)
        return scene

    def with_drives(self, functions: Mapping[Drive, Callable[[float], float] | None]) -> Scene:
        """Copy of the scene with other functions of drives, see :meth:`with_loads`.

        Loads are those of this scene.

        Args:
            functions: The new function of each drive that changes. Results accept the old drive as
                a key.

        Raises:
            ValueError: A drive is not in the scene, or its function does not start at the value of
                the coordinate.
        """
        strange = [drive for drive in functions if drive not in self.connections]
        if strange:
            raise ValueError(f"{strange[0].label} is not in the scene; add it first")
        changed = [
            replace(item, function=functions[item])
            if isinstance(item, Drive) and item in functions
            else item
            for item in self.connections
        ]
        for item in changed:
            item.check()
        scene = self._copy(changed)
        scene.loads = list(self.loads)
        return scene

    def _copy(self, connections: Sequence[Connection]) -> Scene:
        """Copy without loads that shares the setup."""
        scene = Scene(self.gravity, matrix_terms=self.matrix_terms, redundant=self.redundant)
        scene.bodies, scene.joints = list(self.bodies), list(self.joints)
        scene._known, scene._names = set(self._known), set(self._names)
        scene._kinds = Counter(self._kinds)
        scene.connections, scene.links = list(connections), list(self.links)
        scene.contacts, scene.impacts = list(self.contacts), list(self.impacts)
        scene.clamps, scene.motions = list(self.clamps), list(self.motions)
        scene.events, scene.sensors = list(self.events), list(self.sensors)
        scene.controllers = list(self.controllers)
        scene.initial_factors = dict(self.initial_factors)
        scene.switched_by_events = list(self.switched_by_events)
        scene.began = self.began
        self.family = self.family or Family()
        scene.family = self.family
        return scene

    @property
    def switched(self) -> list[Connection]:
        """Connections that are inactive at the start, or that events switch."""
        of_all = (*self.joints, *self.connections)
        return [each for each in of_all if not each.active or each in self.switched_by_events]

    @property
    def happens(self) -> bool:
        """Whether runs have events, sensors, controllers, or limits with impacts."""
        limited = any(item.bounds is not None for item in self.connections)
        return bool(self.events or self.sensors or self.controllers) or limited

    @property
    def scaled(self) -> dict[Load | Connection, float]:
        """Loads, springs and force laws with factors, and these at the start."""
        by_controllers = {item: 1.0 for each in self.controllers for item in each.actuators}
        by_events = self.initial_factors.items()
        return by_controllers | {k: 1.0 if start is None else start for k, start in by_events}

    def without_impacts(self) -> Scene:
        """Copy of the scene without contacts by impacts, which act at ends of steps only.

        Nodes of shells keep their drilling rotations as in this scene.
        """
        if not any(each.law.impulsive for each in self.contacts):
            return self
        scene = self._copy(self.connections)
        scene.loads = list(self.loads)
        scene.contacts = [each for each in self.contacts if not each.law.impulsive]
        scene.impacts = [each for each in self.contacts if each.law.impulsive]
        return scene

    def picture(
        self,
        path: str | os.PathLike[str],
        *,
        frames: bool = False,
        title: str = "",
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw the bodies in the initial configuration.

        Args:
            path: Name of the ``.png`` file.
            frames: Whether to draw the nodal frames.
            title: Title of the picture.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).

        Raises:
            ValueError: The scene has no body, or the name does not end in ``.png``.
        """
        if not self.bodies:
            raise ValueError("the scene has no body")
        nodes = np.concatenate([body.frames for body in self.bodies])
        draw(
            SceneInfo.of(self.bodies),
            nodes,
            path,
            triads=frames,
            canvas=Canvas(title, units, view=view),
        )

    def _add_body(self, body: Body) -> None:
        if body in self._known:
            raise ValueError(f"{body.label} is in the scene already")
        number = 1 + self._kinds[type(body)]
        body.name = body.name or f"{type(body).__name__.lower()} {number}"
        if body.name in self._names:
            raise ValueError(f"the scene has a body named {body.name!r} already")
        self._known.add(body)
        self._names.add(body.name)
        self._kinds[type(body)] = number
        self.bodies.append(body)

    def _check_points(self, what: str, *bodies: Body | None) -> None:
        for body in bodies:
            if body is not None and body not in self._known:
                raise ValueError(f"{what}: {body.label} is not in the scene; add it first")

    def _check_scaled(self, what: str, *items: object) -> None:
        for item in items:
            if not (isinstance(item, Load) or (isinstance(item, Connection) and item.spring)):
                raise TypeError(
                    f"{what}: expected a load, spring or force law to scale, got {shown(item)}"
                )
            if item not in (*self.loads, *self.connections):
                name = item.label if isinstance(item, Connection) else type(item).__name__
                raise ValueError(f"{what} scales {name}, which is not in the scene; add it first")

    def _check_frames(self, what: str, *bodies: Body | None) -> None:
        for body in bodies:
            if body is not None:
                body.model.require_frames(what)

    def _check_coordinates(self, item: Connection) -> None:
        """Refuse a spring, drive or gear whose joint is not in the scene."""
        if isinstance(item, Joint):
            return
        for coordinate in item.coordinates():
            if coordinate.binds and coordinate.joint not in self.joints:
                raise ValueError(
                    f"{item.label} acts along the {coordinate.label}, which is not in the scene; "
                    "add the joint first"
                )

    def _check_friction(self, item: Connection) -> None:
        """Refuse a second friction of a joint, whose forces would add up."""
        if item.friction is None:
            return
        for other in self.connections:
            if other.friction is not None and other.friction.joint is item.friction.joint:
                raise ValueError(
                    f"{item.label}: {item.friction.joint.label} has friction already, by "
                    f"{other.label}"
                )

    def _check_rotations(self, item: Holding) -> None:
        for body, hold in held_by(item):
            body.model.has_drilling([hold])


def started(scene: Scene, state: InitialState) -> Scene:
    """The scene with its items, whose runs and statics start from a state of its bodies.

    Args:
        scene: The scene, which does not change.
        state: The state.
    """
    found = copy(scene)
    found.began = scene.began._replace(state=state)
    # the shared setup is one of bodies that start from their own frames
    found.family = None
    return found

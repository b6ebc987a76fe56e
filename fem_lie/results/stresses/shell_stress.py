"""Stress resultants of a shell at given frames: integration points, and components by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import basix
import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices, vector
from fem_lie._form_cache import compile_expression
from fem_lie.bodies.shells.model import ShellModel
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.pictures.stage import Units
from fem_lie.results.stresses.fields import check_name
from fem_lie.results.stresses.nodal_values import (
    CellPoints,
    SharedValues,
    axes_along,
    shared_values,
    unit,
)

COMPONENTS = ("N11", "N22", "N12", "M11", "M22", "M12", "Q1", "Q2")


@dataclass(frozen=True)
class Quantity:
    """A scalar function of the eight components.

    Attributes:
        name: Name of the quantity.
        of: Function from components (..., 8) and thickness (...) to values (...).
        unit: Its unit in the user's units.
        directional: Whether it depends on the axes.
        layer: Whether it assumes a homogeneous layer.
    """

    name: str
    of: Callable[[Array, Array], Array]
    unit: Callable[[Units], str]
    directional: bool = False
    layer: bool = False


def _per_length(units: Units) -> str:
    return f"{units.force}/{units.length}"


def _moment_per_length(units: Units) -> str:
    return f"{units.force} {units.length}/{units.length}"


def _per_area(units: Units) -> str:
    return f"{units.force}/{units.length}²"


def _component(i: int) -> Quantity:
    unit = _moment_per_length if 3 <= i < 6 else _per_length
    return Quantity(COMPONENTS[i], lambda values, t: values[..., i], unit, directional=True)


def _principal(name: str, start: int, which: int) -> Quantity:
    def of(values: Array, thickness: Array) -> Array:
        return principal(values[..., start : start + 3])[which]

    return Quantity(name, of, _moment_per_length if start else _per_length)


def _outer(name: str, side: float) -> Quantity:
    def of(values: Array, thickness: Array) -> Array:
        t = thickness[..., np.newaxis]
        return plane_von_mises(values[..., :3] / t + side * 6.0 * values[..., 3:6] / t**2)

    return Quantity(name, of, _per_area, layer=True)


_ALL = (
    *(_component(i) for i in range(8)),
    _principal("N max", 0, 0),
    _principal("N min", 0, 1),
    _principal("M max", 3, 0),
    _principal("M min", 3, 1),
    Quantity("Q", lambda values, t: np.hypot(values[..., 6], values[..., 7]), _per_length),
    _outer("von Mises top", 1.0),
    _outer("von Mises bottom", -1.0),
)
QUANTITIES = {each.name: each for each in _ALL}


def names_of(shell: Shell | ThinShell, among: Iterable[str] = tuple(QUANTITIES)) -> tuple[str, ...]:
    """Names of the quantities that the sections of a shell have."""
    every = _homogeneous(shell.model.stiffness, shell.model.thickness)
    return tuple(name for name in among if every or not QUANTITIES[name].layer)


def quantity(name: str, names: Sequence[str], shell: Shell | ThinShell) -> Quantity:
    """The quantity of a name.

    Args:
        name: The name.
        names: Those that the shell has.
        shell: The shell, for messages.

    Raises:
        ValueError: The shell does not have it; the message lists all.
    """
    if name not in names and name in QUANTITIES and QUANTITIES[name].layer:
        raise ValueError(
            f"{name!r} is the stress in a homogeneous layer, got a layered section of {shell.label}"
        )
    check_name(name, names, shell.label)
    return QUANTITIES[name]


def _homogeneous(stiffness: Array, thickness: Array) -> bool:
    """Whether stress is linear over the thickness in all cells.

    Args:
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        thickness: Thickness of each cell, shape (m,).
    """
    D, t = stiffness, thickness[:, np.newaxis, np.newaxis]
    A, B, bending = D[:, :3, :3], D[:, :3, 3:6], D[:, 3:6, 3:6]
    error = np.maximum(np.abs(B / t), np.abs(12 * bending / t**2 - A)).max(axis=(1, 2))
    return bool((error <= 1e-9 * np.abs(A).max(axis=(1, 2))).all())


def rotated(values: Array, cosine: Array, sine: Array) -> Array:
    """Components along ``e₁' = c e₁ + s e₂`` and ``e₂' = −s e₁ + c e₂``.

    Args:
        values: Shape (..., 8).
        cosine: ``c``, shape (...).
        sine: ``s``, shape (...).
    """
    c, s = cosine, sine
    Q1, Q2 = values[..., 6], values[..., 7]
    out = np.empty(np.broadcast_shapes(values.shape, (*np.shape(c), 8)))
    for start in (0, 3):
        T11, T22, T12 = np.moveaxis(values[..., start : start + 3], -1, 0)
        out[..., start] = c * c * T11 + s * s * T22 + 2 * c * s * T12
        out[..., start + 1] = s * s * T11 + c * c * T22 - 2 * c * s * T12
        out[..., start + 2] = c * s * (T22 - T11) + (c * c - s * s) * T12
    out[..., 6], out[..., 7] = c * Q1 + s * Q2, c * Q2 - s * Q1
    return out


def principal(tensor: Array) -> tuple[Array, Array]:
    """Larger and smaller principal value of ``(T₁₁, T₂₂, T₁₂)``, shape (..., 3)."""
    T11, T22, T12 = np.moveaxis(tensor, -1, 0)
    mean, half = 0.5 * (T11 + T22), 0.5 * (T11 - T22)
    radius = np.hypot(half, T12)
    return mean + radius, mean - radius


def plane_von_mises(stress: Array) -> Array:
    """Von Mises stress of a plane stress ``(σ₁₁, σ₂₂, σ₁₂)``, shape (..., 3)."""
    a, b, c = np.moveaxis(stress, -1, 0)
    return np.asarray(np.sqrt(a * a - a * b + b * b + 3 * c * c))


Along = npt.ArrayLike | Callable[[Array], npt.ArrayLike]

_SECTION_JUMP = 0.2  # relative change of the stiffness above which values are not averaged
_CONVERGED = 1e-9
_MOST_ROUNDS = 25


class ShellStress:
    """Stress resultants at the integration points, in the axes of the sections.

    Attributes:
        compliance: Inverse of the stiffness of each cell, shape (m, 8, 8).
    """

    @classmethod
    def of(cls, shell: Shell) -> ShellStress:
        """The object of a shell, whose forms are compiled once."""
        if shell not in _STRESSES:
            _STRESSES[shell] = cls(shell)
        return _STRESSES[shell]

    def __init__(self, shell: Shell) -> None:
        self._assembly = ShellModel.assemble([shell.model])
        rule = integration(shell)[0]
        self._unloaded = self._assembly.linearised_values.copy()
        self._expression = compile_expression(self._assembly.stress, rule)
        self._shape = len(shell.model.cut_mesh.cells), len(rule), 8
        # one scale for forces and moments: square roots of energy
        diagonals = np.diagonal(shell.model.stiffness, axis1=-2, axis2=-1)
        self._scale = 1.0 / np.sqrt(diagonals)[:, np.newaxis]
        self._noise = 1e-12 * float((1.0 / self._scale[..., :3]).max())
        self.compliance = np.asarray(np.linalg.inv(shell.model.stiffness), dtype=np.float64)

    def __call__(self, frames: Array, strains: Array | None = None) -> Array:
        """Stress resultants at frames, shape (m, g, 8).

        Args:
            frames: Frames of the nodes, shape (n, 4, 3).
            strains: Stress-free strain of each cell, shape (m, 8); default: none.
        """
        assembly = self._assembly
        assembly.set_eigenstrain(np.zeros((len(assembly.cells), 8)) if strains is None else strains)
        H = np.empty_like(frames)
        H[assembly.order] = frames
        # so that a state has bitwise the same values whatever was evaluated before
        assembly.restore(self._unloaded)
        assembly.reset_stress(H)
        found = self._updated_stress()
        if assembly.local is None:
            return found
        for _ in range(_MOST_ROUNDS):
            assembly.reset_stress(H)
            before, found = found, self._updated_stress()
            change = np.abs(self._scale * (found - before)).max()
            if change <= _CONVERGED * np.abs(self._scale * found).max() + self._noise:
                return found
        raise RuntimeError(
            f"the stress fields of the cells did not converge in {_MOST_ROUNDS} rounds: the last "
            f"change is {change:.2e} of {np.abs(self._scale * found).max():.2e}"
        )

    def _updated_stress(self) -> Array:
        mesh, cells = self._assembly.mesh, self._assembly.cell_order.astype(np.int32)
        values = self._expression.eval(mesh, cells)
        return np.asarray(values, dtype=np.float64).reshape(self._shape)


_STRESSES: WeakKeyDictionary[Shell, ShellStress] = WeakKeyDictionary()


def integration(shell: Shell) -> tuple[Array, Array]:
    """Reference coordinates (g, 2) and weights (g,) of the integration points."""
    mesh = shell.model.cut_mesh
    degree = shell.model.formulation.measures_for(mesh.cell, mesh.degree).quadrature_degree
    points, weights = basix.make_quadrature(basix.CellType[mesh.cell], degree)
    return np.asarray(points, dtype=np.float64), np.asarray(weights, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class StressPoints:
    """Points at which stress resultants are evaluated, with undeformed axes.

    Attributes:
        points: The integration points.
        areas: Integration weights (areas), shape (m, g).
        section: Axes of the sections at these points, shape (m, g, 3, 3).
        asked: Requested axes at these points, shape (m, g, 3, 3).
        section_at_nodes: Axes of the sections at the nodes of the cells, shape (m, k, 3, 3).
        asked_at_nodes: Requested axes at the nodes, shape (m, k, 3, 3).
        patches: Groups of cell nodes that share a value.
        shared: Axes of these values, shape (p, 3, 3).
        jump: Largest angle, rad, at the nodes between ``asked_at_nodes`` and ``shared``.
    """

    points: CellPoints
    areas: Array
    section: Array
    asked: Array
    section_at_nodes: Array
    asked_at_nodes: Array
    patches: SharedValues
    shared: Array
    jump: float

    @classmethod
    def in_sections(cls, shell: Shell, kink_angle: float) -> StressPoints:
        """The points with the axes of the sections, computed once."""
        kept = _POINTS.setdefault(shell, {})
        if kink_angle not in kept:
            kept[kink_angle] = cls.of(shell, None, kink_angle)
        return kept[kink_angle]

    @classmethod
    def of(cls, shell: Shell, along: Along | None, kink_angle: float) -> StressPoints:
        """The points with requested axes.

        Args:
            shell: The shell.
            along: e₁ of the requested axes, see
                :func:`fem_lie.results.stresses.shell_resultants.resultants`.
            kink_angle: Largest angle, rad, between cells that share values.
        """
        mesh, (rule, weights) = shell.model.cut_mesh, integration(shell)
        points, x = CellPoints.of(mesh, rule), mesh.points[mesh.cells]
        across = np.cross(*np.moveaxis(points.tangents(x), 2, 0))
        given = shell.model.axes[:, np.newaxis]
        section = axes_along(unit(across), given)
        at_nodes = axes_along(mesh.normals, given)
        groups = shared_values(mesh, _smooth(shell, kink_angle))
        normals = unit(groups.mean(mesh.normals))
        if along is None:
            asked, asked_at_nodes = section, at_nodes
            shared = axes_along(normals, mean_direction(groups, normals, at_nodes[:, :, 0]))
        else:
            asked = axes_along(unit(across), _directions(along, points.positions(x)))
            nodal = _directions(along, mesh.points)
            asked_at_nodes = axes_along(mesh.normals, nodal[mesh.cells])
            shared = axes_along(normals, nodal[groups.node])
        cosine, sine = between(asked_at_nodes, shared[groups.number])
        return cls(
            points,
            weights * np.linalg.norm(across, axis=-1),
            section,
            asked,
            at_nodes,
            asked_at_nodes,
            groups,
            shared,
            float(np.abs(np.arctan2(sine, cosine)).max()),
        )


_POINTS: WeakKeyDictionary[Shell, dict[float, StressPoints]] = WeakKeyDictionary()


def between(old: Array, new: Array) -> tuple[Array, Array]:
    """Cosine and sine of the angle from e₁ of one triad to e₁ of another, all (..., 3, 3)."""
    c, s = np.einsum("...ij,...j->i...", old[..., :2, :], new[..., 0, :])
    size = np.hypot(c, s)
    return c / size, s / size


def in_axes(values: Array, old: Array, new: Array) -> Array:
    """Components (..., 8) along the triads ``new`` from those along ``old``, (..., 3, 3)."""
    return values if old is new else rotated(values, *between(old, new))


def _directions(along: Along, positions: Array) -> Array:
    """The user's direction at positions (..., 3)."""
    if not callable(along):
        return np.broadcast_to(vector(along, 3, "along"), positions.shape)
    flat = positions.reshape(-1, 3)
    found = [vector(along(position), 3, f"along at {position}") for position in flat]
    return np.reshape(found, positions.shape)


def mean_direction(groups: SharedValues, normals: Array, directions: Array) -> Array:
    """Mean of unit vectors over groups, normal to the mean normal; one of them if they cancel."""
    mean = groups.mean(directions)
    mean -= np.einsum("pj,pj->p", mean, normals)[:, np.newaxis] * normals
    _, first = np.unique(groups.number, return_index=True)
    weak = np.linalg.norm(mean, axis=1) < 0.1
    mean[weak] = directions.reshape(-1, 3)[first[weak]]
    return mean


def _smooth(shell: Shell, kink_angle: float) -> Callable[..., Flags]:
    """Function that says whether normals and sections of two cells are nearly equal at a node."""
    normals, D = shell.model.cut_mesh.normals, shell.model.stiffness
    A, bending = D[:, :3, :3], D[:, 3:6, 3:6]

    def jumps(part: Array, a: Indices, b: Indices) -> Flags:
        size = np.linalg.norm(part, axis=(1, 2))
        change = np.linalg.norm(part[a] - part[b], axis=(1, 2))
        return np.asarray(change > _SECTION_JUMP * np.maximum(size[a], size[b]))

    def smooth(a: Indices, b: Indices, i: Indices, j: Indices) -> Flags:
        cosine = np.einsum("pj,pj->p", normals[a, i], normals[b, j])
        flat = cosine >= np.cos(kink_angle)
        return np.asarray(flat & ~jumps(A, a, b) & ~jumps(bending, a, b))

    return smooth

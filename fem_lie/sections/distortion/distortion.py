"""Sections that deform in few modes: stiffness and fields for beams.

The displacement of a point of the section, in the axes of the beam, is ``Σ a_k φ_k(y, z)`` with
amplitudes ``a_k`` along the beam. Fields ``φ`` are displacements in the plane of the section, and
axial ones: warping by torsion and by distortion. They are orthogonal in mass to each other and to
rigid motions of the section, and their mean square is one. All other displacements of the section
are in equilibrium with the strains ``s = (Γ, κ, a′, a)`` and have been eliminated, so that the
energy per length is ``½ s·K s``, with the stiffness of the beam if the amplitudes are free.

Of third order is the work of the axial stress ``σ(s)`` in axial strains of second order::

    ∫ σ(s) [κ₂ u_z − κ₃ u_y + ½ (Γ₂ + u′_y − κ₁ z)² + ½ (Γ₃ + u′_z + κ₁ y)²] dA,    u = Σ a φ.

The first two are the change of the moments of inertia by distortion (L. G. Brazier, Proc. R. Soc.
A 116 (1927) 104), the squares the slopes of fibres against the axis, by which axial stress makes
walls buckle, and the whole section by torsion.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, instance, vector
from fem_lie.sections.distortion.fields import Relaxation, SectionFields, flat
from fem_lie.sections.distortion.modes import modes_of, orthonormal, warping_of
from fem_lie.sections.material import Material
from fem_lie.sections.section import Section
from fem_lie.sections.section_mesh import SectionMesh
from fem_lie.sections.warping import Warping, materials_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AXIS = 6
"""Number of strains (Γ, κ) of the axis, the first ones."""

_WARPS = 1e-3  # mean square warping function over the fourth power of the radius of gyration
_OUTSIDE = 0.6  # largest distance of a point from the nearest node, in lengths of an edge


class Distortion:
    """Section that distorts and warps, for a :class:`~fem_lie.reduction.DistortingBeam`.

    The modes are the slowest vibrations of the section in its plane. Each has a displacement in the
    plane and the axial displacement that goes with it; warping by torsion is added if there is any.
    Distortion of thin-walled sections extends along the beam by more than their size. Where decay
    lengths are smaller, as in solid sections, nothing is gained over a beam.

    Attributes:
        section: Section of a beam of the same stiffness if amplitudes are free and do not change
            along it; its shear stiffness is that by energy.
        frequencies: Frequency of each mode in a section that deforms alike all along the beam,
            shape (modes,), 1/time; not a number in a section without mass. Waves of a mode travel
            along the beam above its frequency.
        decay_lengths: Length ℓ of each mode: static amplitudes are about ``exp(−s/ℓ) cos(s/ℓ)`` at
            a distance s from a distortional load, shape (modes,).
        stiffness: Stiffness on the strains (Γ, κ, a′, a), shape (6 + 2 n, 6 + 2 n).
        second_order: Factors of the strains in the stress conjugate to each of the products
            :func:`products_of_strains`, per length, shape (c, 6 + 2 n).
        points: Points of the section from its axis, shape (p, 2).
        cells: Points of each cell, shape (m, k).
        fields: Displacement (x, y, z) of the points for each amplitude: in the plane first, then
            along the axis, shape (n, p, 3).
        plane: Number of amplitudes in the plane.

    Raises:
        ValueError: A region has no material or a material no region; Poisson's ratio is 0.5; or
            there are fewer than one mode.

    Example:
        >>> box = fl.sections.SectionShape.box(0.4, 0.2, 0.004)
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> girder = fl.sections.Distortion(box.mesh, steel, modes=1)
        >>> bool(girder.decay_lengths[0] > 1.0)
        True
    """

    section: Section
    frequencies: Array
    decay_lengths: Array
    stiffness: Array
    second_order: Array
    points: Array
    cells: Indices
    fields: Array
    plane: int

    def __init__(
        self,
        mesh: SectionMesh,
        material: Material | Mapping[str, Material],
        modes: int = 1,
        at: npt.ArrayLike | None = None,
    ) -> None:
        """Solve for the modes and their stiffness.

        Args:
            mesh: Cells of the section, as of :attr:`~fem_lie.sections.SectionShape.mesh`.
            material: Material of all regions, or of each region by its name.
            modes: Number of modes.
            at: Point (y, z) of the axis in the coordinates of the mesh; default: the centroid.
        """
        instance(mesh, SectionMesh, "Distortion: mesh", "a SectionMesh, as shape.mesh")
        instance(modes, int | np.integer, "Distortion: modes", "a whole number")
        if modes < 1:
            raise ValueError(f"Distortion: modes must be at least 1, got {modes}")
        warping, materials = Warping(mesh, material), materials_of(mesh, material)
        if any(each.nu >= 0.5 for each in materials):
            raise ValueError("Distortion: Poisson's ratio must be less than 0.5")
        axis = vector(warping.properties.centroid if at is None else at, 2, "Distortion: at")
        size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
        # of unit size, so that units do not matter
        points = np.asarray((mesh.points - axis) / size, dtype=np.float64)
        fields = SectionFields.of(mesh, points, materials)
        relaxation = Relaxation(fields)
        found = modes_of(relaxation, int(modes))
        torsion = _torsional_warping(relaxation)
        parts = found.plane, np.concatenate([torsion, found.axial])
        plane, axial = (orthonormal(relaxation, each) for each in parts)
        φ, heavy = np.concatenate([plane, axial]), any(each.density for each in materials)
        self.fields, self.plane, self.cells = φ, len(plane), fields.cells
        self.points, self.decay_lengths = size * fields.points, size * found.lengths
        unit = 2.0 * np.pi * size if heavy else np.nan
        self.frequencies = np.sqrt(found.squares) / unit
        K, stress = _condensed(relaxation, φ)
        lengths = _lengths(len(φ), size)
        K *= size**2 * np.outer(lengths, lengths)
        self.stiffness = 0.5 * (K + K.T)
        both = lengths[products_of_strains(len(φ))].prod(axis=1)
        factors = _work_of_stress(fields, φ, stress)
        self.second_order = size**2 * both[:, np.newaxis] * factors * lengths
        self.section = replace(warping.section(at), stiffness=_free(self.stiffness))

    @property
    def count(self) -> int:
        """Number of amplitudes."""
        return len(self.fields)

    def displacement(self, y: float, z: float) -> Array:
        """Displacement (x, y, z) of a point of the section for each amplitude, shape (n, 3).

        Args:
            y: Coordinate along e₂ from the axis.
            z: Coordinate along e₃ from the axis.

        Raises:
            ValueError: The point is not in the section.
        """
        at = np.array([y, z], dtype=np.float64)
        away = np.linalg.norm(self.points - at, axis=1)
        near = int(away.argmin())
        around = np.unique(self.cells[(self.cells == near).any(axis=1)])
        offsets = self.points[around] - self.points[near]
        edge = float(np.linalg.norm(offsets, axis=1).max())
        if not away[near] <= _OUTSIDE * edge:
            raise ValueError(
                f"({y:g}, {z:g}) is not in the section: the nearest point is {self.points[near]}, "
                f"{away[near]:.3g} away"
            )
        # the plane through the values around it
        base = np.column_stack([np.ones(len(around)), offsets])
        values = self.fields[:, around].transpose(1, 0, 2).reshape(len(around), -1)
        fitted = np.linalg.lstsq(base, values, rcond=None)[0]
        found = self.fields[:, near].ravel() + (at - self.points[near]) @ fitted[1:]
        return np.asarray(found.reshape(-1, 3))

    def picture(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """Figure of the fields of all amplitudes, written to a file if one is given.

        Args:
            path: Name of the file; default: none is written.
        """
        from fem_lie.sections.distortion.picture import picture

        return picture(self, path)


def products_of_strains(count: int) -> Indices:
    """Both strains of each product in the axial strain of second order, shape (c, 2).

    Args:
        count: Number of amplitudes n; strains are (Γ, κ, a′, a).
    """
    rates = [1, 2, 3, *range(AXIS, AXIS + count)]
    bent = [(k, AXIS + count + a) for k in (4, 5) for a in range(count)]
    return np.array([*bent, *combinations_with_replacement(rates, 2)], dtype=np.int64)


def _torsional_warping(relaxation: Relaxation) -> Array:
    """Warping by torsion, shape (1, n, 3), or none if there is hardly any, (0, n, 3)."""
    fields = relaxation.fields
    found, area = warping_of(relaxation, fields.rigid[3:4]), fields.weights.sum()
    square = fields.weights @ fields.interpolated(found)[0, :, 0] ** 2
    polar = fields.weights @ (fields.at**2).sum(axis=1)
    return found[: int(square * area > _WARPS * polar**2)]


def _free(stiffness: Array) -> Array:
    """Stiffness on (Γ, κ) for amplitudes that are free and constant along the beam, (6, 6)."""
    count = (len(stiffness) - AXIS) // 2
    own = stiffness[:AXIS, -count:]
    return np.asarray(
        stiffness[:AXIS, :AXIS] - own @ np.linalg.solve(stiffness[-count:, -count:], own.T)
    )


def _lengths(count: int, size: float) -> Array:
    """Strains of the section of unit size per strain (Γ, κ, a′, a), shape (6 + 2 n,)."""
    rows = [np.ones(3), np.full(3, size), np.ones(count), np.full(count, 1.0 / size)]
    return np.concatenate(rows)


def _condensed(relaxation: Relaxation, φ: Array) -> tuple[Array, Array]:
    """Stiffness on (Γ, κ, a′, a), and the stress times weights of each of these strains.

    Displacements that are not in the span of φ, and rigid ones, relax each of them.
    """
    fields = relaxation.fields
    parts = fields.strains_of_axis(), fields.strains_of_rates(φ), fields.strains(φ)
    strains = np.concatenate(parts)
    linear = relaxation.weighted(fields.rigid[4:])
    constraints = np.concatenate([linear, (relaxation.stiffness @ flat(φ).T).T])
    constraints /= np.linalg.norm(constraints, axis=1, keepdims=True)
    relaxed = relaxation.constrained(-relaxation.forces(fields.stress(strains)), constraints)
    strains = strains + fields.strains(relaxed)
    stress = fields.stress(strains)
    return np.einsum("kqi,lqi->kl", strains, stress, optimize=True), stress


def _work_of_stress(fields: SectionFields, φ: Array, stress: Array) -> Array:
    """Work of the axial stress of each strain in :func:`products_of_strains`, (c, 6 + 2 n)."""
    count, u, (y, z) = len(φ), fields.interpolated(φ), fields.at.T
    bent = np.concatenate([u[..., 2], -u[..., 1]])
    # slopes of fibres across the axis by shear, twist, and rates of amplitudes
    one, none = np.ones_like(y), np.zeros_like(y)
    rigid = np.stack([[one, none], [none, one], [-z, y]]).swapaxes(1, 2)
    rates = np.concatenate([rigid, u[..., 1:]])
    pairs = list(combinations_with_replacement(range(3 + count), 2))
    factors = [0.5 if i == k else 1.0 for i, k in pairs]
    quadratic = [
        w * (rates[i] * rates[k]).sum(-1) for w, (i, k) in zip(factors, pairs, strict=True)
    ]
    return np.concatenate([bent, quadratic]) @ stress[..., 0].T

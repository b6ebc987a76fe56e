"""Kirchhoff rod: two nodes with frames, and a cubic whose end tangents are their first axes.

There is no shear: ``e₁`` of a node *is* the tangent there. With the unstretched length ``ℓ``, the
chord ``c`` and the tangents ``t``, all along the midpoint axes between the nodes, the axis is the
cubic with end derivatives ``m t_A`` and ``m t_B`` whose speed at the midpoint is the same::

    |3/2 c/ℓ − m (t_A + t_B)/4| = m,

so that the strain ``ε = m − 1`` is constant, and an inextensible rod can bend: the element does not
lock. (The family is that of Meier, Popp & Wall, *Arch. Comput. Methods Eng.* 26 (2019) 163; the
condition on the speeds replaces their unknown lengths.) For a spline, the ratios of the speeds are
those of the initial curve: derivatives by the parameter are ``m J_A t_A`` and ``m J_B t_B``, and
``m J`` at the midpoint; all strains are then per ``ds = J dξ``, and the unloaded rod is the spline.
Axes within the element are those of the geodesic rotation, with first axis ``D``, rotated onto the
tangent by the smallest rotation. Bending is given by the components of ``t′`` along them, and the
twist is::

    τ = θ₁/ℓ − (D × t)·(D′ + t′)/(1 + D·t)

All strains are functions of the relative motion ``log(H_A⁻¹ H_B)`` only, hence invariant under
superposed rigid motion; their unloaded values are subtracted. Bending is of fourth order. Torsion
that varies along an element, as when an already bent rod is bent further, is of second order, and
so is an axis off the tension centres that is curved or initially twisted.

Axial strain is that of the line of tension centres, where an axial force does not bend: at
``r = (0, r₂, r₃)`` from the axis the strains of a section are ``(Γ + κ × r, κ)``. Along any other
line axial strain would vary with the curvature, for which the element has one value along its
length, and shear with torsion, for which it has none: it would be too stiff in both. So the cubic
joins points that are fixed to the nodes at ``r_A`` and ``r_B``, which are the mean of ``r`` over
the unloaded element, parallel to each other there, so that the unloaded cubic is the initial line.
Zero shear of a section then refers to ``Γ + (κ − κ₀) × r``, also for twisted and curved rods.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial, sqrt
from typing import ClassVar, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.between_frames import on_geodesic
from fem_lie.elements.beams.centres import centres_at_ends, tension_centres
from fem_lie.elements.beams.element import BeamFormulation, CellData, cellwise, present_values
from fem_lie.elements.beams.geodesic import GEODESIC, smooth_inertia
from fem_lie.elements.rods.kirchhoff_forces import force_kernel
from fem_lie.forms.energy import Forces, StrainEnergy
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms

_TERMS = 9  # of the series below: 1e-14 up to a turn of π from end to end
_POINTS = 3  # degree to which two Gauss points are exact
_SHEAR = (1, 2)  # index in the section stiffness
_GAUSS = 0.5 / sqrt(3.0)
_FOLDS = 2.7  # rad: from end to end of an arc, beyond which its moment falls


class Speeds(NamedTuple):
    """Unstretched arc length per parameter, relative to that at the midpoint.

    Attributes:
        start: At the first end.
        end: At the second end.
        here: At the point of the strains.
    """

    start: Expr | float = 1.0
    end: Expr | float = 1.0
    here: Expr | float = 1.0


class LineOfCentres(NamedTuple):
    """Points that the cubic of each cell joins, as DG0 functions.

    Attributes:
        centre: Tension centre of the section from the axis, shape ``(3,)``.
        at_ends: Ends of the cubic in the frames of both nodes, shape ``(2, 3)``.
    """

    centre: fem.Function
    at_ends: fem.Function


@dataclass(frozen=True)
class KirchhoffRod(BeamFormulation):
    """Rod element without shear: cubic between two frames.

    The shear stiffness of the section is not used; the shear force follows from equilibrium. The
    section twists about its tension centre, which should be its shear centre as well. Joints at a
    point within an element act on the geodesic between its ends.
    """

    degree: ClassVar[int] = 1  # type: ignore[misc]
    bows: ClassVar[bool] = True

    @property
    def largest_turn(self) -> float:
        """Largest rotation along an element, rad: less than π.

        For a tighter arc the moment of the cubic decreases.
        """
        return _FOLDS

    def attachment_frame(self, nodes: Sequence[int], ξ: float) -> AttachmentFrame:
        """Attachment frame on the geodesic from end to end."""
        a, b = nodes
        return on_geodesic(int(a), int(b), ξ)

    def forms(self, nodal: NodalFrames, cells: CellData) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent."""
        mesh = nodal.function.function_space.mesh
        ends = nodal.frames[nodal.function.function_space.dofmap.list]
        d = cellwise(mesh, lie.se3_relative(ends[:, 0], ends[:, 1]))
        along = lengths_along(ends, cells.lengths, cells.slopes)
        length, stiffness = cellwise(mesh, along[:, 2]), cellwise(mesh, cells.stiffness)
        viscosity = None if cells.viscosity is None else cellwise(mesh, cells.viscosity)
        speeds = cellwise(mesh, along[:, [0, 4, 1, 3]] / along[:, 2:3])
        centre = cellwise(mesh, tension_centres(cells.stiffness))
        at_ends = cellwise(mesh, centres_at_ends(cells.stiffness, ends))
        axis = LineOfCentres(centre, at_ends)
        energy = rod_energy(d, length, stiffness, cells.eigenstrain, viscosity, speeds, axis)
        return LocalFrameForms(energy, nodal.function, nodal.increment, GEODESIC, coordinates=d)

    def inertia(self, nodal: NodalFrames, cells: CellData) -> Array:
        """Mass matrix of the geodesic beam with the same bending stiffness, without shear.

        Its axis is the line of tension centres, ``x + r₂ d₂ + r₃ d₃``.
        """
        ends = nodal.frames[nodal.function.function_space.dofmap.list]
        bend = lie.se3_relative(ends[:, 0], ends[:, 1])[:, 3:] / cells.lengths[:, np.newaxis]
        r = tension_centres(cells.stiffness)
        stiffness = cells.stiffness.copy()
        stiffness[:, _SHEAR, _SHEAR] = np.inf
        here = np.tile(np.eye(4), (len(r), 1, 1))
        here[:, 1:, 0] = -r
        density = here @ cells.density @ here.swapaxes(1, 2)
        slope = np.eye(1, 3) + np.cross(bend, r)
        G = smooth_inertia(density, stiffness, cells.lengths, slope)
        moved = np.tile(np.eye(4), (len(r), 1, 1))
        moved[:, 0, 1:] = r
        return np.asarray(np.einsum("eka,eikjl,elb->eiajb", moved, G, moved, optimize=True))


def rod_energy(
    d: fem.Function,
    length: fem.Function,
    stiffness: fem.Function,
    eigenstrain: fem.Function | None = None,
    viscosity: Expr | None = None,
    speeds: fem.Function | None = None,
    centres: LineOfCentres | None = None,
) -> StrainEnergy:
    """Energy ``½ ∫ ε·Dε ds`` of every element, unloaded in the current configuration.

    Args:
        d: Unloaded relative motion of both ends, shape ``(6,)``, a DG0 function.
        length: Unstretched arc length, or arc length per parameter at the midpoint, a DG0 function
            as all others.
        stiffness: Section stiffness, shape ``(6, 6)``.
        eigenstrain: Eigenstrain, shape ``(6,)``; default: none.
        viscosity: Viscosity, shape ``(6, 6)``; default: none.
        speeds: Speed of the parameter at both ends and at the Gauss points, relative to that at the
            midpoint, shape ``(4,)``; default: all one.
        centres: Points that the cubic joins; default: along the axis.
    """
    mesh = d.function_space.mesh
    along = fem.Function(fem.functionspace(mesh, ("DG", 1)))
    along.x.array[along.function_space.dofmap.list] = [-0.5, 0.5]
    cells = mesh.topology.index_map(mesh.topology.dim)
    count = cells.size_local + cells.num_ghosts
    if speeds is None:
        speeds = cellwise(mesh, np.ones((count, 4)))
    if centres is None:
        centres = LineOfCentres(*(cellwise(mesh, np.zeros((count, *n))) for n in ((3,), (2, 3))))
    z = ufl.variable(d)
    # linear from one of Gauss' points to the other
    here = 0.5 * (speeds[2] + speeds[3]) + along * (speeds[3] - speeds[2]) / (2 * _GAUSS)
    of_cubic = rod_strains(z, length, along, Speeds(speeds[0], speeds[1], here), centres.at_ends)
    strain = _on_axis(of_cubic, centres.centre)
    unloaded = present_values(strain, mesh, _POINTS)
    if eigenstrain is None:
        eigenstrain = cellwise(mesh, np.zeros((count, 6)))
    return StrainEnergy(
        strain=strain - unloaded - eigenstrain,
        law=lambda strain: 0.5 * ufl.inner(strain, stiffness * strain),
        dx=ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": _POINTS}),
        weight=length * here / ufl.CellVolume(mesh),
        viscosity=viscosity,
        through=z,
        forces=Forces(force_kernel, [length, stiffness, eigenstrain, unloaded, speeds, *centres]),
    )


def _on_axis(strain: Expr, r: Expr) -> Expr:
    """Strain ``(Γ − κ × r, κ)`` on the axis of a strain ``(Γ, κ)`` at ``r`` from it."""
    Γ, κ = (ufl.as_vector([strain[k + i] for i in range(3)]) for k in (0, 3))
    return ufl.as_vector([*(Γ - ufl.cross(κ, r)), *κ])


def lengths_along(ends: Array, lengths: Array, slopes: Array) -> Array:
    """Unstretched arc length per ``ξ`` at end, Gauss, midpoint, Gauss, end, (m, 5).

    Args:
        ends: Unloaded frames of both ends, shape (m, 2, 4, 3).
        lengths: Lengths of the cells, shape (m,).
        slopes: ``|dr/dξ|`` of their cubics at both ends, zero if only the lengths are known, shape
            (m, 2).
    """
    ξ = 0.5 + np.array([-0.5, -_GAUSS, 0.0, _GAUSS, 0.5])
    return np.where(slopes[:, :1] > 0, speeds_of_cubics(ends, slopes, ξ), lengths[:, np.newaxis])


def speeds_of_cubics(ends: Array, slopes: Array, ξ: Array) -> Array:
    """``|dr/dξ|`` at parameters (p,), shape (m, p); arguments as of :func:`lengths_along`."""
    chord = ends[:, 1, 0] - ends[:, 0, 0]
    a, b = (slopes[:, k, np.newaxis] * ends[:, k, 1] for k in range(2))
    shapes = np.stack([6 * ξ * (1 - ξ), 1 - 4 * ξ + 3 * ξ**2, 3 * ξ**2 - 2 * ξ])
    rates = np.einsum("kp,kmj->mpj", shapes, np.stack([chord, a, b]))
    return np.asarray(np.linalg.norm(rates, axis=-1))


def rod_strains(d: Expr, length: Expr, along: Expr, speeds: Speeds, at_ends: Expr) -> Expr:
    """Strains ``(m, 0, 0, τ, κ₂, κ₃)``, shape ``(6,)``; ``m`` is one without axial strain.

    Args:
        d: Relative motion of both ends, shape ``(6,)``.
        length: Unstretched arc length, or arc length per parameter at the midpoint.
        along: Parameter, −½ to ½ from end to end.
        speeds: Speed of the parameter.
        at_ends: Ends of the cubic in the frames of both nodes, shape ``(2, 3)``.
    """
    u, θ = (ufl.as_vector([d[k + i] for i in range(3)]) for k in (0, 3))
    x = ufl.dot(θ, θ)
    r_A, r_B = (ufl.as_vector([at_ends[k, i] for i in range(3)]) for k in range(2))
    moved = _turned(0.5 * θ, r_B) - _turned(-0.5 * θ, r_A)
    chord = (_series(x / 4, 1) * u + _series(x / 4, 3) / 4 * ufl.dot(θ, u) * θ + moved) / length
    first = [ufl.as_vector([float(i == k) for i in range(3)]) for k in range(3)]
    start, end = (
        speed * _turned(factor * θ, first[0])
        for speed, factor in ((speeds.start, -0.5), (speeds.end, 0.5))
    )
    m = _speed(chord, start + end)
    ξ = along + 0.5
    slope = 6 * ξ * (1 - ξ) * chord + m * (
        (1 - 4 * ξ + 3 * ξ**2) * start + (3 * ξ**2 - 2 * ξ) * end
    )
    bend = ((6 - 12 * ξ) * chord + m * ((6 * ξ - 4) * start + (6 * ξ - 2) * end)) / length
    size = ufl.sqrt(ufl.dot(slope, slope))
    t = slope / size
    here = length * speeds.here
    dt = (bend - ufl.dot(t, bend) * t) / size / speeds.here
    D, second, third = (_turned(along * θ, e) for e in first)
    dD, near = ufl.cross(θ, D) / here, 1 + ufl.dot(D, t)
    twist = θ[0] / here - ufl.dot(ufl.cross(D, t), dD + dt) / near
    # t′ is across t, so of the smallest rotation only what is along D counts
    across = dt - ufl.dot(D, dt) / near * (D + t)
    return ufl.as_vector([m, 0, 0, twist, -ufl.dot(across, third), ufl.dot(across, second)])


def _speed(chord: Expr, tangents: Expr) -> Expr:
    """Speed ``m`` from the chord over the length, and the sum of both tangents."""
    square = 1 - ufl.dot(tangents, tangents) / 16
    half = 3 * ufl.dot(chord, tangents) / 8
    return (ufl.sqrt(half**2 + 9 * square * ufl.dot(chord, chord) / 4) - half) / square


def _turned(φ: Expr, e: Expr) -> Expr:
    """Rotated vector ``exp(φ̂) e``."""
    x, across = ufl.dot(φ, φ), ufl.cross(φ, e)
    return e + _series(x, 1) * across + _series(x, 2) * ufl.cross(φ, across)


def _series(x: Expr, order: int) -> Expr:
    """``Σ (−x)ᵏ/(2k + order)!``: sin φ/φ, (1 − cos φ)/φ², (φ − sin φ)/φ³ of ``x = φ²``."""
    value: Expr | float = 0.0
    for k in reversed(range(_TERMS)):
        value = 1.0 / factorial(2 * k + order) - x * value
    return value

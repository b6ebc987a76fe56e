"""Restrained warping of thin-walled sections (Vlasov): springs between the twists of elements.

A section with warping stiffness ``EI_ω`` and twist ``κ₁`` per length has the axial displacement
``κ₁ ω(y, z)``; where the twist varies along the beam there is a bimoment ``−EI_ω κ₁'``::

    W = ½ ∫ EI_ω κ₁'² ds

The twist of an element from a to b is that of its strains, ``(r_y,b·r_z,a − r_y,a·r_z,b)/2ℓ``; its
derivative is the difference between successive elements over the distance of their midpoints. Where
warping is held the twist is zero at the end, half an element away. So the amplitude of warping is
not an unknown. (V. Z. Vlasov, *Thin-Walled Elastic Beams* (1961).)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback
from fem_lie.elements.rods.bends import Springs
from fem_lie.forms.kernels.addresses import Pointer
from fem_lie.forms.small_energy.cell import add_energy, add_forces, add_tangent
from fem_lie.forms.small_energy.element import CELL_SIGNATURE, cell_data, element
from fem_lie.lie.node_types.node_type import NodeType


class WarpingSprings(NamedTuple):
    """Springs against a change of twist between elements.

    Attributes:
        nodes: Three MIXED_DERIVATIVE nodes of each spring along the beam, shape (b, 3); at a held
            end the last two are the same.
        shares: ``1/2ℓ`` of both elements, zero for the second one at a held end, shape (b, 2), 1/m.
        stiffness: ``EI_ω`` over the distance, shape (b,), N m³.
        natural: Change of twist of the unloaded beam, shape (b,), 1/m.
    """

    nodes: Indices
    shares: Array
    stiffness: Array
    natural: Array

    @classmethod
    def between(
        cls, coordinates: Array, ends: Indices, lengths: Array, stiffness: float, held: Indices
    ) -> WarpingSprings:
        """Springs between the elements of a beam.

        Args:
            coordinates: Unloaded coordinates of all nodes, shape (n, 4, 3).
            ends: MIXED_DERIVATIVE nodes of both ends of the elements, shape (m, 2).
            lengths: Lengths of the elements, shape (m,).
            stiffness: ``EI_ω``.
            held: MIXED_DERIVATIVE nodes where warping is held.
        """
        first, second = np.nonzero(ends[:, 1, np.newaxis] == ends[np.newaxis, :, 0])
        last = np.flatnonzero(np.isin(ends, held).any(axis=1))
        once = np.isin(ends[last], held).sum(axis=1)
        last = np.repeat(last, once)
        nodes = np.concatenate(
            [np.column_stack([ends[first], ends[second, 1]]), ends[last][:, [0, 1, 1]]]
        )
        half = 0.5 / lengths
        shares = np.concatenate(
            [
                np.column_stack([half[first], half[second]]),
                np.column_stack([half[last], np.zeros(len(last))]),
            ]
        )
        middles = 0.5 * np.concatenate([lengths[first] + lengths[second], lengths[last]])
        y, z = coordinates[nodes, 1], coordinates[nodes, 2]
        twists = [
            np.einsum("bj,bj->b", y[:, k + 1], z[:, k])
            - np.einsum("bj,bj->b", y[:, k], z[:, k + 1])
            for k in range(2)
        ]
        natural = shares[:, 1] * twists[1] - shares[:, 0] * twists[0]
        return cls(nodes, shares, np.asarray(stiffness / middles), natural)

    @classmethod
    def joined(cls, parts: Sequence[WarpingSprings]) -> WarpingSprings:
        """Concatenation of several records."""
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _vectors(springs: WarpingSprings) -> Array:
    """``T`` of ``r_y``, ``r_z`` at the middle node, and of their fractions at both ends.

    The change of twist is ``(b r_y,2 + a r_y,0)·r_z,1 − r_y,1·(b r_z,2 + a r_z,0)``.
    """
    tables = np.zeros((len(springs.nodes), 1, 4, 6))
    tables[:, 0, 0, 2] = tables[:, 0, 1, 3] = 1.0
    for k in range(2):
        tables[:, 0, 2 + k, k] = springs.shares[:, 0]
        tables[:, 0, 2 + k, 4 + k] = springs.shares[:, 1]
    return tables


ELEMENT = element([NodeType.MIXED_DERIVATIVE] * 3, [(0, 2, 1, 1.0), (0, 0, 3, -1.0)], vectors=4)


@callback(CELL_SIGNATURE)
def energy_of_spring(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Energy of a spring."""
    add_energy(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def forces_of_spring(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Forces of a spring."""
    add_forces(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_spring(A: Pointer, w: Pointer, h: Pointer) -> None:
    """Tangent stiffness of a spring."""
    add_tangent(ELEMENT, A, w)


class Warping(Springs):
    """Springs of restrained warping, on the nodes of their assembly."""

    label = "restrained warping"

    def __init__(self, springs: WarpingSprings, count: int) -> None:
        """Pack the springs, on an assembly with ``count`` nodes."""
        parameters = np.column_stack([springs.natural, springs.stiffness])[:, np.newaxis]
        values = cell_data(ELEMENT, _vectors(springs), parameters)
        functions = energy_of_spring, forces_of_spring, tangent_of_spring
        super().__init__(functions, values, springs, count)

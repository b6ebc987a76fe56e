"""The steps that an integrator made: how wrong each of them was, and what contacts did in it."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array


@dataclass(frozen=True, eq=False)
class StepHistory:
    """All S steps of a run, kept or not, and the local error of each.

    Attributes:
        times: At the ends of the steps, shape (S,).
        sizes: Step sizes, shape (S,).
        translation: Estimated error of positions in the step, the largest of all nodes, shape (S,).
        rotation: Estimated error of rotations in the step, the largest of all nodes, rad.
        nodes: The nodes with these two errors, shape (S, 2).
        measured_translation: Error of positions, measured by a refined step; nan if it was not.
        measured_rotation: Error of rotations, rad, measured in the same way.
        rejected: Ends of the steps that were not accepted, shape (R,).
    """

    times: Array
    sizes: Array
    translation: Array
    rotation: Array
    nodes: npt.NDArray[np.int64]
    measured_translation: Array
    measured_rotation: Array
    rejected: Array

    def __post_init__(self) -> None:
        count = len(self.times)
        for field in fields(self):
            shape = getattr(self, field.name).shape
            wanted = {"nodes": (count, 2), "rejected": (len(self.rejected),)}
            if shape != wanted.get(field.name, (count,)):
                raise ValueError(f"{field.name} has the shape {shape} for {count} steps")

    @property
    def ratios(self) -> Array:
        """Estimated over measured errors of positions and of rotations, shape (S, 2)."""
        estimated = np.stack([self.translation, self.rotation], axis=1)
        measured = np.stack([self.measured_translation, self.measured_rotation], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(estimated / measured)


@dataclass(frozen=True, eq=False)
class ContactSteps:
    """All S steps of a run, kept or not.

    Attributes:
        times: At the ends of the steps, shape (S,).
        contacts: How many took part, zero in free flight, shape (S,).
        sweeps: Over these, in all passes.
        cone_residual: What is left of Coulomb's law, as a part of the largest impulse.
        penetration: The deepest overlap at the end.
        impact_loss: Energy that impulses along normals took.
        friction_loss: Energy that friction took.
        each: Contacts that pushed in the last step before each state that was kept, one after the
            other: time, a number for the contact, those of both its places, gap, position
            (3), impulse on the first side in that step (3), its velocity across the normal at the
            end (3), whether it sticks; :func:`~fem_lie.contact_forces` reads it, shape (k, 15).
    """

    times: Array
    contacts: Array
    sweeps: Array
    cone_residual: Array
    penetration: Array
    impact_loss: Array
    friction_loss: Array
    each: Array

    def __post_init__(self) -> None:
        """Raise ``ValueError`` if lengths differ."""
        for field in fields(self)[:-1]:
            if (shape := getattr(self, field.name).shape) != self.times.shape:
                raise ValueError(f"{field.name} has the shape {shape}, not {self.times.shape}")

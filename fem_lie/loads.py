"""Further loads, prestress and temperature, and histories in time."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.joints.histories import PiecewiseLinear, PiecewiseSmooth
    from fem_lie.scene.pressure_loads import PressureLoad, SurfacePressure
    from fem_lie.scene.solid_loads import BulkLoad, FaceLoad, FacePressure
    from fem_lie.scene.strain_loads import Eigenstrain, PreStress, Temperature
    from fem_lie.scene.surface_loads import EdgeLoad, MassLoad, VolumeLoad
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "BulkLoad",
    "EdgeLoad",
    "Eigenstrain",
    "FaceLoad",
    "FacePressure",
    "MassLoad",
    "PiecewiseLinear",
    "PiecewiseSmooth",
    "PreStress",
    "PressureLoad",
    "SurfacePressure",
    "Temperature",
    "VolumeLoad",
]

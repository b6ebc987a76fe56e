"""Further loads, prestress and temperature, force laws, and histories in time."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.joints.force_law import ForceLaw
    from fem_lie.joints.histories import PiecewiseLinear, PiecewiseSmooth
    from fem_lie.joints.laws import (
        CompressionOnly,
        ForceLawError,
        SpringTable,
        TensionOnly,
        compiled_law,
    )
    from fem_lie.scene.form_loads import FormLoad
    from fem_lie.scene.pressure_loads import PressureLoad, SurfacePressure
    from fem_lie.scene.solid_loads import BulkLoad, FaceLoad, FacePressure
    from fem_lie.scene.strain_loads import Eigenstrain, PreStress, Temperature
    from fem_lie.scene.surface_loads import EdgeLoad, MassLoad, VolumeLoad
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "BulkLoad",
    "CompressionOnly",
    "EdgeLoad",
    "Eigenstrain",
    "FaceLoad",
    "FacePressure",
    "ForceLaw",
    "ForceLawError",
    "FormLoad",
    "MassLoad",
    "PiecewiseLinear",
    "PiecewiseSmooth",
    "PreStress",
    "PressureLoad",
    "SpringTable",
    "SurfacePressure",
    "Temperature",
    "TensionOnly",
    "VolumeLoad",
    "compiled_law",
]

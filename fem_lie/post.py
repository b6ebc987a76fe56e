"""Postprocessing: section forces, stresses, contact forces, frequency response, pictures."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.pictures.page.colours import NodalColours
    from fem_lie.pictures.page.page import Page
    from fem_lie.pictures.stage import Units
    from fem_lie.pictures.vtk import write_resultants
    from fem_lie.results.record import StepHistory
    from fem_lie.results.stresses.contacts import ContactForces, contact_forces
    from fem_lie.results.stresses.section_forces import (
        CableForces,
        SectionForces,
        cable_forces,
        section_forces,
    )
    from fem_lie.results.stresses.shell_resultants import (
        Resultants,
        resultant_colours,
        resultant_series,
        resultants,
    )
    from fem_lie.results.stresses.solid_stress import SolidStresses, solid_stresses
    from fem_lie.results.stresses.thin_resultants import ThinResultants, thin_resultants
    from fem_lie.results.vibrations.response import FrequencyResponse
    from fem_lie.solve.small_motions.frequency_response import BaseExcitation, frequency_response
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "BaseExcitation",
    "CableForces",
    "ContactForces",
    "FrequencyResponse",
    "NodalColours",
    "Page",
    "Resultants",
    "SectionForces",
    "SolidStresses",
    "StepHistory",
    "ThinResultants",
    "Units",
    "cable_forces",
    "contact_forces",
    "frequency_response",
    "resultant_colours",
    "resultant_series",
    "resultants",
    "section_forces",
    "solid_stresses",
    "thin_resultants",
    "write_resultants",
]

"""Finite element formulations of beams, cables, shells and solids."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.elements.beams.directors import DirectorBeam, director_strains
    from fem_lie.elements.beams.element import BeamFormulation
    from fem_lie.elements.beams.geodesic import GeodesicBeam
    from fem_lie.elements.gradients.ancf import AncfElement
    from fem_lie.elements.gradients.plate import AncfPlate
    from fem_lie.elements.membranes.element import LinearMembrane, MembraneFormulation, TensionField
    from fem_lie.elements.rods.cable import HermiteCable
    from fem_lie.elements.rods.discrete import DiscreteCable
    from fem_lie.elements.rods.discrete_rod import DiscreteRod
    from fem_lie.elements.rods.isogeometric import IsogeometricCable
    from fem_lie.elements.rods.kirchhoff import KirchhoffRod
    from fem_lie.elements.shells.element import (
        DisplacementBased,
        HellingerReissner,
        HuWashizu,
        ShellFormulation,
    )
    from fem_lie.elements.shells.geodesic import GeodesicShell
    from fem_lie.elements.shells.measures import (
        DECOUPLED,
        MITC3_PLUS,
        MITC4,
        MITC4_PLUS,
        MITC6,
        MITC9,
        StrainMeasures,
    )
    from fem_lie.elements.solids.element import Isoparametric, MeanDilatation, SolidFormulation
    from fem_lie.elements.thin_shells.bicubic import BicubicHermite
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "DECOUPLED",
    "MITC3_PLUS",
    "MITC4",
    "MITC4_PLUS",
    "MITC6",
    "MITC9",
    "AncfElement",
    "AncfPlate",
    "BeamFormulation",
    "BicubicHermite",
    "DirectorBeam",
    "DiscreteCable",
    "DiscreteRod",
    "DisplacementBased",
    "GeodesicBeam",
    "GeodesicShell",
    "HellingerReissner",
    "HermiteCable",
    "HuWashizu",
    "IsogeometricCable",
    "Isoparametric",
    "KirchhoffRod",
    "LinearMembrane",
    "MeanDilatation",
    "MembraneFormulation",
    "ShellFormulation",
    "SolidFormulation",
    "StrainMeasures",
    "TensionField",
    "director_strains",
]

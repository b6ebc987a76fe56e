"""Contact: surfaces of bodies, and the contact law between two of them."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.contact.contact import Contact
    from fem_lie.contact.convex.polyhedron import ConvexPolyhedron
    from fem_lie.contact.laws.energy import UnresolvedContactWarning
    from fem_lie.contact.laws.law import Impact, Mortar, MortarPenalty, Penalty
    from fem_lie.contact.pairs.lines import Cylinder, Line
    from fem_lie.contact.pairs.patch_surfaces import Facets
    from fem_lie.contact.pairs.shapes import Box, Plane, Sphere, Vertices
    from fem_lie.contact.pairs.shell_surfaces import ShellSurface
    from fem_lie.contact.rings.surfaces import Rings, Rope
    from fem_lie.contact.sides.surfaces import ContactSurface
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "Box",
    "Contact",
    "ContactSurface",
    "ConvexPolyhedron",
    "Cylinder",
    "Facets",
    "Impact",
    "Line",
    "Mortar",
    "MortarPenalty",
    "Penalty",
    "Plane",
    "Rings",
    "Rope",
    "ShellSurface",
    "Sphere",
    "UnresolvedContactWarning",
    "Vertices",
]

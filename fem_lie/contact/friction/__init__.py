"""Coulomb friction of penalty contacts: return mapping, friction springs, forces and tangents."""

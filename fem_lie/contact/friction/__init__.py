"""Coulomb friction of contacts by penalty: return mapping, anchors, forces and tangents."""

"""Shells: strain measures, fields inside of cells, and the energies made of them."""

"""Shell elements: strain measures, independent fields of cells, and energies."""

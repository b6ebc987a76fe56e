"""Results written out: HDF5, VTK and VTX files, DOLFINx functions, tables."""

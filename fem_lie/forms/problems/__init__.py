"""Forms along nodal frames for solvers of PETSc and DOLFINx: their sum, and loads."""

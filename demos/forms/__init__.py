"""Elements of one's own: energies in UFL, and solvers of PETSc and DOLFINx."""

"""Model order reduction: floating frames, reduction bases in nodal frames, and error estimates."""

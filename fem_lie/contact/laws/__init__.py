"""Contact laws: `Penalty` and `Impact`, and the forces of the former."""

"""Steps that solve no equations: explicit ones, and of each element by itself."""

"""What was found: histories, equilibria, paths, modes and files."""

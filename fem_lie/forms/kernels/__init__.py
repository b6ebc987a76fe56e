"""Compiled kernels, which call others by their addresses: the same for all energies and maps."""

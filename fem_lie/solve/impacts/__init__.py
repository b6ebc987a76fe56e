"""Impulses at the end of a step: impacts, and projection of velocities onto constraints."""

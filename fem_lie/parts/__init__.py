"""Scenes divided among MPI ranks: who has which cells, and the scene of one part."""

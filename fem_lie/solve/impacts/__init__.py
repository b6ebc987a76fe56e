"""Impulses at the end of a step that a scheme has made without them: impacts, joint velocities."""

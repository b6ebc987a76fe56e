"""What a run keeps: rows of results, checkpoints, fingerprints."""

"""Recording of runs: rows of results, checkpoints, fingerprints."""

"""One sparse matrix, all that factorises or partitions it, spectra and pivots."""

"""Several MPI ranks that run the same script: output, shared factors, and termination."""

"""Energy and momenta of scenes with nodes that are no frames, beside frames or alone."""

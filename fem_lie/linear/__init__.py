"""The sparse matrix of a scene: factorisation, division into subdomains, spectra and pivots."""

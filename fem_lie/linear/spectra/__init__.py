"""Eigenvalue problems of small vibrations, with a residual check of each mode.

SLEPc's Krylov methods come first (``krylov``), a dense solution second (``dense``). The slowest
motions, which round-off of stiff elements hides, are computed in the span of rigid motions
(``slow_motions``). ``pencil`` defines the problem; no mode is accepted without its residual.
"""

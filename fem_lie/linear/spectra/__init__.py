"""Eigenvalue problems of small vibrations: solved, checked, and solved again where a check fails.

SLEPc's Krylov methods come first (``krylov``), a dense solution second (``dense``); the slowest
motions, which round-off of stiff elements hides, are computed in the span of rigid motions
(``slow_motions``). ``pencil`` brings them together and accepts no mode without its residual.
"""

"""Hyper-reduction: forces and matrix in few shapes from few cells with weights."""

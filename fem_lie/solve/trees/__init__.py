"""Explicit steps of rigid bodies in trees of joints, without constraints or a matrix."""

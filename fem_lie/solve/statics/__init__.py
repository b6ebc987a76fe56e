"""Equilibrium: load steps, paths along loads, steady rotation."""

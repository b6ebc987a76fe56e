"""Schemes of higher order composed of steps of another scheme."""

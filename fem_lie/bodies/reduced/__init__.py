"""Reduced-order bodies: a floating frame with modal coordinates."""

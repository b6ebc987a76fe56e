"""Equations of joints, compiled: written in the relative motion of two frames."""

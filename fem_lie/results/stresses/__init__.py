"""Stress resultants of shells and section forces of beams, in any states."""

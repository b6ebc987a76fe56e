"""Beams whose points have a place and all three of its slopes."""

"""Regions of bodies that move with one frame each, merged and split while a motion runs."""

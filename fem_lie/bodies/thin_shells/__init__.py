"""Thin shells on smooth patches: places, slopes and mixed derivatives."""

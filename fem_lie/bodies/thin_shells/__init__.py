"""Thin shells on smooth patches, with positions, surface gradients and mixed derivatives."""

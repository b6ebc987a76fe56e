"""Reduction: rigid motion taken out, bases of what is left in local frames, and their errors."""

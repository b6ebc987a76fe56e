"""Explicit schemes: synchronous, and asynchronous with a step size for each element."""

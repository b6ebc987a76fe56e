"""Multi-rate scheme: a step size for each body, with multipliers between bodies."""

"""Rigid-body frames."""
from fem_lie._lie_scalar import *
